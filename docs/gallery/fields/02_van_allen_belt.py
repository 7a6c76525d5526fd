"""
A proton in Van Allen's belt
============================

A proton of 10 MeV is trapped by the Earth's dipole field at two Earth radii from the centre: it gyrates 59 times a second,
bounces from north to south and back in 1.04 s and drifts around the Earth in 145 s. The theory of such particles (Walt,
Introduction to Geomagnetically Trapped Radiation, 1994) gives 1.04 s and 146 s. The picture shows one minute, in radii of the
Earth.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

earth, surface_field = 6.371e6, 3.12e-5  # m, T at the equator
speed = 2.998e8 * np.sqrt(1 - 1 / (1 + 10 / 938.272) ** 2)  # m/s, of 10 MeV
charge_to_mass = 1.602e-19 / (1.6726e-27 * (1 + 10 / 938.272))  # with the mass at that speed


def dipole(x):  # x in radii of the Earth
    r2 = x @ x
    return surface_field / r2**2.5 * np.array([-3 * x[0] * x[2], -3 * x[1] * x[2], r2 - 3 * x[2] ** 2])


proton = kd.ChargedParticle(charge_to_mass, dipole)
pitch = np.radians(45)
v0 = np.array([0.0, np.sin(pitch), np.cos(pitch)]) * speed / earth
sol = kd.solve(proton, (0.0, 60.0), x0=[2.0, 0.0, 0.0], v0=v0, step=2e-4, method="boris", save_every=20)

fig = plt.figure(figsize=(6.2, 5.4))
ax = fig.add_subplot(projection="3d")
u, w = np.mgrid[0 : 2 * np.pi : 40j, 0 : np.pi : 20j]
ax.plot_surface(np.cos(u) * np.sin(w), np.sin(u) * np.sin(w), np.cos(w), color="lightblue", linewidth=0, alpha=0.6)
ax.plot(*sol.x.T, linewidth=0.4, color="C3")
ax.set(xlabel="x (radii of the Earth)", ylabel="y", zlabel="z")
ax.set(zlim=(-1.6, 1.6), xticks=range(-2, 3), yticks=range(-2, 3), zticks=(-1, 0, 1))
ax.set_box_aspect((1, 1, 0.75))
north = np.flatnonzero((sol.x[1:, 2] > 0) & (sol.x[:-1, 2] <= 0))
longitude = np.unwrap(np.arctan2(sol.x[:, 1], sol.x[:, 0]))
print(f"bounces once in {np.diff(sol.t[north]).mean():.2f} s")
print(f"drifts around in {60 * 2 * np.pi / abs(longitude[-1]):.0f} s")
print(f"relative change of the speed {abs(np.linalg.norm(sol.v[-1]) / np.linalg.norm(sol.v[0]) - 1):.0e}")

"""
Kozai-Lidov cycles
==================

A planet circles its star at 1 au, nearly in a circle. Far out, a companion of half the star's mass moves on an orbit
that is inclined by 65 degrees. It does not pull the planet away, but in thousands of years it exchanges inclination for
eccentricity and back (Lidov 1962, Kozai 1962).

The component of the planet's angular momentum along the axis of the companion's orbit is nearly conserved, and so the
largest eccentricity is near :math:`\\sqrt{1 - \\frac{5}{3} \\cos^2 i_0} = 0.838`.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

GM = 4 * np.pi**2  # of the Sun, au^3/yr^2
tilt, far = np.radians(65), 20.0
x0 = [[0, 0, 0], [0.95, 0, 0], [far, 0, 0]]  # at the perihelion of an orbit with e = 0.05
speed = np.sqrt(1.5 * GM / far)
around = np.sqrt(GM * 1.05 / 0.95)
v0 = [[0, 0, 0], [0, np.cos(tilt) * around, np.sin(tilt) * around], [0, speed, 0]]
stars = kd.systems.planetary([1.0, 0.0, 0.5], x0, v0, G=GM, names=["star", "planet", "companion"])
sol = kd.solve(stars, (0.0, 30_000.0), step=1 / 120, method="wisdom-holman", save_every=1000)
planet = kd.analysis.orbital_elements(sol)

fig, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(7, 4.6))
top.plot(sol.t, planet.e[:, 0])
top.axhline(np.sqrt(1 - 5 / 3 * np.cos(tilt) ** 2), color="grey", linestyle="--", label="Kozai's limit")
top.set(ylabel="eccentricity", ylim=(0, 1))
top.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
bottom.plot(sol.t, np.degrees(planet.i[:, 0]), color="C1")
bottom.set(xlabel="years", ylabel="inclination (degrees)")
print(
    f"largest eccentricity {planet.e[:, 0].max():.3f}, least inclination {np.degrees(planet.i[:, 0].min()):.1f} degrees"
)
print(f"largest relative error of the energy {kd.analysis.largest_energy_error(sol):.1e}")

"""
A magnetic bottle
=================

Where field lines converge, charges that spiral along them turn around, as in a mirror.

The magnetic moment :math:`\\mu = \\frac{v_\\perp^2}{2 B}` per unit of mass is conserved, and so the charge turns around
where its velocity is perpendicular to the field: at :math:`B = \\frac{v^2}{2 \\mu}`. On the axis the field is
:math:`B = 1 + z^2`, and with 0.3 along the field and 0.5 across it in the middle, the ion turns near
:math:`z = 0.3 / 0.5 = 0.6`. The moment is conserved to 1 %, since the field changes a little during one gyration. Boris' method
conserves the speed to rounding error.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd


def bottle(x):
    return np.array(
        [-x[0] * x[2], -x[1] * x[2], 1 + x[2] ** 2 - 0.5 * (x[0] ** 2 + x[1] ** 2)]
    )  # without curl or sources


ion = kd.ChargedParticle(charge_to_mass=20.0, magnetic_field=bottle, energy=lambda x, v: 0.5 * (v @ v))
sol = kd.solve(ion, (0.0, 60.0), x0=[0.1, 0, 0], v0=[0, 0.5, 0.3], step=0.005, method="boris")

fig = plt.figure(figsize=(8.5, 4), layout="constrained")
ax = fig.add_subplot(1, 2, 1, projection="3d")
ax.plot(*sol.x[:2600].T, linewidth=0.6)
ax.set(xlabel="x", ylabel="y", zlabel="z", xticks=[0.1, 0.12], yticks=[-0.02, 0.02])
field = np.array([bottle(x) for x in sol.x])
size = np.linalg.norm(field, axis=1)
along = (sol.v * field).sum(axis=1) / size
moment = ((sol.v**2).sum(axis=1) - along**2) / (2 * size)
right = fig.add_subplot(1, 2, 2)
right.plot(sol.t, sol.x[:, 2], label="z")
right.plot(sol.t, moment / moment[0], label="magnetic moment / initial value", linewidth=0.8)
right.set(xlabel="t", ylim=(-0.9, 1.8))
right.legend()
print(
    f"turns around at z = {sol.x[:, 2].max():.3f}; moment constant to {100 * abs(moment / moment[0] - 1).max():.1f} %"
)
print(f"largest relative error of the energy {kd.analysis.largest_energy_error(sol):.1e}")

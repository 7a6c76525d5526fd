"""
Order and chaos in the Hénon-Heiles system
==========================================

A star moves through a galaxy in a potential that is not quite round (Hénon and Heiles 1964).

Each time it crosses :math:`x = 0` with :math:`v_x > 0`, its :math:`y` and :math:`v_y` give a point. At an energy of
1/12 the points of each orbit lie on curves, as if something besides the energy were conserved. At 1/8 only islands of such
curves are left, in a chaotic sea over which a single orbit spreads.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd


def force(x, out):
    out[0] = -x[0] - 2 * x[0] * x[1]
    out[1] = -x[1] - x[0] ** 2 + x[1] ** 2


def height(y):
    return 0.5 * y * y - y**3 / 3


fig, axes = plt.subplots(1, 2, figsize=(8.5, 4.2), layout="constrained", sharey=True)
for ax, energy in zip(axes, (1 / 12, 1 / 8), strict=True):
    for number, y in enumerate(np.linspace(-0.25, 0.45, 14)):
        start = [0.0, y], [np.sqrt(2 * (energy - height(y))), 0.0]
        options = {"step": 0.1, "method": "blanes-moan-srkn11b"}
        section = kd.analysis.poincare_section(force, lambda x: x[0], (0.0, 4000.0), *start, **options)
        ax.plot(section.x[:, 1], section.v[:, 1], ".", markersize=0.8, color=f"C{number % 10}")
    ax.set(title=f"energy 1/{1 / energy:.0f}", xlabel="$y$")
axes[0].set_ylabel("$v_y$")
for energy, y in ((1 / 12, 0.1), (1 / 8, -0.2)):
    found = kd.analysis.lyapunov_exponent(
        force, (0.0, 5000.0), [0.0, y], [np.sqrt(2 * (energy - height(y))), 0.0], step=0.1
    )
    print(f"energy {energy:.4f}, y = {y}: Lyapunov exponent {found.values[0]:.4f}")

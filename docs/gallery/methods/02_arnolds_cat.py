"""
What becomes of an area
=======================

A disk of states of a pendulum, in the plane of angle and angular velocity: blue at the start, orange and green after 4 and 8
units of time. The exact motion stretches it and conserves its area. So do the semi-implicit Euler method and Verlet's, step
by step; the explicit method enlarges it, and the implicit one shrinks it.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

angles = np.linspace(0, 2 * np.pi, 400)
disk = np.stack([1.4 + 0.5 * np.cos(angles), 0.5 * np.sin(angles)])


def area(x, v):
    return 0.5 * abs(np.sum(x * np.roll(v, -1) - v * np.roll(x, -1)))


fig, panels = plt.subplots(2, 2, figsize=(8, 6), sharex=True, sharey=True, layout="constrained")
for ax, method in zip(
    panels.flat, ("explicit-euler", "implicit-euler", "semi-implicit-euler", "velocity-verlet"), strict=True
):
    sol = kd.solve(lambda x: -np.sin(x), (0.0, 8.0), *disk, step=0.2, method=method, save_every=20)
    for x, v in zip(sol.x, sol.v, strict=True):
        ax.fill(x, v, alpha=0.6)
    ax.set(title=method, aspect="equal")
    print(f"{method:20} area after 8: {area(sol.x[-1], sol.v[-1]) / area(*disk):.4f} of that at the start")
fig.supxlabel("angle (rad)")
fig.supylabel("angular velocity (rad per unit of time)")

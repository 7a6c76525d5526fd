"""
The pendulum wave
=================

Fifteen pendulums side by side, of such lengths that in a minute the first swings 51 times and the last 65 times. Released
together, they make waves that run, stand, and dissolve, and after a minute all of them are together again. Angles are small
here, 5 degrees, and yet large enough to matter: at this amplitude, periods are 0.05 % longer, and so all pendulums meet 0.03
s late.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

swings = np.arange(51, 66)
lengths = 9.81 / (2 * np.pi * swings / 60) ** 2  # m


def pendulums(x):
    return -9.81 / lengths * np.sin(x)


start = np.full(15, np.radians(5))
sol = kd.solve(pendulums, (0.0, 62.0), start, 0 * start, step=0.002, method="blanes-moan-srkn6b", save_every=5)
fig, panels = plt.subplots(2, 4, sharex=True, sharey=True, figsize=(8, 3.6), layout="constrained")
for ax, time in zip(panels.flat, (0, 1, 4, 7.5, 15, 20, 30, 60), strict=True):
    angles = np.degrees(sol.x[abs(sol.t - time).argmin()])
    ax.plot(swings, angles, "o-", linewidth=0.6, markersize=4)
    ax.set_title(f"{time} s", loc="left", fontsize=9)
fig.supxlabel("swings a minute")
fig.supylabel("angle (degrees)")
late = sol.t > 50
print(f"lengths from {100 * lengths.min():.1f} to {100 * lengths.max():.1f} cm")
print(f"together again at {sol.t[late][sol.x[late].mean(axis=1).argmax()]:.2f} s")

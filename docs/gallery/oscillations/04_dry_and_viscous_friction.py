"""
Dry and viscous friction
========================

A block swings on a spring. Viscous friction removes the same fraction of its amplitude in every period: an exponential.

Dry friction, which is the same at any speed, removes the same length, :math:`4 \\mu N / k`, in every period: a straight
line, and then the block is at rest. Both laws are dotted in the picture. The dry force jumps where the block turns around;
steps end there (``switches=``), so that a method of order four keeps its order.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd


def dry(x, params):
    return -x - 0.1 * params[-1]  # params[-1]: 1 or -1, the side of v = 0 on which the step is


slides = kd.solve(dry, (0.0, 14 * np.pi), 2.55, 0.0, step=0.05, method="blanes-moan-srkn6b", switches=lambda v: v)
viscous = kd.Damped(lambda x: -x, damping=0.1)
flows = kd.solve(viscous, (0.0, 14 * np.pi), x0=2.55, v0=0.0, step=0.05, method="blanes-moan-conformal-4")

fig, ax = plt.subplots(figsize=(7.5, 3.6))
ax.plot(slides.t, slides.x, label="dry")
ax.plot(flows.t, flows.x, label="viscous")
line = np.maximum(2.55 - 0.4 * slides.t / (2 * np.pi), 0)
ax.plot(slides.t, line, "C0:", flows.t, 2.55 * np.exp(-0.05 * flows.t), "C1:")
ax.set(xlabel="t", ylabel="x")
ax.legend()
peaks = [float(slides(2 * np.pi * turn).x) for turn in range(7)]
print("dry friction, peaks:", np.round(peaks, 6), f"and rest at {float(slides.x[-1]):.6f}")

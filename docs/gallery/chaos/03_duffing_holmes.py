"""
A strange attractor
===================

A steel strip between two magnets is shaken and damped (Moon and Holmes 1979).

Its equation is :math:`x'' = x - x^3 - 0.25\\, x' + 0.4 \\cos t`. Sampled once per period of the shaking, its
position and velocity are points of a set that is neither a curve nor an area. Two thousand strips, an ensemble, are
sampled after 30 to 50 periods.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

strip = kd.Damped(lambda t, x: x - x**3 + 0.4 * np.cos(t), damping=0.25)
starts = np.random.default_rng(1).uniform(-1.5, 1.5, (2, 2000))
period = 2 * np.pi
many = kd.solve_ensemble(
    strip, (0.0, 50 * period), x0=starts[0], v0=starts[1], step=period / 100, method="blanes-moan-conformal-4",
    save_every=100,
)  # fmt: skip
fig, ax = plt.subplots(figsize=(7, 4.6))
ax.plot(many.x[:, 30:].ravel(), many.v[:, 30:].ravel(), ",", color="C0")
ax.set(xlabel="x", ylabel="v")
points = np.stack([many.x[:, 30:].ravel(), many.v[:, 30:].ravel()])
boxes = [len(np.unique(np.floor(points.T / size), axis=0)) for size in (0.2, 0.1, 0.05, 0.025)]
print(f"boxes of 0.2, 0.1, 0.05, 0.025 that have points: {boxes}")
print(f"dimension about {np.polyfit(np.log2([1, 2, 4, 8]), np.log2(boxes), 1)[0]:.1f}")

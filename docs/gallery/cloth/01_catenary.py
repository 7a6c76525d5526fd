"""
The catenary
============

A chain of 40 links hangs between two points at the same height.

Galileo likened it to a parabola; it is a hyperbolic cosine (Huygens, Leibniz, Johann Bernoulli 1691), :math:`y = a \\cosh
(x / a)`. The links are damped a little, so that the chain comes to rest; it follows the curve to within two millimetres.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import kickdrift as kd

count, link, span = 40, 0.1, 2.6  # 4 m of chain over 2.6 m
half_angle = brentq(lambda b: count * link * np.sin(b) / b - span, 0.1, 3.0)  # begin on an arc of a circle
turns = np.linspace(-half_angle, half_angle, count + 1)
middle = 0.5 * (turns[1:] + turns[:-1])
steps = link * np.stack([np.cos(middle), 0 * middle, np.sin(middle)], axis=1)
nodes = np.concatenate([[[0, 0, 0]], np.cumsum(steps, axis=0)])
nodes[:, 0] *= span / nodes[-1, 0]
world, before = kd.World(), None
for a, b in zip(nodes[:-1], nodes[1:], strict=True):
    tilt = np.arctan2(b[0] - a[0], b[2] - a[2])
    piece = world.add_capsule(
        0.008, np.linalg.norm(b - a) - 0.016, position=0.5 * (a + b),
        orientation=(np.cos(tilt / 2), 0, np.sin(tilt / 2), 0),
        mass=0.1, angular_damping=3.0, damping=0.5, collides_with=(),
    )  # fmt: skip
    world.add_ball_joint(before, piece, anchor=a)
    before = piece
world.add_ball_joint(piece, None, anchor=nodes[-1])
recording = world.run(duration=20.0, step=1 / 60, save_every=60)
x, _, z = recording.x[-1, recording.moving].T

length = np.linalg.norm(np.diff(nodes, axis=0), axis=1).sum()
a = brentq(lambda a: 2 * a * np.sinh(span / (2 * a)) - length, 0.1, 10.0)
fig, ax = plt.subplots(figsize=(6, 4))
ax.plot(x, z, "o", markersize=4, label="links of the chain")
line = np.linspace(0, span, 200)
curve = a * (np.cosh((line - span / 2) / a) - np.cosh(span / (2 * a)))
ax.plot(line, curve, label="catenary")
ax.plot(line, -curve.min() * ((2 * line / span - 1) ** 2 - 1), "--", linewidth=0.8, label="parabola of the same sag")
ax.set(aspect="equal", xlabel="x (m)", ylabel="z (m)")
ax.legend()
off = np.interp(x, line, curve) - z
print(f"links are within {1e3 * abs(off).max():.1f} mm of the catenary, whose sag is {-curve.min():.3f} m")

"""
A bouncing ball
===============

A ball of restitution 0.8 is thrown over a floor with friction. Each bounce reaches 0.64 of the height of the one before, and
takes 0.8 of its time, so that infinitely many of them fit into a finite time, after which the ball rolls. Impacts are located
within the step, and so steps of 1/60 s suffice.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

world = kd.World()
world.add_plane(friction=0.5)
ball = world.add_sphere(
    0.05, position=(0, 0, 1.05), velocity=(0.6, 0, 0), density=1000.0, restitution=0.8, friction=0.5
)
recording = world.run(duration=5.0, step=1 / 60)
x, _, z = recording.x[:, ball.index].T

floor = kd.Impacts(lambda x: x[1], restitution=0.8)
point = kd.solve(
    lambda x: np.array([0.0, -9.81]), (0.0, 5.0), [0, 1], [0.6, 0], step=0.01, method="velocity-verlet", impacts=floor
)
fig, ax = plt.subplots(figsize=(7.5, 3.4))
ax.plot(recording.t, z - 0.05, ".-", markersize=3, linewidth=0.8, label="a world, 60 steps a second")
ax.plot(point.t, point.x[:, 1], linewidth=0.8, label="a point, by solve and impacts")
ax.set(xlabel="time (s)", ylabel="height (m)")
ax.legend()
total = np.sqrt(2 / 9.81) * (1 + 0.8) / (1 - 0.8)
print(
    f"bouncing ends after {total:.3f} s by theory; "
    f"after 4.2 s the world's ball is within {1e6 * abs(z[-48] - 0.05):.0f} micrometres of the floor"
)
print(f"highest after the third bounce: {(z[recording.t > 1.76] - 0.05).max():.4f} m; theory {0.64**3:.4f} m")

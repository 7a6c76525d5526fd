"""
Newton's cradle
===============

Five steel balls hang side by side. Two are raised, and two fly off at the other side, even though all of them touch: the blow
passes from ball to ball, and each impact happens at its own time within the step.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

world = kd.World()
balls = []
for number in range(5):
    raised = np.radians(40) if number < 2 else 0.0
    top = (0.1 * (number - 2), 0, 1)
    place = (top[0] - np.sin(raised), 0, 1 - np.cos(raised))
    ball = world.add_sphere(radius=0.05, position=place, density=7800.0, friction=0.0, restitution=1.0)
    world.add_distance_joint(None, ball, anchor_a=top, anchor_b=place)
    balls.append(ball)
recording = world.run(duration=4.0, step=1 / 240)

fig, ax = plt.subplots(figsize=(7.5, 3.8))
for number, ball in enumerate(balls):
    x, y, z = recording.x[:, ball.index].T
    angle = np.degrees(np.arctan2(x - 0.1 * (number - 2), 1 - z))
    # Wide lines below thin ones: balls that move together are both seen.
    ax.plot(recording.t, angle, linewidth=8 - 1.7 * number, label=f"ball {number + 1}")
ax.set(xlabel="time (s)", ylabel="angle (degrees)")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=5, fontsize=8)
last = recording.x[:, balls[-1].index, 0] - 0.2
print(f"the fifth ball swings out to {np.degrees(np.arcsin(last[recording.t < 1.6].max())):.2f} degrees")
energy = recording.derived["kinetic energy"] + recording.derived["potential energy"]
print(
    f"energy change in 4 s: {energy[-1] - energy[0]:.4f} J "
    f"of at most {recording.derived['kinetic energy'].max():.2f} J of kinetic energy"
)

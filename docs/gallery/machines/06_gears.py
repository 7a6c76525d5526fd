"""
A gear train
============

Three wheels of 12, 24 and 36 teeth. A torque of 0.2 N m on the first one turns all of them, as if it alone had the sum of their
moments of inertia, each divided by the square of its gear ratio.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

teeth, module = (12, 24, 36), 0.01  # radius is half of teeth times module
world = kd.World(gravity=(0, 0, 0))
hinges, wheels, x = [], [], 0.0
for number, count in enumerate(teeth):
    radius = 0.5 * module * count
    x += radius if number else 0.0
    wheel = world.add_cylinder(radius, 0.02, position=(x, 0, 0), density=7800.0, collides_with=())
    hinges.append(world.add_hinge(None, wheel, anchor=(x, 0, 0), axis=(0, 0, 1)))
    wheels.append(wheel)
    x += radius
for a, b in ((0, 1), (1, 2)):
    world.add_gear(hinges[a], hinges[b], ratio=-teeth[b] / teeth[a])
rows = []
for _ in range(120):
    hinges[0].apply_effort(0.2)
    world.step(1 / 60)
    rows.append([world.time, *(hinge.speed for hinge in hinges)])
t, *speeds = np.array(rows).T
fig, ax = plt.subplots(figsize=(7, 3.4))
for count, speed in zip(teeth, speeds, strict=True):
    ax.plot(t, speed, label=f"{count} teeth")
ax.set(xlabel="time (s)", ylabel="angular velocity (rad/s)")
ax.legend()
inertia = sum(wheel.inertia[2, 2] * (teeth[0] / count) ** 2 for wheel, count in zip(wheels, teeth, strict=True))
print(
    f"after 2 s {speeds[0][-1]:.3f}, {speeds[1][-1]:.3f}, {speeds[2][-1]:.3f} rad/s; "
    f"expected of the first {0.2 * 2 / inertia:.3f}"
)

"""
A car on a slope
================

A car of one tonne with front-wheel drive, on a slope of 15 degrees.

On dry asphalt (friction 0.9) it climbs. On wet leaves (0.35) the front wheels spin, and it rolls back, as the second picture
shows: the front wheels carry less than half of the weight, and :math:`\\tan 15° = 0.27` is more than half of 0.35.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

slope = np.radians(15)
fig, ax = plt.subplots(figsize=(7, 3.6))
for name, friction in (("dry", 0.9), ("wet leaves", 0.35)):
    world = kd.World(gravity=(-9.81 * np.sin(slope), 0, -9.81 * np.cos(slope)))  # the floor is level, the weight leans
    world.add_plane(friction=friction)
    body = world.add_box((3.6, 1.5, 0.5), position=(0, 0, 0.6), mass=900.0)
    wheels = []
    for x in (1.2, -1.2):
        for y in (-0.75, 0.75):
            lying = (np.sqrt(0.5), np.sqrt(0.5), 0, 0)
            wheel = world.add_cylinder(
                0.32, 0.2, position=(x, y, 0.32), orientation=lying, mass=25.0, friction=friction
            )
            motor = kd.Motor(speed=25.0, maximum=550.0) if x > 0 else None  # N m
            wheels.append(world.add_hinge(body, wheel, anchor=(x, y, 0.32), axis=(0, 1, 0), motor=motor))
            world.exclude(body, wheel)
    recording = world.run(duration=5.0, step=1 / 200)
    ax.plot(recording.t, recording.x[:, body.index, 0], label=f"{name}, friction {friction}")
    print(f"{name}: {recording.x[-1, body.index, 0]:.1f} m in 5 s, front wheels at {wheels[0].speed:.1f} rad/s")
ax.set(xlabel="time (s)", ylabel="distance uphill (m)")
ax.legend()
figure = recording.plot()

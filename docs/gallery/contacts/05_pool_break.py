"""
The break
=========

Fifteen balls touch each other in a triangle, and the cue ball comes at 8 m/s. Pool balls have a restitution of 0.93, and the
rolling resistance of the cloth slows them down (Alciatore, The Illustrated Principles of Pool and Billiards).
"""

import numpy as np

import kickdrift as kd

radius, length, width = 0.02858, 2.54, 1.27  # m: WPA
world = kd.World(substeps=8, margin=0.003, slop=0.0002)
world.add_plane(friction=0.2, rolling_resistance=0.01 * radius)
for side in (-1, 1):
    world.add_box(
        (length + 0.2, 0.1, 0.08), position=(0, side * (width / 2 + 0.05), 0.04), static=True, restitution=0.75
    )
    world.add_box((0.1, width, 0.08), position=(side * (length / 2 + 0.05), 0, 0.04), static=True, restitution=0.75)
options = {"mass": 0.17, "friction": 0.06, "restitution": 0.93}
for row in range(5):
    for place in range(row + 1):
        x, y = length / 4 + row * radius * np.sqrt(3), radius * (2 * place - row)
        world.add_sphere(radius, position=(x, y, radius), **options)
world.add_sphere(radius, position=(-length / 4, 0.002, radius), velocity=(8, 0, 0), name="white", **options)
recording = world.run(duration=6.0, step=1 / 240)
figure = recording.plot()
moving = np.linalg.norm(recording.v[:, recording.moving], axis=2)
print(
    f"{(moving.max(axis=0) > 0.5).sum()} balls have moved faster than 0.5 m/s; "
    f"after 6 s {(moving[-1] > 0.01).sum()} still roll"
)
recording.show()

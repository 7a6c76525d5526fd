"""
A flag in the wind
==================

A flag of 1.2 m by 0.7 m in a wind of 6 m/s. Each triangle takes drag and lift from the air that flows past it; waves run along
the cloth, and its free edge beats several times per second.
"""

import numpy as np

import kickdrift as kd

world = kd.World()
world.add_capsule(radius=0.02, length=2.0, position=(-0.03, 0, 1.0), static=True)
upright = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
flag = world.add_cloth_grid(
    (1.2, 0.7), (32, 18), position=(0.6, 0, 1.6), orientation=upright,
    density=0.12, bending_stiffness=1e-5, damping=1e-3,
    drag=1.0, lift=1.0, name="flag",
)  # fmt: skip
flag.pin(np.arange(18))
flag.wind = (6.0, 0.9, 0.0)
recording = world.run(duration=4.0, step=1 / 60)
figure = recording.plot()
edge = recording.cloth("flag")[60:, -9, 1]  # the middle of the free edge, from 1 s on
beats = ((edge[1:] > edge.mean()) & (edge[:-1] <= edge.mean())).sum() / 3.0
print(f"the free edge swings over {np.ptp(edge):.2f} m, {beats:.1f} times a second")
recording.show()

"""
Dominoes
========

Forty dominoes in a row, of which the first is pushed. After the first few, the wave runs at a constant speed: impacts and
friction take away the energy that the falling dominoes gain.
"""

import numpy as np

import kickdrift as kd

world = kd.World()
world.add_plane(friction=0.5)
stones = [
    world.add_box((0.0075, 0.024, 0.048), position=(0.024 * n, 0, 0.024), density=1400.0, friction=0.3, restitution=0.0)
    for n in range(40)
]
stones[0].angular_velocity = (0, 6, 0)
stones[0].velocity = (0.144, 0, 0)
recording = world.run(duration=2.0, step=1 / 480)
tilt = 2 * np.degrees(np.arcsin(np.clip(recording.orientation[:, [s.index for s in stones], 2], -1, 1)))
falls = np.array([recording.t[(lean > 10).argmax()] for lean in tilt.T])

figure = recording.plot()
speed = 19 * 0.024 / (falls[39] - falls[20])
print(f"all {(tilt[-1] > 10).sum()} have fallen; the second half of the wave runs at {speed:.2f} m/s")

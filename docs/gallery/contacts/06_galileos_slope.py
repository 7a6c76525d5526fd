"""
Galileo's slope
===============

A ball, a solid cylinder and a ring roll down a slope of 10 degrees, and a block slides beside them without friction. The block
arrives first, since rolling bodies have to gain rotation as well.

The acceleration is :math:`a = \\frac{g \\sin \\alpha}{1 + I / (m r^2)}`, with :math:`I / (m r^2)` of 2/5, 1/2 and 1 for those
that roll, and 0 for the block. All are ahead by a thousandth: bodies in contact move with the velocity after the kick, and so
are half a substep, 1 ms, early.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

alpha, g, r = np.radians(10), 9.81, 0.1
world = kd.World(gravity=(g * np.sin(alpha), 0, -g * np.cos(alpha)))  # tilt the weight, not the floor
world.add_plane(friction=0.6)
lying = (np.sqrt(0.5), np.sqrt(0.5), 0, 0)
ball = world.add_sphere(r, position=(0, 0, r), mass=1.0, friction=0.6, name="ball")
full = world.add_cylinder(r, 0.1, position=(0, 0.5, r), orientation=lying, mass=1.0, friction=0.6, name="cylinder")
ring = world.add_cylinder(
    r,
    0.1,
    position=(0, 1.0, r),
    orientation=lying,
    mass=1.0,
    inertia=(r * r / 2, r * r / 2, r * r),
    friction=0.6,
    name="ring",
)
block = world.add_box((0.2, 0.2, 0.2), position=(0, 1.5, r), mass=1.0, friction=0.0, name="block")
recording = world.run(duration=2.0, step=1 / 120)
fig, ax = plt.subplots(figsize=(7, 3.8))
for name, ratio in (("block", 0.0), ("ball", 0.4), ("cylinder", 0.5), ("ring", 1.0)):
    way = recording.x[:, recording.row(name), 0]
    ax.plot(recording.t, way, label=name)
    expected = 0.5 * g * np.sin(alpha) / (1 + ratio) * 2.0**2
    print(f"{name:9} {way[-1]:.4f} m in 2 s; theory {expected:.4f} m")
ax.set(xlabel="time (s)", ylabel="distance (m)")
ax.legend()

"""
A wheel hung by its axle
========================

A bicycle wheel hung by one end of its axle does not tip over as long as it spins: its weight turns the axle sideways, at the
rate :math:`m g l / (I \\omega)`. In this version of the classic lecture experiment, the wheel is a disk of 3 kg, whose
axle hangs from a ball joint, and which starts with that rate of precession.
"""

import numpy as np

import kickdrift as kd

radius, mass, length, spin = 0.3, 3.0, 0.2, 30.0
inertia = 0.5 * mass * radius**2  # a disk
precession = mass * 9.81 * length / (inertia * spin)
world = kd.World(substeps=20)
across = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)  # the cylinder's axis along x
wheel = world.add_cylinder(
    radius, 0.04, position=(length, 0, 0), orientation=across, mass=mass, velocity=(0, precession * length, 0),
    angular_velocity=(spin, 0, precession),
)  # fmt: skip
world.add_ball_joint(None, wheel, anchor=(0, 0, 0))
recording = world.run(duration=6.0, step=1 / 500)

centre = recording.x[:, wheel.index]
figure = recording.plot()
around = np.unwrap(np.arctan2(centre[:, 1], centre[:, 0]))
rate = np.polyfit(recording.t, around, 1)[0]
print(f"once around in {2 * np.pi / rate:.2f} s; theory {2 * np.pi / precession:.2f} s")
print(f"the height of the wheel varies by {np.ptp(centre[:, 2]):.0e} m")

"""
A spinning top
==============

A cone on its tip, spinning at 600 rad/s and leaning by 25 degrees, does not fall: its axis precesses about the vertical
and, since the axis was at rest when the top was released, nutates a little.

The rate of slow precession is the smaller root of :math:`I_1 \\cos \\theta\\, \\Omega^2 - I_3 \\omega\\, \\Omega + m g
l = 0`, near :math:`m g l / (I_3 \\omega)`.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

radius, height, spin, lean = 0.05, 0.10, 600.0, np.radians(25)  # m, m, rad/s
top_down = np.pi + lean  # the tip below
turn = (np.cos(top_down / 2), 0.0, np.sin(top_down / 2), 0.0)
axis = np.array([-np.sin(lean), 0.0, -np.cos(lean)])  # from the base to the tip
world = kd.World(substeps=20)
top = world.add_cone(
    radius, height, position=-0.5 * height * axis, orientation=turn, mass=0.2, angular_velocity=-spin * axis
)
world.add_ball_joint(None, top, anchor=(0, 0, 0))
recording = world.run(duration=3.0, step=1 / 1000)

centre = recording.x[:, top.index]
fig, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.8), layout="constrained", width_ratios=(1, 1.5))
left.plot(1e3 * centre[:, 0], 1e3 * centre[:, 1])
left.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)", title="centre of mass from above")
around = np.unwrap(np.arctan2(centre[:, 1], centre[:, 0]))
tilt = np.degrees(np.arccos(centre[:, 2] / np.linalg.norm(centre, axis=1)))
right.plot(recording.t, tilt)
right.set(xlabel="time (s)", ylabel="lean (degrees)")
length, along, across = 0.75 * height, 0.3 * 0.2 * radius**2, 0.6 * 0.2 * (radius**2 / 4 + height**2)
roots = np.roots([across * np.cos(lean), -along * spin, 0.2 * 9.81 * length])
rate = np.polyfit(recording.t, around, 1)[0]
print(f"precession {abs(rate):.3f} rad/s; theory {roots.min():.3f} rad/s")
energy = recording.derived["kinetic energy"] + recording.derived["potential energy"]
print(f"largest relative change of the energy {abs(energy / energy[0] - 1).max():.1e}")

"""
Crank, rod and piston
=====================

A flywheel turns a crank, whose rod pushes a piston to and fro: a closed loop of four joints, which are solved simultaneously.

The piston follows :math:`x = r \\cos \\varphi + \\sqrt{l^2 - r^2 \\sin^2 \\varphi}` to a few picometres, and without
friction the energy is conserved to a millionth.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

r, length = 0.1, 0.3
world = kd.World(gravity=(0, 0, 0), substeps=8)
crank = world.add_cylinder(
    0.15, 0.03, position=(0, 0, 0), orientation=(np.sqrt(0.5), np.sqrt(0.5), 0, 0), mass=5.0, collides_with=()
)
rod = world.add_box((length, 0.02, 0.02), position=(r + length / 2, 0, 0), mass=0.5, collides_with=())
piston = world.add_box((0.08, 0.1, 0.1), position=(r + length, 0, 0), mass=1.0, collides_with=())
shaft = world.add_hinge(None, crank, anchor=(0, 0, 0), axis=(0, -1, 0))
world.add_hinge(crank, rod, anchor=(r, 0, 0), axis=(0, -1, 0))
world.add_hinge(rod, piston, anchor=(r + length, 0, 0), axis=(0, -1, 0))
world.add_slider(None, piston, anchor=(r + length, 0, 0), axis=(1, 0, 0))
crank.angular_velocity = (0, -20, 0)
rod.velocity, rod.angular_velocity = (0, 0, 20 * r / 2), (0, 20 * r / length, 0)
angles, speeds = [], []
with world.record() as recording:
    for _ in range(500):
        world.step(1 / 500)
        angles.append(shaft.angle)
        speeds.append(shaft.speed)
x, phi = recording.x[1:, piston.index, 0], np.array(angles)
exact = r * np.cos(phi) + np.sqrt(length**2 - (r * np.sin(phi)) ** 2)
fig, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.4), layout="constrained")
left.plot(recording.t[1:], x)
left.set(xlabel="time (s)", ylabel="position of the piston (m)")
right.plot(recording.t[1:], speeds, color="C1")
right.set(xlabel="time (s)", ylabel="speed of the shaft (rad/s)")
print(f"the piston is within {abs(x - exact).max():.0e} m of the formula")
kinetic = recording.derived["kinetic energy"]
print(f"largest relative error of the energy {abs(kinetic / kinetic[0] - 1).max():.0e}")

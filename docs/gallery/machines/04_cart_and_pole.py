"""
A pole on a cart
================

A pole stands on a cart, and a controller that knows its angle, the cart's position and their rates pushes the cart so that it
stays up. The gains are the linear-quadratic regulator's, from SciPy's solution of Riccati's equation for the linearised cart.
Pushed hard after 4 s, it recovers.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.linalg import solve_continuous_are

import kickdrift as kd

M, m, half, g = 1.0, 0.2, 0.5, 9.81
inertia = m * half**2 / 3
mass = np.array([[M + m, m * half], [m * half, inertia + m * half**2]])
lift = np.linalg.inv(mass) @ np.array([[0, 0], [0, m * g * half]])
push = np.linalg.inv(mass) @ np.array([1.0, 0.0])
A = np.block([[np.zeros((2, 2)), np.eye(2)], [lift, np.zeros((2, 2))]])
B = np.concatenate([[0, 0], push])[:, None]
gains = B.T @ solve_continuous_are(A, B, np.diag([1.0, 10.0, 1.0, 1.0]), [[0.05]]) / 0.05

world = kd.World()
cart = world.add_box((0.4, 0.2, 0.2), mass=M, collides_with=())
pole = world.add_box((0.04, 0.04, 2 * half), position=(0, 0, half), mass=m, collides_with=())
rail = world.add_slider(None, cart, anchor=(0, 0, 0), axis=(1, 0, 0))
pivot = world.add_hinge(cart, pole, anchor=(0, 0, 0), axis=(0, 1, 0))
pivot.angle = 0.3
rows = []
while world.time < 10.0:
    force = -(gains @ [rail.position, pivot.angle, rail.speed, pivot.speed])[0]
    rail.apply_effort(force)
    if 4.0 <= world.time < 4.1:
        world.apply_force(pole, (6.0, 0, 0))
    world.step(1 / 200)
    rows.append((world.time, rail.position, np.degrees(pivot.angle), force))
t, place, angle, force = np.array(rows).T
fig, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(7, 4.4))
top.plot(t, angle)
bottom.plot(t, place, color="C1")
top.set(ylabel="pole's angle (degrees)")
bottom.set(xlabel="time (s)", ylabel="cart's position (m)")
print(
    f"largest angle after the push {abs(angle[t > 4]).max():.1f} degrees; "
    f"at the end {abs(angle[-1]):.4f} degrees, {place[-1]:.4f} m"
)

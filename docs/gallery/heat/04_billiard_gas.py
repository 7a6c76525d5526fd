"""
Disks become a gas
==================

Sixty disks in a box have the same speed at first.

After a few collisions of each, their speeds follow Maxwell's distribution, which in the plane is :math:`\\frac{v}{T}
e^{-v^2 / (2 T)}` for a mass of 1. Only the start is random here: each collision is located in time, and conserves
energy and momentum.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

count, radius, side = 60, 0.25, 10.0
rng = np.random.default_rng(7)
places = np.array([[1.2 * i + 0.9, 1.2 * j + 0.9] for i in range(8) for j in range(8)])[:count]
angle = rng.uniform(0, 2 * np.pi, count)

world = kd.World(gravity=(0, 0, 0), plane_normal=(0, 0, 1), bounce_speed=0.0)
for normal, point in (
    ((1, 0, 0), (0, 0, 0)),
    ((-1, 0, 0), (side, 0, 0)),
    ((0, 1, 0), (0, 0, 0)),
    ((0, -1, 0), (0, side, 0)),
):
    world.add_plane(normal=normal, point=point, restitution=1.0, friction=0.0)
for (x, y), a in zip(places, angle, strict=True):
    world.add_sphere(
        radius, position=(x, y, 0), velocity=(np.cos(a), np.sin(a), 0), mass=1.0, restitution=1.0, friction=0.0
    )
gas = world.run(duration=300.0, step=1 / 60, save_every=60)
speeds = np.linalg.norm(gas.v[60:, gas.moving], axis=2).ravel()
energy = gas.derived["kinetic energy"]

fig, ax = plt.subplots(figsize=(7, 3.8))
ax.hist(speeds, bins=40, density=True, label="disks")
v, temperature = np.linspace(0, 3.2, 200), energy[-1] / count
ax.plot(v, v / temperature * np.exp(-(v**2) / (2 * temperature)), label="Maxwell")
ax.axvline(1.0, color="grey", linewidth=0.8, label="at the start")
ax.set(xlabel="speed", ylabel="probability density")
ax.legend()
print(f"mean speed {speeds.mean():.3f}, Maxwell {np.sqrt(np.pi * temperature / 2):.3f}")
print(f"energy at the end {energy[-1] / energy[0]:.6f} of that at the start")

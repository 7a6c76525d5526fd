"""
A gap in Saturn's rings
=======================

Cassini's division begins 117,500 km from the centre of Saturn, next to where a particle goes around twice while the moon Mimas
goes around once. Mimas has 7 hundred-millionths of Saturn's mass, and yet it takes particles there out of their circles, by 50
km in eight years, because its pull comes again and again at the same place. (Saturn is a point here. Its flattening shifts the
resonance outwards by several hundred kilometres, and collisions, which open the gap in the end, are left out.)
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

GM, mimas = 37_931_206.2, 185_539.0  # km^3/s^2, km: JPL's Saturn and the mean orbit of Mimas
mass, eccentricity = 2.503 / GM, 0.0196  # GM of Mimas over that of Saturn
axes = np.linspace(112_000, 122_000, 250)
phase = np.random.default_rng(2).uniform(0, 2 * np.pi, axes.size)
x0, v0 = np.zeros((2, axes.size + 2, 3))
x0[1, 0], v0[1, 1] = mimas * (1 - eccentricity), np.sqrt(GM / mimas * (1 + eccentricity) / (1 - eccentricity))
x0[2:, 0], x0[2:, 1] = axes * np.cos(phase), axes * np.sin(phase)
v0[2:, 0], v0[2:, 1] = -np.sqrt(GM / axes) * np.sin(phase), np.sqrt(GM / axes) * np.cos(phase)
masses = np.concatenate([[1.0, mass], np.zeros(axes.size)])
rings = kd.systems.planetary(masses, x0, v0, G=GM, splitting="democratic-heliocentric")
year = 365.25 * 86400.0
sol = kd.solve(rings, (0.0, 8 * year), step=3000.0, method="wisdom-holman", save_every=100)
around = np.linalg.norm(sol.x[:, 2:] - sol.x[:, :1], axis=2)
swing = 0.5 * np.ptp(around, axis=0)

fig, ax = plt.subplots(figsize=(7.5, 3.8))
ax.plot(axes / 1e3, swing, ".-", linewidth=0.7, markersize=4)
resonance = mimas / 2 ** (2 / 3)
ax.axvline(resonance / 1e3, color="grey", linewidth=0.8, label="half of Mimas' period")
ax.axvspan(117.5, 122.2, color="C1", alpha=0.15, label="Cassini's division")
ax.set(xlabel="distance from Saturn (1000 km)", ylabel="radial excursion (km)", xlim=(112, 122))
ax.legend()
print(f"resonance at {resonance:.0f} km; largest excursion {swing.max():.0f} km, at {axes[swing.argmax()]:.0f} km")
print(f"median of all: {np.median(swing):.0f} km")

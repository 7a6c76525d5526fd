"""
Trojan asteroids
================

Sixty degrees before and behind Jupiter lie the points at which Lagrange (1772) found bodies in equilibrium, and around which
thousands of asteroids swing. Here are 120 of them without mass, started on Jupiter's orbit, up to 25 degrees from these
points, over 600 years, seen in the frame that rotates with Jupiter (the Sun is yellow, Jupiter red): none leaves, and each
oscillates about its point with a period of about 150 years.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

GM, mass, radius = 4 * np.pi**2, 1 / 1047.35, 5.2  # Sun, Jupiter (solar masses), au
rate = np.sqrt(GM * (1 + mass) / radius**3)
angles = np.radians(np.concatenate([np.linspace(35, 85, 60), np.linspace(-85, -35, 60)]))
phase = np.concatenate([[0.0], angles])
x0 = radius * np.stack([np.cos(phase), np.sin(phase), 0 * phase], axis=1)
v0 = rate * np.stack([-x0[:, 1], x0[:, 0], 0 * phase], axis=1)
sun = np.zeros((1, 3))
trojans = kd.systems.planetary(
    np.concatenate([[1.0, mass], 0 * angles]), np.concatenate([sun, x0]), np.concatenate([sun, v0]), G=GM,
    splitting="democratic-heliocentric",
)  # fmt: skip
sol = kd.solve(trojans, (0.0, 600.0), step=0.3, method="wisdom-holman", save_every=10)

around = sol.x - sol.x[:, :1]
place = around[..., 0] + 1j * around[..., 1]
place *= np.exp(-1j * np.angle(place[:, 1]))[:, None]  # turned with Jupiter
fig, ax = plt.subplots(figsize=(6, 6))
ax.plot(place[:, 2:62].real, place[:, 2:62].imag, linewidth=0.4, color="C0")
ax.plot(place[:, 62:].real, place[:, 62:].imag, linewidth=0.4, color="C2")
ax.plot(0, 0, "o", color="gold", markersize=14)
ax.plot(place[0, 1].real, 0, "o", color="C3", markersize=9)
ax.set(aspect="equal", xlabel="towards Jupiter (au)", ylabel="along its motion (au)")
swing = np.degrees(np.angle(place[:, 2:]))
print(f"angles to Jupiter between {abs(swing).min():.0f} and {abs(swing).max():.0f} degrees")
first = swing[:, 10] - 60  # of one: the time between zeros on the way up
zeros = sol.t[1:][(first[1:] > 0) & (first[:-1] <= 0)]
print(f"one of them oscillates with a period of {np.diff(zeros).mean():.0f} years")

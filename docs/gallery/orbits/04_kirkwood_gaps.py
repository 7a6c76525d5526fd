"""
Kirkwood's gaps
===============

There are few asteroids whose period is 1/3, 2/5, 3/7 or 1/2 of Jupiter's (Kirkwood 1866). Here are 400 asteroids without
mass, the Sun and Jupiter, over 20,000 years, a hundred thousand steps. All began on circles. From 2.6 to 3.1 au, away from
the resonances, their eccentricity does not exceed 0.08; at three of them it has begun to grow: to 0.12 at 3:1, 0.21 at 5:2 and
0.34 just outside 2:1. In a million years asteroids at 3:1 come to cross the orbit of Mars, and that is how this gap was
emptied (Wisdom 1982).
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

GM, jupiter = 4 * np.pi**2, 5.2044
axes, phase = np.linspace(2.1, 3.5, 400), np.random.default_rng(1).uniform(0, 2 * np.pi, 400)
speed = np.sqrt(GM / axes)
x0, v0 = np.zeros((2, 402, 3))
x0[1, 0] = jupiter * (1 - 0.0489)  # at its perihelion
v0[1, 1] = np.sqrt(GM / jupiter * (1 + 0.0489) / (1 - 0.0489))
x0[2:, 0], x0[2:, 1] = axes * np.cos(phase), axes * np.sin(phase)
v0[2:, 0], v0[2:, 1] = -speed * np.sin(phase), speed * np.cos(phase)
masses = np.concatenate([[1.0, 1 / 1047.35], np.zeros(400)])
belt = kd.systems.planetary(masses, x0, v0, G=GM, splitting="democratic-heliocentric")
sol = kd.solve(belt, (0.0, 20_000.0), step=0.2, method="wisdom-holman", save_every=400)
largest = kd.analysis.orbital_elements(sol, coordinates="heliocentric").e[:, 1:].max(axis=0)

fig, ax = plt.subplots(figsize=(7.5, 3.8))
ax.plot(axes, largest, ".-", linewidth=0.7, markersize=4)
for p, q in ((3, 1), (5, 2), (7, 3), (2, 1)):
    place = jupiter * (q / p) ** (2 / 3)
    ax.axvline(place, color="grey", linewidth=0.6)
    ax.text(place, 1.11 * largest.max(), f"{p}:{q}", ha="center")
ax.set(xlabel="semi-major axis at the start (au)", ylabel="largest eccentricity", ylim=(0, 1.1 * largest.max()))
for name, place in (("3:1", 2.50), ("5:2", 2.82), ("2:1", 3.30)):
    print(f"eccentricities near {name} up to {largest[abs(axes - place) < 0.05].max():.2f}")
calm = (axes > 2.6) & (axes < 3.1) & (abs(axes - 2.82) > 0.05)
print(f"from 2.6 to 3.1 au, except near 5:2, up to {largest[calm].max():.2f}")

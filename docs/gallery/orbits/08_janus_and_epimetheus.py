"""
Two moons on one orbit
======================

The orbits of Saturn's moons Janus and Epimetheus differ by 50 km, less than the moons' own size. Every four years the inner
one catches up, but they do not collide: they pull on each other, the inner one gains energy, rises to the outer orbit and,
slower there, falls behind, while the other sinks to the inner one (Dermott and Murray 1981). In the frame that rotates with
both, Epimetheus draws a horseshoe, and Janus, with 3.6 times the mass, an arc 3.6 times shorter and narrower. Distances from
the mean orbit are drawn 500 times too large.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

GM, janus, epimetheus = 37_931_206.2, 0.1265, 0.0351  # km^3/s^2 (Saturn; Jacobson and others 2008)
mean, apart = 151_450.0, 50.0  # km
share = janus / (janus + epimetheus)
a = np.array([mean + (1 - share) * apart, mean - share * apart])
x0 = [[0, 0, 0], [a[0], 0, 0], [-a[1], 0, 0]]
v0 = [[0, 0, 0], [0, np.sqrt(GM / a[0]), 0], [0, -np.sqrt(GM / a[1]), 0]]
moons = kd.systems.planetary([GM, janus, epimetheus], x0, v0, splitting="democratic-heliocentric")
year = 365.25 * 86400
sol = kd.solve(moons, (0.0, 8.2 * year), step=3000.0, method="wisdom-holman", save_every=20)

elements = kd.analysis.orbital_elements(sol, coordinates="heliocentric")
around = sol.x[:, 1:, :2] - sol.x[:, :1, :2]
angle = np.unwrap(np.arctan2(around[..., 1], around[..., 0]), axis=0)
angle -= (angle @ [share, 1 - share])[:, None] - (angle[0] @ [share, 1 - share])
fig, ax = plt.subplots(figsize=(6, 6), subplot_kw={"projection": "polar"})
for body, name in enumerate(("Janus", "Epimetheus")):
    ax.plot(angle[:, body], mean + 500 * (elements.a[:, body] - mean), linewidth=0.9, label=name)
ax.set(rticks=[], rlim=(0, 1.2 * mean))
ax.legend(loc="center")
above = elements.a[:, 0] > elements.a[:, 1]
changes = sol.t[1:][above[1:] != above[:-1]] / year
print(f"they change places after {', '.join(f'{t:.2f}' for t in changes)} years")
gap = abs(np.angle(np.exp(1j * (angle[:, 0] - angle[:, 1]))))
print(f"and come as near as {np.degrees(gap.min()):.1f} degrees, {gap.min() * mean:.0f} km")

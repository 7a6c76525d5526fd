"""
Two galaxies meet
=================

Two point masses, each surrounded by a disk of massless stars, pass each other on a parabola. Bridges and tails are drawn out
of the disks by gravity alone: the classic of Toomre and Toomre (1972), which explained the Antennae and the Mice. Units are the
mass of a galaxy and the least distance between the two masses on the parabola, and G = 1.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

rng = np.random.default_rng(3)
near, start = 1.0, 6.0  # pericentre; distance at the start; each centre has mass 1
mu, p = 2.0, 2 * near
angle = -np.arccos(p / start - 1)
place = start * np.array([np.cos(angle), np.sin(angle), 0])
rate = np.sqrt(mu / p) * np.array([-np.sin(angle), 1 + np.cos(angle), 0])
x, v = [0.5 * place, -0.5 * place], [0.5 * rate, -0.5 * rate]
for centre, tilt in ((0, np.radians(15)), (1, np.radians(60))):
    r, phi = np.sqrt(rng.uniform(0.15**2, 0.65**2, 1500)), rng.uniform(0, 2 * np.pi, 1500)
    turned = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    x += list(x[centre] + np.stack([r * np.cos(phi), r * np.sin(phi), 0 * r], 1) @ turned.T)
    v += list(v[centre] + np.stack([-np.sin(phi), np.cos(phi), 0 * r], 1) / np.sqrt(r)[:, None] @ turned.T)
galaxies = kd.systems.nbody(np.concatenate([[1.0, 1.0], np.zeros(3000)]), x, v, softening=0.05)
sol = kd.solve(galaxies, (0.0, 12.0), step=0.01, method="velocity-verlet", save_every=100)
fig, panels = plt.subplots(2, 2, figsize=(8, 7.6), sharex=True, sharey=True, layout="constrained")
for ax, row in zip(panels.flat, (0, 6, 9, 12), strict=True):
    ax.plot(*sol.x[row, 2:1502, :2].T, ".", markersize=1, color="C0")
    ax.plot(*sol.x[row, 1502:, :2].T, ".", markersize=1, color="C1")
    ax.plot(*sol.x[row, :2, :2].T, "k.")
    ax.set(aspect="equal", xlim=(-7, 7), ylim=(-7, 7), title=f"t = {sol.t[row]:.0f}")
fig.supxlabel("x")
fig.supylabel("y")
far = np.linalg.norm(sol.x[-1, 2:, None] - sol.x[-1, None, :2], axis=2).min(axis=1) > 2
print(
    f"{100 * far.mean():.0f} % of the stars are more than 2 from both centres at the end,"
    " three times the radius of the disks"
)

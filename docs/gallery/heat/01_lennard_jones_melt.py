"""
A crystal melts
===============

A hundred atoms in a plane interact through the Lennard-Jones potential, :math:`4 (r^{-12} - r^{-6})`, in a box
with walls. They begin in a hexagonal crystal, which Langevin dynamics keeps at a given temperature. At 0.2 nearly all
neighbours stay neighbours; at 0.6 the crystal melts, and only a tenth of them do. Colours show the rows at the start. (Units
are the potential's depth and range; two-dimensional crystals of these atoms melt near 0.4.)
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

rows, side = 10, 12.0
grid = np.array([[1.12 * (i + 0.5 * (j % 2)), 0.97 * j] for j in range(rows) for i in range(rows)])
x0 = np.pad(grid - grid.mean(axis=0), ((0, 0), (0, 1)))


def forces(x, out):
    for i in range(len(x)):
        for k in range(3):
            out[i, k] = 0.0
        for k in range(2):
            out[i, k] -= 50.0 * max(0.0, abs(x[i, k]) - side / 2) * np.sign(x[i, k])  # walls
    for i in range(len(x)):
        for j in range(i):
            dx, dy = x[i, 0] - x[j, 0], x[i, 1] - x[j, 1]
            r2 = dx * dx + dy * dy
            if r2 < 9.0:
                s = 1 / r2**3
                f = 24 * (2 * s * s - s) / r2
                out[i, 0] += f * dx
                out[i, 1] += f * dy
                out[j, 0] -= f * dx
                out[j, 1] -= f * dy


def neighbours(x):
    return np.linalg.norm(x[:, None, :2] - x[None, :, :2], axis=2) + 9 * np.eye(100) < 1.6


fig, axes = plt.subplots(1, 2, figsize=(8, 4), layout="constrained")
for ax, temperature in zip(axes, (0.2, 0.6), strict=True):
    atoms = kd.Langevin(forces, friction=0.5, temperature=temperature, seed=1)
    sol = kd.solve(atoms, (0.0, 100.0), x0, 0 * x0, step=0.01, method="baoab", save_every=100)
    kept = (neighbours(x0) & neighbours(sol.x[-1])).sum() / neighbours(x0).sum()
    ax.scatter(*sol.x[-1, :, :2].T, s=120, c=np.arange(100) // 10, cmap="viridis")
    ax.set(aspect="equal", xlim=(-7, 7), ylim=(-7, 7), xticks=[], yticks=[], title=f"temperature {temperature}")
    print(f"temperature {temperature}: {100 * kept:.0f} % of the neighbours are still neighbours")

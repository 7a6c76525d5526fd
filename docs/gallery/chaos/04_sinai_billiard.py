"""
Sinai's billiard
================

A ball moves without friction on a table with a round post in the middle. Two shots that differ by a millionth of a radian
are as far apart as the table allows after about twenty bounces: the round post makes neighbouring paths diverge
exponentially, and flat walls do not (Sinai 1970).
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd


def gaps(x):
    return np.array([x[0] + 1, 1 - x[0], x[1] + 1, 1 - x[1], np.sqrt(x[0] ** 2 + x[1] ** 2) - 0.4])


def free(x):
    return np.zeros(2)


table = kd.Impacts(gaps, restitution=1.0)
times, shots = np.linspace(0, 24, 2401), []
for angle in (0.7, 0.7 + 1e-6):
    v0 = [np.cos(angle), np.sin(angle)]
    shots.append(
        kd.solve(free, (0.0, 24.0), [-0.9, -0.5], v0, step=0.02, method="velocity-verlet", impacts=table, t_eval=times)
    )
fig, (left, right) = plt.subplots(1, 2, figsize=(8.5, 4), layout="constrained")
for shot in shots:
    left.plot(*shot.x.T, linewidth=0.8)
left.add_patch(plt.Circle((0, 0), 0.4, color="grey"))
left.set(aspect="equal", xlim=(-1, 1), ylim=(-1, 1), xticks=(-1, 0, 1), yticks=(-1, 0, 1), xlabel="x", ylabel="y")
apart = np.linalg.norm(shots[0].x - shots[1].x, axis=1)
right.semilogy(shots[0].t, apart)
right.set(xlabel="t", ylabel="distance between the two balls")
print(
    f"1e-3 apart at t = {shots[0].t[(apart > 1e-3).argmax()]:.1f}, 0.5 at t = {shots[0].t[(apart > 0.5).argmax()]:.1f}"
)
print(f"speed at the end {np.linalg.norm(shots[0].v[-1]):.15f}")

"""
Three methods of Euler
======================

One orbit, one step, and three ways to take it. The explicit method winds outwards, the implicit one inwards, and the
semi-implicit one, which computes the new position with the new velocity, stays: its energy error oscillates and does not grow.
"""

import matplotlib.pyplot as plt

import kickdrift as kd

orbit = kd.systems.kepler(eccentricity=0.4)
fig, (left, right) = plt.subplots(1, 2, figsize=(8.5, 4), layout="constrained")
for method in ("explicit-euler", "implicit-euler", "semi-implicit-euler"):
    sol = kd.solve(orbit, (0.0, 25.0), step=0.004, method=method)
    left.plot(*sol.x.T, linewidth=0.9, label=method)
    right.plot(sol.t, sol.energy, label=method)
    print(f"{method:20} energy at the end {sol.energy[-1]:+.4f}, at the start {sol.energy[0]:+.4f}")
left.set(aspect="equal", xlabel="x", ylabel="y")
right.set(xlabel="t", ylabel="energy")
right.legend()

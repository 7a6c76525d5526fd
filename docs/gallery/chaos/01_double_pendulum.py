"""
Diverging double pendulums
==========================

Ten double pendulums, each started a hundred-thousandth of a degree from the one before. For ten seconds they look like one,
then they separate. SymPy derives the equations from the Lagrangian.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

import kickdrift as kd

a, b, da, db = sp.symbols("a b da db")  # two rods of 1 m, two masses of 1 kg
lagrangian = da**2 + db**2 / 2 + da * db * sp.cos(a - b) + 9.81 * (2 * sp.cos(a) + sp.cos(b))
pendulum = kd.from_lagrangian(lagrangian, q=(a, b), qdot=(da, db))
starts = np.radians(120 + 1e-5 * np.arange(10))
fig, (left, right) = plt.subplots(1, 2, figsize=(8.5, 4), layout="constrained", width_ratios=(1, 1.4))
ends = []
for number, angle in enumerate(starts):
    sol = kd.solve(pendulum, (0.0, 15.0), [angle, angle], [0.0, 0.0], step=0.005, method="gauss-6")
    alpha, beta = sol.q.T
    x, y = np.sin(alpha) + np.sin(beta), -np.cos(alpha) - np.cos(beta)
    left.plot(x[-60:], y[-60:], linewidth=1, color=plt.cm.viridis(number / 10))
    right.plot(sol.t, y, linewidth=0.9, color=plt.cm.viridis(number / 10))
    ends.append(np.array([x, y]).T)
left.set(aspect="equal", title="lower masses, last 0.3 s", xlabel="x (m)", ylabel="z (m)")
right.set(xlabel="time (s)", ylabel="height of the lower mass (m)")
apart = np.ptp(np.array(ends), axis=0).max(axis=1)
print(f"1 cm apart after {sol.t[(apart > 0.01).argmax()]:.1f} s, 1 m after {sol.t[(apart > 1).argmax()]:.1f} s")
print(f"the energy of the last one changes by at most {abs(sol.energy - sol.energy[0]).max():.0e} J")

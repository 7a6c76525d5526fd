"""
What is conserved instead of the energy
=======================================

The energy of Verlet's method oscillates, because what the method conserves is another function close to it: a series in
powers of the step, by the formula of Baker, Campbell and Hausdorff. Each further term leaves less of the oscillation.
"""

import matplotlib.pyplot as plt

import kickdrift as kd

pendulum = kd.systems.pendulum(2.5)
sol = kd.solve(pendulum, (0.0, 30.0), step=0.2, method="velocity-verlet")
fig, ax = plt.subplots(figsize=(7.5, 4))
for order in (0, 2, 4):
    values = kd.analysis.modified_hamiltonian(pendulum, "velocity-verlet", sol.step, sol.x, sol.v, order=order)
    swing = abs(values - values.mean())
    name = "energy" if order == 0 else f"with terms up to h^{order}"
    ax.semilogy(sol.t, swing, linewidth=0.9, label=name)
    print(f"{name}: oscillates by {values.max() - values.min():.1e}")
ax.set(xlabel="t", ylabel="distance from the mean", ylim=(1e-9, 1))
ax.legend(loc="upper right", ncols=3, fontsize=8)

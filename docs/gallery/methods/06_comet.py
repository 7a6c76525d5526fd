"""
Steps for a comet
=================

Halley's comet returns every 76 years, and passes the Sun within months, at an eccentricity of 0.967. Equal steps that are
short enough there are wasted elsewhere. With steps that depend reversibly on the distance, a symmetric method keeps its
bounded energy error: it does not grow from one return to the next. With the logarithmic Hamiltonian, Verlet's method follows
Kepler's ellipse to rounding error, and only the times are off (Mikkola and Tanikawa 1999).
"""

import matplotlib.pyplot as plt

import kickdrift as kd

comet = kd.systems.kepler(eccentricity=0.967)
turns = 2 * 3.141592653589793 * 20
runs = {
    "equal steps": kd.solve(comet, (0.0, turns), step=turns / 75_000, method="velocity-verlet"),
    "by the distance": kd.solve(comet, (0.0, turns), step=1.6e-5, step_control="distance"),
    "logarithmic Hamiltonian": kd.solve(comet, (0.0, turns), step=1.6e-4, step_control=kd.LogarithmicHamiltonian()),
}
fig, ax = plt.subplots(figsize=(7.5, 4))
for name, sol in runs.items():
    ax.semilogy(
        sol.t / (turns / 20), abs(sol.energy + 0.5) + 1e-17, linewidth=0.6, label=f"{name}: {sol.n_steps} steps"
    )
    print(f"{name}: {sol.n_steps} steps, energy off by {abs(sol.energy + 0.5).max():.1e} of 0.5 at most")
ax.set(xlabel="returns", ylabel="error of the energy", ylim=(1e-17, 1e6))
ax.legend(loc="upper center")

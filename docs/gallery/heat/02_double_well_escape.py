"""
Escape over a barrier
=====================

Thermal noise kicks a particle about in one of two wells, and now and then over the barrier.

Kramers (1940) computed the rate, :math:`r = \\frac{\\omega_0 \\omega_b}{2 \\pi \\gamma} e^{-\\Delta V / kT}` for strong
friction; the code has his formula for moderate friction. Four thousand particles start in the left well. Since some
of those that leave come back, the share in it decays towards one half, at twice that rate.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

friction, heat = 4.0, 0.2  # the wells of (x^2 - 1)^2 are 1 deep
wells = kd.Langevin(lambda x: 4 * x * (1 - x * x), friction=friction, temperature=heat, seed=3)
sol = kd.solve(wells, (0.0, 400.0), -np.ones(4000), np.zeros(4000), step=0.05, method="baoab", save_every=40)
left = (sol.x < 0).mean(axis=1)

omega_0, omega_b = np.sqrt(8.0), 2.0  # curvatures of the well and of the barrier
rate = (np.sqrt(friction**2 / 4 + omega_b**2) - friction / 2) / omega_b * omega_0 / (2 * np.pi) * np.exp(-1 / heat)
fig, ax = plt.subplots(figsize=(7, 3.8))
ax.plot(sol.t, left, label="four thousand particles")
ax.plot(sol.t, 0.5 + 0.5 * np.exp(-2 * rate * sol.t), "--", label="Kramers' rate")
ax.set(xlabel="t", ylabel="share in the left well", ylim=(0.4, 1.02))
ax.legend()
early = (sol.t > 5) & (sol.t < 200)
measured = -0.5 * np.polyfit(sol.t[early], np.log(2 * left[early] - 1), 1)[0]
print(f"rate {measured:.2e}, Kramers {rate:.2e}: ratio {measured / rate:.2f}")

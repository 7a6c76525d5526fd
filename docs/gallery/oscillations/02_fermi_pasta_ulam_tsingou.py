"""
Fermi, Pasta, Ulam and Tsingou
==============================

In 1955 a chain of 32 masses with slightly nonlinear springs was to show on a computer how energy spreads over all
modes. The energy did not spread: nearly all of it came back to the first mode.

The same chain, the same strength, :math:`\\alpha = 1/4`: after 153 periods of the first mode, 98 % of the energy is
back in it.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

N, alpha = 32, 0.25


def chain(x, out):
    left = x[0]
    for i in range(N):
        right = (x[i + 1] if i < N - 1 else 0.0) - x[i]
        out[i] = right - left + alpha * (right**2 - left**2)
        left = right


k = np.arange(1, N + 1)
shape = np.sqrt(2 / (N + 1)) * np.sin(np.pi * np.outer(k, k) / (N + 1))
omega = 2 * np.sin(np.pi * k / (2 * (N + 1)))
x0 = np.sin(np.pi * k / (N + 1))  # all in the first mode
period = 2 * np.pi / omega[0]
sol = kd.solve(chain, (0.0, 180 * period), x0, np.zeros(N), step=0.1, method="blanes-moan-srkn6b", save_every=100)
energy = 0.5 * (sol.v @ shape) ** 2 + 0.5 * (omega * (sol.x @ shape)) ** 2

fig, ax = plt.subplots(figsize=(7.5, 3.8))
for mode in range(5):
    ax.plot(sol.t / period, energy[:, mode] / energy[0, 0], label=f"mode {mode + 1}", linewidth=1)
ax.set(xlabel="periods of the first mode", ylabel="share of the energy")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=5, fontsize=8, frameon=False)
first = energy[:, 0] / energy[0, 0]
late = sol.t > 100 * period
print(
    f"least share of the first mode {first.min():.2f}; back to {first[late].max():.3f} after "
    f"{sol.t[late][first[late].argmax()] / period:.0f} periods"
)

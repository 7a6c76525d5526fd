"""
Order on a forced problem
=========================

A force that depends on time has to be evaluated at the right time: the clock advances with the drifts, by the share of each.
If it advances with the kicks instead, a method keeps its order for forces that do not depend on time, and falls to order one
for those that do. Here is Forest and Ruth's method of order four, with both clocks.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

word = [(letter.symbol, float(share)) for letter, share in kd.methods.get("forest-ruth-4").word]


def wrong(steps):
    """The same kicks and drifts, with a clock that advances with the kicks."""
    h, t, x, v = 5.0 / steps, 0.0, 1.0, 0.0
    for _ in range(steps):
        for letter, share in word:
            if letter == "D":
                x += share * h * v
            else:
                v += share * h * (np.cos(2 * t) - x - x**3)
                t += share * h
    return x


def force(t, x):
    return np.cos(2 * t) - x - x**3


exact = kd.solve(force, (0.0, 5.0), 1.0, 0.0, step=0.002, method="kahan-li-8").x[-1]
counts = np.array([80, 160, 320, 640, 1280])
right_error = [
    abs(kd.solve(force, (0.0, 5.0), 1.0, 0.0, step=5 / n, method="forest-ruth-4").x[-1] - exact) for n in counts
]
wrong_error = [abs(wrong(n) - exact) for n in counts]
fig, ax = plt.subplots(figsize=(6.5, 4))
for name, errors in (("clock with the kicks", wrong_error), ("clock with the drifts", right_error)):
    ax.loglog(5 / counts, errors, "o-", label=name)
    print(f"{name}: order {np.polyfit(np.log(5 / counts), np.log(errors), 1)[0]:.2f}")
ax.set(xlabel="step", ylabel="error at t = 5", xticks=5 / counts, xticklabels=[f"5/{n}" for n in counts])
ax.minorticks_off()
ax.legend()

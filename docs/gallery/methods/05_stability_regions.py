"""
Where methods are stable
========================

Applied to :math:`y' = \\lambda y`, a Runge-Kutta method multiplies y in each step by a number :math:`R(h \\lambda)`. Where its
modulus is at most one (blue), nothing grows. The regions of explicit methods are bounded; that of the implicit midpoint
rule is exactly the left half of the plane. For implicit Euler and Radau, R also tends to zero on the far left: what decays
too fast for the step to resolve is damped.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

real, imaginary = np.meshgrid(np.linspace(-6, 10, 400), np.linspace(-7, 7, 350))
z = real + 1j * imaginary
fig, panels = plt.subplots(2, 3, figsize=(8.5, 5), sharex=True, sharey=True, layout="constrained")
for ax, method in zip(
    panels.flat,
    ("explicit-euler", "runge-kutta-4", "dop853", "implicit-euler", "implicit-midpoint", "radau-5"),
    strict=True,
):
    factor = abs(kd.analysis.amplification_factor(method, z))
    ax.contourf(real, imaginary, factor, levels=[0, 1], colors=["C0"], alpha=0.5)
    ax.contour(real, imaginary, factor, levels=[1], colors=["C0"])
    ax.axhline(0, color="grey", linewidth=0.5)
    ax.axvline(0, color="grey", linewidth=0.5)
    ax.set(title=method, aspect="equal")
    print(f"{method:18} |R(-1000)| = {abs(kd.analysis.amplification_factor(method, -1000.0)):.1e}")
fig.supxlabel(r"real part of $h \lambda$")
fig.supylabel(r"imaginary part of $h \lambda$")

"""
An ion in Paul's trap
=====================

No electrostatic field alone can hold a charge (Earnshaw 1842): where it is pushed inwards along one axis, it is pushed
outwards along another.

A field that changes its sign fast enough holds it all the same (Paul 1953, Nobel prize 1989), if the parameter
:math:`q` of Mathieu's equation :math:`x'' = -2 q \\cos(2 \\tau)\\, x` is below 0.908. Here 232 ions, an ensemble, begin
at 1 with q from 0.05 to 1.2: those beyond 0.908 are lost.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd


def trap(t, x, params, out):
    out[0] = -2 * params[0] * np.cos(2 * t) * x[0]


q = np.linspace(0.05, 1.2, 232)
runs = kd.solve_ensemble(
    trap,
    (0.0, 60 * np.pi),
    x0=[[1.0]],
    v0=[[0.0]],
    args={"q": q},
    step=0.02,
    method="blanes-moan-srkn6b",
    save_every=10,
)
largest = abs(runs.x[:, :, 0]).max(axis=1)

fig, (left, right) = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
for chosen in (0.2, 0.6, 0.95):
    member = abs(q - chosen).argmin()
    left.plot(runs.t, runs.x[member, :, 0], label=f"q = {q[member]:.2f}", linewidth=0.9)
left.set(xlabel=r"$\tau$", ylabel="x", ylim=(-8, 8), xlim=(0, 60))
left.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, fontsize=8, frameon=False)
right.semilogy(q, largest)
right.axvline(0.908, color="grey", linewidth=0.8, label="q = 0.908")
right.set(xlabel="q", ylabel="largest |x|")
right.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), fontsize=8, frameon=False)
kept = q[largest < 100].max()
print(f"ions are held up to q = {kept:.3f}; Mathieu's limit is 0.908")

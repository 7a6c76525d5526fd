"""
The figure eight
================

Three equal masses chase each other along one curve. The orbit was found by Moore (1993) and proved to exist by Chenciner and
Montgomery (2000); the initial values are Simó's, to fourteen digits. It is stable, so that even after a hundred periods
nothing has visibly moved: the hundredth period, a black line below the coloured ones of the first, does not show.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

place, last = np.array([0.97000435669734, -0.24308753153583]), np.array([-0.93240737144104, -0.86473146092102])
period = 6.32591398292621
three = kd.systems.nbody(
    masses=[1.0, 1.0, 1.0], x0=[[*place, 0], [*-place, 0], [0, 0, 0]], v0=[[*-last / 2, 0], [*-last / 2, 0], [*last, 0]]
)
sol = kd.solve(three, (0.0, 100 * period), step=period / 400, method="blanes-moan-srkn11b")

fig, ax = plt.subplots(figsize=(7, 3.4))
ax.plot(*sol.x[-400:, 0, :2].T, color="black", linewidth=0.8)
for body in range(3):
    ax.plot(*sol.x[:134, body, :2].T, linewidth=2)
    ax.plot(*sol.x[0, body, :2], "o", color=f"C{body}", markersize=9)
ax.set(aspect="equal", xlabel="x", ylabel="y")
print(f"largest distance from the start after 100 periods: {abs(sol.x[-1] - sol.x[0]).max():.1e}")
print(f"largest relative error of the energy: {kd.analysis.largest_energy_error(sol):.1e}")
kd.solve(three, (0.0, 3 * period), step=period / 400, method="blanes-moan-srkn11b").show()

"""
Lorenz's butterfly
==================

Three numbers describe the convection of air over warm ground (Lorenz 1963). There are no positions and velocities here, and no
energy to conserve: a Runge-Kutta method, DOP853, solves such equations of first order. Two runs that begin a millionth apart
have nothing in common after 30 units of time.

Differences grow as :math:`e^{0.9 t}` on average (Benettin and others 1980 describe how to measure it).
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

air = kd.FirstOrder(lambda y: np.array([10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2]]))
one, other = (
    kd.solve(
        air,
        (0.0, 40.0),
        x0=[1.0 + d, 1.0, 1.0],
        rtol=1e-11,
        atol=1e-11,
        method="dop853",
        t_eval=np.linspace(0, 40, 8001),
    )
    for d in (0.0, 1e-6)
)
fig = plt.figure(figsize=(8.5, 4), layout="constrained")
ax = fig.add_subplot(1, 2, 1, projection="3d")
ax.plot(*one.y.T, linewidth=0.4)
ax.set(xticks=[], yticks=[], zticks=[])
for axis, name in zip((ax.xaxis, ax.yaxis, ax.zaxis), ("$y_0$", "$y_1$", "$y_2$"), strict=True):
    axis.set_label_text(name)
    axis.labelpad = -12
right = fig.add_subplot(1, 2, 2)
right.plot(one.t, one.y[:, 0], linewidth=0.8)
right.plot(other.t, other.y[:, 0], linewidth=0.8)
right.set(xlabel="t", ylabel="$y_0$")
apart = np.linalg.norm(one.y - other.y, axis=1)
found = kd.analysis.lyapunov_exponent(air, (0.0, 500.0), [1.0, 1.0, 1.0], step=0.005, method="dop853")
print(f"10 apart at t = {one.t[(apart > 10).argmax()]:.1f}; Lyapunov exponent {found.values[0]:.2f}")

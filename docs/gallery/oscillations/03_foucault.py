"""
Foucault's pendulum
===================

The pendulum of the Panthéon is 67 m long, and swings 3 m to either side.

The Earth turns under it, and so its plane seems to turn, by :math:`360 \\sin \\varphi` degrees a day, 11.3 an hour in Paris
at 48.85 degrees north. The Coriolis force that turns it, :math:`-2 m \\Omega \\times v`, is tiny: its maximum is three
ten-thousandths of the restoring force's. It depends on the velocity, and so needs a method that keeps its order there, such as
``implicit-verlet``.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

g, length, turn = 9.81, 67.0, 7.292115e-5 * np.sin(np.radians(48.846))  # m/s^2, m, rad/s


def swing(x, v, out):
    height = np.sqrt(length**2 - x[0] ** 2 - x[1] ** 2)
    down = -g * height / length**2 - (v[0] ** 2 + v[1] ** 2 + ((x[0] * v[0] + x[1] * v[1]) / height) ** 2) / length**2
    out[0] = down * x[0] + 2 * turn * v[1]
    out[1] = down * x[1] - 2 * turn * v[0]


sol = kd.solve(swing, (0.0, 3600.0), [3.0, 0.0], [0.0, 0.0], step=0.02, method="implicit-verlet")
fig, ax = plt.subplots(figsize=(5.6, 5))
ax.plot(*sol.x.T, linewidth=0.3)
ax.set(aspect="equal", xlabel="east (m)", ylabel="north (m)", ylim=(-1.5, 1.5))
far = np.linalg.norm(sol.x, axis=1)
turns = np.flatnonzero((far[1:-1] > far[2:]) & (far[1:-1] >= far[:-2])) + 1
angle = np.unwrap(2 * np.arctan2(sol.x[turns, 1], sol.x[turns, 0])) / 2
rate = np.degrees(np.polyfit(sol.t[turns], angle, 1)[0]) * 3600
print(f"{abs(rate):.2f} degrees an hour, clockwise; {15.041 * np.sin(np.radians(48.846)):.2f} expected of small swings")

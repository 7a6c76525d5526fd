"""
Kapitza's pendulum
==================

A pendulum whose support shakes up and down fast enough stands on its head, if the peak speed of the support exceeds
:math:`\\sqrt{2 g l}` (Stephenson 1908, Kapitza 1951), which is 2 m/s for a length of 20 cm. Shaken at 40 Hz with an amplitude
of 10 mm, at up to 2.5 m/s, it swings about the upright position; with 7 mm, at up to 1.8 m/s, it falls, swings up on the other
side, and back.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

g, length, rate = 9.81, 0.2, 2 * np.pi * 40  # m/s^2, m, 1/s


def shaken(t, x, params, out):
    amplitude = params[0]
    out[0] = (g - amplitude * rate**2 * np.cos(rate * t)) / length * np.sin(x[0])  # x: angle from the upright position


fig, ax = plt.subplots(figsize=(7.5, 3.6))
for amplitude in (0.007, 0.010):
    sol = kd.solve(shaken, (0.0, 3.0), [0.2], [0.0], args=(amplitude,), step=1e-4, method="blanes-moan-srkn6b")
    angle = np.degrees(sol.x[:, 0])
    ax.plot(sol.t, angle, label=f"{1e3 * amplitude:.0f} mm, up to {amplitude * rate:.1f} m/s")
    print(f"{1e3 * amplitude:.0f} mm: farthest from upright {abs(angle).max():.0f} degrees")
ax.set(xlabel="time (s)", ylabel="degrees from upright", ylim=(-30, 370))
ax.legend()

"""
The air grows thin
==================

Molecules of nitrogen fall, and heat throws them up again: at a temperature T the share above a height z is
:math:`e^{-m g z / k T}`, which for 288 K is half at 6 km. Here are four thousand molecules, each knocked about by a bath of
that temperature, over a ground that throws them back.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

k, mass, g, kelvin = 1.380649e-23, 28.0134 * 1.66054e-27, 9.80665e-3, 288.15  # J/K, kg, km/s^2
scale = k * kelvin / (mass * g) * 1e-6  # km


def fall(x):
    return np.where(x > 0, -g, 100 * g)  # a ground that is hard, but not infinitely


air = kd.Langevin(fall, friction=0.02, temperature=g * scale, seed=5)
sol = kd.solve(air, (0.0, 1500.0), np.full(4000, 5.0), np.zeros(4000), step=0.1, method="baoab", save_every=500)
heights = sol.x[-20:].ravel()
fig, ax = plt.subplots(figsize=(7, 3.8))
ax.hist(heights, bins=np.arange(0, 45, 0.5), density=True, label="molecules")
z = np.linspace(0, 45, 200)
ax.plot(z, np.exp(-z / scale) / scale, label=r"$(mg/kT)\, e^{-mgz/kT}$")
ax.set(xlabel="height (km)", ylabel="share per km", xlim=(0, 45))
ax.legend()
print(f"mean height {heights.mean():.2f} km; kT/mg = {scale:.2f} km; half are below {np.median(heights):.2f} km")

"""
Mercury's perihelion
====================

In Newton's gravity the ellipse of a lone planet stays where it is.

General relativity adds a force that falls with the fourth power of the distance, and the perihelion moves on: by
:math:`\\frac{6 \\pi GM}{c^2 a (1 - e^2)}` an orbit, which is 43 seconds of arc a century for Mercury (Einstein
1915). That additional force is a ten-millionth of Newton's. It shows because the method's own error turns the ellipse by
less than a hundredth of a second of arc.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

GM, c = 0.295912208284e-3, 173.144632674  # Sun, light: au, days (JPL, IAU)
a, e = 0.387098, 0.205630  # Mercury
spin = GM * a * (1 - e * e)  # square of the angular momentum


def gravity(x):
    r2 = x @ x
    return -GM * x / r2**1.5 * (1 + 3 * spin / (c * c * r2))


def newton(x):
    return -GM * x / (x @ x) ** 1.5


start = [a * (1 - e), 0.0], [0.0, np.sqrt(GM / a * (1 + e) / (1 - e))]
options = {"step": 0.25, "method": "blanes-moan-srkn14a", "save_every": 500}
fig, ax = plt.subplots(figsize=(7, 3.8))
for name, law in (("Newton", newton), ("Einstein", gravity)):
    sol = kd.solve(law, (0.0, 36525.0), *start, **options)
    spins = sol.x[:, 0] * sol.v[:, 1] - sol.x[:, 1] * sol.v[:, 0]
    r = np.linalg.norm(sol.x, axis=1)
    lenz = np.stack([sol.v[:, 1], -sol.v[:, 0]], 1) * spins[:, None] / GM - sol.x / r[:, None]
    angle = np.degrees(np.unwrap(np.arctan2(lenz[:, 1], lenz[:, 0]))) * 3600
    rate = abs(np.polyfit(sol.t / 36525, angle, 1)[0])
    ax.plot(sol.t / 365.25, angle, label=f"{name}: {rate:.2f}'' a century")
    print(f"{name}: {rate:.3f} seconds of arc a century")
turn, period = 6 * np.pi * GM / (c * c * a * (1 - e * e)), 2 * np.pi * np.sqrt(a**3 / GM)
print(f"expected: {np.degrees(turn) * 3600 * 36525 / period:.3f}")
ax.set(xlabel="years", ylabel="perihelion (seconds of arc)")
ax.legend()

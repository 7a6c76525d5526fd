"""
A swing past Jupiter
====================

A probe comes from the Earth's orbit, on an ellipse that would lead it back. It passes behind Jupiter, as near as Voyager 1
did in 1979, at 4.9 of its radii, and its path is bent forwards. Seen from Jupiter it leaves as fast as it came; seen from the
Sun it has gained so much that it never comes back. The run starts in the middle and goes both ways, since time may run
backwards.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

GM, mass, a = 4 * np.pi**2, 1 / 1047.35, 5.2  # au^3/yr^2, Jupiter's mass over the Sun's, au
km_s = 149_597_870.7 / 31_557_600.0
closest, far_speed = 4.9 * 71_492 / 149_597_870.7, 10.8 / km_s  # au, au/yr
turn = 2 * np.arcsin(1 / (1 + closest * far_speed**2 / (GM * mass)))
heading = np.radians(-30) + turn / 2  # at the closest point; Jupiter is to the left
speed = np.sqrt(far_speed**2 + 2 * GM * mass / closest)
planet = np.array([[a, 0, 0], [0, np.sqrt(GM / a), 0]])
probe = planet + np.array([
    [closest * np.sin(heading), -closest * np.cos(heading), 0], [speed * np.cos(heading), speed * np.sin(heading), 0]
])  # fmt: skip
flight = kd.systems.nbody([1.0, mass, 0.0], [[0, 0, 0], planet[0], probe[0]], [[0, 0, 0], planet[1], probe[1]], G=GM)
options = {"rtol": 1e-11, "atol": 1e-11, "method": "dop853"}
halves = [kd.solve(flight, (0.0, end), t_eval=np.linspace(0, end, 2001), **options) for end in (-1.6, 2.5)]

fig, (left, right) = plt.subplots(1, 2, figsize=(8.5, 4.4), layout="constrained", width_ratios=(1, 1.9))
for half, name in zip(halves, ("before", "after"), strict=True):
    way, rate = half.x[:, 2] - half.x[:, 0], half.v[:, 2] - half.v[:, 0]
    left.plot(*way[:, :2].T, label=name)
    jupiter = "Jupiter" if name == "after" else None
    left.plot(*(half.x[:, 1] - half.x[:, 0])[:, :2].T, color="grey", linewidth=0.8, label=jupiter)
    right.plot(half.t, km_s * np.linalg.norm(rate, axis=1))
    energy = 0.5 * (rate[-1] @ rate[-1]) - GM / np.linalg.norm(way[-1])
    kind = f"leaves with {km_s * np.sqrt(2 * energy):.1f} km/s" if energy > 0 else "bound to the Sun"
    print(f"{name}: {kind}; nearest to the Sun {np.linalg.norm(way, axis=1).min():.2f} au")
left.plot(0, 0, "o", color="gold", label="Sun")
left.set(aspect="equal", xlabel="x (au)", ylabel="y (au)")
left.legend(fontsize=8)
right.set(xlabel="time (years)", ylabel="speed (km/s)", ylim=(0, 50))

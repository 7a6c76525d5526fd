"""
Dzhanibekov's wing nut
======================

A wing nut that spins in weightlessness turns over, back, and over again, as the cosmonaut Dzhanibekov saw in 1985: rotation
about the axis of the intermediate moment of inertia, here z, is unstable. About the other two axes it is stable. Energy and
angular momentum are conserved all the while.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

world = kd.World(gravity=(0, 0, 0))
wings = kd.Part(kd.Box((0.16, 0.02, 0.05)), density=2700.0)
stem = kd.Part(kd.Cylinder(0.015, 0.10), position=(0, 0, 0.04), density=2700.0)
nut = world.add_body([wings, stem], angular_velocity=(0.01, 0.01, 0.0))
moments = nut.inertia
middle = np.eye(3)[np.argsort(np.diag(moments))[1]]
nut.angular_velocity = 10 * middle + [0.002, 0.002, 0.002]
recording = world.run(duration=20.0, step=1 / 240)

spin = recording.angular_velocity[:, nut.index]
w, x, y, z = recording.orientation[:, nut.index].T
axis = np.stack(
    [
        [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
        [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
        [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ]
)  # rows: the body's axes
own = np.einsum("ijt,tj->ti", axis, spin)
fig, ax = plt.subplots(figsize=(7.5, 3.6))
for k, name in enumerate("xyz"):
    ax.plot(recording.t, own[:, k], label=f"about the body's {name} axis")
ax.set(xlabel="time (s)", ylabel="angular velocity (rad/s)")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, fontsize=8, frameon=False)
print("moments of inertia, g m^2:", np.round(1e3 * np.diag(moments), 4))
about = own @ middle
print(f"turns over at {', '.join(f'{t:.1f}' for t in recording.t[1:][about[1:] * about[:-1] < 0])} s")
kinetic = recording.derived["kinetic energy"]
print(f"largest relative change of the energy {abs(kinetic / kinetic[0] - 1).max():.1e}")

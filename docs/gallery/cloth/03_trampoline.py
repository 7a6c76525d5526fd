"""
A trampoline
============

Two balls fall on a mat that is held all around, and that throws them up again. Neither comes back to its height: some of the
energy stays in the vibrating mat, and some is lost at the contacts.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

world = kd.World(substeps=8)
mat = world.add_cloth_grid(
    (2.0, 2.0), (21, 21), position=(0, 0, 1.0), density=0.4, stretch_stiffness=800.0, shear_stiffness=200.0, name="mat"
)
index = np.arange(21 * 21).reshape(21, 21)
mat.pin(np.unique(np.concatenate((index[0], index[-1], index[:, 0], index[:, -1]))))
large = world.add_sphere(radius=0.15, position=(-0.25, 0, 1.9), mass=4.0)
small = world.add_sphere(radius=0.1, position=(0.25, 0, 1.5), mass=1.0)
recording = world.run(duration=2.5, step=1 / 120)
figure = recording.plot()
fig, ax = plt.subplots(figsize=(7, 3))
for ball, name in ((large, "4 kg"), (small, "1 kg")):
    ax.plot(recording.t, recording.x[:, ball.index, 2], label=name)
ax.axhline(1.0, color="grey", linewidth=0.8, label="the mat at rest")
ax.set(xlabel="time (s)", ylabel="height (m)")
ax.legend()
print(
    f"the mat is pushed down to a height of {recording.cloth('mat')[:, :, 2].min():.2f} m; "
    f"the balls come up to {recording.x[recording.t > 0.8, large.index, 2].max():.2f} and "
    f"{recording.x[recording.t > 0.8, small.index, 2].max():.2f} m"
)

"""
A ball through a sheet
======================

A ball of 2 kg flies at 8 m/s into a sheet that tears where it is stretched by a quarter of its length. The tear begins where
the ball hits, and runs to both sides, perpendicular to the tension between the upper and the lower edge, which are fixed.
"""

import numpy as np

import kickdrift as kd

world = kd.World()
world.add_plane()
upright = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
sheet = world.add_cloth_grid(
    (1.2, 1.0), (31, 26), position=(0, 0, 1.2), orientation=upright, density=0.3, stretch_stiffness=300.0,
    shear_stiffness=60.0, damping=2e-3, tear_strain=0.25, name="sheet",
)  # fmt: skip
height = sheet.position[:, 2]
sheet.pin(np.flatnonzero((height > height.max() - 1e-9) | (height < height.min() + 1e-9)))
ball = world.add_sphere(0.12, position=(0.02, -1.2, 1.25), velocity=(0, 8.0, 1.0), mass=2.0)
vertices = len(sheet.mass)
recording = world.run(duration=0.4, step=1 / 120)
figure = recording.plot()
print(
    f"behind the sheet the ball flies at {ball.velocity[1]:.1f} m/s; "
    f"{len(sheet.mass) - vertices} of the {vertices} vertices"
    " of the sheet were split"
)

"""
A cloth over a ball
===================

A square of cotton falls over a ball and lies on it in folds. Its stiffnesses, in N/m and N m, are those of the
material, so that the same values describe the same cloth on a finer mesh.
"""

import numpy as np

import kickdrift as kd

world = kd.World()
world.add_plane()
world.add_sphere(radius=0.3, position=(0, 0, 0.3), density=2000.0)
cloth = world.add_cloth_grid(
    (1.2, 1.2),
    (32, 32),
    position=(0.05, 0.02, 0.66),
    bending_stiffness=1e-4,
    damping=1e-3,
    linear_damping=1.0,
    name="cloth",
)
recording = world.run(duration=2.5, step=1 / 60)
figure = recording.plot()
places = recording.cloth("cloth")[-1]
above = np.linalg.norm(places - [0, 0, 0.3], axis=1) - 0.3
print(
    f"no vertex is nearer than {1e3 * above.min():.1f} mm to the ball; "
    f"{100 * (above < 0.01).mean():.0f} % of the cloth lies on it"
)

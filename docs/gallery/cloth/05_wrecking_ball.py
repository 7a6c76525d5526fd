"""
A wrecking ball
===============

A chain of twenty rods of 1 kg carries a ball of 1000 kg. Solvers that treat one joint after the other let such a chain stretch
like rubber. Here all joints are solved simultaneously, as one island, and the chain keeps its length. The ball breaks through
a wall of 28 stones, and behind it rises by a quarter of the height that it fell.
"""

import numpy as np

import kickdrift as kd

world = kd.World(substeps=10)
world.add_plane(friction=0.5)
top, lean, links = np.array([0.0, 0.0, 10.6]), np.radians(70), 20
along = np.array([-np.sin(lean), 0.0, -np.cos(lean)])
turn = (np.cos(lean / 2), 0, np.sin(lean / 2), 0)
before = None
for number in range(links):
    rod = world.add_capsule(
        0.05, 0.35, position=top + (number + 0.5) * 0.45 * along, orientation=turn, mass=1.0, collides_with=()
    )
    world.add_ball_joint(before, rod, anchor=top + number * 0.45 * along)
    before = rod
ball = world.add_sphere(0.5, position=top + (links * 0.45 + 0.5) * along, mass=1000.0)
world.add_ball_joint(before, ball, anchor=top + links * 0.45 * along)
for row in range(7):
    for place in range(4):
        world.add_box(
            (0.4, 0.8, 0.4), position=(0.9, 0.82 * (place - 1.5), 0.2 + 0.4 * row), density=1200.0, friction=0.6
        )
recording = world.run(duration=4.0, step=1 / 240)
figure = recording.plot()
height = recording.x[:, ball.index, 2]
print(f"joints open by {recording.derived['joint gap'].max():.0e} m at most")
rise = height[recording.t > 2.0].max() - height.min()
print(f"the ball falls by {height[0] - height.min():.2f} m and rises by {rise:.2f} m behind the wall")
recording.show()

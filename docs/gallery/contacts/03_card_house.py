"""
A house of cards
================

Three storeys of cards that lean against each other in pairs, with a long card across each storey. The house stands by friction
alone. A marble then knocks down its upper part, and the lowest storey still stands.
"""

import numpy as np

import kickdrift as kd

length, thick, lean = 0.09, 0.002, np.radians(30)
world = kd.World(substeps=8, margin=0.004, slop=0.0005)
world.add_plane(friction=0.7)


def card(x, z, angle):
    turn = (np.cos(angle / 2), 0, np.sin(angle / 2), 0)
    return world.add_box((thick, 0.06, length), position=(x, 0, z), orientation=turn, density=900.0, friction=0.7)


rise, apart = length * np.cos(lean) + thick * np.sin(lean), length * np.sin(lean) + thick * np.cos(lean)
for row in range(3):
    floor = row * (rise + thick)
    for pair in range(3 - row):
        x = (pair - 0.5 * (2 - row)) * 2 * apart
        card(x - 0.5 * apart, floor + 0.5 * rise, lean)
        card(x + 0.5 * apart, floor + 0.5 * rise, -lean)
    if row < 2:
        size = ((2 - row) * 2 * apart + 0.05, 0.06, thick)
        world.add_box(size, position=(0, 0, floor + rise + 0.5 * thick), density=900.0, friction=0.7)
before = world.position.copy()
stands = world.run(duration=3.0, step=1 / 240)
moved = np.linalg.norm(world.position - before, axis=1).max()
figure = stands.plot()
world.add_sphere(0.012, position=(-0.4, 0, 0.12), velocity=(3.0, 0, 0.6), density=2500.0)
falls = world.run(duration=1.0, step=1 / 240)
after = falls.plot()
print(
    f"in 3 s the cards moved by at most {1e3 * moved:.2f} mm; "
    f"then a marble of {1e3 * 2500 * 4.19 * 0.012**3:.0f} g hits the house"
)

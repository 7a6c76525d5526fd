"""Many bodies at once: balls through a hopper, hail on towers."""

import itertools

import numpy as np

from benchmarks.lab.building import GRAVITY, Builder
from benchmarks.lab.measures import at_most, rises
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched


def _hopper(mouth: float = 0.36, wide: float = 1.2, thick: float = 0.1) -> Trial:
    """Pour 294 balls of 3 cm through a square funnel, six balls wide at its mouth, into a bin.

    Its slopes are steeper than friction holds, and no arch of balls spans such a mouth for long (Beverloo et al., 1961).
    """
    random, builder, radius = np.random.default_rng(6), Builder(friction=0.3), 0.03
    builder.plane()
    lean, slope = np.radians(45.0), (wide - mouth) / 2 * 2**0.5
    for axis, side in itertools.product((0, 1), (-1.0, 1.0)):
        out = side * np.eye(3)[axis]
        size = np.full(3, wide + 2 * thick)
        size[axis] = thick
        for low, high in ((0.0, 0.6), (1.02, 1.8)):  # the bin and the shaft
            size[2] = high - low
            builder.box(size, position=(wide + thick) / 2 * out + (0.0, 0.0, (low + high) / 2), static=True)
        size[axis], size[2] = slope + thick, thick
        turn = (np.cos(lean / 2), *np.sin(lean / 2) * np.cross(out, (0.0, 0.0, 1.0)))
        middle = (wide + mouth) / 4 * out + (0.0, 0.0, 0.6 + (wide - mouth) / 4)
        builder.box(size, position=middle + thick / 2**1.5 * (out - (0.0, 0.0, 1.0)), orientation=turn, static=True)
    first = len(builder.scene().bodies)
    for x, y, z in itertools.product(range(7), range(7), range(6)):
        place = np.array([0.0, 0.0, 1.15]) + 0.11 * np.array([x - 3, y - 3, z]) + random.uniform(-0.02, 0.02, 3)
        builder.sphere(radius, position=place, density=2500.0)

    def outside(scene: Scene, watched: Watched) -> float:
        place = watched.poses[:, first:, :3]
        return float(max(np.abs(place[..., :2]).max() - wide / 2, -place[..., 2].min()))

    def above(scene: Scene, watched: Watched) -> float:
        return float((watched.poses[-1, first:, 2] > 0.6).sum())

    criteria = (at_most("outside", "m", outside, 0.0), at_most("still above", "", above, 0.0), rises(0.01))
    return Trial("294 balls through a hopper", (builder.scene(),), 4.0, criteria)


def _hail(members: int = 4, count: int = 81, drop: float = 1.0) -> Trial:
    """Let 81 small boxes fall at once onto towers under loads of 30 to 300 t, e = 0: nothing gets faster than by falling."""
    random, scenes, boxes, thick = np.random.default_rng(10), [], 3, 1.0
    for _ in range(members):
        builder, side = Builder(), round(count**0.5)
        builder.plane()
        for k in range(boxes):
            builder.box((1.0, 1.0, 1.0), position=(0.0, 0.0, k + 0.5), mass=10.0 ** random.uniform(-0.5, 0.5))
        builder.box((2.0, 2.0, thick), position=(0.0, 0.0, boxes + 0.5), mass=10.0 ** random.uniform(4.5, 5.5))
        for x, y in itertools.product(range(side), range(side)):
            place = 0.2 * (np.array([x, y]) - (side - 1) / 2) + random.uniform(-0.04, 0.04, 2)
            builder.box((0.1, 0.1, 0.1), position=(*place, boxes + thick + 0.05 + drop), mass=0.1)
        scenes.append(builder.scene())

    def fastest(scene: Scene, watched: Watched) -> float:
        return float(np.linalg.norm(watched.motions[:, 1:, :3], axis=2).max())

    most = (2 * GRAVITY * (boxes + thick + drop)) ** 0.5
    criteria = (at_most("fastest", "m/s", fastest, most),)
    return Trial("hail of boxes on 4 towers under 30 to 300 t", tuple(scenes), 1.0, criteria, looks=60)


TRIALS = (_hopper(), _hail())

"""Worlds in a plane."""

import numpy as np

from benchmarks.lab.building import GROUND, Builder
from benchmarks.lab.measures import apart, at_most, overlaps, rests, sinks, stays
from benchmarks.lab.scenes.towers import pyramid
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched


def _zigzag() -> Trial:
    """Stack five boxes, every other 0.2 m aside."""
    builder = Builder(planar=True)
    builder.plane()
    for k in range(5):
        builder.box((1.0, 1.0, 1.0), position=(0.2 * (k % 2), 0.0, k + 0.5), mass=1.0)
    return Trial("planar: 5 boxes, every other 0.2 m aside", (builder.scene(),), 10.0, (rests(), stays(0.05)))


def _pyramid() -> Trial:
    scene = pyramid(10, planar=True)
    return Trial("planar: pyramid of 55", (scene,), 10.0, (rests(), stays(0.05), overlaps(0.1)))


def rope_bridge(planar: bool, kind: str = "hinge", planks: int = 12, ball: float = 15.0) -> Scene:
    """Hang a bridge of planks of 3 kg between two points, and put a ball on its middle, gently."""
    builder = Builder(planar=planar)
    width, sag = 0.5, 0.3
    angles = np.linspace(sag, -sag, planks)
    ends = np.vstack([np.zeros(3), np.cumsum([(width * np.cos(a), 0.0, -width * np.sin(a)) for a in angles], axis=0)])
    ends[:, 0] -= ends[-1, 0] / 2
    before = GROUND
    for begin, end, angle in zip(ends[:-1], ends[1:], angles, strict=True):
        turn = (np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0)
        plank = builder.box((width, 1.0, 0.1), position=(begin + end) / 2, orientation=turn, mass=3.0)
        builder.join(kind, before, plank, begin, (0.0, 1.0, 0.0))
        before = plank
    builder.join(kind, before, GROUND, ends[-1], (0.0, 1.0, 0.0))
    radius = 0.35
    builder.sphere(radius, position=(0.0, 0.0, ends[planks // 2, 2] + 0.05 + radius + 0.005), mass=ball)
    return builder.scene()


def _bridges() -> list[Trial]:
    def fallen(scene: Scene, watched: Watched) -> float:
        """How far the ball is below the lowest plank."""
        return float((watched.poses[:, :-1, 2].min(axis=1) - watched.poses[:, -1, 2]).max())

    criteria = (rests(), sinks(np.inf), at_most("below the planks", "m", fallen, 0.0), apart(0.01))
    names = {(True, "hinge"): "planar: ball on a bridge of hinges", (False, "hinge"): "ball on a bridge of hinges"}
    return [
        Trial(name, (rope_bridge(planar, kind),), 20.0, criteria, looks=80)
        for (planar, kind), name in names.items()
    ]  # fmt: skip


TRIALS = (_zigzag(), _pyramid(), *_bridges())

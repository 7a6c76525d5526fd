"""Boxes on boxes."""

from collections.abc import Sequence

import numpy as np

from benchmarks.lab.building import Builder
from benchmarks.lab.measures import overlaps, rests, sinks, stays
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene

_TEN = 10.0  # s


def tower(masses: Sequence[float], edges: Sequence[float]) -> Scene:
    """Stack cubes, the first of each list at the bottom."""
    builder = Builder()
    builder.plane()
    height = 0.0
    for mass, edge in zip(masses, edges, strict=True):
        builder.box((edge,) * 3, position=(0.0, 0.0, height + edge / 2), mass=mass)
        height += edge
    return builder.scene()


def standing(name: str, scene: Scene, size: float, quick: bool = True, deep: float | None = None) -> Trial:
    """Want a stack of boxes of a size, the smallest, to stand: less than that aside, half as deep in each other.

    It may not sink by more than a quarter of where the highest one is, or as deep as is said.
    """
    high = max(body.position[2] for body in scene.bodies)
    criteria = (rests(), stays(size), sinks(0.25 * high if deep is None else deep), overlaps(0.5 * size))
    return Trial(name, (scene,), _TEN, criteria, quick=quick)


def _towers() -> list[Trial]:
    ratios = [
        standing(f"tower: 2 boxes, 1 kg under {ratio}", tower((1.0, float(ratio)), (1.0, 1.0)), 1.0)
        for ratio in (10, 100, 1000)
    ]
    under = standing("tower: 4 boxes of 1 kg under 100", tower((1.0,) * 4 + (100.0,), (1.0,) * 5), 1.0)
    equal = [
        standing(f"tower: {count} equal boxes of {edge:g} m", tower((1.0,) * count, (edge,) * count), edge, count <= 20)
        for edge in (1.0, 0.05)
        for count in (20, 40)
    ]
    halves = [0.5**k for k in range(10)]
    halving = standing("tower: 10 boxes, halving masses", tower(halves, (1.0,) * 10), 1.0)
    edges = (0.25, 0.5, 1.0)
    growing = standing("tower: cubes of 0.25, 0.5, 1 m", tower([1000 * e**3 for e in edges], edges), 0.25)
    edges_up = [0.2 * 1.5**k for k in range(10)]
    masses = [1.5**k for k in range(10)]
    heavier = standing("tower: 10 boxes, masses growing by 1.5", tower(masses, (1.0,) * 10), 1.0)
    larger = standing("tower: 10 cubes, edges growing by 1.5", tower([1000 * e**3 for e in edges_up], edges_up), 0.2)
    tiny = standing("tower: 5 cubes of 5 mm", tower((1e-4,) * 5, (0.005,) * 5), 0.005)
    return [*ratios, under, *equal, halving, growing, heavier, larger, tiny, _drawn()]


def _drawn(members: int = 6) -> Trial:
    """Towers of three to eight boxes with masses and sizes drawn at random; statics holds them all."""
    random = np.random.default_rng(11)
    scenes = []
    for _ in range(members):
        count = random.integers(3, 9)
        scenes.append(tower(10.0 ** random.uniform(-0.7, 0.7, count), random.uniform(0.6, 1.4, count)))
    trial = standing("tower: 6 of random masses and sizes", scenes[0], 0.6)
    return Trial(trial.name, tuple(scenes), 6.0, trial.criteria)


def _pyramids() -> list[Trial]:
    return [standing(f"pyramid of {base * (base + 1) // 2}", pyramid(base), 1.0, base < 20) for base in (10, 20)]


def pyramid(base: int, edge: float = 1.0, planar: bool = False) -> Scene:
    """Stack a vertical pyramid of cubes that touch their neighbours."""
    builder = Builder(planar=planar)
    builder.plane()
    for row in range(base):
        for place in range(base - row):
            x = (place - (base - row - 1) / 2) * edge
            builder.box((edge,) * 3, position=(x, 0.0, (row + 0.5) * edge), density=100.0)
    return builder.scene()


def bricks(share: float, count: int = 10) -> Scene:
    """Let a stack of bricks hang over as far as statics allows, times a share: the k-th from the top by 1 / 2k."""
    builder = Builder()
    builder.plane()
    x = 0.0
    for k in range(count, 0, -1):  # from the bottom
        builder.box((1.0, 0.5, 0.25), position=(x, 0.0, (count - k + 0.5) * 0.25), mass=1.0)
        x += share / (2 * (k - 1)) if k > 1 else 0.0
    return builder.scene()


def _harmonic() -> list[Trial]:
    return [standing(f"bricks: 10 hang over at {share:.0%}", bricks(share), 0.25) for share in (0.8, 0.9)]


TRIALS = (*_towers(), *_pyramids(), *_harmonic())

"""Rows of free balls of 10 g to 100 kg, struck at one end with e = 0: none passes through another.

Mechanics lets all move on together; how far they are from that is printed, not judged.
"""

import numpy as np
from scipy.spatial.distance import pdist

from benchmarks.lab.building import Builder
from benchmarks.lab.measures import at_most
from benchmarks.lab.trial import Criterion, Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched

_RADIUS = 0.15


def _row(random: np.random.Generator, gravity: float) -> Scene:
    builder, x = Builder(gravity, friction=0.0), 0.0
    if gravity > 0.0:
        builder.plane()
    for k in range(random.integers(2, 10)):
        motion = {"velocity": (random.uniform(1, 20) if k == 0 else 0.0, 0.0, 0.0)}
        builder.sphere(_RADIUS, position=(x, 0.0, _RADIUS), mass=10.0 ** random.uniform(-2, 2), **motion)
        x += 2 * _RADIUS + random.uniform(0.0, 0.3)
    return builder.scene()


def _balls(scene: Scene) -> list[int]:
    return [k for k, body in enumerate(scene.bodies) if body.mass > 0.0]


def _overlap(scene: Scene, watched: Watched) -> float:
    places = watched.poses[:, _balls(scene), :3]
    return float(2 * _RADIUS - min(pdist(look).min() for look in places))


def _off(scene: Scene, watched: Watched) -> float:
    masses = np.array([scene.bodies[ball].mass for ball in _balls(scene)])
    start, end = watched.motions[[0, -1]][:, _balls(scene), 0]
    return float(np.abs(end - masses @ start / masses.sum()).max() / start.max())


def _struck(name: str, gravity: float, members: int = 20) -> Trial:
    random = np.random.default_rng(7)
    scenes = tuple(_row(random, gravity) for _ in range(members))
    criteria = (
        at_most("overlap", "m", _overlap, 0.5 * _RADIUS),
        Criterion("off the common velocity", "of the first", _off),
    )
    return Trial(f"{members} rows of balls of 10 g to 100 kg {name}, e = 0", scenes, 10.0, criteria, looks=300)


TRIALS = (_struck("in free fall", 0.0), _struck("on a floor", 9.81))

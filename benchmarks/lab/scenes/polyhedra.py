"""Polyhedra of drawn shapes, whose faces may be nearly parallel, that land and come to rest."""

from collections.abc import Callable

import numpy as np

from benchmarks.lab.building import Builder, moments_of
from benchmarks.lab.measures import gains, rests
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Floats


def draw(random: np.random.Generator) -> Floats:
    """Draw points on an ellipsoid of 5 to 50 cm, of which all are corners; return them along the axes of the inertia."""
    points = random.normal(size=(random.integers(6, 30), 3))
    points *= random.uniform(0.3, 1.0, 3) * random.uniform(0.05, 0.5) / np.linalg.norm(points, axis=1)[:, None]
    _, axes = np.linalg.eigh(moments_of(points)[2])
    return np.asarray(points @ (axes * np.linalg.det(axes)))


def _landing(name: str, floor: Callable[[Builder], int], seed: int, side: int = 6) -> Trial:
    build, random = Builder(), np.random.default_rng(seed)
    floor(build)
    for k in range(side * side):
        build.hull(
            draw(random),
            position=(4.0 * (k % side) - 9.8, 4.0 * (k // side) - 9.7, 0.6),
            orientation=random.normal(size=4),
            angular_velocity=random.normal(scale=3.0, size=3),
        )
    return Trial(f"{side * side} drawn polyhedra landing on {name}", (build.scene(),), 20.0, (rests(), gains()))


def _mesh(build: Builder) -> int:
    corners = [(-20.0, -20.0, 0.0), (20.0, -20.0, 0.0), (20.0, 20.0, 0.0), (-20.0, 20.0, 0.0)]
    return build.mesh(corners, [(0, 1, 2), (0, 2, 3)])


TRIALS = (
    _landing("a plane", Builder.plane, 1),
    _landing("a box", lambda build: build.box((40.0, 40.0, 1.0), position=(0.0, 0.0, -0.5), static=True), 2),
    _landing("a mesh", _mesh, 3),
)

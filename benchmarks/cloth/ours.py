"""Cloths of kickdrift."""

import time

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from benchmarks.cloth.scene import DAMPING, DENSITY, FRAME, HEIGHT, RADIUS, SIZE, THICKNESS, Draped
from kickdrift.world import tables
from kickdrift.world.deformables.layout import PARTS
from kickdrift.world.world import World

_SPACING = 0.01  # m, of cloths that hang


class Kickdrift(Draped):
    """A cloth on a ball: 200 N/m against stretching, 40 N/m against shear, 1e-5 N m against bending.

    Parameters
    ----------
    side : int
        Particles on a side.
    meets : bool
        Whether it collides with itself.
    threads : bool
        Whether Numba's threads share the work.
    """

    def __init__(self, side: int, meets: bool, threads: bool = False) -> None:
        self._world = World(threads=threads)
        self._world.add_plane()
        self._world.add_sphere(RADIUS, position=(0, 0, RADIUS), static=True)
        self._world.add_cloth_grid(
            (SIZE, SIZE), (side, side), position=(0, 0, HEIGHT), density=DENSITY, thickness=THICKNESS, damping=1e-3,
            linear_damping=DAMPING, self_collision=meets,
        )  # fmt: skip

    @property
    def parts(self) -> int:
        """Parts of a frame."""
        return self._world.substeps * int(self._world.tables.array(tables.CLOTH)[0, PARTS])

    def advance(self, frames: int) -> None:
        """Advance by so many frames."""
        self._world.advance(FRAME, frames)


class Hanging:
    """A square of cloth that hangs by one side, with triangles of 1 cm: a grid, or an irregular mesh."""

    def __init__(self, side: int, irregular: bool = False) -> None:
        self.world, self.count, size = World(), side * side, _SPACING * side
        if irregular:
            vertices, triangles = _irregular(side)
            sheet = self.world.add_cloth(size * vertices, triangles, damping=1e-3, self_collision=False)
        else:
            sheet = self.world.add_cloth_grid((size, size), (side, side), damping=1e-3, self_collision=False)
        sheet.pin(np.arange(side))

    def part_cost(self, frames: int) -> float:
        """Return nanoseconds of a particle and part, over so many frames."""
        started = time.perf_counter()
        self.world.advance(FRAME, frames)
        parts = self.world.substeps * int(self.world.tables.array(tables.CLOTH)[0, PARTS])
        return (time.perf_counter() - started) / (frames * parts * self.count) * 1e9


def _irregular(side: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return a Delaunay triangulation of a unit square, of grid points of which the inner ones are moved at random."""
    rng, along = np.random.default_rng(0), np.linspace(0.0, 1.0, side)
    points = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    inner = ((points > 0.0) & (points < 1.0)).all(axis=1)
    points[inner] += rng.uniform(-0.2, 0.2, (int(inner.sum()), 2)) / (side - 1)
    return np.pad(points, ((0, 0), (0, 1))), Delaunay(points).simplices.astype(np.int64)


def hanging(side: int, irregular: bool = False) -> Hanging:
    """Return a cloth that has begun to hang."""
    cloth = Hanging(side, irregular)
    cloth.world.advance(FRAME, 1)
    return cloth

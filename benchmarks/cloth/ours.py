"""Cloths of kickdrift."""

import time

import numpy as np

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
    """

    def __init__(self, side: int, meets: bool) -> None:
        self._world = World()
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
    """A square of cloth that hangs by one side, with triangles of 1 cm."""

    def __init__(self, side: int) -> None:
        self.world, self.count, self._side = World(), side * side, side
        self._sheet = self.world.add_cloth_grid(
            (_SPACING * side, _SPACING * side), (side, side), damping=1e-3, self_collision=False
        )
        self._sheet.pin(np.arange(side))

    def part_cost(self, frames: int) -> float:
        """Return nanoseconds of a particle and part, over so many frames."""
        started = time.perf_counter()
        self.world.advance(FRAME, frames)
        parts = self.world.substeps * int(self.world.tables.array(tables.CLOTH)[0, PARTS])
        return (time.perf_counter() - started) / (frames * parts * self.count) * 1e9


def hanging(side: int) -> Hanging:
    """Return a cloth that has begun to hang."""
    cloth = Hanging(side)
    cloth.world.advance(FRAME, 1)
    return cloth

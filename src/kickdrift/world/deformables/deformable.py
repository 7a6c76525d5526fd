"""The base class of the handles of cloths, ropes and soft bodies: their vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.world.bodies.handle import Body
from kickdrift.world.deformables.layout import PARTICLE_MASS, PARTICLE_VELOCITY
from kickdrift.world.deformables.material import parameter
from kickdrift.world.handle import Handle

if TYPE_CHECKING:
    from kickdrift.world.deformables.registry import Cloths

Floats = NDArray[np.float64]


class Deformable(Handle):
    """A cloth, a rope or a soft body of a world.

    Attributes
    ----------
    index : int
        Its position among the cloths, ropes and soft bodies of the world, from 0; it decreases when an earlier one is removed.

    Notes
    -----
    Positions and velocities are live views with one row per vertex: writing into them moves it. Pinned vertices move with the
    velocities that are written for them, or with the body that they are pinned to.
    """

    __slots__ = ("_cloths",)
    registered_in = "cloths"

    def __init__(self, index: int, generation: int, cloths: Cloths) -> None:
        self._index, self._generation, self._cloths = index, generation, cloths
        self._last_name = cloths.names.of(index)

    @property
    def _registry(self) -> Cloths:
        return self._cloths

    @property
    def registry(self) -> Cloths:
        """The cloths of its world."""
        return self._cloths

    @property
    def index(self) -> int:
        """Its position among the cloths, ropes and soft bodies of the world, from 0.

        It decreases when an earlier one is removed. Once it has been removed itself, it is the last one.
        """
        self._index = self._cloths.index_of(self._generation, self._index)
        return self._index

    @property
    def position(self) -> Floats:
        """Positions of the vertices, (N, 3), m."""
        return self._cloths.particles(self)[:, 0:3]

    @property
    def velocity(self) -> Floats:
        """Velocities of the vertices, (N, 3), m/s."""
        return self._cloths.particles(self)[:, PARTICLE_VELOCITY : PARTICLE_VELOCITY + 3]

    @property
    def mass(self) -> Floats:
        """Masses of the vertices, (N,), kg, a copy."""
        return self._cloths.particles(self)[:, PARTICLE_MASS].copy()

    @property
    def friction(self) -> float:
        """Coefficient of friction; can be set."""
        return float(self._cloths.numbers(self, "friction")[0])

    @friction.setter
    def friction(self, friction: float) -> None:
        self._cloths.set_numbers(self, "friction", parameter("friction", friction, "1"))

    def pin(self, vertices: ArrayLike, body: Body | None = None) -> None:
        """Pin vertices at their present positions, in the world or on a body.

        Without a body they stay where they are, or move with the velocities that are written into `velocity`.

        Parameters
        ----------
        vertices : array_like of int
            Their indices.
        body : Body, optional
            The body that carries them; their pull acts on it.

        Raises
        ------
        ArgumentError
            For vertices that do not exist, and for a removed body.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet = world.add_cloth_grid(size=(1.0, 1.0), vertices=(5, 5), position=(0, 0, 2))
        >>> cart = world.add_box(
        ...     (0.1, 0.1, 0.1), position=(-0.5, -0.5, 2), velocity=(0.5, 0, 0), kinematic=True
        ... )
        >>> sheet.pin([0], cart)
        >>> sheet.pin([4])
        >>> world.advance(1 / 60, 60)
        >>> sheet.position[[0, 4]].round(3) + 0.0
        array([[ 0. , -0.5,  2. ],
               [-0.5,  0.5,  2. ]])
        """
        self._cloths.pin(self, vertices, body)

    def unpin(self, vertices: ArrayLike) -> None:
        """Release pinned vertices; others are not affected.

        Parameters
        ----------
        vertices : array_like of int
            Their indices.

        Raises
        ------
        ArgumentError
            For vertices that do not exist.
        """
        self._cloths.unpin(self, vertices)

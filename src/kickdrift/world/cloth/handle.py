"""The handle of a cloth, which reads and sets its properties."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.arguments import direction, number, vector
from kickdrift.world.body import Body
from kickdrift.world.cloth.layout import PARTICLE_MASS, PARTICLE_VELOCITY
from kickdrift.world.handle import Handle

if TYPE_CHECKING:
    from kickdrift.world.cloth.registry import Cloths
    from kickdrift.world.world import World

Floats = NDArray[np.float64]
_FASTEST = 1e6  # m/s: the largest wind, whose square and forces are finite


class Cloth(Handle):
    """A cloth of a world.

    Attributes
    ----------
    index : int
        Its position among the cloths of the world, from 0, which decreases when an earlier cloth is removed.

    Notes
    -----
    Positions and velocities are live views with one row per vertex: writing into them moves the cloth. Pinned vertices move
    with the velocities that are written for them, or with the body that they are pinned to.
    """

    __slots__ = ("_cloths",)

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

    @staticmethod
    def registry_of(world: World) -> Cloths:
        """Return the cloths of a world."""
        return world.cloths

    @property
    def index(self) -> int:
        """Its position among the cloths of the world, from 0; of a removed cloth, the last one."""
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
    def triangles(self) -> NDArray[np.int64]:
        """Vertices of the triangles, (M, 3), a copy."""
        return self._cloths.triangles(self)

    @property
    def stiffness(self) -> tuple[float, float, float]:
        """Stiffness against stretching and shear, N/m, and bending, N m, that is in use.

        It is lower than that of the fabric if the step is too long for it; a smaller step or more substeps raise it.
        """
        return self._cloths.stiffness(self)

    @property
    def wind(self) -> Floats:
        """Velocity of the air around it, (3,), m/s, a copy; can be set."""
        return self._cloths.numbers(self, "wind")

    @wind.setter
    def wind(self, wind: ArrayLike) -> None:
        air = vector("wind", wind, 3)
        if np.abs(air).max() > _FASTEST:
            raise ArgumentError(f"wind={wind!r} is faster than {_FASTEST:g} m/s; give a slower one.")
        self._cloths.set_numbers(self, "wind", air)

    @property
    def friction(self) -> float:
        """Coefficient of friction; can be set."""
        return float(self._cloths.numbers(self, "friction")[0])

    @friction.setter
    def friction(self, friction: float) -> None:
        self._cloths.set_numbers(self, "friction", number("friction", friction, "1"))

    @property
    def tear_strain(self) -> float:
        """Strain above which it tears, 0.0 if it does not; can be set."""
        return float(self._cloths.numbers(self, "tear_strain")[0])

    @tear_strain.setter
    def tear_strain(self, tear_strain: float) -> None:
        self._cloths.set_numbers(self, "tear_strain", number("tear_strain", tear_strain, "1"))

    def cut(self, point: ArrayLike, normal: ArrayLike) -> int:
        """Cut it by a plane along edges: triangles whose centroids are on different sides are separated.

        Vertices on the cut are split. The new ones are appended, with the velocities and pins of their originals and a share of
        their mass; mass and momentum are conserved.

        Parameters
        ----------
        point, normal : (3,) array_like
            A point of the plane, m, and its normal, of any length.

        Returns
        -------
        int
            Number of vertices added.

        Raises
        ------
        ArgumentError
            For numbers that are not finite, and a direction of length zero.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet = world.add_cloth_grid(size=(1.0, 1.0), vertices=(5, 5))
        >>> sheet.cut(point=(0, 0, 0), normal=(1, 0, 0))
        5
        """
        return self._cloths.cut(self, vector("point", point, 3), direction("normal", normal))

    def pin(self, vertices: ArrayLike, body: Body | None = None) -> None:
        """Pin vertices at their present positions, in the world or on a body.

        Without a body they stand still, or move with the velocities that are written into `velocity`.

        Parameters
        ----------
        vertices : array_like of int
            Their indices.
        body : Body, optional
            The body that carries them, and feels their pull.

        Raises
        ------
        ArgumentError
            For vertices that do not exist, and for a removed body.
        """
        self._cloths.pin(self, vertices, body)

    def unpin(self, vertices: ArrayLike) -> None:
        """Release pinned vertices; others are not affected.

        Raises
        ------
        ArgumentError
            For vertices that do not exist.
        """
        self._cloths.unpin(self, vertices)

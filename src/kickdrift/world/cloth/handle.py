"""The handle of a cloth: what it says of the cloth, and what it sets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.arguments import direction, number, vector
from kickdrift.world.body import Body
from kickdrift.world.handle import Handle

if TYPE_CHECKING:
    from kickdrift.world.cloth.registry import Cloths
    from kickdrift.world.world import World

Floats = NDArray[np.float64]
_FASTEST = 1e6  # m/s, of winds: their squares, and what follows from these, are finite


class Cloth(Handle):
    """A cloth of a world.

    Attributes
    ----------
    index : int
        How many cloths of the world come before it: one less where one of those is removed.

    Notes
    -----
    Positions and velocities are live views, a row a vertex: what is written into them moves the cloth. Pinned vertices move
    with the velocities that they are given, or with the body that they are pinned to.
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
        """How many cloths of the world come before it; of one that was removed, how many came."""
        self._index = self._cloths.index_of(self._generation, self._index)
        return self._index

    @property
    def position(self) -> Floats:
        """Where the vertices are, (N, 3), m."""
        return self._cloths.particles(self)[:, 0:3]

    @property
    def velocity(self) -> Floats:
        """Velocities of the vertices, (N, 3), m/s."""
        return self._cloths.particles(self)[:, 4:7]

    @property
    def mass(self) -> Floats:
        """Masses of the vertices, (N,), kg, a copy."""
        return self._cloths.particles(self)[:, 7].copy()

    @property
    def triangles(self) -> NDArray[np.int64]:
        """Vertices of the triangles, (M, 3), a copy."""
        return self._cloths.triangles(self)

    @property
    def stiffness(self) -> tuple[float, float, float]:
        """Stiffness against stretching and shear, N/m, and bending, N m, as they are in use.

        They are lower than those that the cloth was made with where the step does not allow so much; a smaller step or more
        substeps do.
        """
        return self._cloths.stiffness(self)

    @property
    def wind(self) -> Floats:
        """Velocity of the air around it, (3,), m/s, a copy; may be given anew."""
        return self._cloths.numbers(self, "wind")

    @wind.setter
    def wind(self, wind: ArrayLike) -> None:
        air = vector("wind", wind, 3)
        if np.abs(air).max() > _FASTEST:
            raise ArgumentError(f"wind={wind!r} is faster than {_FASTEST:g} m/s; give a slower one.")
        self._cloths.set_numbers(self, "wind", air)

    @property
    def friction(self) -> float:
        """Coefficient of friction; may be given anew."""
        return float(self._cloths.numbers(self, "friction")[0])

    @friction.setter
    def friction(self, friction: float) -> None:
        self._cloths.set_numbers(self, "friction", number("friction", friction, "1"))

    @property
    def tear_strain(self) -> float:
        """Strain at which it tears, 0.0 if it does not; may be given anew."""
        return float(self._cloths.numbers(self, "tear_strain")[0])

    @tear_strain.setter
    def tear_strain(self, tear_strain: float) -> None:
        self._cloths.set_numbers(self, "tear_strain", number("tear_strain", tear_strain, "1"))

    def cut(self, point: ArrayLike, normal: ArrayLike) -> int:
        """Cut it along the edges of its triangles that are nearest to a plane: each triangle goes with the side of its middle.

        Vertices on the cut are split. Those that are new come after all others, with the velocities that these had, their
        shares of the mass, and what they were pinned to; mass and momentum stay.

        Parameters
        ----------
        point, normal : (3,) array_like
            A point of the plane, m, and a direction across it.

        Returns
        -------
        int
            How many vertices it has more.

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
        """Hold vertices where they are, or to where they are on a body.

        Without a body they stand still, or move with the velocities that are written into `velocity`.

        Parameters
        ----------
        vertices : array_like of int
        body : Body, optional
            Which takes what they pull with.

        Raises
        ------
        ArgumentError
            For vertices that there are none of, and a body that is gone.
        """
        self._cloths.pin(self, vertices, body)

    def unpin(self, vertices: ArrayLike) -> None:
        """Let vertices go; those that are free stay free.

        Raises
        ------
        ArgumentError
            For vertices that there are none of.
        """
        self._cloths.unpin(self, vertices)

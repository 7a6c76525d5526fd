"""The handle of a cloth, which reads and sets its properties."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.world.argument_checks import direction, vector
from kickdrift.world.deformables.material import parameter
from kickdrift.world.deformables.tethered import Tethered
from kickdrift.world.deformables.wind_functions import air_velocity

Floats = NDArray[np.float64]


class Cloth(Tethered):
    """A cloth of a world.

    Attributes
    ----------
    index : int
        Its position among the cloths, ropes and soft bodies of the world, from 0; it decreases when an earlier one is removed.

    Notes
    -----
    Positions and velocities are live views with one row per vertex: writing into them moves the cloth. Pinned vertices move
    with the velocities that are written for them, or with the body that they are pinned to.
    """

    __slots__ = ()

    @property
    def triangles(self) -> NDArray[np.int64]:
        """Vertices of the triangles, (M, 3), a copy."""
        return self._cloths.triangles(self)

    @property
    def stiffness(self) -> tuple[float, float, float]:
        """Stiffness in use against stretching, shear, N/m, and bending, N m.

        It is lower than that of the fabric if the step is too long for that; a smaller step or more substeps raise it.
        """
        return self._cloths.stiffness(self)

    @property
    def wind(self) -> Floats:
        """Velocity of the air around it, (3,), m/s, a copy; can be set. It acts by drag and lift, zero by default."""
        return self._cloths.numbers(self, "wind")

    @wind.setter
    def wind(self, wind: ArrayLike) -> None:
        self._cloths.set_numbers(self, "wind", air_velocity("wind", wind))

    @property
    def tear_strain(self) -> float:
        """Strain above which it tears, 0.0 if it does not; can be set."""
        return float(self._cloths.numbers(self, "tear_strain")[0])

    @tear_strain.setter
    def tear_strain(self, tear_strain: float) -> None:
        self._cloths.set_numbers(self, "tear_strain", parameter("tear_strain", tear_strain, "1"))

    def cut(self, point: ArrayLike, normal: ArrayLike) -> int:
        """Cut it along edges near a plane: triangles whose centroids are on different sides are separated.

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
            For numbers that are not finite, and a normal of length zero.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet = world.add_cloth_grid(size=(1.0, 1.0), vertices=(5, 5))
        >>> sheet.cut(point=(0, 0, 0), normal=(1, 0, 0))
        5
        """
        return self._cloths.cut(self, vector("point", point, 3), direction("normal", normal))

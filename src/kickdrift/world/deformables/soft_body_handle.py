"""The handle of a soft body, which reads and sets its properties."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables.deformable import Deformable


class SoftBody(Deformable):
    """A soft body of a world.

    Attributes
    ----------
    index : int
        Its position among the cloths, ropes and soft bodies of the world, from 0; it decreases when an earlier one is removed.

    Notes
    -----
    Positions and velocities are live views with one row per vertex: writing into them moves the body. Pinned vertices move with
    the velocities that are written for them, or with the body that they are pinned to.
    """

    __slots__ = ()

    @property
    def tetrahedra(self) -> NDArray[np.int64]:
        """Vertices of the tetrahedra, (M, 4), a copy."""
        return self._cloths.tetrahedra(self)

    @property
    def triangles(self) -> NDArray[np.int64]:
        """Vertices of the triangles of the surface, (K, 3), counter-clockwise as seen from outside, a copy."""
        return self._cloths.triangles(self)

    @property
    def volume(self) -> float:
        """Volume inside the surface, m^3."""
        corners = self.position[self.triangles] - self.position[0]
        return float(np.linalg.det(corners).sum() / 6.0)

    @property
    def young_modulus(self) -> float:
        """Young's modulus in use, Pa.

        It is lower than that of the material if the step is too long for that; a smaller step or more substeps raise it.
        """
        return self._cloths.stiffness(self)[0]

    @property
    def poisson_ratio(self) -> float:
        """Poisson's ratio: transverse contraction per axial strain, in a bar under small tension."""
        return float(self._cloths.numbers(self, "poisson_ratio")[0])

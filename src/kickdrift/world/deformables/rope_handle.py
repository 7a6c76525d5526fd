"""The handle of a rope, which reads and sets its properties."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables.tethered import Tethered

Floats = NDArray[np.float64]


class Rope(Tethered):
    """A rope of a world.

    Attributes
    ----------
    index : int
        Its position among the cloths, ropes and soft bodies of the world, from 0; it decreases when an earlier one is removed.

    Notes
    -----
    Positions and velocities are live views with one row per vertex: writing into them moves the rope. Pinned vertices move with
    the velocities that are written for them, or with the body that they are pinned to. Two consecutive pins clamp the rope.
    """

    __slots__ = ()

    @property
    def radius(self) -> float:
        """Radius, m."""
        return float(self._cloths.numbers(self, "radius")[0])

    @property
    def stiffness(self) -> tuple[float, float]:
        """Stiffness in use against stretching, N, and bending, N m^2.

        It is lower than that of the material if the step is too long for that; a smaller step or more substeps raise it.
        """
        stretch, _, bending = self._cloths.stiffness(self)
        return stretch, bending

    @property
    def tension(self) -> Floats:
        """Tension of the segments between consecutive vertices, (N - 1,), N; negative where they are compressed."""
        lengths = np.linalg.norm(np.diff(self.position, axis=0), axis=1)
        at_rest = self._cloths.rest_lengths(self)
        tension: Floats = self.stiffness[0] * (lengths / at_rest - 1.0)
        return tension

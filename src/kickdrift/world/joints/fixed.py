"""The fixed joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.world.joints.axis import LOCKED
from kickdrift.world.joints.record import Placement, Record, point


@dataclass(frozen=True)
class Fixed(Record):
    """Two bodies move as one.

    Parameters
    ----------
    anchor : (3,) array_like
        Where they are joined, in the world, m: the reference point of its torque.
    """

    anchor: ArrayLike

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        anchor = point("anchor", self.anchor)
        return Placement(anchor, anchor, np.eye(3), (LOCKED, LOCKED, LOCKED), (LOCKED, LOCKED, LOCKED))

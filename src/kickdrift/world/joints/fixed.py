"""The fixed joint: no relative motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.world.argument_checks import vector
from kickdrift.world.joints.limits_motors_options import LOCKED
from kickdrift.world.joints.record import Placement, Record


@dataclass(frozen=True)
class Fixed(Record):
    """A fixed joint: two bodies are rigidly connected.

    Parameters
    ----------
    anchor : (3,) array_like
        Where they are joined, in the world, m: the reference point of its torque.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(radius=0.05, length=0.9, position=(0, 0, -0.5), mass=1.0)
    >>> joint = world.add_fixed_joint(None, rod, anchor=(0, 0, 0))
    >>> world.advance(1 / 60, 60)
    >>> joint.force.round(2)
    array([0.  , 0.  , 9.81])
    """

    anchor: ArrayLike

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        anchor = vector("anchor", self.anchor, 3)
        return Placement(anchor, anchor, np.eye(3), (LOCKED, LOCKED, LOCKED), (LOCKED, LOCKED, LOCKED))

"""The rope: two points come no farther apart than its length."""

from __future__ import annotations

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.world.joints.limits_motors_options import Axis
from kickdrift.world.joints.point_to_point import line_placement
from kickdrift.world.joints.record import Placement, Record


@dataclass(frozen=True)
class Rope(Record):
    """A massless rope between a point of one body and a point of the other: it pulls, but does not push.

    Parameters
    ----------
    anchor_a, anchor_b : (3,) array_like
        The points, in the world, m.
    length : float, optional
        m; by default the current distance between the points.

    Raises
    ------
    ArgumentError
        For points that coincide and lengths that are not positive.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(radius=0.05, length=0.9, position=(0, 0, -0.5), mass=1.0)
    >>> rope = world.add_rope_joint(
    ...     None, rod, anchor_a=(0, 0, 1), anchor_b=(0, 0, 0), length=1.5
    ... )
    >>> world.advance(1 / 60, 300)
    >>> bool(rod.position[2] > -1.01)
    True
    """

    anchor_a: ArrayLike
    anchor_b: ArrayLike
    length: float | None = None

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        return line_placement(self.anchor_a, self.anchor_b, self.length, Axis(limits=(-math.inf, 0.0)))

"""The distance joint: two points stay as far apart as they are."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.world.joints.limits_motors_options import LOCKED
from kickdrift.world.joints.point_to_point import line_placement
from kickdrift.world.joints.record import Placement, Record


@dataclass(frozen=True)
class Distance(Record):
    """A distance joint: a massless rod between a point of one body and a point of the other.

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
    >>> joint = world.add_distance_joint(None, rod, anchor_a=(0, 0, 1), anchor_b=(0, 0, 0))
    >>> world.advance(1 / 60, 60)
    >>> round(float(rod.position[2]), 6)
    -0.5
    """

    anchor_a: ArrayLike
    anchor_b: ArrayLike
    length: float | None = None

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        return line_placement(self.anchor_a, self.anchor_b, self.length, LOCKED)

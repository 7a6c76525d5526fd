"""The distance joint: two points keep their distance."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.world.joints.axis import LOCKED
from kickdrift.world.joints.line import line_placement
from kickdrift.world.joints.record import Placement, Record


@dataclass(frozen=True)
class Distance(Record):
    """A rod without mass between a point of one body and a point of the other.

    Parameters
    ----------
    anchor_a, anchor_b : (3,) array_like
        The points, in the world, m.
    length : float, optional
        m; by default the current distance of the points.

    Raises
    ------
    ArgumentError
        For points that coincide and lengths that are not positive.
    """

    anchor_a: ArrayLike
    anchor_b: ArrayLike
    length: float | None = None

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        return line_placement(self.anchor_a, self.anchor_b, self.length, LOCKED)

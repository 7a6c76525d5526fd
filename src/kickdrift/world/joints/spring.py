"""The spring between two points."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.joints.limits_motors_options import Axis, Drive
from kickdrift.world.joints.point_to_point import line_placement
from kickdrift.world.joints.record import Placement, Record


@dataclass(frozen=True)
class Spring(Record):
    """A spring with a damper between a point of one body and a point of the other.

    Give either stiffness and damping, or frequency and damping ratio, which are those of the two bodies on their own.

    Parameters
    ----------
    anchor_a, anchor_b : (3,) array_like
        The points, in the world, m.
    length : float, optional
        Rest length, m; by default the current distance between the points.
    hertz, damping_ratio : float, optional
        Natural frequency, Hz, and damping divided by critical damping.
    stiffness, damping : float
        N/m and N s/m.

    Raises
    ------
    ArgumentError
        For points that coincide, lengths that are not positive, and a spring without stiffness and damping.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(radius=0.05, length=0.9, position=(0, 0, -0.5), mass=1.0)
    >>> spring = world.add_spring(
    ...     None, rod, anchor_a=(0, 0, 1), anchor_b=(0, 0, 0), stiffness=98.1, damping=20.0
    ... )
    >>> world.advance(1 / 60, 300)
    >>> round(float(rod.position[2]), 3)
    -0.6
    """

    anchor_a: ArrayLike
    anchor_b: ArrayLike
    length: float | None = None
    hertz: float | None = None
    damping_ratio: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        drive = Drive(self.stiffness, self.damping, self.hertz, self.damping_ratio)
        if self.hertz is None and self.stiffness == self.damping == 0.0:
            raise ArgumentError(
                "stiffness=0.0 and damping=0.0 make a spring without force; give stiffness, damping or hertz."
            )
        return line_placement(self.anchor_a, self.anchor_b, self.length, Axis(drive=drive))

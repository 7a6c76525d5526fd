"""The universal joint."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import vector
from kickdrift.world.joints.limits_motors_options import FREE, LOCKED, Axis
from kickdrift.world.joints.record import Placement, Record, frame_of


@dataclass(frozen=True)
class Universal(Record):
    """A universal (Cardan) joint: a cross with one axis in body a and one in body b, perpendicular to each other.

    Parameters
    ----------
    anchor : (3,) array_like
        Where the axes meet, in the world, m.
    axis_a, axis_b : (3,) array_like
        Their directions, in the world.
    about_a, about_b : Axis
        The laws about them: limits, motor, drive, friction. Angles are zero initially and count turns.

    Raises
    ------
    ArgumentError
        For axes of length zero or not perpendicular, and for axes that are locked.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(radius=0.05, length=0.9, position=(0, 0, -0.5), mass=1.0)
    >>> joint = world.add_universal_joint(
    ...     None, rod, anchor=(0, 0, 0), axis_a=(1, 0, 0), axis_b=(0, 1, 0)
    ... )
    >>> world.advance(1 / 60, 60)
    >>> joint.angles.round(6)
    array([0., 0., 0.])
    """

    anchor: ArrayLike
    axis_a: ArrayLike
    axis_b: ArrayLike
    about_a: Axis = FREE
    about_b: Axis = FREE

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        anchor = vector("anchor", self.anchor, 3)
        frame = frame_of("axis_a", self.axis_a, "axis_b", self.axis_b)
        for name, about in (("about_a", self.about_a), ("about_b", self.about_b)):
            if not isinstance(about, Axis):
                raise ArgumentError(f"{name}={about!r} must be a kickdrift.Axis.")
        if self.about_a.locked or self.about_b.locked:
            raise ArgumentError("about_a and about_b must be open; use add_hinge for a joint with one open axis.")
        return Placement(anchor, anchor, frame, (LOCKED, LOCKED, LOCKED), (self.about_a, self.about_b, LOCKED))

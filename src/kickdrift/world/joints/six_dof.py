"""The joint with six configurable axes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import vector
from kickdrift.world.joints.limits_motors_options import FREE, LOCKED, Axis, is_number
from kickdrift.world.joints.record import Axes, Placement, Record, frame_of


@dataclass(frozen=True)
class SixDof(Record):
    """A joint with three linear and three angular axes, each locked, or open with limits, motor, drive and friction.

    Parameters
    ----------
    anchor : (3,) array_like
        Origin of the axes, in the world, m.
    axis_x, axis_y : (3,) array_like
        Directions of the first two axes, in the world, perpendicular; the third is perpendicular to both. They are fixed in
        body a.
    linear : tuple of three Axis
        Limits, motor, drive and friction along them, or locks.
    angular : tuple of three Axis
        The same about them. A single open axis is that of a hinge; of two, the first (of x-y, y-z, z-x) is fixed in a and
        the other in b, as in a universal joint; with three, the angles are the components of the rotation vector, or with
        limits swing and twist about z.
    swing_limit : float, optional
        With three open angular axes: largest angle between the z axes of a and b, rad.

    Raises
    ------
    ArgumentError
        For axes of length zero or not perpendicular; for a swing limit, or limits about x or y, that do not fit the open axes;
        for motors or differing drives together with swing and twist.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(radius=0.05, length=0.9, position=(0, 0, -0.5), mass=1.0)
    >>> free, held = kd.Axis(), kd.Axis(locked=True)
    >>> axes = {"linear": (held, held, free), "angular": (held, held, free)}
    >>> joint = world.add_six_dof_joint(None, rod, anchor=(0, 0, 0), **axes)
    >>> world.advance(1 / 60, 60)
    >>> bool(joint.positions[2] < -4)
    True
    """

    anchor: ArrayLike
    axis_x: ArrayLike = (1.0, 0.0, 0.0)
    axis_y: ArrayLike = (0.0, 1.0, 0.0)
    linear: Axes = (LOCKED, LOCKED, LOCKED)
    angular: Axes = (FREE, FREE, FREE)
    swing_limit: float | None = None

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        anchor = vector("anchor", self.anchor, 3)
        frame = frame_of("axis_x", self.axis_x, "axis_y", self.axis_y)
        for name, axes in (("linear", self.linear), ("angular", self.angular)):
            three = isinstance(axes, tuple | list) and len(axes) == 3
            if not (three and all(isinstance(axis, Axis) for axis in axes)):
                raise ArgumentError(f"{name}={axes!r} must be three kd.Axis, for x, y and z.")
        angular, cone = self._angular()
        return Placement(anchor, anchor, frame, self.linear, angular, cone=cone)

    def _angular(self) -> tuple[Axes, bool]:
        """Return the laws about the axes, and whether angles are swing and twist."""
        x, y, z = self.angular
        if x.locked or y.locked or z.locked:
            if self.swing_limit is not None:
                raise ArgumentError(
                    f"swing_limit={self.swing_limit!r} is for joints with three open angular axes; limit the axes instead."
                )
            return self.angular, False
        if x.limits is not None or y.limits is not None:
            raise ArgumentError(
                "angular has limits about x or y with all three axes open, where they do not define angles; give"
                " swing_limit, or lock an axis."
            )
        if self.swing_limit is None and z.limits is None:
            return self.angular, False
        if self.swing_limit is not None and not (is_number(self.swing_limit) and 0.0 < self.swing_limit < math.pi):
            raise ArgumentError(f"swing_limit={self.swing_limit!r} must be above 0 and below pi, in rad.")
        if x.motor or y.motor or z.motor or not x.drive == y.drive == z.drive:
            raise ArgumentError(
                "angular has motors or different drives together with limits of swing or twist, whose axes move with the"
                " bodies; give the same drive to all three axes, or leave the limits out."
            )
        swing = Axis(limits=(-math.inf, self.swing_limit or math.inf), drive=x.drive, friction=x.friction)
        return (swing, y, z), True

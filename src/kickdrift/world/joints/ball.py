"""The ball joint: rotation about a point, whose swing and twist may be limited."""

from __future__ import annotations

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import direction, vector
from kickdrift.world.joints.limits_motors_options import LOCKED, Axis, Drive, check_kind, is_number, pair
from kickdrift.world.joints.record import Placement, Record, frame_along


@dataclass(frozen=True)
class Ball(Record):
    """A ball joint: two bodies share a point, about which they rotate freely.

    Parameters
    ----------
    anchor : (3,) array_like
        The point, in the world, m.
    axis : (3,) array_like
        Direction from which swing and about which twist are measured, in the world: along the limb.
    swing_limit : float, optional
        Largest angle between the axes of a and b, rad, below pi.
    twist_limits : (2,) tuple of float, optional
        Smallest and largest angle of b about the axis, rad, between -pi and pi.
    drive : Drive, optional
        Pulls b back to its initial orientation, by the rotation vector.
    friction : float
        Largest torque of dry friction, about whatever axis, N m.

    Raises
    ------
    ArgumentError
        For limits in the wrong order or beyond pi, and for a drive with a target or a maximum.

    Notes
    -----
    Swing and twist: Baerlocher, Boulic, Parametrization and range of motion of the ball-and-socket joint (2001).

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(radius=0.05, length=0.9, position=(0, 0, -0.5), mass=1.0)
    >>> joint = world.add_ball_joint(None, rod, anchor=(0, 0, 0))
    >>> world.advance(1 / 60, 60)
    >>> bool(abs(rod.position[2] + 0.5) < 1e-6)
    True
    """

    anchor: ArrayLike
    axis: ArrayLike = (0.0, 0.0, 1.0)
    swing_limit: float | None = None
    twist_limits: tuple[float, float] | None = None
    drive: Drive | None = None
    friction: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_kind("drive", self.drive, Drive)
        if self.swing_limit is not None and not (is_number(self.swing_limit) and 0.0 < self.swing_limit < math.pi):
            raise ArgumentError(f"swing_limit={self.swing_limit!r} must be above 0 and below pi, in rad.")
        if self.twist_limits is not None:
            lower, upper = pair("twist_limits", self.twist_limits)
            if not -math.pi < lower <= upper < math.pi:
                raise ArgumentError(
                    f"twist_limits={self.twist_limits!r} must be the smallest and the largest angle, in this order,"
                    " above -pi and below pi."
                )
        if self.drive is not None and (
            self.drive.target != 0.0 or self.drive.speed != 0.0 or self.drive.maximum != math.inf
        ):
            raise ArgumentError(
                f"drive={self.drive!r} has a target, a speed or a maximum, but the drive of a ball joint only pulls"
                " back to the initial orientation, about no particular axis; use add_six_dof_joint for other drives."
            )

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        anchor = vector("anchor", self.anchor, 3)
        swing = None if self.swing_limit is None else (-math.inf, self.swing_limit)
        limits = (swing, None, self.twist_limits)
        x, y, z = (Axis(limits=limit, drive=self.drive, friction=self.friction) for limit in limits)
        return Placement(
            anchor, anchor, frame_along(direction("axis", self.axis)), (LOCKED, LOCKED, LOCKED), (x, y, z),
            cone=swing is not None or self.twist_limits is not None,
        )  # fmt: skip

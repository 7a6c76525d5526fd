"""The slider: translation along one axis."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.world.argument_checks import direction, vector
from kickdrift.world.joints.limits_motors_options import LOCKED, Axis, Drive, Motor
from kickdrift.world.joints.record import Placement, Record, frame_along


@dataclass(frozen=True)
class Slider(Record):
    """A slider: body b slides along an axis of body a without relative rotation.

    Parameters
    ----------
    anchor : (3,) array_like
        A point of the axis, in the world, m.
    axis : (3,) array_like
        Direction of the axis, in the world. Positions, positive along it, are those of b relative to a; if only one of the two
        is dynamic, those of the dynamic one relative to the other.
    limits : (2,) tuple of float, optional
        Smallest and largest position, m; the position is zero initially.
    motor : Motor, optional
    drive : Drive, optional
    friction : float
        Largest force of dry friction, N.

    Raises
    ------
    ArgumentError
        For an axis of length zero, limits in the wrong order, negative friction.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(radius=0.05, length=0.9, position=(0, 0, -0.5), mass=1.0)
    >>> slider = world.add_slider(
    ...     None, rod, anchor=(0, 0, 0), axis=(0, 0, 1), limits=(-0.2, 0.2)
    ... )
    >>> world.advance(1 / 60, 120)
    >>> round(slider.position, 3)
    -0.2
    """

    anchor: ArrayLike
    axis: ArrayLike
    limits: tuple[float, float] | None = None
    motor: Motor | None = None
    drive: Drive | None = None
    friction: float = 0.0

    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes."""
        anchor = vector("anchor", self.anchor, 3)
        slide = Axis(False, self.limits, self.motor, self.drive, self.friction)
        frame = frame_along(direction("axis", self.axis))
        return Placement(anchor, anchor, frame, (LOCKED, LOCKED, slide), (LOCKED, LOCKED, LOCKED), principal=2)

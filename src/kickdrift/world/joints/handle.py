"""The handle of a joint, which reads and sets its properties while a world runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError
from kickdrift.world.joints.forward_kinematics import place, set_speed
from kickdrift.world.joints.handle_limits_motors import HasLaws
from kickdrift.world.joints.layout import AXES, JOINT_POSITION, TOTAL
from kickdrift.world.joints.limits_motors_options import finite
from kickdrift.world.joints.views import JointViews, look_up
from kickdrift.world.layout import AWAKE, LOAD_TORQUE, TIME_AT_REST

if TYPE_CHECKING:
    from kickdrift.world.joints.registry import Joints

Floats = NDArray[np.float64]


class Joint(HasLaws):
    """A joint of a world.

    Attributes
    ----------
    index : int
        Its row in the tables of joints.
    generation : int
        How many joints were added before it; tells its handle from those of earlier occupants of its row.

    Notes
    -----
    Angles, positions, speeds, efforts, forces and torques are those of the *measured* body relative to the other one, the
    reference. The measured body is body b or, if only one of the two is dynamic, the dynamic one, whichever was named first. A
    hinge's angle is positive counter-clockwise about its axis, a slider's position along it.

    Axes 0-2 are linear and 3-5 angular; the default of ``axis`` is the axis of a hinge or a slider, and the line of a
    distance joint, a rope or a spring. Positions and angles are those at the end of the last step, or those set since. Once the
    joint has been removed or has broken, access to its state raises `ArgumentError`.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> rod = world.add_capsule(0.05, 0.9, position=(0, 0, -0.5), mass=1.0)
    >>> hinge = world.add_hinge(None, rod, anchor=(0, 0, 0), axis=(0, 1, 0))
    >>> hinge.place(0.5)
    >>> round(hinge.angle, 6), hinge.speed
    (0.5, 0.0)
    >>> world.advance(1 / 60, 60)
    >>> bool(-0.5 < hinge.angle < 0.5)
    True
    """

    __slots__ = ("_joints", "_views")
    registered_in = "joints"

    def __init__(self, index: int, generation: int, joints: Joints) -> None:
        self._index, self._generation, self._joints = index, generation, joints
        self._last_name = joints.names.of(index)
        self._views: JointViews | None = None

    @property
    def joints(self) -> Joints:
        """The joints of its world."""
        return self._joints

    @property
    def _registry(self) -> Joints:
        return self._joints

    @property
    def angles(self) -> Floats:
        """Angles about the three axes, rad; those of hinges and universal joints count turns.

        They are zero, because they are not measured, if all three axes are open and have neither limits, drive nor friction.
        """
        views = self._current_views()
        return 0.0 + views.numbers[JOINT_POSITION + 3 : JOINT_POSITION + 6] * views.signs[3:]

    @property
    def positions(self) -> Floats:
        """Positions along the three axes, m."""
        views = self._current_views()
        return 0.0 + views.numbers[JOINT_POSITION : JOINT_POSITION + 3] * views.signs[:3]

    @property
    def angle(self) -> float:
        """Angle about the axis of a hinge, rad, with full turns counted; setting it moves what is attached, see `place`."""
        views, k = self._current_views(), self._axis("angle")
        angle: float = 0.0 + views.signs[k] * views.numbers.item(JOINT_POSITION + k)  # never -0.0
        return angle

    @angle.setter
    def angle(self, angle: float) -> None:
        place(self, self._axis("angle"), "angle", angle)

    @property
    def position(self) -> float:
        """Position along the axis of a slider; for a distance joint, rope or spring the excess length; m.

        Setting it moves what is attached, see `place`.
        """
        views, k = self._current_views(), self._axis("position")
        position: float = 0.0 + views.signs[k] * views.numbers.item(JOINT_POSITION + k)
        return position

    @position.setter
    def position(self, position: float) -> None:
        place(self, self._axis("position"), "position", position)

    @property
    def speed(self) -> float:
        """Rate of `angle` or `position`, rad/s or m/s; setting it moves what is attached, as in `place`."""
        views = self._current_views()
        k = views.principal if views.principal >= 0 else self.axis()
        x, y, z = views.axes[k].tolist()
        rate = 0.0
        for arm, motion, *_ in views.ends:
            rate = -rate
            if motion is None:
                continue
            u, v, w, p, q, r = motion.tolist()
            if k >= 3:
                rate += x * p + y * q + z * r
            else:
                a, b, c = arm.tolist()
                rate += x * (u + q * c - r * b) + y * (v + r * a - p * c) + z * (w + p * b - q * a)
        return 0.0 + views.signs[k] * rate  # never -0.0

    @speed.setter
    def speed(self, speed: float) -> None:
        set_speed(self, self.axis(), speed)

    @property
    def force(self) -> Floats:
        """Mean force of the joint on the measured body during the last step, (3,) in the world's axes, N."""
        views = self._current_views()
        numbers = views.numbers
        return np.asarray(views.side * (numbers[TOTAL : TOTAL + 3] @ numbers[AXES : AXES + 9].reshape(3, 3)))

    @property
    def torque(self) -> Floats:
        """Mean torque of the joint on the measured body during the last step, about the anchor, (3,) as `force`, N m."""
        views = self._current_views()
        numbers = views.numbers
        return np.asarray(views.side * (numbers[TOTAL + 3 : TOTAL + 6] @ numbers[AXES + 9 : AXES + 18].reshape(3, 3)))

    @property
    def effort(self) -> float:
        """Torque or force along the open axis in the last step, from motor, drive, friction and limits; N m or N."""
        views, k = self._current_views(), self.axis()
        effort: float = 0.0 + views.signs[k] * views.numbers.item(TOTAL + k)
        return effort

    def apply_effort(self, effort: float, axis: int | None = None) -> None:
        """Apply a torque about an open axis, or a force along it, in the next step, and its reaction to the other body.

        A positive effort increases the angle or position. Its direction is that of the axis at the end of the last step.
        It is not included in `effort`, which the joint itself exerts.

        Parameters
        ----------
        effort : float
            N m about an axis, N along one; efforts add up.
        axis : int, optional
            The one open axis by default.

        Raises
        ------
        ArgumentError
            For an effort that is not finite, and for an axis that is locked.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World(gravity=(0, 0, 0))
        >>> block = world.add_box((1, 1, 1), mass=2.0)
        >>> slider = world.add_slider(None, block, anchor=(0, 0, 0), axis=(1, 0, 0))
        >>> slider.apply_effort(12.0)
        >>> world.step(1 / 60)
        >>> round(slider.speed, 6)
        0.1
        """
        finite("effort", effort)
        views = self._current_views()
        k = views.principal if axis is None and views.principal >= 0 else self.axis(axis)
        if views.locked >> k & 1:
            raise ArgumentError(f"axis={k} is locked, so an effort along it moves nothing; give an open one.")
        x, y, z = views.axes[k].tolist()
        size = views.signs[k] * effort  # on a the opposite, and the opposite of that on b
        for arm, _, load, *_ in views.ends:
            size = -size
            if load is None:
                continue
            f, g, h = size * x, size * y, size * z
            u, v, w, p, q, r = load.tolist()
            if k >= 3:
                load[LOAD_TORQUE : LOAD_TORQUE + 3] = (p + f, q + g, r + h)
            else:
                a, b, c = arm.tolist()
                load[:] = (u + f, v + g, w + h, p + b * h - c * g, q + c * f - a * h, r + a * g - b * f)

    def place(self, value: float, axis: int | None = None) -> None:
        """Move a joint to an angle or position, with everything attached to it; the rates of all joints stay the same.

        The measured body is rotated or shifted relative to the other one, and everything joined to it moves with it as one
        rigid body. If a chain of joints connects it to a static or kinematic body, the other side moves instead.

        Parameters
        ----------
        value : float
            rad about an axis, m along one.
        axis : int, optional
            The one open axis by default.

        Raises
        ------
        ArgumentError
            For a value that is not finite or beyond the limits, an axis that is locked, geared, or has no angle of its own,
            and where the joint is part of a loop, or both sides are held, so that neither side can move alone.
        """
        place(self, self.axis(axis), "value", value)

    def axis(self, axis: int | None = None) -> int:
        """Return the index of an axis, by default that of the one open axis.

        Parameters
        ----------
        axis : int, optional
            0-2 linear, 3-5 angular.

        Returns
        -------
        int

        Raises
        ------
        ArgumentError
            If none is named and the joint has several open axes, or none; and for an invalid index.
        """
        principal = self._current_views().principal
        if axis is None:
            if principal < 0:
                raise ArgumentError(
                    f"axis=None is ambiguous for joint={self!r}, which does not have exactly one open axis; give 0-2"
                    " for a linear or 3-5 for an angular one, or use angles or positions."
                )
            return principal
        if not is_whole(axis, 0, 5):
            raise ArgumentError(f"axis={axis!r} must be 0-2 for a linear or 3-5 for an angular axis.")
        return axis

    def sign(self, k: int) -> float:
        """Return -1.0 if the tables, which hold b relative to a, have the opposite sign along axis k, else 1.0."""
        return self._current_views().signs[k]

    def wake(self) -> None:
        """Wake its bodies, as `wake_bodies` does, but by the views kept here, for control loops that call it in every step."""
        for end in self._current_views().ends:
            if end.load is not None:
                end.body[AWAKE], end.rested[TIME_AT_REST] = 1, 0.0

    def _axis(self, what: str) -> int:
        """Return the one open axis; ArgumentError unless it has an angle or a position, as asked."""
        k = self.axis()
        if (k < 3) == (what == "angle"):
            does, has = ("slides", "position") if k < 3 else ("turns", "angle")
            raise ArgumentError(f"joint={self!r} {does} and has no {what} of its own; use its {has}.")
        return k

    def _current_views(self) -> JointViews:
        """Return views of the rows; they are made again only after rows have been removed or tables have moved in memory."""
        views, tables = self._views, self._joints.tables
        if views is None or views.version != tables.version:
            views = self._views = look_up(tables, self._joints.row(self))
        return views

"""The handle of a joint: what it reads and sets while a world runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.flight import DYNAMIC, KIND
from kickdrift.world.handle import Handle
from kickdrift.world.joints.axis import Axis, Drive, Motor, finite
from kickdrift.world.joints.layout import ARM_A, ARM_B, AXES, BODY_A, BODY_B, LOCKED, POSITION, PRINCIPAL, TOTAL
from kickdrift.world.joints.placing import place, set_speed, signs
from kickdrift.world.tables import BODY, JOINT, JOINT_NUMBERS, LOAD, MOTION

if TYPE_CHECKING:
    from kickdrift.world.joints.registry import Joints

Floats = NDArray[np.float64]

# Columns as plain integers: adding to those of NumPy takes as long as reading a number.
_POSITION, _TOTAL = int(POSITION), int(TOTAL)
_ARMS, _END = int(ARM_A), int(AXES) + 18
_ARM_B, _AXES = int(ARM_B) - _ARMS, int(AXES) - _ARMS


class _Seen(NamedTuple):
    """Where a joint and its bodies lie in the tables, for as long as these have a version."""

    version: int
    principal: int
    locked: int
    side: float  # -1.0 where a is measured against b
    signs: list[float]
    numbers: Floats
    motion_a: Floats
    motion_b: Floats
    load_a: Floats | None  # where forces move it
    load_b: Floats | None


class Joint(Handle):
    """A joint of a world.

    Attributes
    ----------
    index : int
        Its row in the tables of joints.
    generation : int
        Joints that the world had seen before it; a handle of one that is gone is known by it.

    Notes
    -----
    Angles, positions, speeds, efforts, forces and torques are those of body b against body a. Where forces move only one
    of the two, they are those of that one against the other, whichever was named first: the ground, a static or a kinematic
    body is what one measures from. A hinge's angle is positive counter-clockwise about its axis, a slider's position along it.

    Axes 0-2 are linear and 3-5 angular; where ``axis`` is left out, the one that a hinge turns about, a slider slides along
    and the line of a distance joint, a rope or a spring are meant. Positions and angles are those at the end of the last step,
    or those that the joint was given since. Everything raises `ArgumentError` once the joint is gone.
    """

    __slots__ = ("_joints", "_seen")

    def __init__(self, index: int, generation: int, joints: Joints) -> None:
        self._index, self._generation, self._joints = index, generation, joints
        self._last_name = joints.names.of(index)
        self._seen: _Seen | None = None

    @property
    def joints(self) -> Joints:
        """The joints of its world."""
        return self._joints

    @property
    def _registry(self) -> Joints:
        return self._joints

    @property
    def angles(self) -> Floats:
        """Angles about the three axes, rad; those of hinges and universal joints count turns."""
        seen = self._look()
        return 0.0 + seen.numbers[_POSITION + 3 : _POSITION + 6] * seen.signs[3:]

    @property
    def positions(self) -> Floats:
        """Positions along the three axes, m."""
        seen = self._look()
        return 0.0 + seen.numbers[_POSITION : _POSITION + 3] * seen.signs[:3]

    @property
    def angle(self) -> float:
        """Angle about the axis of a hinge, rad, with full turns counted; a new one places what hangs on it, see `place`."""
        seen, k = self._look(), self._axis("angle")
        angle: float = 0.0 + seen.signs[k] * seen.numbers.item(_POSITION + k)  # never -0.0
        return angle

    @angle.setter
    def angle(self, angle: float) -> None:
        place(self, self._axis("angle"), "angle", angle)

    @property
    def position(self) -> float:
        """Position along the axis of a slider; of a distance joint, rope or spring the length it has too much; m.

        A new one places what hangs on it, see `place`.
        """
        seen, k = self._look(), self._axis("position")
        position: float = 0.0 + seen.signs[k] * seen.numbers.item(_POSITION + k)
        return position

    @position.setter
    def position(self, position: float) -> None:
        place(self, self._axis("position"), "position", position)

    @property
    def speed(self) -> float:
        """Rate of `angle` or `position`, rad/s or m/s; a new one is given to what hangs on it, see `place`."""
        seen, k = self._look(), self.axis()
        numbers = seen.numbers[_ARMS:_END].tolist()
        x, y, z = numbers[_AXES + 3 * k : _AXES + 3 * k + 3]
        ua, va, wa, pa, qa, ra, *_ = seen.motion_a.tolist()
        ub, vb, wb, pb, qb, rb, *_ = seen.motion_b.tolist()
        if k >= 3:
            turning: float = x * (pb - pa) + y * (qb - qa) + z * (rb - ra)
            return seen.signs[k] * turning
        ax, ay, az = numbers[:3]
        bx, by, bz = numbers[_ARM_B : _ARM_B + 3]
        u = ub + qb * bz - rb * by - (ua + qa * az - ra * ay)
        v = vb + rb * bx - pb * bz - (va + ra * ax - pa * az)
        w = wb + pb * by - qb * bx - (wa + pa * ay - qa * ax)
        sliding: float = x * u + y * v + z * w
        return seen.signs[k] * sliding

    @speed.setter
    def speed(self, speed: float) -> None:
        set_speed(self, self.axis(), speed)

    @property
    def force(self) -> Floats:
        """Mean force at the joint during the last step on the body whose motion is measured, (3,) in the world's axes, N."""
        seen = self._look()
        numbers = seen.numbers
        return np.asarray(seen.side * (numbers[_TOTAL : _TOTAL + 3] @ numbers[AXES : AXES + 9].reshape(3, 3)))

    @property
    def torque(self) -> Floats:
        """Mean torque on that body during the last step, about the point where the joint acts, (3,) as `force`, N m."""
        seen = self._look()
        numbers = seen.numbers
        return np.asarray(seen.side * (numbers[_TOTAL + 3 : _TOTAL + 6] @ numbers[AXES + 9 : AXES + 18].reshape(3, 3)))

    @property
    def effort(self) -> float:
        """Torque or force along the open axis in the last step: of motor, drive, friction and limits; N m or N."""
        seen, k = self._look(), self.axis()
        effort: float = 0.0 + seen.signs[k] * seen.numbers.item(_TOTAL + k)
        return effort

    def apply_effort(self, effort: float, axis: int | None = None) -> None:
        """Let a torque about an open axis, or a force along it, act during the next step, and its opposite on the other body.

        A positive one makes the angle or position grow. Its direction is that of the axis at the end of the last step.
        `effort`, what the joint itself does, is without it.

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
        """
        finite("effort", effort)
        seen, k = self._look(), self.axis(axis)
        if seen.locked >> k & 1:
            raise ArgumentError(f"axis={k} is locked, so an effort along it moves nothing; give an open one.")
        numbers = seen.numbers[_ARMS:_END].tolist()
        size = seen.signs[k] * effort
        x, y, z = (size * part for part in numbers[_AXES + 3 * k : _AXES + 3 * k + 3])
        for load, arm in ((seen.load_b, _ARM_B), (seen.load_a, 0)):
            if load is not None:
                u, v, w, p, q, r, *_ = load.tolist()
                if k < 3:
                    ax, ay, az = numbers[arm : arm + 3]
                    load[:6] = (u + x, v + y, w + z, p + ay * z - az * y, q + az * x - ax * z, r + ax * y - ay * x)
                else:
                    load[3:6] = (p + x, q + y, r + z)
            x, y, z = -x, -y, -z

    def set_motor(self, motor: Motor | None, axis: int | None = None) -> None:
        """Exchange the motor of an axis; None takes it away."""
        self._joints.change_law(self, axis, Axis(motor=motor), "motor")

    def set_drive(self, drive: Drive | None, axis: int | None = None) -> None:
        """Exchange the drive of an axis; None takes it away."""
        self._joints.change_law(self, axis, Axis(drive=drive), "drive")

    def set_limits(self, limits: tuple[float, float] | None, axis: int | None = None) -> None:
        """Exchange the limits of an axis, m or rad; None takes them away."""
        self._joints.change_law(self, axis, Axis(limits=limits), "limits")

    def set_friction(self, friction: float, axis: int | None = None) -> None:
        """Exchange the dry friction of an axis, N or N m."""
        self._joints.change_law(self, axis, Axis(friction=friction), "friction")

    def place(self, value: float, axis: int | None = None) -> None:
        """Place a joint at an angle or position, with everything that hangs on it; the rates of all joints stay.

        The body whose motion is measured is turned or shifted against the other one, and all that joints hold to it goes
        with it as if it were one body. Where a way of joints leads from it to what forces do not move, the other side moves.

        Parameters
        ----------
        value : float
            rad about an axis, m along one.
        axis : int, optional
            The one open axis by default.

        Raises
        ------
        ArgumentError
            For a value that is not finite or beyond the limits, an axis that is locked or has no angle of its own, and where
            the joint is part of a loop, or both sides are held: then there is no side that could move alone.
        """
        place(self, self.axis(axis), "value", value)

    def axis(self, axis: int | None = None) -> int:
        """Return the axis that is meant.

        Raises
        ------
        ArgumentError
            If none is named and the joint has several, or none; and for one that no joint has.
        """
        principal = self._look().principal
        if axis is None:
            if principal < 0:
                raise ArgumentError(
                    f"axis=None is ambiguous for joint={self!r}, which has no one open axis; give 0-2 for a linear or 3-5 for"
                    " an angular one, or ask for angles or positions."
                )
            return principal
        if isinstance(axis, bool | float) or axis not in range(6):
            raise ArgumentError(f"axis={axis!r} has to be 0-2 for a linear or 3-5 for an angular axis.")
        return axis

    def _axis(self, what: str) -> int:
        """Return the open axis, if it has an angle, or a position."""
        k = self.axis()
        if (k < 3) == (what == "angle"):
            does, has = ("slides", "position") if k < 3 else ("turns", "angle")
            raise ArgumentError(f"joint={self!r} {does} and has no {what} of its own; ask for its {has}.")
        return k

    def _look(self) -> _Seen:
        """Return where the joint lies; it is looked up again only after something has gone or was moved."""
        seen, tables = self._seen, self._joints.tables
        if seen is None or seen.version != tables.version:
            row = self._joints.row(self)
            joint, axes = tables.row(JOINT, row), signs(tables, row).tolist()
            ends = [joint.item(column) for column in (BODY_A, BODY_B)]
            moved = [tables.row(BODY, body).item(KIND) == DYNAMIC for body in ends]
            loads = [tables.row(LOAD, body) if moves else None for body, moves in zip(ends, moved, strict=True)]
            seen = self._seen = _Seen(
                tables.version, joint.item(PRINCIPAL), joint.item(LOCKED), 1.0 if moved[1] else -1.0, axes,
                tables.row(JOINT_NUMBERS, row), *(tables.row(MOTION, body) for body in ends), *loads,
            )  # fmt: skip
        return seen

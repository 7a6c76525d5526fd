"""The handle of a joint: what it reads and sets while a world runs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.flight import DYNAMIC, KIND
from kickdrift.world.joints.axis import Axis, Drive, Motor, finite
from kickdrift.world.joints.layout import ARM_A, ARM_B, AXES, BODY_A, BODY_B, LOCKED, POSITION, PRINCIPAL, TOTAL
from kickdrift.world.tables import BODY, JOINT, JOINT_NUMBERS, LOAD, MOTION

if TYPE_CHECKING:
    from kickdrift.world.joints.registry import Joints

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Joint:
    """A joint of a world.

    Attributes
    ----------
    index : int
        Its row in the tables of joints.
    generation : int
        Joints that the world had seen before it; a handle of one that is gone is known by it.

    Notes
    -----
    Axes 0-2 are linear and 3-5 angular; where ``axis`` is left out, the one that a hinge turns about, a slider slides along
    and the line of a distance joint, a rope or a spring are meant. Positions and angles are those at the end of the last step.
    Everything raises `ArgumentError` once the joint is gone.
    """

    index: int
    generation: int
    joints: Joints = field(repr=False, compare=False)

    @property
    def angles(self) -> Floats:
        """Angles of b against a about the three axes, rad; those of hinges and universal joints count turns."""
        return self._numbers()[POSITION + 3 : POSITION + 6].copy()

    @property
    def positions(self) -> Floats:
        """Positions of b against a along the three axes, m."""
        return self._numbers()[POSITION : POSITION + 3].copy()

    @property
    def angle(self) -> float:
        """Angle about the axis of a hinge, rad, with full turns counted."""
        k = self.axis()
        if k < 3:
            raise ArgumentError(f"joint={self!r} slides and has no angle of its own; ask for its position.")
        return float(self._numbers()[POSITION + k])

    @property
    def position(self) -> float:
        """Position along the axis of a slider; of a distance joint, rope or spring the length it has too much; m."""
        k = self.axis()
        if k >= 3:
            raise ArgumentError(f"joint={self!r} turns and has no position of its own; ask for its angle.")
        return float(self._numbers()[POSITION + k])

    @property
    def speed(self) -> float:
        """Rate of `angle` or `position`, rad/s or m/s."""
        k, numbers = self.axis(), self._numbers()
        body_a, body_b = self.joints.tables.array(JOINT)[self.index, [BODY_A, BODY_B]]
        motion = self.joints.tables.array(MOTION)
        velocity = motion[body_b, 3:6] - motion[body_a, 3:6]
        if k < 3:
            velocity = motion[body_b, :3] + np.cross(motion[body_b, 3:6], numbers[ARM_B : ARM_B + 3])
            velocity -= motion[body_a, :3] + np.cross(motion[body_a, 3:6], numbers[ARM_A : ARM_A + 3])
        return float(numbers[AXES + 3 * k : AXES + 3 * k + 3] @ velocity)

    @property
    def force(self) -> Floats:
        """Mean force on b at the joint during the last step, (3,) in the world's axes, N; that on a is its opposite."""
        numbers = self._numbers()
        return np.asarray(numbers[TOTAL : TOTAL + 3] @ numbers[AXES : AXES + 9].reshape(3, 3))

    @property
    def torque(self) -> Floats:
        """Mean torque on b during the last step, about the point where the joint acts, (3,) in the world's axes, N m."""
        numbers = self._numbers()
        return np.asarray(numbers[TOTAL + 3 : TOTAL + 6] @ numbers[AXES + 9 : AXES + 18].reshape(3, 3))

    @property
    def effort(self) -> float:
        """Torque or force along the open axis in the last step: of motor, drive, friction and limits; N m or N."""
        k = self.axis()
        return float(self._numbers()[TOTAL + k])

    def apply_effort(self, effort: float, axis: int | None = None) -> None:
        """Let a torque about an open axis, or a force along it, act on b during the next step, and its opposite on a.

        Its direction is that of the axis at the end of the last step. `effort`, what the joint itself does, is without it.

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
        k, numbers = self.axis(axis), self._numbers()
        row = self.joints.tables.array(JOINT)[self.index]
        if row[LOCKED] >> k & 1:
            raise ArgumentError(f"axis={k} is locked, so an effort along it moves nothing; give an open one.")
        along = effort * numbers[AXES + 3 * k : AXES + 3 * k + 3]
        load, kinds = self.joints.tables.array(LOAD), self.joints.tables.array(BODY)
        for body, arm, sign in ((row[BODY_A], ARM_A, -1.0), (row[BODY_B], ARM_B, 1.0)):
            if kinds[body, KIND] != DYNAMIC:
                continue
            if k < 3:
                load[body, :3] += sign * along
            load[body, 3:6] += sign * (np.cross(numbers[arm : arm + 3], along) if k < 3 else along)

    def set_motor(self, motor: Motor | None, axis: int | None = None) -> None:
        """Exchange the motor of an axis; None takes it away."""
        self.joints.change_law(self, axis, Axis(motor=motor), "motor")

    def set_drive(self, drive: Drive | None, axis: int | None = None) -> None:
        """Exchange the drive of an axis; None takes it away."""
        self.joints.change_law(self, axis, Axis(drive=drive), "drive")

    def set_limits(self, limits: tuple[float, float] | None, axis: int | None = None) -> None:
        """Exchange the limits of an axis, m or rad; None takes them away."""
        self.joints.change_law(self, axis, Axis(limits=limits), "limits")

    def set_friction(self, friction: float, axis: int | None = None) -> None:
        """Exchange the dry friction of an axis, N or N m."""
        self.joints.change_law(self, axis, Axis(friction=friction), "friction")

    def axis(self, axis: int | None = None) -> int:
        """Return the axis that is meant.

        Raises
        ------
        ArgumentError
            If none is named and the joint has several, or none; and for one that no joint has.
        """
        row = self.joints.row(self)
        if axis is None:
            axis = int(self.joints.tables.array(JOINT)[row, PRINCIPAL])
            if axis < 0:
                raise ArgumentError(
                    f"axis=None is ambiguous for joint={self!r}, which has no one open axis; give 0-2 for a linear or 3-5 for"
                    " an angular one, or ask for angles or positions."
                )
        elif isinstance(axis, bool | float) or axis not in range(6):
            raise ArgumentError(f"axis={axis!r} has to be 0-2 for a linear or 3-5 for an angular axis.")
        return axis

    def _numbers(self) -> Floats:
        row: Floats = self.joints.tables.array(JOINT_NUMBERS)[self.joints.row(self)]
        return row

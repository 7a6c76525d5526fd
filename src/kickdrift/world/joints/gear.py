"""The gear, which couples axes of two joints: meshing wheels, belts, racks and screws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.forward_kinematics import measure_again
from kickdrift.world.joints.handle import Joint
from kickdrift.world.joints.limits_motors_options import LOCKED, finite
from kickdrift.world.joints.record import Geared, Placement, Record
from kickdrift.world.layout import BODY_KIND, DYNAMIC
from kickdrift.world.tables import BODY, JOINT, JOINT_NUMBERS


@dataclass(frozen=True)
class Gear(Record):
    """A gear: one joint moves in proportion to another, as with meshing wheels, belts, racks and screws.

    From its current value, the angle or position of joint a changes by ``ratio`` times as much as that of joint b. The
    reaction acts about or along the axes of both joints, on both bodies of each: a movable housing takes its share.

    Parameters
    ----------
    joint_a, joint_b : Joint
        Hinges and sliders, of any bodies; or others, with the axes named.
    ratio : float
        Change of joint a per change of joint b. Meshing wheels turn in opposite directions: the ratio is minus the radius of
        wheel b over that of wheel a, if both axes have the same direction. With a slider as joint a and a hinge as joint b
        it is in m/rad: the radius of a pinion on a rack, or the pitch of a screw over 2 pi.
    axis_a, axis_b : int, optional
        The coupled axes: 0-2 linear, 3-5 angular; by default the axis of a hinge or a slider. Joint b may be joint a, with
        another axis: a cylindrical joint (of `World.add_six_dof_joint`) becomes a screw.

    Raises
    ------
    ArgumentError
        For removed joints or joints of different worlds, axes that are locked or have no angle or position that can be
        coupled, an axis with itself, and a ratio that is zero or not finite.

    Notes
    -----
    The handle's `Joint.effort` is the torque or force on joint a; that on joint b is ``-ratio`` times as great. The gear breaks
    at ``breaking_torque`` if joint a is a hinge, at ``breaking_force`` if it is a slider. It is removed with its joints; while
    it exists, the angles and positions of the coupled axes cannot be set.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> small = world.add_cylinder(0.1, 0.05, mass=1.0)
    >>> large = world.add_cylinder(0.3, 0.05, position=(0.4, 0, 0), mass=9.0)
    >>> one = world.add_hinge(None, small, anchor=(0, 0, 0), axis=(0, 0, 1))
    >>> other = world.add_hinge(None, large, anchor=(0.4, 0, 0), axis=(0, 0, 1))
    >>> gear = world.add_gear(one, other, ratio=-3.0)
    >>> one.apply_effort(0.1)
    >>> world.step(1 / 60)
    >>> round(one.speed / other.speed, 6)
    -3.0
    """

    joint_a: Joint
    joint_b: Joint
    ratio: float
    axis_a: int | None = None
    axis_b: int | None = None

    def bodies(self) -> tuple[int, int]:
        """Return the rows of two different bodies, one of each joint: the second is dynamic, and the first if possible."""
        tables = self.joint_a.joints.tables
        first, second = (tables.row(JOINT, joint.index) for joint in (self.joint_a, self.joint_b))
        moves = tables.array(BODY)[:, BODY_KIND] == DYNAMIC
        pairs = [(first.item(a), second.item(b)) for a in (j.BODY_B, j.BODY_A) for b in (j.BODY_B, j.BODY_A)]
        return max((pair for pair in pairs if pair[0] != pair[1]), key=lambda pair: (moves[pair[1]], moves[pair[0]]))

    def placement(self) -> Placement:
        """Return the axes that are coupled, and what their positions add up to."""
        finite("ratio", self.ratio)
        if self.ratio == 0.0:
            raise ArgumentError(
                f"ratio={self.ratio!r} couples nothing; give the change of joint a per change of joint b."
            )
        ends = (("a", self.joint_a, self.axis_a), ("b", self.joint_b, self.axis_b))
        axes = tuple(_axis(name, joint, axis) for name, joint, axis in ends)
        joints = (self.joint_a.index, self.joint_b.index)
        if joints[0] == joints[1] and axes[0] == axes[1]:
            raise ArgumentError(f"joint_b={self.joint_b!r} is joint_a with the same axis; give another joint or axis.")
        registry = self.joint_a.joints
        measure_again(registry.tables.address, np.array(joints))
        rates = (self.joint_a.sign(axes[0]), -self.ratio * self.joint_b.sign(axes[1]))
        numbers = registry.tables.array(JOINT_NUMBERS)
        total = sum(
            rate * numbers.item(row, j.JOINT_POSITION + k) for rate, row, k in zip(rates, joints, axes, strict=True)
        )
        nowhere, held = np.zeros(3), (LOCKED, LOCKED, LOCKED)
        geared = Geared(joints, (axes[0], axes[1]), rates)
        return Placement(nowhere, nowhere, np.eye(3), held, held, length=total, principal=axes[0], geared=geared)


def _axis(name: str, joint: Joint, axis: int | None) -> int:
    """Return the axis of a joint that is coupled.

    Raises
    ------
    ArgumentError
        If it is ambiguous, locked, or has no position that can be coupled.
    """
    row = joint.joints.tables.row(JOINT, joint.joints.row(joint))
    if axis is None and row.item(j.PRINCIPAL) < 0:
        raise ArgumentError(
            f"axis_{name}=None is ambiguous for joint_{name}={joint!r}, which does not have exactly one open axis;"
            " give 0-2 for a linear or 3-5 for an angular one."
        )
    k = joint.axis(axis)
    if row.item(j.LOCKED) >> k & 1:
        raise ArgumentError(
            f"axis_{name}={k} of joint_{name}={joint!r} is locked and cannot be geared; give an open one."
        )
    if (k < 3 and row.item(j.LINEAR) == j.LINE) or (k >= 3 and row.item(j.ANGULAR) != j.HINGE):
        raise ArgumentError(
            f"axis_{name}={k} of joint_{name}={joint!r} cannot be geared; give a linear axis that is fixed in a body,"
            " as in a slider, or the only open angular axis, as in a hinge."
        )
    return k

"""The rows of a new joint in the tables."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import of_matrix, product, turned
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.forward_kinematics import signs
from kickdrift.world.joints.joint_kinds import KINDS
from kickdrift.world.joints.limits_motors_tables import LAW_PARTS, clear_laws, write_law
from kickdrift.world.joints.record import Geared, Placement, Record
from kickdrift.world.layout import ORIENTATION, POSITION
from kickdrift.world.tables import JOINT, JOINT_NUMBERS, POSE, Tables

Floats = NDArray[np.float64]
_CONJUGATE = (1.0, -1.0, -1.0, -1.0)


def write_joint(tables: Tables, row: int, bodies: tuple[int, int], record: Record, placement: Placement) -> None:
    """Write the row of a joint between two bodies in their present poses, with the laws of its axes; impulses are zero."""
    joint, numbers = tables.array(JOINT)[row], tables.array(JOINT_NUMBERS)[row]
    joint[:], numbers[:] = 0, 0.0
    axes = (*placement.linear, *placement.angular)
    joint[[j.JOINT_KIND, j.BODY_A, j.BODY_B]] = KINDS.index(type(record)), *bodies
    joint[[j.LINEAR, j.PRINCIPAL]] = _linear_mode(placement), placement.principal
    joint[[j.ANGULAR, j.PIVOT]] = _angular_mode(placement)
    joint[j.LOCKED] = sum(1 << k for k, axis in enumerate(axes) if axis.locked)
    numbers[j.LENGTH] = placement.length
    numbers[[j.BREAKING_FORCE, j.BREAKING_TORQUE]] = record.breaking_force, record.breaking_torque
    _write_frames(numbers, placement, tables.array(POSE)[list(bodies)], joint[j.LINEAR] == j.POINT)
    if placement.geared is not None:
        _couple(joint, numbers, placement.geared)
    clear_laws(tables, row)
    for k, (axis, sign) in enumerate(zip(axes, signs(tables, row), strict=True)):
        if axis.has_law:
            seen = axis if sign > 0.0 else axis.reversed()
            for part in LAW_PARTS:
                write_law(tables, row, k, part, getattr(seen, part))


def _write_frames(numbers: Floats, placement: Placement, poses: Floats, point: bool) -> None:
    """Write anchors and axes, in the axes of both bodies and in the world's; a point is measured along the latter."""
    frame, anchors = of_matrix(placement.frame), (placement.anchor_a, placement.anchor_b)
    for pose, at, turn, anchor in zip(poses, (j.ANCHOR_A, j.ANCHOR_B), (j.FRAME_A, j.FRAME_B), anchors, strict=True):
        back = pose[ORIENTATION : ORIENTATION + 4] * _CONJUGATE
        numbers[at : at + 3] = turned(back, anchor - pose[POSITION : POSITION + 3])
        numbers[turn : turn + 4] = product(back, frame)
    for pose, arm in zip(poses, (j.ARM_A, j.ARM_B), strict=True):
        numbers[arm : arm + 3] = placement.anchor_b - pose[POSITION : POSITION + 3]
    along = np.eye(3) if point else placement.frame
    numbers[j.AXES : j.AXES + 18] = np.concatenate((along.T.ravel(), placement.frame.T.ravel()))
    if placement.line:
        numbers[j.JOINT_POSITION + 2] = np.linalg.norm(placement.anchor_b - placement.anchor_a) - placement.length


def _couple(joint: NDArray[np.int64], numbers: Floats, geared: Geared) -> None:
    """Write the axes that a gear couples; it has no anchors."""
    joint[j.GEARED_JOINTS : j.GEARED_JOINTS + 2] = geared.joints
    joint[j.GEARED_AXES : j.GEARED_AXES + 2] = geared.axes
    numbers[j.RATES : j.RATES + 2] = geared.rates
    numbers[[*range(j.ANCHOR_A, j.ANCHOR_A + 3), *range(j.ANCHOR_B, j.ANCHOR_B + 3)]] = 0.0
    numbers[j.ARM_A : j.AXES + 18] = 0.0


def _linear_mode(placement: Placement) -> int:
    """Return how positions are measured, a value of LINEAR."""
    if placement.geared is not None:
        return j.GEARED
    if placement.line:
        return j.LINE
    return j.POINT if all(axis.locked for axis in placement.linear) else j.FRAME


def _angular_mode(placement: Placement) -> tuple[int, int]:
    """Return how angles are measured, a value of ANGULAR, and the axis that it refers to (PIVOT)."""
    is_open = [not axis.locked for axis in placement.angular]
    if sum(is_open) == 0:
        return j.RIGID, 0
    if sum(is_open) == 1:
        return j.HINGE, is_open.index(True)
    if sum(is_open) == 2:
        return j.UNIVERSAL, (is_open.index(False) + 1) % 3
    if placement.cone:
        return j.SWING_TWIST, 0
    return (j.VECTOR if any(axis.has_law for axis in placement.angular) else j.LOOSE), 0

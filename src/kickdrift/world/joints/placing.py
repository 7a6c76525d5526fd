"""Joints at given angles and positions: the side of a joint that hangs on it is moved as if it were one body.

Seen from the reference, the body at the joint that stays, all points and velocities of the other side are turned or shifted
alike, so that the rates of all joints stay what they were, that of the one placed too.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.world.flight import DYNAMIC
from kickdrift.world.flight import KIND as BODY_KIND
from kickdrift.world.joints.layout import (
    ANGULAR,
    ARM_B,
    AXES,
    BODY_A,
    BODY_B,
    BROKEN,
    FRAME_B,
    HINGE,
    KIND,
    LENGTH,
    LINE,
    LINEAR,
    LOCKED,
    LOWER,
    PIVOT,
    POSITION,
    REMOVED,
    UNIVERSAL,
    UPPER,
)
from kickdrift.world.joints.measure import measure
from kickdrift.world.rotations import product, turned
from kickdrift.world.tables import BODY, JOINT, JOINT_AXES, JOINT_NUMBERS, MOTION, POSE, Tables

Floats = NDArray[np.float64]


class Side(NamedTuple):
    """The bodies that a joint moves against a reference: their rows, its row, and 1.0 if they are the side of b, or -1.0."""

    moved: NDArray[np.intp]
    reference: int
    sign: float


@compiled
def measure_again(joints: Any, world: int) -> None:
    """Measure some joints where they stand."""
    for k in range(len(joints)):
        measure(joints[k], world)


def check_placeable(tables: Tables, row: int, k: int) -> None:
    """Refuse axes that are locked, and those that have no angle or position of their own; ArgumentError."""
    joint = tables.array(JOINT)[row]
    if joint[LOCKED] >> k & 1:
        raise ArgumentError(f"axis={k} is locked, so the joint cannot be placed along it; place one of its bodies.")
    if k < 3 and joint[LINEAR] == LINE and k != 2:
        raise ArgumentError(f"axis={k} of a joint along a line has no position of its own; only axis 2, the line, has.")
    if k >= 3 and joint[ANGULAR] not in (HINGE, UNIVERSAL):
        raise ArgumentError(
            f"axis={k} is one of three open angular axes, which have no angles of their own; give a body its orientation."
        )


def place(tables: Tables, row: int, k: int, target: float, side: Side) -> None:
    """Turn or shift a side of a measured joint so that its position along axis k, of b against a, is the target."""
    joint, numbers, pose = tables.array(JOINT)[row], tables.array(JOINT_NUMBERS)[row], tables.array(POSE)
    if k == 2 and joint[LINEAR] == LINE and target < -numbers[LENGTH]:
        raise ArgumentError(
            f"position={target!r} is a distance below zero; give at least minus the joint's length, {-numbers[LENGTH]:g}."
        )
    axis, pivot = _axis(tables, row, k)
    way = side.sign * (target - numbers[POSITION + k])
    moved, reference = pose[side.moved], pose[side.reference, :3].copy()
    motion = tables.array(MOTION)
    base_v, base_w = motion[side.reference, :3].copy(), motion[side.reference, 3:6].copy()
    v = motion[side.moved, :3] - base_v - np.cross(base_w, moved[:, :3] - reference)
    w = motion[side.moved, 3:6] - base_w
    if k < 3:
        moved[:, :3] += way * axis
    else:
        q = np.array((np.cos(0.5 * way), *(np.sin(0.5 * way) * axis)))
        moved[:, :3] = pivot + turned(q, moved[:, :3] - pivot)
        moved[:, 3:7] = product(np.broadcast_to(q, (len(moved), 4)), moved[:, 3:7])
        v, w = turned(q, v), turned(q, w)
    pose[side.moved] = moved
    motion[side.moved, :3] = base_v + np.cross(base_w, moved[:, :3] - reference) + v
    motion[side.moved, 3:6] = base_w + w
    numbers[POSITION + k] = target  # which full turn it is
    joints = tables.array(JOINT)
    touched = np.isin(joints[:, [BODY_A, BODY_B]], side.moved).any(axis=1) & (joints[:, KIND] != REMOVED)
    measure_again(np.flatnonzero(touched), tables.address)


def speed_up(tables: Tables, row: int, k: int, change: float, side: Side) -> None:
    """Change the rate of axis k of a measured joint, of b against a, by the velocities of a side."""
    axis, pivot = _axis(tables, row, k)
    motion, way = tables.array(MOTION), side.sign * change * axis
    if k < 3:
        motion[side.moved, :3] += way
        return
    motion[side.moved, :3] += np.cross(way, tables.array(POSE)[side.moved, :3] - pivot)
    motion[side.moved, 3:6] += way


def side_of(tables: Tables, row: int, words: str) -> Side:
    """Find the side of a joint that moves alone: that of the body whose motion is measured, or else the other one.

    Raises
    ------
    ArgumentError
        Where joints lead from one body to the other besides this one, or from both to what forces do not move.
    """
    a, b = (int(body) for body in tables.array(JOINT)[row, [BODY_A, BODY_B]])
    moves = tables.array(BODY)[:, BODY_KIND] == DYNAMIC
    neighbours = _neighbours(tables, row)
    for start, other, sign in ((b, a, 1.0), (a, b, -1.0)):
        if not moves[start]:
            continue
        side, held = _hanging(start, neighbours, moves)
        if other in side:
            raise ArgumentError(
                f"{words} is part of a loop, where no side can move alone; place its bodies one by one."
            )
        if not held:
            return Side(np.array(sorted(side)), other, sign)
    raise ArgumentError(
        f"{words} lies on a way of joints between what forces do not move, where no side can move alone; place its bodies one"
        " by one."
    )


def check_limits(tables: Tables, row: int, k: int, sign: float, what: str, value: float) -> None:
    """Refuse a value, of the sign that users see, which is beyond the limits of an axis; ArgumentError."""
    ends = sign * tables.array(JOINT_AXES)[6 * row + k, [LOWER, UPPER]]
    lower, upper = ends.min(), ends.max()
    if not lower <= value <= upper:
        raise ArgumentError(
            f"{what}={value!r} is beyond the joint's limits, {lower:g} to {upper:g}; give one within them."
        )


def _axis(tables: Tables, row: int, k: int) -> tuple[Floats, Floats]:
    """Return the axis of a measured joint along or about which b is moved against a, and the point where the joint acts."""
    joint, numbers = tables.array(JOINT)[row], tables.array(JOINT_NUMBERS)[row]
    pose = tables.array(POSE)[joint[BODY_B]]
    pivot: Floats = pose[:3] + numbers[ARM_B : ARM_B + 3]
    if k >= 3 and joint[ANGULAR] == UNIVERSAL and k - 3 != joint[PIVOT]:
        # The second axis of a cross is one of b; that in AXES is at right angles to the first also where they are not.
        return turned(product(pose[3:7], numbers[FRAME_B : FRAME_B + 4]), np.eye(3)[k - 3]), pivot
    return numbers[AXES + 3 * k : AXES + 3 * k + 3].copy(), pivot


def _neighbours(tables: Tables, without: int) -> dict[int, list[int]]:
    """Bodies that joints hold to each other, but for one joint; springs, which only pull, do not hold."""
    joints = tables.array(JOINT)
    limits = tables.array(JOINT_AXES)[:, [LOWER, UPPER]].reshape(-1, 12)
    holds = (joints[:, KIND] != REMOVED) & (joints[:, BROKEN] == 0)
    holds &= (joints[:, LOCKED] != 0) | np.isfinite(limits).any(axis=1)
    holds[without] = False
    found: dict[int, list[int]] = {}
    for a, b in joints[holds][:, [BODY_A, BODY_B]].tolist():
        found.setdefault(a, []).append(b)
        found.setdefault(b, []).append(a)
    return found


def _hanging(start: int, neighbours: dict[int, list[int]], moves: NDArray[np.bool_]) -> tuple[set[int], bool]:
    """Return the bodies that hang together with one, and whether any is held by what forces do not move."""
    found, ahead, held = {start}, [start], False
    while ahead:
        for body in neighbours.get(ahead.pop(), ()):
            if not moves[body]:
                held = True
            elif body not in found:
                found.add(body)
                ahead.append(body)
    return found, held

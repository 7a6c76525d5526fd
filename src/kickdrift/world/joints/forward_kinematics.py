"""Setting joints to angles and positions: one side of a joint is moved as a rigid body.

In the frame of the reference, the body at the joint that is not moved, all points and velocities of the other side are rotated
or shifted alike, so that the rates of all joints are unchanged, including that of the joint itself.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError
from kickdrift.core.rotations import product as rotated_by
from kickdrift.core.rotations import turned as rotated
from kickdrift.core.vectors import Vector, cross, exponential, minus, plus, product, turned, unit
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.kinematics import measure_joint
from kickdrift.world.joints.limits_motors_options import finite
from kickdrift.world.layout import ANGULAR_VELOCITY, BODY_KIND, DYNAMIC, ORIENTATION, POSITION, VELOCITY
from kickdrift.world.tables import BODY, JOINT, JOINT_AXES, JOINT_NUMBERS, MOTION, POSE, Tables, floats

if TYPE_CHECKING:
    from kickdrift.world.joints.handle import Joint

Floats = NDArray[np.float64]


class Side(NamedTuple):
    """The side of a joint that is moved: rows of its bodies, row of the reference, and 1.0 for the side of b, -1.0 for a."""

    moved: NDArray[np.intp]
    reference: int
    sign: float


@compiled
def measure_again(world: int, joints: Any) -> None:
    """Measure some joints in their present poses."""
    for k in range(len(joints)):
        measure_joint(world, joints[k], 0.0)


@compiled
def shift(world: int, moved: Any, reference: int, way: Vector, pivot: Vector) -> None:
    """Shift bodies, with their velocities relative to the rotating reference unchanged."""
    pose, motion = floats(world, POSE), floats(world, MOTION)
    added = cross(vector_at(motion, reference, j.ANGULAR_PART), way)
    for body in moved:
        for k in range(3):
            pose[body, k] += way[k]
            motion[body, k] += added[k]


@compiled
def turn(world: int, moved: Any, reference: int, way: Vector, pivot: Vector) -> None:
    """Rotate bodies about a point, together with their velocities relative to the rotating reference."""
    pose, motion = floats(world, POSE), floats(world, MOTION)
    q, x, base = exponential(way), vector_at(pose, reference, POSITION), vector_at(motion, reference, VELOCITY)
    spin = vector_at(motion, reference, j.ANGULAR_PART)
    for body in moved:
        before = vector_at(pose, body, POSITION)
        seen = minus(minus(vector_at(motion, body, VELOCITY), base), cross(spin, minus(before, x)))
        at = plus(pivot, turned(q, minus(before, pivot)))
        v = plus(plus(base, cross(spin, minus(at, x))), turned(q, seen))
        w = plus(spin, turned(q, minus(vector_at(motion, body, j.ANGULAR_PART), spin)))
        orientation = unit(product(q, quaternion_at(pose, body, j.ANGULAR_PART)))
        for k in range(3):
            pose[body, POSITION + k], motion[body, VELOCITY + k], motion[body, ANGULAR_VELOCITY + k] = at[k], v[k], w[k]
        for k in range(4):
            pose[body, ORIENTATION + k] = orientation[k]


def signs(tables: Tables, row: int) -> Floats:
    """Return the signs of a joint's axes for users, (6,): -1.0 if only body a is dynamic, as tables hold b relative to a.

    Distances and swings have the same sign from both sides.
    """
    joint, found = tables.row(JOINT, row), np.ones(6)
    if tables.row(BODY, joint.item(j.BODY_B)).item(BODY_KIND) != DYNAMIC:
        found[3 * (joint[j.LINEAR] == j.LINE) :] = -1.0
        found[3] *= -1.0 if joint[j.ANGULAR] == j.SWING_TWIST else 1.0
    return found


def place(joint: "Joint", k: int, what: str, value: float) -> None:
    """Move a joint to a position along axis k, or an angle about it; see `Joint.place`."""
    row, sign, side = _ready(joint, k, what, value)
    tables = joint.joints.tables
    _check_limits(tables, row, k, sign, what, value)
    _put(tables, row, k, sign * value, side)


def set_speed(joint: "Joint", k: int, speed: float) -> None:
    """Set the rate of axis k of a joint; see `Joint.speed`."""
    row, sign, side = _ready(joint, k, "speed", speed)
    tables = joint.joints.tables
    axis, pivot = _axis(tables, row, k)
    motion, change = tables.array(MOTION), side.sign * sign * (speed - joint.speed) * axis
    if k < 3:
        motion[side.moved, VELOCITY : VELOCITY + 3] += change
        return
    arms = tables.array(POSE)[side.moved, POSITION : POSITION + 3] - pivot
    motion[side.moved, VELOCITY : VELOCITY + 3] += np.cross(change, arms)
    motion[side.moved, ANGULAR_VELOCITY : ANGULAR_VELOCITY + 3] += change


def _ready(joint: "Joint", k: int, what: str, value: float) -> tuple[int, float, Side]:
    """Check that axis k can be set, measure the joint, and return its row, the sign of the axis and the side that moves."""
    finite(what, value)
    row, tables = joint.joints.row(joint), joint.joints.tables
    _check_placeable(tables, row, k)
    side = _side_of(tables, row, f"joint={joint!r}")
    measure_again(tables.address, np.array([row]))
    return row, joint.sign(k), side


def _check_placeable(tables: Tables, row: int, k: int) -> None:
    """Check that axis k is open, not geared, and has an angle or position of its own; ArgumentError if not."""
    joint = tables.array(JOINT)[row]
    if joint[j.LOCKED] >> k & 1:
        raise ArgumentError(f"axis={k} is locked, so the joint cannot be moved along it; move one of its bodies.")
    if k < 3 and joint[j.LINEAR] == j.LINE and k != 2:
        raise ArgumentError(f"axis={k} of a joint along a line has no position of its own; only axis 2, the line, has.")
    joints = tables.array(JOINT)
    gears = joints[(joints[:, j.JOINT_KIND] != j.REMOVED_JOINT) & (joints[:, j.LINEAR] == j.GEARED)]
    coupled = (gears[:, j.GEARED_JOINTS : j.GEARED_JOINTS + 2] == row) & (
        gears[:, j.GEARED_AXES : j.GEARED_AXES + 2] == k
    )
    if coupled.any():
        raise ArgumentError(f"axis={k} of the joint is geared to another one; remove the gear, and add it again later.")
    if k >= 3 and joint[j.ANGULAR] not in (j.HINGE, j.UNIVERSAL):
        raise ArgumentError(
            f"axis={k} is one of three open angular axes, which have no angles of their own; set the orientation of a"
            " body."
        )


def _put(tables: Tables, row: int, k: int, target: float, side: Side) -> None:
    """Rotate or shift a side of a measured joint so that its position along axis k, of b relative to a, is the target."""
    numbers = tables.row(JOINT_NUMBERS, row)
    if k == 2 and tables.row(JOINT, row).item(j.LINEAR) == j.LINE and target < -numbers[j.LENGTH]:
        raise ArgumentError(
            f"position={target!r} is a negative distance; give at least minus the joint's length, {-numbers[j.LENGTH]:g}."
        )
    axis, pivot = _axis(tables, row, k)
    way = side.sign * (target - numbers.item(j.JOINT_POSITION + k)) * axis
    numbers[j.JOINT_POSITION + k] = target  # determines the number of full turns
    joints = tables.array(JOINT)
    moves = np.zeros(tables.count(BODY), dtype=np.bool_)
    moves[side.moved] = True
    touched = np.flatnonzero(
        (moves[joints[:, j.BODY_A]] | moves[joints[:, j.BODY_B]]) & (joints[:, j.JOINT_KIND] != j.REMOVED_JOINT)
    )
    move = shift if k < 3 else turn
    move(tables.address, side.moved, side.reference, (way[0], way[1], way[2]), (pivot[0], pivot[1], pivot[2]))
    measure_again(tables.address, touched)


def _side_of(tables: Tables, row: int, words: str) -> Side:
    """Return the side of a joint that can be moved: that of the body whose motion is measured, or else the other one.

    Raises
    ------
    ArgumentError
        If the joint is part of a loop, or joints connect both sides to bodies that are not dynamic.
    """
    a, b = (int(body) for body in tables.array(JOINT)[row, [j.BODY_A, j.BODY_B]])
    moves = tables.array(BODY)[:, BODY_KIND] == DYNAMIC
    neighbours = _neighbours(tables, row)
    for start, other, sign in ((b, a, 1.0), (a, b, -1.0)):
        if not moves[start]:
            continue
        side, held = _hanging(start, neighbours, moves)
        if other in side:
            raise ArgumentError(
                f"{words} is part of a loop, where neither side can move alone; place its bodies one by one."
            )
        if not held:
            return Side(np.array(sorted(side)), other, sign)
    raise ArgumentError(
        f"{words} lies on a chain of joints between bodies that forces do not move, where neither side can move alone;"
        " place its bodies one by one."
    )


def _check_limits(tables: Tables, row: int, k: int, sign: float, what: str, value: float) -> None:
    """Check that a value, with the sign for users, is within the limits of an axis; ArgumentError if not."""
    ends = sign * tables.array(JOINT_AXES)[6 * row + k, [j.LOWER_LIMIT, j.UPPER_LIMIT]]
    lower, upper = ends.min(), ends.max()
    if not lower <= value <= upper:
        raise ArgumentError(
            f"{what}={value!r} is beyond the joint's limits, {lower:g} to {upper:g}; give one within them."
        )


def _axis(tables: Tables, row: int, k: int) -> tuple[Floats, Floats]:
    """Return the axis of a measured joint along or about which b is moved against a, and the point where the joint acts."""
    joint, numbers = tables.row(JOINT, row), tables.row(JOINT_NUMBERS, row)
    pose = tables.row(POSE, joint.item(j.BODY_B))
    pivot: Floats = pose[:3] + numbers[j.ARM_B : j.ARM_B + 3]
    if k >= 3 and joint.item(j.ANGULAR) == j.UNIVERSAL and k - 3 != joint.item(j.PIVOT):
        # The second axis of a universal joint is fixed in b; that in AXES is made perpendicular to the first.
        return rotated(rotated_by(pose[3:7], numbers[j.FRAME_B : j.FRAME_B + 4]), np.eye(3)[k - 3]), pivot
    return numbers[j.AXES + 3 * k : j.AXES + 3 * k + 3].copy(), pivot


def _neighbours(tables: Tables, without: int) -> dict[int, list[int]]:
    """Return the bodies that each body is connected to by joints with locked axes or limits, without one joint and gears."""
    joints = tables.array(JOINT)
    limits = tables.array(JOINT_AXES)[:, [j.LOWER_LIMIT, j.UPPER_LIMIT]].reshape(-1, 12)
    holds = (joints[:, j.JOINT_KIND] != j.REMOVED_JOINT) & (joints[:, j.LINEAR] != j.GEARED)
    holds &= (joints[:, j.LOCKED] != 0) | np.isfinite(limits).any(axis=1)
    holds[without] = False
    found: dict[int, list[int]] = {}
    for a, b in joints[holds][:, [j.BODY_A, j.BODY_B]].tolist():
        found.setdefault(a, []).append(b)
        found.setdefault(b, []).append(a)
    return found


def _hanging(start: int, neighbours: dict[int, list[int]], moves: NDArray[np.bool_]) -> tuple[set[int], bool]:
    """Return the dynamic bodies connected to one, and whether any of them is connected to a body that is not dynamic."""
    found, ahead, held = {start}, [start], False
    while ahead:
        for body in neighbours.get(ahead.pop(), ()):
            if not moves[body]:
                held = True
            elif body not in found:
                found.add(body)
                ahead.append(body)
    return found, held

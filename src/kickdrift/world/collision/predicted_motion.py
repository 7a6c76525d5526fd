"""Paths on which bodies are expected to move in a step, by which the search for contacts knows which shapes they may meet.

A body is expected to move under forces and gravity from its initial velocity in the step. Where impacts within the step made it
so fast that a contact was missed, the step is repeated (see `missed_contacts`), and the path is that of the previous attempt in
two parts: free flight from the start and, from the time on at which an impact changed the velocity, the free flight that ends
with the position and velocity of that attempt.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, conjugate, dot, exponential, length, minus, plus, product, times
from kickdrift.world.collision.body_acceleration import acceleration, angular_acceleration
from kickdrift.world.columns import column, quaternion_at, symmetric_at, vector_at
from kickdrift.world.free_rotation import fast_rotation, turned_product
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    AWAKE,
    BODY_INERTIA,
    BODY_KIND,
    DYNAMIC,
    INERTIA_KIND,
    LINK_COUNT,
    ORIENTATION,
    POSITION,
    TUMBLES,
    VELOCITY,
)
from kickdrift.world.settings import STEP
from kickdrift.world.tables import (
    BODY,
    DELTA_POSE,
    INERTIA,
    MOTION,
    POSE,
    PREDICTED,
    SETTINGS,
    STARTED_MOTION,
    STARTED_POSE,
    SWEPT,
    floats,
    integers,
    rows,
)

HAS_CHANGE = column(PREDICTED)  # 1.0 while a step in which the velocity has changed is repeated
CHANGE_TIME = column(PREDICTED, 1, "s")  # time of that change since the start of the step
END_POSE = column(PREDICTED, 7)  # pose at the end of the previous attempt
END_MOTION = column(PREDICTED, 6, "m/s, rad/s")
POSITION_ERROR = column(PREDICTED, 1, "m")  # largest distance from the path in an attempt
TURN_ERROR = column(PREDICTED, 1, "rad")  # by how much more the body has turned than was expected
STRUCK = column(PREDICTED)  # 1.0 of bodies that a fast contact may strike
WIDE_BOUNDS = column(PREDICTED)  # 1.0 in the next step: fat bounds contain the path, and are computed anew

# Columns of SWEPT: the box around the positions of a body at impacts and at the ends of substeps
LEAST, MOST = column(SWEPT, 3, "m"), column(SWEPT, 3, "m")

TURN = 0.1  # rad: a shape that has turned by more than was expected has other points of contact


@compiled
def path(world: int, body: int, when: float) -> tuple[Vector, Quaternion]:
    """Return the pose of a body on its path, a time after the start of the step."""
    pose, motion, predicted = floats(world, POSE), floats(world, MOTION), floats(world, PREDICTED)
    if predicted[body, HAS_CHANGE] != 0.0 and when >= predicted[body, CHANGE_TIME]:
        back = when - floats(world, SETTINGS)[0, STEP]
        at, q = vector_at(predicted, body, END_POSE), quaternion_at(predicted, body, END_POSE + 3)
        v, w, since = vector_at(predicted, body, END_MOTION), vector_at(predicted, body, END_MOTION + 3), back
    else:
        at, q = vector_at(pose, body, POSITION), quaternion_at(pose, body, ORIENTATION)
        v, w, since = vector_at(motion, body, VELOCITY), vector_at(motion, body, ANGULAR_VELOCITY), when
    at = plus(plus(at, times(since, v)), times(0.5 * since * since, acceleration(world, body)))
    return at, _turned_freely(world, body, q, w, since)


@compiled
def _turned_freely(world: int, body: int, q: Quaternion, w: Vector, time: float) -> Quaternion:
    """Return the orientation of a body in free flight after a time, or before it if that is negative.

    A plate that tumbles is 30 degrees off a rotation about one axis after it has turned by two radians.
    """
    inertia, own = floats(world, INERTIA), integers(world, BODY)
    tumbles = inertia[body, INERTIA_KIND] == TUMBLES and own[body, BODY_KIND] == DYNAMIC
    if not tumbles or own[body, LINK_COUNT] != 0:
        return product(exponential(times(time, w)), q)
    moments, turn = symmetric_at(inertia, body, BODY_INERTIA), w if time >= 0.0 else times(-1.0, w)
    before, part, mean = fast_rotation(abs(time), q, moments, turned_product(q, moments, turn), turn)
    return product(exponential(times(part, mean)), before)


@compiled
def velocity_then(world: int, body: int, when: float) -> Vector:
    """Return the velocity of a body on its path."""
    predicted, gained = floats(world, PREDICTED), acceleration(world, body)
    if predicted[body, HAS_CHANGE] != 0.0 and when >= predicted[body, CHANGE_TIME]:
        return plus(vector_at(predicted, body, END_MOTION), times(when - floats(world, SETTINGS)[0, STEP], gained))
    return plus(vector_at(floats(world, MOTION), body, 0), times(when, gained))


@compiled(inline=True)
def fastest_turn(world: int, body: int) -> float:
    """Bound the angular speed of a body on its path."""
    predicted, turn = floats(world, PREDICTED), length(vector_at(floats(world, MOTION), body, 3))
    if has_change(world, body):
        turn = max(turn, length(vector_at(predicted, body, END_MOTION + 3)))
    return turn


@compiled(inline=True)
def next_change(world: int, body: int, when: float, end: float) -> float:
    """Return when the velocity changes on the path of a body, if that is between two times; or the latter."""
    predicted = floats(world, PREDICTED)
    if predicted[body, HAS_CHANGE] != 0.0 and when < predicted[body, CHANGE_TIME] < end:
        end = predicted[body, CHANGE_TIME]
    return end


@compiled(inline=True)
def has_change(world: int, body: int) -> bool:
    """Whether the velocity of a body is expected to change in the step by more than forces change it."""
    changes: bool = floats(world, PREDICTED)[body, HAS_CHANGE] != 0.0
    return changes


@compiled
def way_on_path(world: int, body: int) -> float:
    """Bound the distance of a path from the present position of its body."""
    predicted, step = floats(world, PREDICTED), floats(world, SETTINGS)[0, STEP]
    change = predicted[body, CHANGE_TIME]
    at, _ = path(world, body, change)
    before = change * length(vector_at(floats(world, MOTION), body, 0))
    jump = length(minus(at, vector_at(floats(world, POSE), body, 0)))
    after = length(minus(vector_at(predicted, body, END_POSE), at))
    way: float = max(before, jump) + after + step * step * length(acceleration(world, body))
    return way


@compiled
def note_path(world: int, h: float, body: int) -> bool:
    """Note the motion of a body in an attempt at a step that will be repeated; return whether it differs from the last one."""
    pose, motion, predicted = floats(world, POSE), floats(world, MOTION), floats(world, PREDICTED)
    news: bool = predicted[body, HAS_CHANGE] == 0.0
    start, before = vector_at(floats(world, STARTED_POSE), body, 0), vector_at(floats(world, STARTED_MOTION), body, 0)
    gained = times(h, acceleration(world, body))
    at, after = vector_at(pose, body, POSITION), vector_at(motion, body, VELOCITY)
    # The velocity has changed when the flight from the start and that back from the end are nearest to each other.
    faster = minus(minus(after, gained), before)
    apart = plus(minus(minus(at, start), times(h, after)), times(0.5 * h, gained))
    change = -dot(apart, faster) / max(dot(faster, faster), 1e-300)
    predicted[body, HAS_CHANGE], predicted[body, CHANGE_TIME] = 1.0, min(max(change, 0.0), h)
    for k in range(7):
        news = news or predicted[body, END_POSE + k] != pose[body, k]
        predicted[body, END_POSE + k] = pose[body, k]
    for k in range(6):
        predicted[body, END_MOTION + k] = motion[body, k]
    return news


@compiled
def begin_paths(t: float, h: float, world: int) -> None:
    """Begin the boxes around the paths of bodies at their present positions."""
    pose, swept, predicted = floats(world, POSE), floats(world, SWEPT), floats(world, PREDICTED)
    for body in range(rows(world, SWEPT)):
        predicted[body, POSITION_ERROR] = 0.0
        for k in range(3):
            swept[body, LEAST + k], swept[body, MOST + k] = pose[body, k], pose[body, k]


@compiled
def follow_paths(t: float, h: float, world: int) -> None:
    """Note the positions of bodies at the end of a substep."""
    body = integers(world, BODY)
    for row in range(rows(world, BODY)):
        if body[row, BODY_KIND] == DYNAMIC and body[row, AWAKE] != 0:
            note_position(world, row)


@compiled
def note_position(world: int, body: int) -> None:
    """Widen the box around the path of a body to its present position, and note the distance from its expected position."""
    predicted, swept, at = floats(world, PREDICTED), floats(world, SWEPT), vector_at(floats(world, POSE), body, 0)
    for k in range(3):
        swept[body, LEAST + k] = min(swept[body, LEAST + k], at[k])
        swept[body, MOST + k] = max(swept[body, MOST + k], at[k])
    predicted[body, POSITION_ERROR] = max(predicted[body, POSITION_ERROR], _off_path(world, body, at))


@compiled
def _off_path(world: int, body: int, at: Vector) -> float:
    """Return the distance of a position from the expected path of a body; stopped bodies are on it."""
    before, after = _corners(world, body)
    off = _distance(at, vector_at(floats(world, STARTED_POSE), body, 0), before)
    if has_change(world, body):
        off = min(off, _distance(at, after, vector_at(floats(world, PREDICTED), body, END_POSE)))
    return off


@compiled
def _corners(world: int, body: int) -> tuple[Vector, Vector]:
    """Return the end of the first part of a path, and the beginning of the second one."""
    predicted, change = floats(world, PREDICTED), floats(world, SETTINGS)[0, STEP]
    start, gained = vector_at(floats(world, STARTED_POSE), body, 0), acceleration(world, body)
    back = 0.0
    if has_change(world, body):
        change, back = predicted[body, CHANGE_TIME], predicted[body, CHANGE_TIME] - change
    way = plus(times(change, vector_at(floats(world, STARTED_MOTION), body, 0)), times(0.5 * change * change, gained))
    left = plus(times(back, vector_at(predicted, body, END_MOTION)), times(0.5 * back * back, gained))
    return plus(start, way), plus(vector_at(predicted, body, END_POSE), left)


@compiled
def path_error(world: int, body: int) -> float:
    """Return the distance of a body from its path; if the path has a jump, the body was elsewhere in between."""
    error: float = floats(world, PREDICTED)[body, POSITION_ERROR]
    if has_change(world, body):
        before, after = _corners(world, body)
        error = max(error, length(minus(after, before)))
    return error


@compiled
def end_error(world: int, body: int) -> Vector:
    """Return where a body is relative to the end of its path; zero of bodies that are on it."""
    predicted = floats(world, PREDICTED)
    if predicted[body, POSITION_ERROR] == 0.0:
        return 0.0, 0.0, 0.0
    end, _ = _corners(world, body)
    if has_change(world, body):
        end = vector_at(predicted, body, END_POSE)
    return minus(vector_at(floats(world, POSE), body, 0), end)


@compiled
def turn_error(world: int, h: float, body: int) -> float:
    """Return by how much a body has turned farther than was expected, or about another axis, rad."""
    turn, torque = length(vector_at(floats(world, DELTA_POSE), body, 3)), length(angular_acceleration(world, body))
    start = vector_at(floats(world, STARTED_MOTION), body, 3)
    most = length(start) + h * torque
    if has_change(world, body):
        most = max(most, length(vector_at(floats(world, PREDICTED), body, END_MOTION + 3)))
    excess = max(turn - h * most, 0.0)
    # Joints turn bodies about changing axes all the time.
    if turn + h * most <= TURN or integers(world, BODY)[body, LINK_COUNT] != 0:
        return excess
    if has_change(world, body):
        expected = quaternion_at(floats(world, PREDICTED), body, END_POSE + 3)
    else:
        before = quaternion_at(floats(world, STARTED_POSE), body, ORIENTATION)
        expected = _turned_freely(world, body, before, start, h)
    off = product(quaternion_at(floats(world, POSE), body, ORIENTATION), conjugate(expected))
    angle = 2.0 * math.asin(min(length((off[1], off[2], off[3])), 1.0)) - h * h * torque
    # Smaller differences may be those between one long step and several short ones.
    return max(excess, angle if angle > 0.1 * TURN else 0.0)


@compiled(inline=True)
def _distance(point: Vector, start: Vector, end: Vector) -> float:
    """Return the distance of a point from the line from one point to another."""
    along, to = minus(end, start), minus(point, start)
    part = min(max(dot(to, along) / max(dot(along, along), 1e-300), 0.0), 1.0)
    off: float = length(minus(to, times(part, along)))
    return off


@compiled(inline=True)
def drop_path(world: int, body: int) -> None:
    """Expect a body to move under forces alone; bounds that contain its path are computed anew in the next step."""
    predicted = floats(world, PREDICTED)
    predicted[body, WIDE_BOUNDS], predicted[body, HAS_CHANGE] = predicted[body, HAS_CHANGE], 0.0

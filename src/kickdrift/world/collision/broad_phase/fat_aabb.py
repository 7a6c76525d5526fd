"""The boxes of shapes: all that a shape may touch in a step lies in its box; pairs are updated when it leaves its fat bounds.

The box of a shape holds its points, their way in the step, and a margin within which contacts are found before they
touch. The fat bounds are larger by some slack on all sides and by some of the way ahead, so that pairs of resting bodies are
never sought, and those of falling bodies every few steps. Shapes that cannot move have neither.
"""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, plus, product, times, turned
from kickdrift.world.collision.body_acceleration import acceleration, angular_acceleration, reach
from kickdrift.world.collision.broad_phase.aabb import box_around
from kickdrift.world.collision.broad_phase.bvh import Box
from kickdrift.world.collision.predicted_motion import CHANGE_TIME, WIDE_BOUNDS, has_change, path
from kickdrift.world.collision.shape_properties import extent_of, sort_of
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    BODY_KIND,
    BODY_ROW,
    LOWER,
    ORIENTATION,
    PLACE_ORIENTATION,
    PLACE_POSITION,
    POSITION,
    RADIUS,
    STATIC,
    UPPER,
    VELOCITY,
)
from kickdrift.world.settings import MARGIN, STEP
from kickdrift.world.shapes.record import SOLID
from kickdrift.world.tables import (
    BODY,
    BOUNDS,
    MOTION,
    MOVERS,
    PLACE,
    POSE,
    PREDICTED,
    SETTINGS,
    SHAPE,
    floats,
    integers,
    rows,
)

_FRACTION = 0.125  # of the longest side: margin and slack of small shapes
_SLACK = 0.05  # m, of large ones
_AHEAD = 3.0  # steps: at 2 falling boxes are sought half as often again, at 4 fast ones have a third more contacts


@compiled(inline=True)
def may_move(world: int, shape: int) -> bool:
    """Whether a shape belongs to a body that moves, or could."""
    body = integers(world, SHAPE)[shape, BODY_ROW]
    moves: bool = sort_of(world, shape) == SOLID and integers(world, BODY)[body, BODY_KIND] != STATIC
    return moves


@compiled
def settle(world: int, shape: int, h: float) -> bool:
    """Give a shape that leaves its fat bounds in a step of h new ones; return whether it does."""
    box, slack, way = _box_in_step(world, shape, h)
    bounds = floats(world, BOUNDS)
    body = integers(world, SHAPE)[shape, BODY_ROW]
    # Those that contain a path grow with it, and would grow again whenever a full table had the stage repeated.
    wide = floats(world, PREDICTED)[body, WIDE_BOUNDS] != 0.0 and not has_change(world, body)
    if _holds(bounds, shape, box) and not wide:
        return False
    for k in range(3):
        bounds[shape, LOWER + k] = box[k] - slack + _AHEAD * min(way[k], 0.0)
        bounds[shape, UPPER + k] = box[3 + k] + slack + _AHEAD * max(way[k], 0.0)
    if not is_somewhere(world, shape):
        for k in range(6):
            bounds[shape, k] = np.nan  # which holds nothing, where infinity might
    return True


@compiled
def _box_of_path(world: int, shape: int, body: int, margin: float) -> Box:
    """Return the box of a shape on the path of its body, for any rotation, and of its fat bounds: no earlier pair is lost."""
    predicted, far = floats(world, PREDICTED), reach(floats(world, PLACE), shape) + margin
    change, bounds = predicted[body, CHANGE_TIME], floats(world, BOUNDS)
    at = vector_at(floats(world, POSE), body, POSITION)
    box = (at[0], at[1], at[2], at[0], at[1], at[2])
    # The two parts of the path need not meet where the velocity changes: just before that is where the first one ends.
    for when in (0.999999 * change, change, floats(world, SETTINGS)[0, STEP]):
        at, _ = path(world, body, when)
        box = box_around(box, (at[0], at[1], at[2], at[0], at[1], at[2]))
    box = (box[0] - far, box[1] - far, box[2] - far, box[3] + far, box[4] + far, box[5] + far)
    own = vector_at(bounds, shape, LOWER), vector_at(bounds, shape, UPPER)
    return box_around(box, (own[0][0], own[0][1], own[0][2], own[1][0], own[1][1], own[1][2]))


@compiled
def find_strays(world: int, strays: Any) -> int:
    """List the shapes that are outside their fat bounds at present; return their number."""
    movers, bounds = integers(world, MOVERS), floats(world, BOUNDS)
    count = 0
    for k in range(rows(world, MOVERS)):
        box, _, _ = _box_in_step(world, movers[k, 0], 0.0)
        if not _holds(bounds, movers[k, 0], box):
            strays[count] = movers[k, 0]
            count += 1
    return count


@compiled(inline=True)
def _holds(bounds: Any, shape: int, box: Box) -> bool:
    """Whether the fat bounds of a shape hold a box; not if a number is NaN."""
    inside = True
    for k in range(3):
        inside = inside and bounds[shape, LOWER + k] <= box[k] and bounds[shape, UPPER + k] >= box[3 + k]
    return inside


@compiled(inline=True)
def is_somewhere(world: int, shape: int) -> bool:
    """Whether the fat bounds of a shape are finite."""
    bounds = floats(world, BOUNDS)
    total = 0.0
    for k in range(6):
        total += abs(bounds[shape, k])
    return total < np.inf


@compiled(inline=True)
def _box_in_step(world: int, shape: int, h: float) -> tuple[Box, float, Vector]:
    """Return the box of a shape, the slack of its fat bounds, and the way of its origin in a step of h."""
    shapes, place, pose = integers(world, SHAPE), floats(world, PLACE), floats(world, POSE)
    body = shapes[shape, BODY_ROW]
    arm, turn = (0.0, 0.0, 0.0), quaternion_at(pose, body, ORIENTATION)
    offset = vector_at(place, shape, PLACE_POSITION)
    if (
        place[shape, PLACE_ORIENTATION] != 1.0 or dot(offset, offset) > 0.0
    ):  # most bodies are one shape: that saves 5 ns of 30
        arm = turned(turn, offset)
        turn = product(turn, quaternion_at(place, shape, PLACE_ORIENTATION))
    box, size_about = extent_of(world, shape, turn), place[shape, RADIUS]
    at = plus(vector_at(pose, body, POSITION), arm)
    if not may_move(world, shape):
        still = (at[0] + box[0], at[1] + box[1], at[2] + box[2], at[0] + box[3], at[1] + box[4], at[2] + box[5])
        return still, 0.0, (0.0, 0.0, 0.0)
    settings, motion = floats(world, SETTINGS), floats(world, MOTION)
    spin = vector_at(motion, body, ANGULAR_VELOCITY)
    way = times(h, plus(vector_at(motion, body, VELOCITY), cross(spin, arm)))
    way = plus(way, times(h * h, acceleration(world, body)))
    gained = h * h * length(angular_acceleration(world, body))
    angle = h * length(spin) + gained
    sway = angle * size_about  # no point leaves the ball of that radius by turning
    # of the arc of its centre beyond the tangent, and of the displacement by torques
    bulge = length(arm) * min(0.5 * angle * angle + gained, 2.0)
    size = _FRACTION * max(max(box[3] - box[0], box[4] - box[1]), box[5] - box[2])
    margin = min(settings[0, MARGIN], size) + bulge
    if has_change(world, body):
        return _box_of_path(world, shape, body, margin), min(_SLACK, size), (0.0, 0.0, 0.0)
    grown = (
        at[0] + max(box[0] - sway, -size_about) + min(way[0], 0.0) - margin,
        at[1] + max(box[1] - sway, -size_about) + min(way[1], 0.0) - margin,
        at[2] + max(box[2] - sway, -size_about) + min(way[2], 0.0) - margin,
        at[0] + min(box[3] + sway, size_about) + max(way[0], 0.0) + margin,
        at[1] + min(box[4] + sway, size_about) + max(way[1], 0.0) + margin,
        at[2] + min(box[5] + sway, size_about) + max(way[2], 0.0) + margin,
    )
    return grown, min(_SLACK, size), way

"""Arms of contacts that are recomputed within a step, since their bodies have turned or slid past each other."""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import conjugate, exponential, product, times
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.body_gather_simd import gather, gather_inertia
from kickdrift.world.contacts.constraint_groups import group_of, lane_count, new_scratch, run
from kickdrift.world.contacts.impacts.impact_motion import is_moved, way_to
from kickdrift.world.contacts.prepare_simd import DELTA_POSE_A, FROM_A_TO_B, MARK, TURNED_A, TURNED_B, VELOCITY_A
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    IMPACT_TIME,
    KICKED_ANGULAR_VELOCITY,
    ORIENTATION,
    POSITION,
    VELOCITY,
)
from kickdrift.world.settings import SLOP
from kickdrift.world.tables import (
    BOUNCING,
    DELTA_POSE,
    GROUPS,
    KICKED,
    MOTION,
    POSE,
    SETTINGS,
    STARTED_POSE,
    floats,
    integers,
    rows,
)

_W = c.WIDTH
_GAPS = 4 * _W
_FAR = 1e10  # m, as a gap


@compiled(inline=True)
def hide_from_sweeps(own: Any, point: int) -> None:
    """Make the gap of a point so large that the sweeps ignore it until its arms are recomputed.

    Bodies that have bounced are moved back to poses that they never had, in which they may seem to overlap if they turn fast.
    The sweeps assume constant velocities, and might also stop the corner of a fast body that only passes by.
    """
    own[(c.P + c.POINT_FIELDS * point + c.GAP) * _W] = _FAR


@compiled
def refresh_hit(t: float, h: float, world: int) -> None:
    """Recompute the arms of bodies that impacts have moved to other poses, except of points hidden from the sweeps.

    With those from before, a frictionless capsule that has hit a box changes its spin from 10.6 to 19.6 rad/s.
    """
    for g in range(rows(world, GROUPS) if rows(world, BOUNCING) > 0 else 0):
        if _is_hit(world, g):
            _refresh_hit_group(world, h, g)


@compiled
def _is_hit(world: int, g: int) -> bool:
    """Whether a body of a group has been hit in the substep."""
    groups, kicked, hit = integers(world, GROUPS), floats(world, KICKED), False
    for lane in range(lane_count(world)):
        hit = hit or kicked[groups[g, c.BODIES_A + lane], IMPACT_TIME] > 0.0
        hit = hit or kicked[groups[g, c.BODIES_B + lane], IMPACT_TIME] > 0.0
    return hit


@compiled
def _refresh_hit_group(world: int, h: float, g: int) -> None:
    own, scratch, gaps = group_of(world, g), new_scratch(), carray(floats_on_stack(_GAPS), (_GAPS,))
    n = lane_count(world)
    gather_for_arms(world, g, scratch)
    run(world, c.FIND_STALE, own, scratch, 0.0, 0.0, 0.0)
    _put_poses(world, g, scratch)
    for lane in range(n):
        _move_to_impact(world, h, g, lane, scratch)
        for k in range(4):
            gaps[4 * lane + k] = own[(c.P + c.POINT_FIELDS * k + c.GAP) * _W + lane]
    _refresh(world, h, own, scratch)
    for lane in range(n):
        for k in range(4):
            if gaps[4 * lane + k] == _FAR:
                hide_from_sweeps(own[lane:], k)
                own[c.REFERENCE * _W + lane] = c.HIT  # until they are recomputed after the drift


@compiled
def _move_to_impact(world: int, h: float, g: int, lane: int, scratch: Any) -> None:
    """Move the poses of the bodies of a lane in scratch to those of their impacts, from which on impulses act."""
    groups, kicked = integers(world, GROUPS), floats(world, KICKED)
    a, b = groups[g, c.BODIES_A + lane], groups[g, c.BODIES_B + lane]
    when = max(kicked[a, IMPACT_TIME], kicked[b, IMPACT_TIME])
    for side in range(2):
        body = b if side == 1 else a
        last = kicked[body, IMPACT_TIME] if is_moved(world, body) else when
        turned, changed = TURNED_B if side == 1 else TURNED_A, DELTA_POSE_A + 6 * side
        velocity = vector_at(floats(world, MOTION), body, ANGULAR_VELOCITY)
        way = times(last, vector_at(floats(world, MOTION), body, VELOCITY))
        if is_moved(world, body):
            way, velocity = way_to(world, h, body, last), vector_at(kicked, body, KICKED_ANGULAR_VELOCITY)
        q = scratch[turned * _W + lane :]
        turn = product(exponential(times(last, velocity)), (q[0], q[_W], q[2 * _W], q[3 * _W]))
        for k in range(4):
            scratch[(turned + k) * _W + lane] = turn[k]
        for k in range(3):
            scratch[(FROM_A_TO_B + k) * _W + lane] += way[k] if side == 1 else -way[k]
            scratch[(changed + k) * _W + lane] += way[k]
            scratch[(changed + 3 + k) * _W + lane] += last * velocity[k]


@compiled(inline=True)
def gather_for_arms(world: int, g: int, scratch: Any) -> None:
    """Copy what is needed of the bodies of every lane to recompute its arms."""
    gather(world, g, floats(world, MOTION), VELOCITY_A, scratch)
    gather(world, g, floats(world, DELTA_POSE), DELTA_POSE_A, scratch)
    gather_inertia(world, g, scratch)


@compiled
def refresh_marked(world: int, h: float, g: int, own: Any, scratch: Any) -> None:
    """Recompute the arms of the marked lanes of a group."""
    marked = 0.0
    for lane in range(lane_count(world)):
        marked += scratch[MARK * _W + lane]
    if marked == 0.0:
        return
    _put_poses(world, g, scratch)
    _refresh(world, h, own, scratch)


@compiled
def _put_poses(world: int, g: int, scratch: Any) -> None:
    """Put the rotations of the bodies of a group since the step began into scratch, and the ways between their centres."""
    pose, started, groups = floats(world, POSE), floats(world, STARTED_POSE), integers(world, GROUPS)
    for lane in range(lane_count(world)):
        a, b = groups[g, c.BODIES_A + lane], groups[g, c.BODIES_B + lane]
        _gather_turn(pose, started, a, scratch[TURNED_A * _W + lane :])
        _gather_turn(pose, started, b, scratch[TURNED_B * _W + lane :])
        for k in range(3):
            scratch[(FROM_A_TO_B + k) * _W + lane] = pose[b, POSITION + k] - pose[a, POSITION + k]


@compiled(inline=True)
def _refresh(world: int, h: float, own: Any, scratch: Any) -> None:
    turns = 0.0
    for lane in range(lane_count(world)):
        turns += own[c.TURNS * _W + lane]
    if turns > 0.0:
        run(world, c.TURN_NORMALS, own, scratch, 0.0, 0.0, 0.0)
    run(world, c.REFRESH, own, scratch, floats(world, SETTINGS)[0, SLOP], h, 0.0)
    run(world, c.REFRESH_FRICTION, own, scratch, 0.0, 1.0, 0.0)


@compiled(inline=True)
def _gather_turn(pose: Any, started: Any, body: int, scratch: Any) -> None:
    """Store the rotation of a body since the step began, a quaternion."""
    turn = product(quaternion_at(pose, body, ORIENTATION), conjugate(quaternion_at(started, body, ORIENTATION)))
    for k in range(4):
        scratch[k * _W] = turn[k]

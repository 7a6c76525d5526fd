"""Fast pairs: contacts of shapes that may pass through or by each other within a step are found at their closest approach.

Conservative advancement (Mirtich 1996): from a gap s that closes at most at a speed u that grows at most at a rate a, nothing
happens before the time t with u t + a t^2 / 2 = s.
The contact points of the step are those of the pose in which the shapes touch: they move with their bodies, and meet in that
pose. The normal is that of the shapes then.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, dot, length, minus, plus, times, turned, turned_back
from kickdrift.world.collision.body_acceleration import closing_acceleration, reach
from kickdrift.world.collision.broad_phase.search_state import TRIES
from kickdrift.world.collision.ghost_collisions import drop_ghosts
from kickdrift.world.collision.narrow_phase.manifolds import deepest, find_manifold, radius, smallest
from kickdrift.world.collision.narrow_phase.triangle_round import beside_triangle
from kickdrift.world.collision.predicted_motion import fastest_turn, next_change, path, velocity_then
from kickdrift.world.collision.shape_poses import placed_pose, pose_on_body, relative_pose
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    CONTACT_STATE,
    FAST,
    FOUND_POSE,
    NORMAL,
    ON_A,
    ON_B,
    POINT,
    POINT_SIZE,
    POINTS,
    REACHABLE,
    RECYCLED,
    SHAPE_A,
    SHAPE_B,
    TRIANGLE_INDEX,
)
from kickdrift.world.layout import BEGIN, RADIUS
from kickdrift.world.settings import MARGIN, STEP
from kickdrift.world.shapes.record import SURFACE
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, begin_of
from kickdrift.world.tables import (
    CONTACT,
    GEOMETRY,
    MANIFOLD,
    PLACE,
    SEARCH,
    SETTINGS,
    SHAPE,
    flat,
    floats,
    integers,
    rows,
)

# A round goes on by the gap at least: the end of a stick of 0.2 m at 850 rad/s, which is 20 cm from a wall at most, comes 3 m.
_ROUNDS = 1000
# Of the radius of a shape: how far from a triangle it counts as near, and the way it goes on beside its face
_PART = 0.1


@compiled
def find_impacts(t: float, h: float, world: int) -> None:
    """Find the points of the contacts that `find_points` has left out because their shapes are too fast."""
    contact, manifold, settings = integers(world, CONTACT), floats(world, MANIFOLD), floats(world, SETTINGS)
    tried = integers(world, SEARCH)[0, TRIES] > 0
    for row in range(rows(world, CONTACT)):
        if contact[row, CONTACT_STATE] & FAST and not (tried and contact[row, POINTS] != 0):
            _advance(world, row, manifold[row, RECYCLED] - settings[0, MARGIN])
    drop_ghosts(world, FAST)


@compiled
def _advance(world: int, row: int, way: float) -> None:
    """Find the points of a contact for the pose in which its shapes touch within the step; none if they do not."""
    contact, settings = integers(world, CONTACT), floats(world, SETTINGS)
    a, b = contact[row, BODY_A], contact[row, BODY_B]
    spin = _spin(world, contact[row, SHAPE_A], a) + _spin(world, contact[row, SHAPE_B], b)
    place = floats(world, PLACE)
    # Nearer than this they touch; shapes that pass at a greater distance are not hit.
    near = 1e-3 * smallest(place[contact[row, SHAPE_A], RADIUS], place[contact[row, SHAPE_B], RADIUS])
    step, pushed = settings[0, STEP], closing_acceleration(world, row)
    when, gap, on_surface = 0.0, 0.0, sort_of(world, contact[row, SHAPE_A]) == SURFACE
    ball = place[contact[row, SHAPE_B], RADIUS]
    apart = max(settings[0, MARGIN] + step * step * pushed, _PART * ball)
    floats(world, MANIFOLD)[row, REACHABLE] = settings[0, MARGIN] + way
    for _ in range(_ROUNDS):
        at, turn, turn_a = _relative(world, row, when)
        until = next_change(world, b, when, next_change(world, a, when, step))
        approach = _approach(world, a, b, when)
        left = _until_near(world, row, at, turn_a, approach, spin, pushed, apart) if on_surface else 0.0
        if left < 0.0 or (left > 0.0 and left >= until - when and until == step):
            contact[row, POINTS] = 0
            return
        if left > 0.0:
            when = min(when + left, until)
            continue
        find_manifold(world, row, at, turn, settings[0, MARGIN] + way)
        if contact[row, POINTS] == 0:
            if not on_surface or when >= step:
                return
            # Beside its face a triangle leaves contacts to its neighbours.
            when = min(when + _PART * ball / max(spin + length(approach) + step * pushed, 1e-150), until)
            continue
        gap, normal = deepest(floats(world, MANIFOLD), row, contact[row, POINTS], at, turn)
        closing = spin - dot(turned(turn_a, normal), approach)
        left = _until(gap, closing, pushed)
        if gap <= near or when >= step or (closing <= 0.0 and left >= until - when and until == step):
            break
        when = min(when + left, until)
    # Forces and other contacts may turn them away from a contact that they would otherwise have.
    if gap > max(settings[0, MARGIN], step * step * pushed):
        contact[row, POINTS] = 0
    if when > 0.0 and contact[row, POINTS] != 0:
        _bring_back(world, row, when)
        # The plane of a face that shapes approach from behind would stop them at once.
        if _gap_at_start(world, row) < -near - spin * when:
            contact[row, POINTS] = 0


@compiled
def _until_near(
    world: int, row: int, at: Vector, turn_a: Quaternion, approach: Vector, spin: float, pushed: float, apart: float
) -> float:
    """Return the time before which the ball around a shape is farther than `apart` from a triangle, s; -1.0 if it is behind.

    The manifold of a triangle and a shape that is far from it may be that of an edge that does not separate them.
    """
    ball = floats(world, PLACE)[integers(world, CONTACT)[row, SHAPE_B], RADIUS]
    out, height = beside_triangle(_triangle(world, row), at)
    distance = length(out)
    if height < -ball:
        return -1.0
    if distance - ball <= apart:
        return 0.0
    return _until(distance - ball, spin - dot(turned(turn_a, out), approach) / distance, pushed)


@compiled(inline=True)
def _until(gap: float, speed: float, pushed: float) -> float:
    """Return the time before which a gap does not close at a speed that grows at a rate; infinity if it never does."""
    root = math.sqrt(speed * speed + 2.0 * pushed * gap)
    return 2.0 * gap / (root + speed) if root + speed > 0.0 else math.inf


@compiled(inline=True)
def _approach(world: int, a: int, b: int, when: float) -> Vector:
    """Velocity of the second body relative to the first on their paths."""
    return minus(velocity_then(world, b, when), velocity_then(world, a, when))


@compiled(inline=True)
def _triangle(world: int, row: int) -> Any:
    """Return the numbers of the triangle of a contact."""
    contact = integers(world, CONTACT)
    begin = begin_of(integers(world, SHAPE)[contact[row, SHAPE_A], BEGIN], contact[row, TRIANGLE_INDEX])
    return flat(world, GEOMETRY)[begin : begin + TRIANGLE_SIZE]


@compiled
def _spin(world: int, shape: int, body: int) -> float:
    """Bound the speed of points of a shape by the rotation of its body."""
    turn = fastest_turn(world, body)
    return turn * reach(floats(world, PLACE), shape) if turn > 0.0 else 0.0


@compiled
def _placed_at(world: int, shape: int, body: int, when: float) -> tuple[Vector, Quaternion]:
    """Return the pose of a shape a time after the start of the step, on the path that its body is expected to take."""
    at, turn = path(world, body, when)
    return pose_on_body(world, shape, at, turn)


@compiled
def _relative(world: int, row: int, when: float) -> tuple[Vector, Quaternion, Quaternion]:
    """Pose of the second shape in the first's frame at a time, and the orientation of that frame."""
    contact = integers(world, CONTACT)
    a = _placed_at(world, contact[row, SHAPE_A], contact[row, BODY_A], when)
    at, turn = relative_pose(a, _placed_at(world, contact[row, SHAPE_B], contact[row, BODY_B], when))
    return at, turn, a[1]


@compiled
def _bring_back(world: int, row: int, when: float) -> None:
    """Transform the normal found for a time in the step, and the points of round shapes, to the start of the step."""
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    a, b = placed_pose(world, contact[row, SHAPE_A]), placed_pose(world, contact[row, SHAPE_B])
    frame_a, frame_b = a[1], b[1]
    _, turn, turn_a = _relative(world, row, when)
    then = vector_at(manifold, row, NORMAL)
    along = turned(turn_a, then)
    now = turned_back(frame_a, along)
    radius_a, radius_b = radius(world, contact[row, SHAPE_A]), radius(world, contact[row, SHAPE_B])
    on_a = times(radius_a, minus(now, then))
    on_b = times(-radius_b, minus(turned_back(frame_b, along), turned_back(turn, then)))
    for k in range(contact[row, POINTS]):
        p = POINT + POINT_SIZE * k
        _put(manifold, row, p + ON_A, plus(vector_at(manifold, row, p + ON_A), on_a))
        _put(manifold, row, p + ON_B, plus(vector_at(manifold, row, p + ON_B), on_b))
    _put(manifold, row, NORMAL, now)
    at, turn = relative_pose(a, b)
    _put(manifold, row, FOUND_POSE, at)
    for k in range(4):
        manifold[row, FOUND_POSE + 3 + k] = turn[k]


@compiled
def _gap_at_start(world: int, row: int) -> float:
    """Smallest gap of the points of a contact at the start of the step."""
    manifold = floats(world, MANIFOLD)
    at, turn = vector_at(manifold, row, FOUND_POSE), quaternion_at(manifold, row, FOUND_POSE + 3)
    gap, _ = deepest(manifold, row, integers(world, CONTACT)[row, POINTS], at, turn)
    return gap


@compiled(inline=True)
def _put(table: Any, row: int, column: int, vector: Vector) -> None:
    for k in range(3):
        table[row, column + k] = vector[k]

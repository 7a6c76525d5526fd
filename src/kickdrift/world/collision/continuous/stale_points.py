"""How far shapes are from where they were expected in a step, and whether points of contact found for there still count."""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, cross, dot, length, minus, plus, times, turned
from kickdrift.world.collision.body_acceleration import reach
from kickdrift.world.collision.narrow_phase.manifolds import smallest
from kickdrift.world.collision.predicted_motion import POSITION_ERROR, TURN, TURN_ERROR, end_error
from kickdrift.world.collision.shape_poses import shape_pose
from kickdrift.world.collision.shape_properties import extent_of, sort_of
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts.layout import BODY_A, BODY_B, NORMAL, ON_A, ON_B, POINT, SHAPE_A, SHAPE_B
from kickdrift.world.layout import BODY_ROW, PLACE_POSITION, PLACED_ORIENTATION, RADIUS
from kickdrift.world.shapes.record import HALF_SPACE, SURFACE
from kickdrift.world.tables import CONTACT, MANIFOLD, PLACE, PLACED, PREDICTED, SHAPE, floats, integers

# Of the radius around the smaller of two shapes: a contact farther beside its points needs a new normal. With 0.25, none of 157
# balls at 8 m/s comes 0.1 radii into another at 60 steps per second, and 2 pairs a step did without.
_ASIDE = 0.25


@compiled
def points_are_stale(world: int, row: int) -> bool:
    """Whether the points of a fast contact are not those at which its shapes have met or may still meet."""
    place, contact = floats(world, PLACE), integers(world, CONTACT)
    a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
    far = _ASIDE * smallest(place[a, RADIUS], place[b, RADIUS])
    if deviation(world, a) + deviation(world, b) > far and _aside(world, row) > far:
        return True
    return _has_turned(world, row) or _has_crossed(world, row)


@compiled
def _aside(world: int, row: int) -> float:
    """Return how far across the normal of a contact one body is from where the other expected it, m; zero on planes."""
    contact = integers(world, CONTACT)
    if sort_of(world, contact[row, SHAPE_A]) == HALF_SPACE:
        return 0.0
    turn = quaternion_at(floats(world, PLACED), contact[row, SHAPE_A], PLACED_ORIENTATION)
    normal = turned(turn, vector_at(floats(world, MANIFOLD), row, NORMAL))
    off = minus(end_error(world, contact[row, BODY_B]), end_error(world, contact[row, BODY_A]))
    across: float = length(cross(normal, off))
    return across


@compiled
def _has_turned(world: int, row: int) -> bool:
    """Whether a shape of a contact, unless it is a ball, has turned farther than was expected."""
    for side in range(2):
        shape = integers(world, CONTACT)[row, SHAPE_A + side]
        if _turn_off(world, shape) > TURN * reach(floats(world, PLACE), shape):
            return True
    return False


@compiled
def _has_crossed(world: int, row: int) -> bool:
    """Whether the middle of a shape has passed the point at which it was expected to touch the other one.

    An impact at the rim of a thin body turns it; other points of it then hit, which the contact does not know.
    """
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
    if sort_of(world, a) == HALF_SPACE:
        return False
    normal = turned(quaternion_at(floats(world, PLACED), a, PLACED_ORIENTATION), vector_at(manifold, row, NORMAL))
    at_a, turn_a = shape_pose(world, a)
    at_b, turn_b = shape_pose(world, b)
    on_a = plus(at_a, turned(turn_a, vector_at(manifold, row, POINT + ON_A)))
    on_b = plus(at_b, turned(turn_b, vector_at(manifold, row, POINT + ON_B)))
    if _is_past(world, b, at_b, turn_b, on_a, times(-1.0, normal)):
        return True
    return sort_of(world, a) != SURFACE and _is_past(world, a, at_a, turn_a, on_b, normal)


@compiled
def _is_past(world: int, shape: int, at: Vector, turn: Quaternion, point: Vector, way: Vector) -> bool:
    """Whether the middle of the bounds of a shape in a pose is past a point of contact; a ball, which no turn moves, is not."""
    if _inner_radius(world, shape) >= reach(floats(world, PLACE), shape):
        return False
    box = extent_of(world, shape, turn)
    middle = plus(at, (0.5 * (box[0] + box[3]), 0.5 * (box[1] + box[4]), 0.5 * (box[2] + box[5])))
    return dot(minus(middle, point), way) > 0.0


@compiled(inline=True)
def deviation(world: int, shape: int) -> float:
    """Bound the distance of a point of a shape from its expected position."""
    predicted, body = floats(world, PREDICTED), integers(world, SHAPE)[shape, BODY_ROW]
    off: float = predicted[body, POSITION_ERROR] + _turn_off(world, shape)
    return off


@compiled(inline=True)
def _turn_off(world: int, shape: int) -> float:
    """Bound how far a point of a shape is from its expected position since its body has turned farther than was expected, m."""
    turn, off = floats(world, PREDICTED)[integers(world, SHAPE)[shape, BODY_ROW], TURN_ERROR], 0.0
    if turn > 0.0:
        far = reach(floats(world, PLACE), shape)
        off = min(turn * far, far - _inner_radius(world, shape))
    return off


@compiled
def _inner_radius(world: int, shape: int) -> float:
    """Return the radius of a ball about the centre of mass of its body in a shape that is about as wide as high, m; or zero."""
    if length(vector_at(floats(world, PLACE), shape, PLACE_POSITION)) > 0.0:
        return 0.0
    box, inner = extent_of(world, shape, (1.0, 0.0, 0.0, 0.0)), math.inf
    for k in range(3):
        inner = min(inner, min(-box[k], box[3 + k]))
    return max(inner, 0.0)

"""Impulses of cloths on bodies; in a planar world they move in its plane only."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, cross, dot, exponential, minus, product, times
from kickdrift.world.collision.body_acceleration import acceleration
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.deformables.layout import GIVEN_CHANGE, HELD, MOST_WITHHELD, WITHHELD_CHANGE
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    DISPLACEMENT,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    ORIENTATION,
    POSITION,
    ROTATION,
    VELOCITY,
)
from kickdrift.world.settings import PLANE_NORMAL
from kickdrift.world.tables import CLOTH_LOAD, DELTA_POSE, INVERSE_MASS, MOTION, POSE, SETTINGS, floats


@compiled(inline=True)
def mutual_response(world: int, body: int, arm: Vector, other_arm: Vector, n: Vector) -> float:
    """Return the change of velocity of a point of a body along n by a unit impulse along n at another one, 1/kg."""
    inverse = floats(world, INVERSE_MASS)
    turn = applied(symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD), cross(other_arm, n))
    way = _within_plane(world, n)
    response: float = inverse[body, INVERSE_LINEAR_MASS] * dot(way, way) + dot(cross(arm, n), turn)
    return response


@compiled
def response_to_load(world: int, body: int, arm: Vector, d: Vector, n: Vector) -> float:
    """Return the change of velocity of a point of a body along n by a unit impulse along n, 1/kg.

    The body is loaded along the unit vector d; what its contacts hold of that is left out.
    """
    inverse = floats(world, INVERSE_MASS)
    way, torque = _free(world, body, 0, d, _within_plane(world, n)), _free(world, body, 3, d, cross(arm, n))
    turn = applied(symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD), torque)
    response: float = inverse[body, INVERSE_LINEAR_MASS] * dot(way, way) + dot(torque, turn)
    return response


@compiled(inline=True)
def _free(world: int, body: int, first: int, d: Vector, v: Vector) -> Vector:
    """Return a vector without what contacts hold of it in a body that is loaded along d; `first` is 3 for a rotation.

    They hold no loads against gravity and forces.
    """
    load = floats(world, CLOTH_LOAD)
    x, y, z = vector_at(load, body, HELD + first)
    withheld, most = vector_at(load, body, WITHHELD_CHANGE), load[body, MOST_WITHHELD]
    part = 1.0 if dot(d, acceleration(world, body)) >= 0.0 and dot(withheld, withheld) <= most * most else 0.0
    return (1.0 - part * x) * v[0], (1.0 - part * y) * v[1], (1.0 - part * z) * v[2]


@compiled
def push_body(world: int, body: int, arm: Vector, impulse: Vector, left: float) -> None:
    """Apply an impulse to a body at a point, `arm` from its centre of mass."""
    inverse = floats(world, INVERSE_MASS)
    shift = times(inverse[body, INVERSE_LINEAR_MASS], _within_plane(world, impulse))
    turn = applied(symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD), cross(arm, impulse))
    move_on(world, body, shift, turn, left)


@compiled
def load_body(world: int, body: int, arm: Vector, d: Vector, impulse: Vector, left: float) -> None:
    """Apply an impulse to a body that is loaded along d; what its contacts hold acts in the next substep."""
    inverse, load = floats(world, INVERSE_MASS), floats(world, CLOTH_LOAD)
    inverse_mass, inertia = inverse[body, INVERSE_LINEAR_MASS], symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD)
    whole, torque = times(inverse_mass, _within_plane(world, impulse)), cross(arm, impulse)
    shift = _free(world, body, 0, d, _free(world, body, 0, d, whole))
    turn = _free(world, body, 3, d, applied(inertia, _free(world, body, 3, d, torque)))
    held = minus(whole, shift), minus(applied(inertia, torque), turn)
    for k in range(3):
        load[body, GIVEN_CHANGE + k] += shift[k]
        load[body, GIVEN_CHANGE + 3 + k] += turn[k]
        load[body, WITHHELD_CHANGE + k] += held[0][k]
        load[body, WITHHELD_CHANGE + 3 + k] += held[1][k]
    move_on(world, body, shift, turn, left)


@compiled
def move_on(world: int, body: int, shift: Vector, turn: Vector, left: float) -> None:
    """Add to the velocity and the angular velocity of a body, and move it with these for the time `left`, s.

    The body has drifted through the substep already. If the changes acted on its pose in the next substep only, a load on
    a spring of cloth would gain energy: a lag of h / 2 is a negative damping.
    """
    shift = _within_plane(world, shift)
    motion = floats(world, MOTION)
    for k in range(3):
        motion[body, VELOCITY + k] += shift[k]
        motion[body, ANGULAR_VELOCITY + k] += turn[k]
    displace(world, body, times(left, shift), times(left, turn))


@compiled
def displace(world: int, body: int, way: Vector, turn: Vector) -> None:
    """Move a body by a displacement, m, and a rotation, rad."""
    way = _within_plane(world, way)
    pose, delta = floats(world, POSE), floats(world, DELTA_POSE)
    for k in range(3):
        pose[body, POSITION + k] += way[k]
        delta[body, DISPLACEMENT + k] += way[k]
        delta[body, ROTATION + k] += turn[k]
    q = product(exponential(turn), quaternion_at(pose, body, ORIENTATION))
    for k in range(4):
        pose[body, ORIENTATION + k] = q[k]


@compiled(inline=True)
def _within_plane(world: int, v: Vector) -> Vector:
    """Return the part of a vector along the plane of a planar world; otherwise its normal is zero, and this is the vector."""
    n = vector_at(floats(world, SETTINGS), 0, PLANE_NORMAL)
    return minus(v, times(dot(n, v), n))

"""Gathers what round shapes add to the data of a constraint: axes about which impulses have no torque, and cores."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, dot, length, minus
from kickdrift.world.collision.shape_poses import placed_pose
from kickdrift.world.collision.shape_properties import core_of
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts import prepare_simd as r
from kickdrift.world.contacts.constraint_groups import put_vector_of
from kickdrift.world.contacts.round_cores import are_parallel, half_axis, spin_axis
from kickdrift.world.layout import ANGULAR_VELOCITY, FRICTION, INVERSE_LINEAR_MASS, POSITION
from kickdrift.world.material_mixing import mixed_friction
from kickdrift.world.shapes.closest_points import segments
from kickdrift.world.shapes.record import CENTRE
from kickdrift.world.tables import CONTACT, INVERSE_MASS, MOTION, PLACE, POSE, floats, integers

# Sine of the angle between two axes below which frictionless capsules touch at two points: with one, a pile of parallel ones
# that lies between walls would yaw and fall.
_SIDE_BY_SIDE = 0.02


@compiled(inline=True)
def gather_spin_axis(world: int, row: int, raw: Any) -> None:
    """Gather the axis of a solid of revolution that touches a body that cannot turn; zeros otherwise.

    Between two bodies that move, an impulse without torque about the axis of one would change their angular momentum.
    """
    contact, axis = integers(world, CONTACT), (0.0, 0.0, 0.0)
    fixed_a, fixed_b = _cannot_turn(world, contact[row, c.BODY_A]), _cannot_turn(world, contact[row, c.BODY_B])
    if fixed_a or fixed_b:
        side = int(fixed_a)
        shape, body = contact[row, c.SHAPE_A + side], contact[row, c.BODY_A + side]
        at, turn = placed_pose(world, shape)
        axis = spin_axis(world, shape, turn, minus(at, vector_at(floats(world, POSE), body, POSITION)))
    put_vector_of(raw, r.SPIN_AXIS, axis)


@compiled(inline=True)
def _cannot_turn(world: int, body: int) -> bool:
    """Whether impulses do not move a body, and it does not turn."""
    w = vector_at(floats(world, MOTION), body, ANGULAR_VELOCITY)
    return bool(floats(world, INVERSE_MASS)[body, INVERSE_LINEAR_MASS] == 0.0 and dot(w, w) == 0.0)


@compiled(inline=True)
def gather_cores(world: int, row: int, turn_a: Quaternion, turn_b: Quaternion, between: Vector, raw: Any) -> None:
    """Gather the half axes of the cores of balls and capsules, and whether the normal turns with the direction between them.

    `between` is the vector between their middles. Capsules without friction that are not side by side touch at one point
    whatever is listed: at others, impulses would have a torque about their axes.
    """
    contact, place = integers(world, CONTACT), floats(world, PLACE)
    a, b, moving = contact[row, c.SHAPE_A], contact[row, c.SHAPE_B], contact[row, c.CONTACT_STATE] & (c.MOVING | c.FAST)
    raw[r.TURNS * c.WIDTH] = 0.0
    if moving == 0 or core_of(world, a) != CENTRE or core_of(world, b) != CENTRE:
        return
    # With friction, piles of parallel capsules whose normals turned would creep at 1e-7 m/s, and never come to rest.
    smooth = mixed_friction(place[a, FRICTION], place[b, FRICTION]) == 0.0
    if contact[row, c.POINTS] > 1 and not smooth:
        return
    half_a, half_b = half_axis(world, a, turn_a), half_axis(world, b, turn_b)
    raw[r.TURNS * c.WIDTH] = 1.0
    if contact[row, c.POINTS] > 1 and not are_parallel(half_a, half_b, _SIDE_BY_SIDE):
        on_a, on_b = segments(between, half_a, half_b)
        raw[(r.ON_A + 2) * c.WIDTH], raw[(r.ON_B + 2) * c.WIDTH] = on_a * length(half_a), on_b * length(half_b)
        raw[r.COUNT * c.WIDTH] = 1.0
        raw[r.IMPULSE * c.WIDTH] += raw[(r.IMPULSE + 1) * c.WIDTH]
        raw[(r.IMPULSE + 1) * c.WIDTH] = 0.0
    put_vector_of(raw, r.HALF_A, half_a)
    put_vector_of(raw, r.HALF_B, half_b)

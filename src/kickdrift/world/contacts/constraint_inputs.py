"""Gathers the data of the constraint of one contact from the tables, for `kickdrift.world.contacts.prepare_simd`."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    Quaternion,
    Vector,
    conjugate,
    cross,
    dot,
    minus,
    plus,
    product,
    times,
    turned,
    turned_back,
)
from kickdrift.world.collision.body_acceleration import RESTING_SUBSTEPS, weight_per_mass
from kickdrift.world.collision.narrow_phase.manifolds import radius, smallest
from kickdrift.world.collision.shape_poses import placed_pose
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts import prepare_simd as r
from kickdrift.world.contacts.effective_mass_simd import SLIP_STRICTNESS, TWIST_STRICTNESS
from kickdrift.world.contacts.planar_contacts import flatten_contact
from kickdrift.world.contacts.round_cores import RollingCore, radius_at, rolling_core, rolls
from kickdrift.world.contacts.round_inputs import gather_cores, gather_spin_axis
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    BODY_ROW,
    FRICTION,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    ORIENTATION,
    POSITION,
    RADIUS,
    SURFACE_VELOCITY,
)
from kickdrift.world.material_mixing import mixed_friction, mixed_rolling_resistance
from kickdrift.world.settings import PLANE_NORMAL, STEP, SUBSTEPS
from kickdrift.world.tables import (
    CONTACT,
    INVERSE_MASS,
    MANIFOLD,
    MOTION,
    PLACE,
    POSE,
    SETTINGS,
    SHAPE,
    floats,
    integers,
)

# Arms are recomputed if bodies turn or slide past each other faster than _STILL, in half widths of their common face per
# second.
# Bodies that creep keep the arms with which they came to rest, until these are wrong by more than _CREEP of them: contacts of
# a tall stack are soft, and with arms that follow every lean it would bend like a soft rod, and fall. Contacts at edges and
# points have no width, and round shapes roll: their arms always follow.
_STILL, _CREEP = 1.2, 0.2
_ROUNDING = 1e-9  # of the size of the smaller shape: motion below this is rounding


@compiled
def gather(world: int, row: int, soft: Vector, softer: Vector, raw: Any, scratch: Any) -> None:
    """Gather the data of the constraint of one contact: field k goes to raw[k WIDTH], or scratch[k WIDTH].

    `soft` and `softer` are the softness of contacts with immovable and with movable bodies.
    """
    contact, manifold, pose = integers(world, CONTACT), floats(world, MANIFOLD), floats(world, POSE)
    shape_a, shape_b = contact[row, c.SHAPE_A], contact[row, c.SHAPE_B]
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    at_a, turn_a = placed_pose(world, shape_a)
    at_b, turn_b = placed_pose(world, shape_b)
    centre_a, centre_b = vector_at(pose, a, POSITION), vector_at(pose, b, POSITION)
    arm_a, arm_b, apart = minus(at_a, centre_a), minus(at_b, centre_b), minus(centre_b, centre_a)
    normal = vector_at(manifold, row, c.NORMAL)
    along, width = turned(turn_a, normal), float(manifold[row, c.WIDTH_OF_FACE])
    # Height of the contact above the farther of both centres, along the normal
    arm = plus(arm_a, turned(turn_a, vector_at(manifold, row, c.POINT)))
    height = max(abs(dot(along, arm)), abs(dot(along, minus(arm, apart))))
    step, motion = floats(world, SETTINGS)[0, STEP], floats(world, MOTION)
    turning_a, turning_b = vector_at(motion, a, ANGULAR_VELOCITY), vector_at(motion, b, ANGULAR_VELOCITY)
    back = turned_back(quaternion_at(manifold, row, c.FOUND_POSE + 3), normal)
    round_a = rolling_core(world, shape_a, radius(world, shape_a), turn_a, normal, along, times(step, turning_a))
    round_b = rolling_core(
        world, shape_b, radius(world, shape_b), turn_b, times(-1.0, back), along, times(step, turning_b)
    )
    width = 0.0 if rolls(round_a) or rolls(round_b) else width
    moves = width == 0.0 or contact[row, c.CONTACT_STATE] & (c.MOVING | c.FAST) != 0
    turned_a, turned_b, lay = _frames_of_arms(world, row, moves, turn_a, turn_b, along, arm, apart, max(height, width))
    along = turned(turned_a, along)
    if rolls(round_a) and not rolls(round_b):  # the normal turns with the shape that is not round
        along = turned(turn_b, back)
    for k in range(4):
        scratch[(r.TURNED_A + k) * c.WIDTH], scratch[(r.TURNED_B + k) * c.WIDTH] = turned_a[k], turned_b[k]
        raw[(r.TURN_A + k) * c.WIDTH], raw[(r.TURN_B + k) * c.WIDTH] = turn_a[k], turn_b[k]
    for k in range(3):
        raw[(r.NORMAL + k) * c.WIDTH] = along[k]
        raw[(r.ARM_A + k) * c.WIDTH], raw[(r.ARM_B + k) * c.WIDTH] = arm_a[k], arm_b[k]
        raw[(r.APART + k) * c.WIDTH], scratch[(r.FROM_A_TO_B + k) * c.WIDTH] = apart[k], lay[k]
        raw[(r.TURNING_A + k) * c.WIDTH], raw[(r.TURNING_B + k) * c.WIDTH] = turning_a[k], turning_b[k]
    gather_spin_axis(world, row, raw)
    _gather_points(world, row, round_a, round_b, raw)
    gather_cores(world, row, turn_a, turn_b, plus(apart, minus(arm_b, arm_a)), raw)
    _gather_masses(world, a, b, raw, scratch)
    weight = max(weight_per_mass(world, a), weight_per_mass(world, b))
    raw[r.LANDING * c.WIDTH] = RESTING_SUBSTEPS * step / floats(world, SETTINGS)[0, SUBSTEPS] * weight
    _gather_surfaces(world, row, soft, softer, raw)
    raw[r.SHARE * c.WIDTH] = _share(rolls(round_a), rolls(round_b), raw[r.MASS_A * c.WIDTH], raw[r.MASS_B * c.WIDTH])
    place = floats(world, PLACE)
    least = _ROUNDING * smallest(place[shape_a, RADIUS], place[shape_b, RADIUS])
    still = max(_STILL * step * width, least)
    raw[(r.STALE + 1) * c.WIDTH] = still
    raw[r.STALE * c.WIDTH] = still / max(height, width + least)
    plane = vector_at(floats(world, SETTINGS), 0, PLANE_NORMAL)
    if dot(plane, plane) > 0.0:
        raw[r.TURNS * c.WIDTH] = 0.0
        flatten_contact(raw, plane)


@compiled(inline=True)
def _frames_of_arms(
    world: int,
    row: int,
    moves: bool,
    turn_a: Quaternion,
    turn_b: Quaternion,
    normal: Vector,
    arm: Vector,
    apart: Vector,
    reach: float,
) -> tuple[Quaternion, Quaternion, Vector]:
    """Return the turns of both bodies from now to when their arms were set, and the vector between their centres then.

    Contacts that move, or have crept too far, set their arms anew.
    """
    manifold = floats(world, MANIFOLD)
    if not moves:
        lay = vector_at(manifold, row, c.REST_APART)
        turned_a = product(quaternion_at(manifold, row, c.REST_A), conjugate(turn_a))
        turned_b = product(quaternion_at(manifold, row, c.REST_B), conjugate(turn_b))
        error = _arm_error(turned_a, turned_b, minus(lay, apart), arm, apart, normal, reach)
        if error <= (_CREEP * manifold[row, c.WIDTH_OF_FACE]) ** 2:
            return turned_a, turned_b, lay
    for k in range(4):
        manifold[row, c.REST_A + k], manifold[row, c.REST_B + k] = turn_a[k], turn_b[k]
    for k in range(3):
        manifold[row, c.REST_APART + k] = apart[k]
    return (1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), apart


@compiled(inline=True)
def _gather_points(world: int, row: int, round_a: RollingCore, round_b: RollingCore, raw: Any) -> None:
    """Gather the points of a contact, on the cores of round shapes, and the impulses with which it begins."""
    manifold, points = floats(world, MANIFOLD), integers(world, CONTACT)[row, c.POINTS]
    raw[r.COUNT * c.WIDTH] = points
    for k in range(4):
        p, at = c.POINT + c.POINT_SIZE * k, c.ANCHOR_SIZE * k
        on_a, on_b = vector_at(manifold, row, p + c.ON_A), vector_at(manifold, row, p + c.ON_B)
        radius_a, radius_b = radius_at(round_a, on_a), radius_at(round_b, on_b)
        on_a, on_b = minus(on_a, times(radius_a, round_a[2])), minus(on_b, times(radius_b, round_b[2]))
        for j in range(3):
            raw[(r.ON_A + at + j) * c.WIDTH] = on_a[j] if k < points else 0.0
            raw[(r.ON_B + at + j) * c.WIDTH] = on_b[j] if k < points else 0.0
        raw[(r.RADII + at) * c.WIDTH], raw[(r.RADII + at + 1) * c.WIDTH] = radius_a, radius_b
        raw[(r.IMPULSE + k) * c.WIDTH] = manifold[row, c.NORMAL_IMPULSE + k] if k < points else 0.0
    keep = 0.0 if integers(world, CONTACT)[row, c.CONTACT_STATE] & c.JUST_LANDED else 1.0
    for k in range(3):
        raw[(r.FRICTION_IMPULSE + k) * c.WIDTH] = keep * manifold[row, c.FRICTION_IMPULSE + k]
        raw[(r.ROLLED + k) * c.WIDTH] = manifold[row, c.ROLLING_IMPULSE + k]
        raw[(r.AXIS_A + k) * c.WIDTH], raw[(r.AXIS_B + k) * c.WIDTH] = round_a[1][k], round_b[1][k]
    raw[r.TWISTED * c.WIDTH] = keep * manifold[row, c.TWIST_IMPULSE]


@compiled(inline=True)
def _gather_masses(world: int, a: int, b: int, raw: Any, scratch: Any) -> None:
    """Gather the inverse masses and inertias of both bodies."""
    inverse_mass = floats(world, INVERSE_MASS)
    raw[r.MASS_A * c.WIDTH], raw[r.MASS_B * c.WIDTH] = (
        inverse_mass[a, INVERSE_LINEAR_MASS],
        inverse_mass[b, INVERSE_LINEAR_MASS],
    )
    for k in range(6):
        scratch[(r.INERTIA_A + k) * c.WIDTH] = inverse_mass[a, INVERSE_INERTIA_IN_WORLD + k]
        scratch[(r.INERTIA_B + k) * c.WIDTH] = inverse_mass[b, INVERSE_INERTIA_IN_WORLD + k]


@compiled(inline=True)
def _gather_surfaces(world: int, row: int, soft: Vector, softer: Vector, raw: Any) -> None:
    """Gather what the surfaces of both shapes are like: friction, rolling resistance, velocity and softness."""
    contact, place = integers(world, CONTACT), floats(world, PLACE)
    a, b = contact[row, c.SHAPE_A], contact[row, c.SHAPE_B]
    raw[r.FRICTION * c.WIDTH] = mixed_friction(place[a, FRICTION], place[b, FRICTION])
    raw[r.RESISTANCE * c.WIDTH] = mixed_rolling_resistance(world, a, b)
    fixed = raw[r.MASS_A * c.WIDTH] == 0.0 or raw[r.MASS_B * c.WIDTH] == 0.0
    slide_a, slide_b = _surface_velocity(world, a), _surface_velocity(world, b)
    for k in range(3):
        raw[(r.SURFACE_SLIP + k) * c.WIDTH] = slide_a[k] - slide_b[k]
        raw[(r.SOFTNESS + k) * c.WIDTH] = soft[k] if fixed else softer[k]


@compiled(inline=True)
def _arm_error(
    turned_a: Quaternion, turned_b: Quaternion, slid: Vector, arm: Vector, apart: Vector, normal: Vector, reach: float
) -> float:
    """Return the square of the error of arms, m^2, after the given turns of the bodies and the slide between them.

    `arm` is that of the first body, `apart` the vector from its centre to that of the second.
    """
    tilt_a = times(math.copysign(2.0, turned_a[0]), (turned_a[1], turned_a[2], turned_a[3]))
    tilt_b = times(math.copysign(2.0, turned_b[0]), (turned_b[1], turned_b[2], turned_b[3]))
    slid = minus(plus(slid, cross(tilt_b, minus(arm, apart))), cross(tilt_a, arm))
    along, twist_a, twist_b = dot(normal, slid), dot(normal, tilt_a), dot(normal, tilt_b)
    turn = max(dot(tilt_a, tilt_a), dot(tilt_b, tilt_b)) + TWIST_STRICTNESS**2 * max(
        twist_a * twist_a, twist_b * twist_b
    )
    return SLIP_STRICTNESS**2 * (dot(slid, slid) - along * along) + turn * reach * reach


@compiled(inline=True)
def _share(rolls_a: bool, rolls_b: bool, lightness_a: float, lightness_b: float) -> float:
    """Return where the contact is between the first body's point, 0, and the second's, 1, if they have slid past each other.

    It moves with a round shape, whatever that rolls on; otherwise with the lighter body, on which an error of the arm has more
    effect.
    """
    if rolls_a != rolls_b:
        return 0.0 if rolls_a else 1.0
    return lightness_b / (lightness_a + lightness_b + 1e-300)


@compiled(inline=True)
def _surface_velocity(world: int, shape: int) -> Vector:
    """Return the surface velocity of a shape in the world's axes, m/s."""
    place, pose = floats(world, PLACE), floats(world, POSE)
    s = SURFACE_VELOCITY
    velocity = (place[shape, s], place[shape, s + 1], place[shape, s + 2])
    if velocity[0] == 0.0 and velocity[1] == 0.0 and velocity[2] == 0.0:
        return velocity
    body = integers(world, SHAPE)[shape, BODY_ROW]
    return turned(quaternion_at(pose, body, ORIENTATION), velocity)

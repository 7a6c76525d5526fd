"""Points of a round of impacts: what is known of them, their speeds, and impulses on their bodies."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, cross, dot, length, minus, plus, times
from kickdrift.world.columns import Fields, column, point_at, symmetric_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import constraint, vector_of
from kickdrift.world.contacts.impacts.moved_contacts import (
    meeting_arms,
    meets_at_one_point,
    normal_between,
    place_now,
    torque_arm,
)
from kickdrift.world.impulses import push_body
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    IMPACT_TIME,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    VELOCITY,
)
from kickdrift.world.settings import SLOP
from kickdrift.world.tables import CONTACT, IMPACT, INVERSE_MASS, KICKED, MOTION, SETTINGS, floats, integers

# Numbers of a point that hits
_POINT = Fields()
TURN_A = _POINT.field(3, "m")  # arm x normal
TURN_B = _POINT.field(3, "m")
WANTED = _POINT.field(1, "m/s")  # normal velocity after the impact
IMPULSE = _POINT.field(1, "N s")
PLASTIC = _POINT.field(1, "N s")  # impulse that stops it; negative if it does not hit
POINT_SIZE = _POINT.close()

# Columns of IMPACT
ROW = column(IMPACT)  # of the contact
LISTED = column(IMPACT)  # row of the contact in `BOUNCING`
TIME = column(IMPACT, 1, "s")  # when the first of its points hits
SPEED = column(IMPACT, 1, "m/s")  # of that point
APPROACH = column(IMPACT, 1, "m/s")  # its speed where the impulse acts: half way between its two points
BOUNCE = column(IMPACT)  # coefficient of restitution e
ARM_A = column(IMPACT, 3, "m")  # from the centres of both bodies to the centre of the contact
ARM_B = column(IMPACT, 3, "m")
INVERSE_RESPONSE = column(IMPACT, 3, "kg")  # inverse of the response to friction
FRICTION = column(IMPACT, 2, "N s")
BOUND = column(IMPACT, 1, "N s")  # of friction
IMPACT_POINTS = column(IMPACT, 4 * POINT_SIZE)
TIMES = column(IMPACT, 4, "s")  # when the points hit
NORMAL = column(IMPACT, 3)
TANGENT = column(IMPACT, 3)  # the first

STOPPING, RUBBING, THROWING = 0, 1, 2  # parts of a round: impulses that stop, friction, impulses after restitution


@compiled(inline=True)
def bodies_of(world: int, hit: Any) -> tuple[int, int]:
    """Return the rows of the bodies of an impact."""
    contact, row = integers(world, CONTACT), int(hit[ROW])
    return contact[row, c.BODY_A], contact[row, c.BODY_B]


@compiled(inline=True)
def point_of(hit: Any, k: int) -> Any:
    """Return the numbers of a point of an impact."""
    return hit[IMPACT_POINTS + POINT_SIZE * k : IMPACT_POINTS + POINT_SIZE * (k + 1)]


@compiled(inline=True)
def is_left_out(point: Any, part: int) -> bool:
    """Whether a point takes no part in a part of a round: it does not hit, or has no impulse that friction could change."""
    left_out: bool = point[PLASTIC] < 0.0 or (part == RUBBING and point[PLASTIC] == 0.0)
    return left_out


@compiled
def meet(world: int, hit: Any, least: float) -> None:
    """Write arms and target velocities of a contact whose bodies are at their impact; points slower than `least` do not hit."""
    row, kicked, (a, b) = int(hit[ROW]), floats(world, KICKED), bodies_of(world, hit)
    own = constraint(world, row)
    when = max(kicked[a, IMPACT_TIME], kicked[b, IMPACT_TIME])
    place_a, place_b = place_now(world, a, when), place_now(world, b, when)
    normal, _ = normal_between(world, row, own, place_a, place_b)
    first = minus(vector_of(own, c.T), times(dot(normal, vector_of(own, c.T)), normal))
    first = times(1.0 / length(first), first)
    put_vector(hit, NORMAL, normal)
    put_vector(hit, TANGENT, first)
    near, single = 0.1 * floats(world, SETTINGS)[0, SLOP], meets_at_one_point(world, row, own, place_a, place_b)
    centre_a, centre_b, found, hit[APPROACH] = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0
    for k in range(4):
        point = point_of(hit, k)
        point[PLASTIC] = -1.0
        if not (hit[TIMES + k] - when) * hit[SPEED] <= near or (single and found > 0.0):
            continue
        arm_a, arm_b, gap = meeting_arms(world, row, own, k, normal, place_a, place_b)
        if gap > near:  # it has hit before, and has separated
            continue
        put_vector(point, TURN_A, torque_arm(own, place_a, arm_a, normal))
        put_vector(point, TURN_B, torque_arm(own, place_b, arm_b, normal))
        speed = separating_speed(world, hit, point)
        hit[APPROACH] = max(hit[APPROACH], -speed)
        if speed < -least:
            point[WANTED], point[IMPULSE], point[PLASTIC] = -hit[BOUNCE] * speed, 0.0, 0.0
            centre_a, centre_b, found = plus(centre_a, arm_a), plus(centre_b, arm_b), found + 1.0
    put_vector(hit, ARM_A, times(1.0 / max(found, 1.0), centre_a))
    put_vector(hit, ARM_B, times(1.0 / max(found, 1.0), centre_b))
    second = cross(normal, first)
    k11, k22 = _response(world, hit, first, first), _response(world, hit, second, second)
    k12 = _response(world, hit, first, second)
    scale = 1.0 / (k11 * k22 - k12 * k12)
    put_vector(hit, INVERSE_RESPONSE, (scale * k22, scale * k11, -scale * k12))
    hit[FRICTION], hit[FRICTION + 1] = 0.0, 0.0


@compiled(inline=True)
def put_vector(array: Any, at: int, vector: Vector) -> None:
    """Write a vector into the numbers from `at` on."""
    array[at], array[at + 1], array[at + 2] = vector


@compiled
def _response(world: int, hit: Any, along: Vector, other: Vector) -> float:
    """Return the change of relative velocity along a direction at the centre by a unit impulse along another, 1/kg."""
    inverse_mass, (a, b) = floats(world, INVERSE_MASS), bodies_of(world, hit)
    arm_a, arm_b = point_at(hit, ARM_A), point_at(hit, ARM_B)
    inverse_a = symmetric_at(inverse_mass, a, INVERSE_INERTIA_IN_WORLD)
    inverse_b = symmetric_at(inverse_mass, b, INVERSE_INERTIA_IN_WORLD)
    linear: float = (inverse_mass[a, INVERSE_LINEAR_MASS] + inverse_mass[b, INVERSE_LINEAR_MASS]) * dot(along, other)
    turned_a: float = dot(cross(arm_a, along), applied(inverse_a, cross(arm_a, other)))
    turned_b: float = dot(cross(arm_b, along), applied(inverse_b, cross(arm_b, other)))
    return linear + turned_a + turned_b


@compiled(inline=True)
def separating_speed(world: int, hit: Any, point: Any) -> float:
    """Return the normal velocity at which a point of b separates from a, m/s."""
    motion, (a, b) = floats(world, MOTION), bodies_of(world, hit)
    linear = dot(point_at(hit, NORMAL), minus(vector_at(motion, b, VELOCITY), vector_at(motion, a, VELOCITY)))
    speed: float = linear + dot(point_at(point, TURN_B), vector_at(motion, b, ANGULAR_VELOCITY))
    return speed - dot(point_at(point, TURN_A), vector_at(motion, a, ANGULAR_VELOCITY))


@compiled(inline=True)
def missing_speed(world: int, hit: Any, point: Any, part: int) -> float:
    """Return by how much the normal velocity of a point misses its target in a part of a round, m/s."""
    missing: float = (point[WANTED] if part == THROWING else 0.0) - separating_speed(world, hit, point)
    return missing


@compiled(inline=True)
def apply_impulse(world: int, hit: Any, impulse: Vector, turn_a: Vector, turn_b: Vector) -> None:
    """Apply an impulse to b and its opposite to a, with the angular impulses `turn_b` and -`turn_a`."""
    a, b = bodies_of(world, hit)
    push_body(world, a, times(-1.0, impulse), times(-1.0, turn_a))
    push_body(world, b, impulse, turn_b)


@compiled(inline=True)
def press(world: int, hit: Any, point: Any, impulse: float) -> None:
    """Add an impulse along the normal at a point, N s."""
    point[IMPULSE] += impulse
    turn_a, turn_b = times(impulse, point_at(point, TURN_A)), times(impulse, point_at(point, TURN_B))
    apply_impulse(world, hit, times(impulse, point_at(hit, NORMAL)), turn_a, turn_b)


@compiled
def normal_impulse(hit: Any) -> float:
    """Return the sum of the normal impulses of a contact, N s."""
    total = 0.0
    for k in range(4):
        point = point_of(hit, k)
        total += point[IMPULSE] if point[PLASTIC] >= 0.0 else 0.0
    return total

"""The impulses of a round of impacts, found for all of its points simultaneously.

First the plastic impulses, with which no point approaches any more; then friction, which minimises the energy within Coulomb's
bound, with corrections of the normal impulses that keep the points at rest along the normal; then the impulses of restitution.
In this order no impact adds energy, whatever e and friction, while Newton's rule holds exactly: friction acts on the part of
the motion that restitution leaves alone. After A. Chatterjee and A. Ruina, "A New Algebraic Rigid-Body Collision Law Based on
Impulse Space Considerations" (1998). Newton's rule with independent friction can add energy (Kane's paradox).
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, cross, dot, length, minus, plus, times
from kickdrift.world.columns import Fields, column, symmetric_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.active_impacts import begin_sweeps, may_change, note_change
from kickdrift.world.contacts.impact_motion import arms_now, constraint, normal_at, vector_of
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    IMPACT_TIME,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    VELOCITY,
)
from kickdrift.world.settings import SLOP
from kickdrift.world.tables import CONTACT, IMPACT, INVERSE_MASS, KICKED, MOTION, SETTINGS, floats, integers, rows

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
TIME = column(IMPACT, 1, "s")  # when the first of its points hits
SPEED = column(IMPACT, 1, "m/s")  # of that point
BOUNCE = column(IMPACT)  # coefficient of restitution e
ARM_A = column(IMPACT, 3, "m")  # from the centres of both bodies to the centre of the contact
ARM_B = column(IMPACT, 3, "m")
GRIP = column(IMPACT, 3, "kg")  # inverse of the response to friction
FRICTION = column(IMPACT, 2, "N s")
BOUND = column(IMPACT, 1, "N s")  # of friction
IMPACT_POINTS = column(IMPACT, 4 * POINT_SIZE)
TIMES = column(IMPACT, 4, "s")  # when the points hit
NORMAL = column(IMPACT, 3)
TANGENT = column(IMPACT, 3)  # the first
_BOUNDS = 4  # iterations of friction, each bounded by the normal impulses that the last one has left
_TOLERANCE = 1e-15  # of the largest impulse
_PLASTIC, _FRICTION, _THROWN = (
    0,
    1,
    2,
)  # parts of the impulses of a round: those that stop, friction, those after restitution


@compiled
def meet(world: int, hit: Any, least: float) -> None:
    """Write arms and target velocities of a contact whose bodies are at their impact; points slower than `least` do not hit."""
    row, kicked, contact = int(hit[ROW]), floats(world, KICKED), integers(world, CONTACT)
    a, b, own = contact[row, c.BODY_A], contact[row, c.BODY_B], constraint(world, row)
    when = max(kicked[a, IMPACT_TIME], kicked[b, IMPACT_TIME])
    normal = normal_at(world, row, own, when)
    first = minus(vector_of(own, c.T), times(dot(normal, vector_of(own, c.T)), normal))
    first = times(1.0 / length(first), first)
    _put(hit, NORMAL, normal)
    _put(hit, TANGENT, first)
    near, share = 0.1 * floats(world, SETTINGS)[0, SLOP], own[c.SHARE * c.WIDTH]
    centre_a, centre_b, found = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0
    for k in range(4):
        hit[IMPACT_POINTS + POINT_SIZE * k + PLASTIC] = -1.0
        if not (hit[TIMES + k] - when) * hit[SPEED] <= near:
            continue
        point = hit[IMPACT_POINTS + POINT_SIZE * k : IMPACT_POINTS + POINT_SIZE * (k + 1)]
        arm_a, arm_b, between = arms_now(world, row, own, k, when, normal)
        if dot(normal, between) > near:  # it has hit before, and has separated
            continue
        arm_a, arm_b = plus(arm_a, times(share, between)), minus(arm_b, times(1.0 - share, between))
        _put(point, TURN_A, cross(arm_a, normal))
        _put(point, TURN_B, cross(arm_b, normal))
        speed = _speed(world, a, b, normal, point)
        if speed < -least:
            point[WANTED], point[IMPULSE], point[PLASTIC] = -hit[BOUNCE] * speed, 0.0, 0.0
            centre_a, centre_b, found = plus(centre_a, arm_a), plus(centre_b, arm_b), found + 1.0
    _put(hit, ARM_A, times(1.0 / max(found, 1.0), centre_a))
    _put(hit, ARM_B, times(1.0 / max(found, 1.0), centre_b))
    second = cross(normal, first)
    k11, k22 = _response(world, a, b, hit, first, first), _response(world, a, b, hit, second, second)
    k12 = _response(world, a, b, hit, first, second)
    scale = 1.0 / (k11 * k22 - k12 * k12)
    _put(hit, GRIP, (scale * k22, scale * k11, -scale * k12))
    hit[FRICTION], hit[FRICTION + 1] = 0.0, 0.0


@compiled(inline=True)
def _put(array: Any, at: int, vector: Vector) -> None:
    array[at], array[at + 1], array[at + 2] = vector


@compiled(inline=True)
def _at(array: Any, at: int) -> Vector:
    return (array[at], array[at + 1], array[at + 2])


@compiled
def _response(world: int, a: int, b: int, hit: Any, along: Vector, other: Vector) -> float:
    """Return the change of relative velocity along a direction at the centre by a unit impulse along another, 1/kg."""
    inverse_mass = floats(world, INVERSE_MASS)
    arm_a, arm_b = _at(hit, ARM_A), _at(hit, ARM_B)
    inverse_a = symmetric_at(inverse_mass, a, INVERSE_INERTIA_IN_WORLD)
    inverse_b = symmetric_at(inverse_mass, b, INVERSE_INERTIA_IN_WORLD)
    linear: float = (inverse_mass[a, INVERSE_LINEAR_MASS] + inverse_mass[b, INVERSE_LINEAR_MASS]) * dot(along, other)
    turned_a: float = dot(cross(arm_a, along), applied(inverse_a, cross(arm_a, other)))
    turned_b: float = dot(cross(arm_b, along), applied(inverse_b, cross(arm_b, other)))
    return linear + turned_a + turned_b


@compiled(inline=True)
def _speed(world: int, a: int, b: int, normal: Vector, point: Any) -> float:
    """Return the normal velocity at which a point of b separates from a, m/s."""
    motion = floats(world, MOTION)
    linear = dot(normal, minus(vector_at(motion, b, VELOCITY), vector_at(motion, a, VELOCITY)))
    speed: float = linear + dot(_at(point, TURN_B), vector_at(motion, b, ANGULAR_VELOCITY))
    return speed - dot(_at(point, TURN_A), vector_at(motion, a, ANGULAR_VELOCITY))


@compiled(inline=True)
def _apply_impulse(world: int, a: int, b: int, impulse: Vector, turn_a: Vector, turn_b: Vector) -> None:
    """Apply an impulse to b and its opposite to a, with the angular impulses `turn_b` and -`turn_a`."""
    motion, inverse_mass = floats(world, MOTION), floats(world, INVERSE_MASS)
    change_a = applied(symmetric_at(inverse_mass, a, INVERSE_INERTIA_IN_WORLD), turn_a)
    change_b = applied(symmetric_at(inverse_mass, b, INVERSE_INERTIA_IN_WORLD), turn_b)
    for k in range(3):
        motion[a, VELOCITY + k] -= inverse_mass[a, INVERSE_LINEAR_MASS] * impulse[k]
        motion[b, VELOCITY + k] += inverse_mass[b, INVERSE_LINEAR_MASS] * impulse[k]
        motion[a, ANGULAR_VELOCITY + k] -= change_a[k]
        motion[b, ANGULAR_VELOCITY + k] += change_b[k]


@compiled
def _sweep_points(world: int, hit: Any, stopping: bool, least: float, thrown: bool) -> float:
    """Sweep over the points of a contact that hit, and return the largest change of an impulse, N s.

    Their target velocity is zero, or, if `thrown`, that after restitution. Impulses stay above -`least` times the plastic ones.
    Points with a plastic impulse of zero are included only if `stopping` or `thrown`.
    """
    row, contact, inverse_mass = int(hit[ROW]), integers(world, CONTACT), floats(world, INVERSE_MASS)
    a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
    normal = _at(hit, NORMAL)
    inverse_a = symmetric_at(inverse_mass, a, INVERSE_INERTIA_IN_WORLD)
    inverse_b = symmetric_at(inverse_mass, b, INVERSE_INERTIA_IN_WORLD)
    largest = 0.0
    for k in range(4):
        point = hit[IMPACT_POINTS + POINT_SIZE * k : IMPACT_POINTS + POINT_SIZE * (k + 1)]
        if point[PLASTIC] < 0.0 or (not stopping and point[PLASTIC] == 0.0 and not thrown):
            continue
        turn_a, turn_b = _at(point, TURN_A), _at(point, TURN_B)
        response = inverse_mass[a, INVERSE_LINEAR_MASS] + inverse_mass[b, INVERSE_LINEAR_MASS]
        response += dot(turn_a, applied(inverse_a, turn_a)) + dot(turn_b, applied(inverse_b, turn_b))
        missing = (point[WANTED] if thrown else 0.0) - _speed(world, a, b, normal, point)
        d = max(point[IMPULSE] + missing / response, -least * point[PLASTIC]) - point[IMPULSE]
        point[IMPULSE] += d
        _apply_impulse(world, a, b, times(d, normal), times(d, turn_a), times(d, turn_b))
        largest = max(largest, abs(d))
    return largest


@compiled
def _sweep_friction(world: int, hit: Any) -> float:
    """Do one sweep over the friction of a contact, and return the change of its impulse, N s."""
    row, contact, motion = int(hit[ROW]), integers(world, CONTACT), floats(world, MOTION)
    a, b, own = contact[row, c.BODY_A], contact[row, c.BODY_B], constraint(world, row)
    first, arm_a, arm_b = _at(hit, TANGENT), _at(hit, ARM_A), _at(hit, ARM_B)
    second = cross(_at(hit, NORMAL), first)
    slip = minus(
        plus(vector_at(motion, b, VELOCITY), cross(vector_at(motion, b, ANGULAR_VELOCITY), arm_b)),
        plus(vector_at(motion, a, VELOCITY), cross(vector_at(motion, a, ANGULAR_VELOCITY), arm_a)),
    )
    s1, s2 = dot(slip, first) - own[c.SURFACE_SPEED * c.WIDTH], dot(slip, second) - own[(c.SURFACE_SPEED + 1) * c.WIDTH]
    k11, k22, k12 = _at(hit, GRIP)
    f1, f2 = hit[FRICTION] - (k11 * s1 + k12 * s2), hit[FRICTION + 1] - (k12 * s1 + k22 * s2)
    if f1 * f1 + f2 * f2 > hit[BOUND] ** 2:  # friction opposes the sliding, as in `contact_solver_simd.solve_friction`
        mass = 0.5 * (k11 + k22) - math.sqrt(0.25 * (k11 - k22) ** 2 + k12 * k12)
        f1, f2 = hit[FRICTION] - mass * s1, hit[FRICTION + 1] - mass * s2
        scale = min(1.0, hit[BOUND] / (math.sqrt(f1 * f1 + f2 * f2) + 1e-300))
        f1, f2 = f1 * scale, f2 * scale
    d1, d2 = f1 - hit[FRICTION], f2 - hit[FRICTION + 1]
    hit[FRICTION], hit[FRICTION + 1] = f1, f2
    impulse = plus(times(d1, first), times(d2, second))
    _apply_impulse(world, a, b, impulse, cross(arm_a, impulse), cross(arm_b, impulse))
    return math.sqrt(d1 * d1 + d2 * d2)


@compiled
def normal_impulse(hit: Any) -> float:
    """Return the sum of the normal impulses of a contact, N s."""
    total = 0.0
    for k in range(4):
        point = hit[IMPACT_POINTS + POINT_SIZE * k : IMPACT_POINTS + POINT_SIZE * (k + 1)]
        total += point[IMPULSE] if point[PLASTIC] >= 0.0 else 0.0
    return total


@compiled
def find_impulses(world: int, sweeps: int) -> None:
    """Find and apply the impulses of a round, in a limited number of sweeps; the next round resolves the rest."""
    impact, count = floats(world, IMPACT), rows(world, IMPACT)
    scale, rough = _sweep(world, sweeps, _PLASTIC, 0.0), False
    for hit in range(count):
        for k in range(4):
            p = IMPACT_POINTS + POINT_SIZE * k
            impact[hit, p + PLASTIC] = impact[hit, p + IMPULSE] if impact[hit, p + PLASTIC] >= 0.0 else -1.0
        rough = rough or constraint(world, int(impact[hit, ROW]))[c.FRICTION * c.WIDTH] > 0.0
    if rough:
        for _ in range(_BOUNDS):
            _find_friction(world, scale, sweeps)
    for hit in range(count):
        _apply_restitution(world, impact[hit])
    _sweep(world, sweeps, _THROWN, scale)


@compiled
def _sweep(world: int, sweeps: int, part: int, scale: float) -> float:
    """Sweep over a part of the impulses of a round until none changes; return the largest known, or plastic, impulse, N s."""
    impact, count = floats(world, IMPACT), rows(world, IMPACT)
    for hit in range(count):
        begin_sweeps(world, int(impact[hit, ROW]))
    for sweep in range(sweeps):
        settled = True
        for hit in range(count):
            if not may_change(world, int(impact[hit, ROW]), sweep):
                continue
            change = _sweep_friction(world, impact[hit]) if part == _FRICTION else 0.0
            least = impact[hit, BOUNCE] if part == _FRICTION else 0.0
            change = max(change, _sweep_points(world, impact[hit], part == _PLASTIC, least, part == _THROWN))
            scale = max(scale, normal_impulse(impact[hit])) if part == _PLASTIC else scale
            if change > _TOLERANCE * scale:
                note_change(world, int(impact[hit, ROW]), sweep)
                settled = False
        if settled:
            break
    return scale


@compiled
def _find_friction(world: int, scale: float, sweeps: int) -> None:
    """Find friction within Coulomb's bound, and the normal impulses that keep normal velocities at zero."""
    impact, count = floats(world, IMPACT), rows(world, IMPACT)
    for hit in range(count):
        total = normal_impulse(impact[hit])
        for k in range(4):
            total += impact[hit, BOUNCE] * max(impact[hit, IMPACT_POINTS + POINT_SIZE * k + PLASTIC], 0.0)
        impact[hit, BOUND] = constraint(world, int(impact[hit, ROW]))[c.FRICTION * c.WIDTH] * max(total, 0.0)
    _sweep(world, sweeps, _FRICTION, scale)


@compiled
def _apply_restitution(world: int, hit: Any) -> None:
    """Apply e times the plastic impulses of the points of a contact."""
    row, contact = int(hit[ROW]), integers(world, CONTACT)
    normal = _at(hit, NORMAL)
    for k in range(4):
        point = hit[IMPACT_POINTS + POINT_SIZE * k : IMPACT_POINTS + POINT_SIZE * (k + 1)]
        d = hit[BOUNCE] * max(point[PLASTIC], 0.0)
        if d > 0.0:
            point[IMPULSE] += d
            turn_a, turn_b = times(d, _at(point, TURN_A)), times(d, _at(point, TURN_B))
            _apply_impulse(world, contact[row, c.BODY_A], contact[row, c.BODY_B], times(d, normal), turn_a, turn_b)

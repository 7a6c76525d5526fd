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
from kickdrift.core.vectors import applied, cross, dot, minus, plus, times
from kickdrift.world.columns import point_at, symmetric_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.constraint_groups import constraint
from kickdrift.world.contacts.impacts.impact_active_set import solve_pressed
from kickdrift.world.contacts.impacts.impact_rows import (
    ARM_A,
    ARM_B,
    BOUNCE,
    BOUND,
    FRICTION,
    IMPULSE,
    INVERSE_RESPONSE,
    NORMAL,
    PLASTIC,
    ROW,
    RUBBING,
    STOPPING,
    TANGENT,
    THROWING,
    TURN_A,
    TURN_B,
    apply_impulse,
    bodies_of,
    is_left_out,
    missing_speed,
    normal_impulse,
    point_of,
    press,
)
from kickdrift.world.contacts.impacts.impact_worklist import begin_sweeps, may_change, note_change
from kickdrift.world.layout import ANGULAR_VELOCITY, INVERSE_INERTIA_IN_WORLD, INVERSE_LINEAR_MASS, VELOCITY
from kickdrift.world.tables import IMPACT, INVERSE_MASS, MOTION, floats, rows

_BOUNDS = 4  # iterations of friction, each bounded by the normal impulses that the last one has left
_SWEEPS, _FEW = 400, 50  # at most, and those after which the points that press are solved by elimination


@compiled
def _sweep_points(world: int, hit: Any, part: int) -> float:
    """Sweep over the points of a contact that hit, and return the largest change of an impulse, N s.

    Their target velocity is zero, or, when `THROWING`, that after restitution. Impulses do not fall below zero, or, when
    `RUBBING`, below -e times the plastic ones.
    """
    inverse_mass, (a, b) = floats(world, INVERSE_MASS), bodies_of(world, hit)
    inverse_a = symmetric_at(inverse_mass, a, INVERSE_INERTIA_IN_WORLD)
    inverse_b = symmetric_at(inverse_mass, b, INVERSE_INERTIA_IN_WORLD)
    least, largest = hit[BOUNCE] if part == RUBBING else 0.0, 0.0
    for k in range(4):
        point = point_of(hit, k)
        if is_left_out(point, part):
            continue
        turn_a, turn_b = point_at(point, TURN_A), point_at(point, TURN_B)
        response = inverse_mass[a, INVERSE_LINEAR_MASS] + inverse_mass[b, INVERSE_LINEAR_MASS]
        response += dot(turn_a, applied(inverse_a, turn_a)) + dot(turn_b, applied(inverse_b, turn_b))
        missing = missing_speed(world, hit, point, part)
        d = max(point[IMPULSE] + missing / response, -least * point[PLASTIC]) - point[IMPULSE]
        press(world, hit, point, d)
        largest = max(largest, abs(d))
    return largest


@compiled
def _sweep_friction(world: int, hit: Any) -> float:
    """Do one sweep over the friction of a contact, and return the change of its impulse, N s."""
    motion, (a, b), own = floats(world, MOTION), bodies_of(world, hit), constraint(world, int(hit[ROW]))
    first, arm_a, arm_b = point_at(hit, TANGENT), point_at(hit, ARM_A), point_at(hit, ARM_B)
    second = cross(point_at(hit, NORMAL), first)
    slip = minus(
        plus(vector_at(motion, b, VELOCITY), cross(vector_at(motion, b, ANGULAR_VELOCITY), arm_b)),
        plus(vector_at(motion, a, VELOCITY), cross(vector_at(motion, a, ANGULAR_VELOCITY), arm_a)),
    )
    s1, s2 = dot(slip, first) - own[c.SURFACE_SPEED * c.WIDTH], dot(slip, second) - own[(c.SURFACE_SPEED + 1) * c.WIDTH]
    k11, k22, k12 = point_at(hit, INVERSE_RESPONSE)
    f1, f2 = hit[FRICTION] - (k11 * s1 + k12 * s2), hit[FRICTION + 1] - (k12 * s1 + k22 * s2)
    if f1 * f1 + f2 * f2 > hit[BOUND] ** 2:  # friction opposes the sliding: one mass, as in the sweeps
        mass = 0.5 * (k11 + k22) - math.sqrt(0.25 * (k11 - k22) ** 2 + k12 * k12)
        f1, f2 = hit[FRICTION] - mass * s1, hit[FRICTION + 1] - mass * s2
        scale = min(1.0, hit[BOUND] / (math.sqrt(f1 * f1 + f2 * f2) + 1e-300))
        f1, f2 = f1 * scale, f2 * scale
    d1, d2 = f1 - hit[FRICTION], f2 - hit[FRICTION + 1]
    hit[FRICTION], hit[FRICTION + 1] = f1, f2
    impulse = plus(times(d1, first), times(d2, second))
    apply_impulse(world, hit, impulse, cross(arm_a, impulse), cross(arm_b, impulse))
    return math.sqrt(d1 * d1 + d2 * d2)


@compiled
def find_impulses(world: int, tolerance: float) -> None:
    """Find and apply the impulses of a round, in a limited number of sweeps; the next round resolves the rest.

    Sweeps end where no impulse changes by more than `tolerance` times the largest one.
    """
    impact, count = floats(world, IMPACT), rows(world, IMPACT)
    scale, rough = _sweep(world, STOPPING, 0.0, tolerance), False
    for hit in range(count):
        for k in range(4):
            point = point_of(impact[hit], k)
            point[PLASTIC] = point[IMPULSE] if point[PLASTIC] >= 0.0 else -1.0
        rough = rough or constraint(world, int(impact[hit, ROW]))[c.FRICTION * c.WIDTH] > 0.0
    if rough:
        for _ in range(_BOUNDS):
            _find_friction(world, scale, tolerance)
    for hit in range(count):
        _apply_restitution(world, impact[hit])
    _sweep(world, THROWING, scale, tolerance)


@compiled
def _sweep(world: int, part: int, scale: float, tolerance: float) -> float:
    """Sweep over a part of the impulses of a round until none changes; return the largest known, or plastic, impulse, N s."""
    impact, count = floats(world, IMPACT), rows(world, IMPACT)
    for hit in range(count):
        begin_sweeps(world, int(impact[hit, ROW]))
    for sweep in range(_SWEEPS):
        settled = True
        for hit in range(count):
            if not may_change(world, int(impact[hit, ROW]), sweep):
                continue
            change = _sweep_friction(world, impact[hit]) if part == RUBBING else 0.0
            change = max(change, _sweep_points(world, impact[hit], part))
            scale = max(scale, normal_impulse(impact[hit])) if part == STOPPING else scale
            if change > tolerance * scale:
                note_change(world, int(impact[hit, ROW]), sweep)
                settled = False
        if settled:
            break
        if sweep % _FEW == _FEW - 1:
            solve_pressed(world, sweep, part)
    return scale


@compiled
def _find_friction(world: int, scale: float, tolerance: float) -> None:
    """Find friction within Coulomb's bound, and the normal impulses that keep normal velocities at zero."""
    impact, count = floats(world, IMPACT), rows(world, IMPACT)
    for hit in range(count):
        total = normal_impulse(impact[hit])
        for k in range(4):
            total += impact[hit, BOUNCE] * max(point_of(impact[hit], k)[PLASTIC], 0.0)
        impact[hit, BOUND] = constraint(world, int(impact[hit, ROW]))[c.FRICTION * c.WIDTH] * max(total, 0.0)
    _sweep(world, RUBBING, scale, tolerance)


@compiled
def _apply_restitution(world: int, hit: Any) -> None:
    """Apply e times the plastic impulses of the points of a contact."""
    for k in range(4):
        point = point_of(hit, k)
        d = hit[BOUNCE] * max(point[PLASTIC], 0.0)
        if d > 0.0:
            press(world, hit, point, d)

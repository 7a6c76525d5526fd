"""One contact between bodies that do not answer an impulse as if they were alone: links, whose joints answer too.

The sweeps of `kickdrift.world.contacts.lanes`, for one contact and any response. A row of a constraint is a wrench of twelve
numbers: impulse and angular impulse on the first body, the same on the second. `answers` holds what velocities each row's
unit impulse gives them, twelve numbers a row: four points, two tangents, twist.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus, times
from kickdrift.world.contacts import layout as c

W = c.WIDTH
TANGENT, TWIST, ROWS = 4, 6, 7  # rows; the first four are the points
# Further columns of LINK_CONTACTS: velocities wanted of points that bounce (4), and whether the answers are there
BOUNCES, ANSWERED = 84, 95

# Of the answer of the bodies alone, added to that of the articulation: joints may leave a row no freedom at all, and where
# they turn fast, answers are not quite symmetric and may be below zero.
_SHARE = 1e-3


@compiled(inline=True, cached=False)
def _vector(own: Any, field: int) -> Vector:
    return own[field * W], own[(field + 1) * W], own[(field + 2) * W]


@compiled(cached=False)
def write_row(own: Any, row: int, wrench: Any) -> None:
    """Write the wrench of a row's unit impulse."""
    n, u = _vector(own, c.N), _vector(own, c.T)
    push, turn_a, turn_b = (0.0, 0.0, 0.0), n, n
    if row < TANGENT:
        push = n
        turn_a = _vector(own, c.P + c.POINT_FIELDS * row + c.ARM)
        turn_b = minus(turn_a, cross(_vector(own, c.BETWEEN), n))
    elif row < TWIST:
        push = u if row == TANGENT else cross(n, u)
        turn_a = cross(_vector(own, c.CENTRE), push)
        turn_b = minus(turn_a, cross(_vector(own, c.BETWEEN), push))
    for k in range(3):
        wrench[k], wrench[3 + k] = -push[k], -turn_a[k]
        wrench[6 + k], wrench[9 + k] = push[k], turn_b[k]


@compiled(cached=False)
def _product(answers: Any, row: int, wrench: Any) -> float:
    """Speed along the row of a wrench by the unit impulse of another one."""
    total = 0.0
    for k in range(12):
        total += answers[12 * row + k] * wrench[k]
    return total


@compiled(cached=False)
def _give(answers: Any, row: int, wrench: Any, impulse: float, velocity: Any, given: Any) -> None:
    for k in range(12):
        velocity[k] += impulse * answers[12 * row + k]
        given[k] += impulse * wrench[k]


@compiled(cached=False)
def _speed(wrench: Any, velocity: Any) -> float:
    total = 0.0
    for k in range(12):
        total += wrench[k] * velocity[k]
    return total


@compiled(cached=False)
def note_hits(
    own: Any, answers: Any, change: Any, wrench: Any, e: float, slowest: float, h: float, kicked: Any, velocity: Any
) -> None:
    """Say which points hit faster than some speed in the substep, and what velocities they shall have after the drift.

    With one of them hit those that would within the next substep, which keeps what lands flat from turning. They hit with
    what they had after the kick at most: impulses of the last substep are no impact.
    """
    hits = False
    for k in range(4):
        answers[BOUNCES + k] = 0.0
        i = (c.P + c.POINT_FIELDS * k) * W
        if e > 0.0 and own[i + c.POINT_MASS * W] > 0.0:
            write_row(own, k, wrench)
            gap = own[i + c.GAP * W] + _speed(wrench, change)
            speed = max(_speed(wrench, velocity), _speed(wrench, kicked))
            if speed < -slowest and gap + 2.0 * h * speed <= 0.0:
                hits = hits or gap + h * speed <= 0.0
                answers[BOUNCES + k] = -e * speed
    for k in range(4):
        answers[BOUNCES + k] *= 1.0 if hits else 0.0


@compiled(cached=False)
def bounces(answers: Any) -> bool:
    """Whether any point has hit."""
    any_does: bool = answers[BOUNCES] + answers[BOUNCES + 1] + answers[BOUNCES + 2] + answers[BOUNCES + 3] > 0.0
    return any_does


@compiled(cached=False)
def forget(own: Any) -> None:
    """Let a contact carry no impulse."""
    for k in range(4):
        own[(c.P + c.POINT_FIELDS * k + c.IMPULSE) * W] = 0.0
    for k in range(3):
        own[(c.ROLL + 2 + k) * W] = 0.0
    own[c.SLID * W], own[(c.SLID + 1) * W], own[(c.TWIST + 1) * W] = 0.0, 0.0, 0.0


@compiled(cached=False)
def press(
    own: Any, answers: Any, change: Any, wrench: Any, soft: float, h: float, push: float, velocity: Any, given: Any
) -> None:
    """One sweep over the points; see `kickdrift.world.contacts.lanes.solve_normals`.

    Parameters
    ----------
    change : (12,) array
        Displacements and turns of both bodies since the step began.
    velocity, given : (12,) arrays
        Velocities of both bodies, and the wrench that they have been given, which the sweep changes.
    """
    softness = _vector(own, c.SOFTNESS)
    for k in range(4):
        i = (c.P + c.POINT_FIELDS * k) * W
        if own[i + c.POINT_MASS * W] == 0.0:
            continue
        write_row(own, k, wrench)
        gap = own[i + c.GAP * W] + _speed(wrench, change)
        mass = 1.0 / (max(_product(answers, k, wrench), 0.0) + _SHARE / own[i + c.POINT_MASS * W])
        scale, leak, bias = 1.0, 0.0, max(gap, 0.0) / h
        if soft > 0.0 and gap <= 0.0:
            scale, leak = softness[1], softness[2]
            bias = max(scale * softness[0] * gap, -push)
        impulse = own[i + c.IMPULSE * W]
        wanted = answers[BOUNCES + k] if soft == 0.0 else 0.0
        bias = -wanted if wanted > 0.0 else bias
        new = max(impulse - mass * (scale * _speed(wrench, velocity) + bias) - leak * impulse, 0.0)
        if soft == 0.0 and gap > 0.0 and impulse == 0.0 and wanted == 0.0:
            new = 0.0
        own[i + c.IMPULSE * W] = new
        _give(answers, k, wrench, new - impulse, velocity, given)


@compiled(cached=False)
def grip(own: Any, answers: Any, wrench: Any, other: Any, velocity: Any, given: Any) -> None:
    """Solve rolling resistance, twist and friction; see `kickdrift.world.contacts.lanes.solve_friction`."""
    normal, lever, friction = 0.0, 0.0, own[c.FRICTION * W]
    for k in range(4):
        i = (c.P + c.POINT_FIELDS * k) * W
        normal += own[i + c.IMPULSE * W]
        lever += own[i + c.IMPULSE * W] * own[i + c.LEVER * W]
    if own[c.ROLL * W] > 0.0:
        _roll(own, normal, velocity, given)
    write_row(own, TWIST, wrench)
    old = own[(c.TWIST + 1) * W]
    new = old - _speed(wrench, velocity) / (max(_product(answers, TWIST, wrench), 0.0) + _SHARE / own[c.TWIST * W])
    new = min(max(new, -friction * lever), friction * lever)
    own[(c.TWIST + 1) * W] = new
    _give(answers, TWIST, wrench, new - old, velocity, given)
    write_row(own, TANGENT, wrench)
    write_row(own, TANGENT + 1, other)
    alone = _SHARE * (own[c.MASS_A * W] + own[c.MASS_B * W])
    k11, k12 = max(_product(answers, TANGENT, wrench), 0.0) + alone, _product(answers, TANGENT + 1, wrench)
    k21, k22 = _product(answers, TANGENT, other), max(_product(answers, TANGENT + 1, other), 0.0) + alone
    s1 = _speed(wrench, velocity) - own[c.SLIDE * W]
    s2 = _speed(other, velocity) - own[(c.SLIDE + 1) * W]
    scale = 1.0 / max(k11 * k22 - k12 * k21, _SHARE * k11 * k22)
    old1, old2 = own[c.SLID * W], own[(c.SLID + 1) * W]
    new1, new2 = old1 - scale * (k22 * s1 - k12 * s2), old2 - scale * (k11 * s2 - k21 * s1)
    size = math.sqrt(new1 * new1 + new2 * new2)
    if size > friction * normal:
        new1, new2 = new1 * (friction * normal / size), new2 * (friction * normal / size)
    own[c.SLID * W], own[(c.SLID + 1) * W] = new1, new2
    _give(answers, TANGENT, wrench, new1 - old1, velocity, given)
    _give(answers, TANGENT + 1, other, new2 - old2, velocity, given)


@compiled(cached=False)
def _roll(own: Any, normal: float, velocity: Any, given: Any) -> None:
    """Solve rolling resistance as if both bodies were alone, which makes it slower to hold, and no weaker."""
    old = _vector(own, c.ROLL + 2)
    wa, wb = (velocity[3], velocity[4], velocity[5]), (velocity[9], velocity[10], velocity[11])
    new = minus(old, times(own[(c.ROLL + 1) * W], minus(wb, wa)))
    size, most = math.sqrt(dot(new, new)), own[c.ROLL * W] * normal
    new = times(most / size, new) if size > most else new
    turn = minus(new, old)
    for k in range(3):
        own[(c.ROLL + 2 + k) * W] = new[k]
        given[3 + k] -= turn[k]
        given[9 + k] += turn[k]

"""Line search between the accepted solution and the current one, whose assumed pieces of laws may not be those it lies on.

With fixed bounds of friction, the laws of contacts are gradients of convex functions of the velocities, and so is the inertia:
the solution is the minimum of their sum. A step of Newton's method is a descent direction, but may lead too far; then the
minimum along it is taken, which makes the method converge from any initial guess. Castro, Permenter, Han, IEEE Trans. Robotics
39 (2023) 1301, section IV.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_lookup import contact_row
from kickdrift.world.direct.contact_rows import bound_rows, first_row
from kickdrift.world.direct.direct_bodies import mass_of
from kickdrift.world.direct.island_velocities import kinetic_energy
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.law_pieces import law_impulse
from kickdrift.world.tables import (
    ISLAND,
    ISLAND_CONTACT,
    ISLAND_JOINT,
    JOINT,
    LINK,
    LINK_NUMBERS,
    MOTION,
    floats,
    integers,
)

# Fractions of the initial slope that may be left at the end of a full step and of a shortened one; evaluations of the slope.
_FLAT, _LEVEL, _TRIALS = 1e-3, 1e-6, 20

# Rounding errors of slopes: a fraction of the kinetic energy, and that of an island in which all bodies have this speed, m/s.
_ROUNDING, _AT_REST = 1e-12, 1e-7


@compiled(cached=False, fast=True)
def search_line(world: int, island: int, full: bool, touched: bool) -> bool:
    """Accept the minimum between the accepted solution and the current one; return whether that is the current one."""
    share = 1.0 if full else _minimum(world, island, touched)
    whole = share == 1.0
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    if touched:
        for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
            _accept(contact_row(world, order[k, 0]), share)
    joints = integers(world, ISLAND_JOINT)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        _accept_laws(world, joints[place, 0], share)
    return whole


@compiled(cached=False, fast=True)
def _minimum(world: int, island: int, touched: bool) -> float:
    """Return the fraction of the step at which the slope, which increases, is zero; 1.0 if it is negative to the end.

    By the Illinois variant of false position, which halves the slope at an end that is retained (Dowell, Jarratt, BIT 11 (1971)
    168). With bisection, a step of sixteen ragdolls in a heap takes 1.09 times as long.
    """
    above = _slope(world, island, 1.0, touched)
    if above <= 0.0:
        return 1.0
    first = _slope(world, island, 0.0, touched)
    unnoticed = max(_AT_REST * _AT_REST * mass_of(world, island), _ROUNDING * kinetic_energy(world, island, MOTION))
    if first >= 0.0 or above <= max(-_FLAT * first, unnoticed):
        return 1.0
    low, high, below, side = 0.0, 1.0, first, 0
    for _ in range(_TRIALS):
        middle = (low * above - high * below) / (above - below)
        slope = _slope(world, island, middle, touched)
        if abs(slope) <= _LEVEL * -first or high - low <= _LEVEL:
            return middle
        if slope > 0.0:
            high, above, below = middle, slope, below * (0.5 if side > 0 else 1.0)
            side = 1
        else:
            low, below, above = middle, slope, above * (0.5 if side < 0 else 1.0)
            side = -1
    return high


@compiled(cached=False, fast=True)
def _slope(world: int, island: int, share: float, touched: bool) -> float:
    """Return the derivative of the convex function along the step, at a fraction `share` of it."""
    own, order, total = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), 0.0
    if touched:
        for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
            total += _slope_of_contact(contact_row(world, order[k, 0]), share)
    joints = integers(world, ISLAND_JOINT)
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        total += _slope_of_laws(world, joints[place, 0], share)
    return total


@compiled(cached=False, fast=True)
def _slope_of_contact(rows: Any, share: float) -> float:
    """Return the part of a contact in `_slope`."""
    total = 0.0
    for i in range(d.TANGENT):
        if rows[d.ACTIVE + i] != 0.0:
            way = rows[d.MOVED + i] - rows[d.ACCEPTED + i]
            trial = _trial_impulse(rows, i, i, rows[d.ACCEPTED + i] + share * way)
            borne = rows[d.BORNE + i] + share * (rows[d.GIVEN + i] - rows[d.BORNE + i])
            total += way * (borne + rows[d.IMPULSE + i] - max(trial, 0.0))
    for bound in range(3):
        begin, end = first_row(bound), first_row(bound) + bound_rows(bound)
        if rows[d.ACTIVE + begin] == 0.0:
            continue
        square, uphill = 1e-300, 0.0
        for i in range(begin, end):
            way = rows[d.MOVED + i] - rows[d.ACCEPTED + i]
            trial = _trial_impulse(rows, i, begin, rows[d.ACCEPTED + i] + share * way)
            square += trial * trial
            uphill += way * trial
            total += way * (rows[d.BORNE + i] + share * (rows[d.GIVEN + i] - rows[d.BORNE + i]) + rows[d.IMPULSE + i])
        total -= uphill * min(1.0, rows[d.BOUND + bound] / math.sqrt(square))
    return total


@compiled(cached=False, fast=True)
def _slope_of_laws(world: int, link: int, share: float) -> float:
    """Return the part of the laws of a joint in `_slope`."""
    joint, work, total = integers(world, LINK)[link, j.LINK_JOINT], floats(world, LINK_NUMBERS), 0.0
    laws = integers(world, JOINT)[joint, j.LAWS]
    for k in range(6):
        if laws >> k & 1:
            way = work[link, j.DELTA_SPEED + k] - work[link, j.ACCEPTED_DELTA_SPEED + k]
            given = work[link, j.PUSH + k] - work[link, j.SLOPE + k] * work[link, j.DELTA_SPEED + k]
            borne = work[link, j.ACCEPTED_IMPULSE + k] + share * (given - work[link, j.ACCEPTED_IMPULSE + k])
            law = law_impulse(world, joint, k, link, work[link, j.ACCEPTED_DELTA_SPEED + k] + share * way)
            total += way * (borne - law)
    return total


@compiled(inline=True, cached=False, fast=True)
def _trial_impulse(rows: Any, i: int, begin: int, moved: float) -> float:
    """Return the impulse of a row before it is bounded, for a change of its speed."""
    trial: float = (
        rows[d.IMPULSE + i]
        + rows[d.BASE + i]
        - rows[d.STIFFNESS + begin] * (rows[d.SPEED + i] + moved - rows[d.WANTED + i])
    )
    return trial


@compiled(cached=False, fast=True)
def _accept(rows: Any, share: float) -> None:
    """Move the accepted solution of a contact towards the current one by a fraction of the step."""
    for i in range(d.CONTACT_ROWS):
        rows[d.BORNE + i] += share * (rows[d.GIVEN + i] - rows[d.BORNE + i])
        rows[d.ACCEPTED + i] += share * (rows[d.MOVED + i] - rows[d.ACCEPTED + i])
        rows[d.MOVED + i] = rows[d.ACCEPTED + i]
        if i < d.TANGENT and share < 1.0:
            rows[d.GIVEN + i] = max(_trial_impulse(rows, i, i, rows[d.MOVED + i]), 0.0) - rows[d.IMPULSE + i]


@compiled(cached=False, fast=True)
def _accept_laws(world: int, link: int, share: float) -> None:
    """Move the accepted solution of the laws of a joint towards the current one by a fraction of the step."""
    joint, work = integers(world, LINK)[link, j.LINK_JOINT], floats(world, LINK_NUMBERS)
    laws = integers(world, JOINT)[joint, j.LAWS]
    for k in range(6):
        if laws >> k & 1:
            given = work[link, j.PUSH + k] - work[link, j.SLOPE + k] * work[link, j.DELTA_SPEED + k]
            work[link, j.ACCEPTED_IMPULSE + k] += share * (given - work[link, j.ACCEPTED_IMPULSE + k])
            work[link, j.ACCEPTED_DELTA_SPEED + k] += share * (
                work[link, j.DELTA_SPEED + k] - work[link, j.ACCEPTED_DELTA_SPEED + k]
            )

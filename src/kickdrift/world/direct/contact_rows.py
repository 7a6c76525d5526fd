"""The rows of a contact in the direct solver: wrenches, target speeds, and the assumed pieces of their laws.

A point pushes or is open. Friction, torsion and rolling resistance each hold the target speed, or slide with their largest
impulse, mu times the normal impulses. The law is the projection of the trial impulse lambda - D (s - wanted) onto a disk;
Newton's method uses its derivative.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_wrenches import along, mobility, wrench_of, write_wrench

_W = c.WIDTH

# Stiffness: impulse per speed error, over the effective mass of a row. For points that are pushed apart, for points at rest,
# for friction, and for all rows in a bounce, which has no earlier impulses to begin with. The stiffer, the more often solutions
# lie on other pieces: with friction of 1e3 a heap of ragdolls takes six trials, with 100 and 30 one or two; overlaps of
# a planar pyramid pushed with 1e3 do not settle in twenty; points at rest with 100 leave a tower of twenty swaying at 2 mm/s,
# with 1e3 at 5e-6 m/s.
PRESSING, RIGID, GRIP, RIGID_BOUNCE = 100.0, 1e3, 30.0, 1e5

# A row that bears far more than its effective mass is as stiff as if its effective mass were this fraction of the mass borne:
# for points, and for friction below them. Otherwise the impulses on a light body under a heavy one hardly converge from one
# solution to the next: a tower of 40 boxes stays at 5e-5 m/s; with these it is at 1e-8 after 15 s and at 1e-14 after 60 s. With
# friction five times as stiff, a row of dominoes falls in half the time.
BEARING, BEARING_GRIP = 2.0, 0.05

# Tolerance of the inequalities of points, m/s: smaller violations do not change the assumed pieces.
MISSED = 1e-5

# Tolerance of the impulse of friction in direction and size, over its effective mass, m/s.
SLIPPED = 1e-4


@compiled(inline=True, cached=False, fast=True)
def impulse_field(k: int) -> int:
    """Return the field of a constraint that holds the impulse of a row."""
    if k < d.TANGENT:
        return c.P + c.POINT_FIELDS * k + c.IMPULSE
    if k < d.TWIST:
        return c.TANGENT_IMPULSE + k - d.TANGENT
    return c.TWISTING_IMPULSE if k == d.TWIST else c.ROLL_IMPULSE + k - d.ROLL


@compiled(cached=False, fast=True)
def weigh(own: Any, rows: Any, fallen: float, most: float) -> None:
    """Find the mass borne by points and tangents, scaled by BEARING and BEARING_GRIP, which sets their stiffness.

    It is the impulse over ``fallen``, the speed that gravity adds in a substep, but at most ``most``, the mass of the island;
    zero in a bounce and without gravity.
    """
    total = 0.0
    for k in range(d.TANGENT):
        impulse = own[impulse_field(k) * _W]
        rows[d.WEIGHT + k] = BEARING * min(impulse / fallen, most) if fallen > 0.0 else 0.0
        total += rows[d.WEIGHT + k]
    for k in range(d.TANGENT, d.TWIST):
        rows[d.WEIGHT + k] = BEARING_GRIP * total


@compiled(cached=False, fast=True)
def begin_row(world: int, own: Any, rows: Any, k: int, velocity: Any, a: int, b: int, rigid: float) -> None:
    """Write wrench, speed and stiffness of a row, which is active if impulses along it move anything.

    The stiffness is that of the effective mass, or of the mass borne if that is larger. If the bodies are of two islands, the
    body of the other island (`CUT`: 1: a, 2: b) responds as if it were free.
    """
    wrench = wrench_of(rows, k)
    write_wrench(own, k, wrench)
    of_a, of_b = mobility(world, wrench, a, 0), mobility(world, wrench, b, 1)
    yielding, other = of_a + of_b, of_a if rows[d.CUT] == 1.0 else of_b if rows[d.CUT] == 2.0 else 0.0
    rows[d.ACTIVE + k] = 1.0 if yielding > 0.0 else 0.0
    rows[d.ROW_MASS + k] = 1.0 / yielding if yielding > 0.0 else 0.0
    stiff = rigid * (max(1.0, yielding * rows[d.WEIGHT + k]) if k < d.TWIST else 1.0)
    rows[d.STIFFNESS + k] = 1.0 / (yielding / stiff + other) if yielding > 0.0 else 0.0
    rows[d.SPEED + k], rows[d.IMPULSE + k] = along(wrench, velocity), own[impulse_field(k) * _W]
    rows[d.WANTED + k], rows[d.MOVED + k], rows[d.GIVEN + k], rows[d.STATE + k] = 0.0, 0.0, 0.0, d.OPEN
    rows[d.ACCEPTED + k], rows[d.BORNE + k], rows[d.BASE + k] = 0.0, 0.0, 0.0


@compiled(inline=True, cached=False, fast=True)
def first_row(bound: int) -> int:
    """Return the first row of a bound: tangents, twist, rolling."""
    return d.TANGENT if bound == 0 else d.TWIST if bound == 1 else d.ROLL


@compiled(inline=True, cached=False, fast=True)
def bound_rows(bound: int) -> int:
    """Return the number of rows that share a bound."""
    return 2 if bound == 0 else 1 if bound == 1 else 3


@compiled(inline=True, cached=False, fast=True)
def bound_of(k: int) -> int:
    """Return the bound of a row; -1 for points."""
    return -1 if k < d.TANGENT else 0 if k < d.TWIST else 1 if k == d.TWIST else 2


@compiled(cached=False, fast=True)
def share_stiffness(rows: Any) -> None:
    """Let the first row of rolling resistance, which stands for all three, be as stiff as the one that yields most.

    In a planar world bodies turn about one axis alone, and hardly or not at all about that of the first row.
    """
    most = d.ROLL
    for k in range(d.ROLL + 1, d.ROLL + 3):
        if rows[d.ACTIVE + k] != 0.0 and (
            rows[d.ACTIVE + most] == 0.0 or rows[d.ROW_MASS + k] < rows[d.ROW_MASS + most]
        ):
            most = k
    for number in (d.ACTIVE, d.ROW_MASS, d.STIFFNESS):
        rows[number + d.ROLL] = rows[number + most]


@compiled(cached=False, fast=True)
def find_bounds(own: Any, rows: Any) -> None:
    """Bound friction, torsion and rolling resistance by the normal impulses of the current solution."""
    normal, lever = 0.0, 0.0
    for k in range(d.TANGENT):
        if rows[d.ACTIVE + k] != 0.0:
            carried = max(rows[d.IMPULSE + k] + rows[d.GIVEN + k], 0.0)
            normal += carried
            lever += carried * own[(c.P + c.POINT_FIELDS * k + c.LEVER) * _W]
    friction = own[c.FRICTION * _W]
    rows[d.BOUND], rows[d.BOUND + 1] = friction * normal, friction * lever
    rows[d.BOUND + 2] = own[c.ROLL_RESISTANCE * _W] * normal


@compiled(cached=False, fast=True)
def update_point_states(rows: Any, first: bool, whole: bool) -> bool:
    """Assume that points push or are open as the current solution implies; return whether nothing changes.

    With a tolerance if it was accepted `whole`. After a shortened step there is none: a stiff point that is open within it
    would shorten all further steps to nothing.
    """
    settled = True
    for k in range(d.TANGENT):
        if rows[d.ACTIVE + k] == 0.0:
            continue
        missing, stiffness = rows[d.WANTED + k] - rows[d.SPEED + k], rows[d.STIFFNESS + k]
        pull = rows[d.ROW_MASS + k] if first else stiffness
        trial = rows[d.IMPULSE + k] + rows[d.BASE + k] + pull * (missing - rows[d.MOVED + k])
        if not first and whole:
            trial += -MISSED * stiffness if rows[d.STATE + k] == d.OPEN else MISSED * rows[d.ROW_MASS + k]
        state = d.HELD if trial > 0.0 else d.OPEN
        settled = settled and state == rows[d.STATE + k]
        rows[d.STATE + k] = state
        rows[d.CONSTANT + k] = rows[d.BASE + k] + stiffness * missing if state == d.HELD else -rows[d.IMPULSE + k]
    return settled


@compiled(cached=False, fast=True)
def update_bound_states(rows: Any, bound: int, first: bool) -> bool:
    """Assume that friction, torsion or rolling resistance holds or slides; return whether that changes nothing."""
    begin, count = first_row(bound), bound_rows(bound)
    end, most = begin + count, rows[d.BOUND + bound]
    stiffness, was = rows[d.STIFFNESS + begin], rows[d.STATE + begin]
    if most <= MISSED * rows[d.ROW_MASS + begin]:
        for k in range(begin, end):
            rows[d.CONSTANT + k], rows[d.DIRECTION + k] = -rows[d.IMPULSE + k], 0.0
        rows[d.STATE + begin], rows[d.SLIDING_PART + bound] = d.SLIDING, 0.0
        return True
    size = _trial_impulse(rows, begin, end, rows[d.ROW_MASS + begin] if first else stiffness)
    state = d.HELD if size <= most else d.SLIDING
    if first and state == d.SLIDING:
        size = _trial_impulse(rows, begin, end, stiffness)
    off = 0.0
    for k in range(begin, end):
        within = rows[d.CONSTANT + k] * min(1.0, most / (size + 1e-300))
        off = max(off, abs(within - rows[d.IMPULSE + k] - rows[d.GIVEN + k]))
    settled: bool = not first and off <= SLIPPED * rows[d.ROW_MASS + begin]
    rows[d.STATE + begin] = state
    if state == d.HELD:
        for k in range(begin, end):
            rows[d.CONSTANT + k] = rows[d.BASE + k] + stiffness * (rows[d.WANTED + k] - rows[d.SPEED + k])
            rows[d.DIRECTION + k] = 0.0
        return settled or was == d.HELD
    for k in range(begin, end):
        rows[d.DIRECTION + k] = rows[d.CONSTANT + k] / size
    _slide(rows, bound, most, most / size)
    return settled


@compiled(cached=False, fast=True)
def _trial_impulse(rows: Any, begin: int, end: int, stiffness: float) -> float:
    """Write the trial impulse of a bound, before projection, into CONSTANT of its rows, and return its size."""
    square = 0.0
    for k in range(begin, end):
        trial = (
            rows[d.IMPULSE + k]
            + rows[d.BASE + k]
            - stiffness * (rows[d.SPEED + k] + rows[d.MOVED + k] - rows[d.WANTED + k])
        )
        rows[d.CONSTANT + k] = trial
        square += trial * trial
    return math.sqrt(square)


@compiled(cached=False, fast=True)
def _slide(rows: Any, bound: int, most: float, share: float) -> None:
    """Let rows slide with their largest impulse; `share` of the stiffness is left against changes of its direction."""
    begin, count = first_row(bound), bound_rows(bound)
    rows[d.SLIDING_PART + bound] = share
    for k in range(begin, begin + count):
        left = rows[d.MOVED + k]
        for j in range(begin, begin + count):
            left -= rows[d.DIRECTION + k] * rows[d.DIRECTION + j] * rows[d.MOVED + j]
        turning = rows[d.STIFFNESS + begin] * share * left
        rows[d.CONSTANT + k] = most * rows[d.DIRECTION + k] - rows[d.IMPULSE + k] + turning


@compiled(cached=False, fast=True)
def bind_points(rows: Any) -> None:
    """Bound the impulses of points from below: none pulls."""
    for k in range(d.TANGENT):
        if rows[d.ACTIVE + k] != 0.0:
            rows[d.GIVEN + k] = max(rows[d.GIVEN + k], -rows[d.IMPULSE + k])


@compiled(cached=False, fast=True)
def bind(rows: Any) -> None:
    """Keep the impulses of the current solution within their bounds."""
    bind_points(rows)
    for bound in range(3):
        begin, end = first_row(bound), first_row(bound) + bound_rows(bound)
        if rows[d.ACTIVE + begin] == 0.0:
            continue
        square, most = 0.0, rows[d.BOUND + bound]
        for k in range(begin, end):
            square += (rows[d.IMPULSE + k] + rows[d.GIVEN + k]) ** 2
        share = min(1.0, most / math.sqrt(square)) if square > 0.0 else 0.0
        for k in range(begin, end):
            rows[d.GIVEN + k] = share * (rows[d.IMPULSE + k] + rows[d.GIVEN + k]) - rows[d.IMPULSE + k]


@compiled(cached=False, fast=True)
def fix_rows(own: Any, rows: Any) -> None:
    """Fix the impulses of all rows to those that act on the bodies in the accepted solution, within their bounds.

    The impulses of the laws at these velocities may be far from them if rows are stiff.
    """
    for k in range(d.CONTACT_ROWS):
        rows[d.GIVEN + k] = rows[d.BORNE + k]
    find_bounds(own, rows)
    bind(rows)
    for k in range(d.CONTACT_ROWS):
        rows[d.CONSTANT + k] = rows[d.GIVEN + k]
    for k in range(d.TANGENT):
        rows[d.STATE + k] = d.OPEN
    for bound in range(3):
        rows[d.STATE + first_row(bound)], rows[d.SLIDING_PART + bound] = d.SLIDING, 0.0


@compiled(cached=False, fast=True)
def give_of(rows: Any, k: int) -> float:
    """Return the change of impulse along a row in the current solution."""
    impulse: float = rows[d.CONSTANT + k]
    stiffness, moved, bound = 0.0, 0.0, bound_of(k)
    if bound < 0:
        if rows[d.STATE + k] == d.HELD:
            stiffness, moved = rows[d.STIFFNESS + k], rows[d.MOVED + k]
    else:
        begin, end = first_row(bound), first_row(bound) + bound_rows(bound)
        stiffness, moved = rows[d.STIFFNESS + begin], rows[d.MOVED + k]
        if rows[d.STATE + begin] != d.HELD:
            stiffness *= rows[d.SLIDING_PART + bound]
            for j in range(begin, end):
                moved -= rows[d.DIRECTION + k] * rows[d.DIRECTION + j] * rows[d.MOVED + j]
    return impulse - stiffness * moved

"""The rows of a contact as the direct solver takes them: wrenches, the speed wanted, and the piece of its law that is assumed.

A point pushes or is open. Friction, twist and rolling resistance each hold what touches at its speed, or slide at their
greatest impulse, mu times what the points carry: the projection of lambda - D (s - wanted) onto a disk, of which a trial of
Newton's method takes the derivative.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct.layout import (
    ACCEPTED,
    ACTIVE,
    BASE,
    BORNE,
    BOUND,
    CONSTANT,
    CONTACT_ROWS,
    CUT,
    DIRECTION,
    GIVEN,
    HELD,
    IMPULSE,
    MOVED,
    OPEN,
    ROLL,
    ROW_MASS,
    SLIDE,
    SLIDING,
    SPEED,
    STATE,
    STIFFNESS,
    TANGENT,
    TWIST,
    WANTED,
    WEIGHT,
    WRENCH,
)
from kickdrift.world.direct.wrenches import along, mobility, write_wrench

_W = c.WIDTH

# Impulse per speed missing, over the mass that a row moves: of points that are pushed apart, of points that rest, of friction,
# and of all in a bounce, which has no impulses of a substep before to begin with. The stiffer, the more often solutions lie on
# other pieces: with friction of 1e3 a heap of ragdolls takes six trials, with 100 and 30 one or two; overlaps of a planar
# pyramid pushed with 1e3 do not settle in twenty; points at rest with 100 leave a tower of twenty swaying at 2 mm/s, with 1e3
# at 5e-6 m/s.
PRESSING, RIGID, GRIP, RIGID_BOUNCE = 100.0, 1e3, 30.0, 1e5

# A row that bears the weight of far more than it moves is as stiff as if it moved these parts of it: of points, and of friction
# under them. Without, the multipliers of a light body under a heavy one hardly come nearer from one solution to the next: a
# tower of 40 boxes stays at 5e-5 m/s, with them it is at 1e-8 after 15 s and at 1e-14 after 60 s. Friction that is five times
# as stiff lets a row of dominoes fall in half the time.
BEARING, BEARING_GRIP = 2.0, 0.05

# Speeds by which points may be missed or pulled, m/s: no other solution is sought for them.
MISSED = 1e-5

# What friction may be off by in direction and size, over the mass that it moves, m/s.
SLIPPED = 1e-4


@compiled(inline=True, cached=False, fast=True)
def impulse_field(k: int) -> int:
    """Field of a constraint that holds the impulse of a row."""
    if k < TANGENT:
        return c.P + c.POINT_FIELDS * k + c.IMPULSE
    if k < TWIST:
        return c.TANGENT_IMPULSE + k - TANGENT
    return c.TWIST + 1 if k == TWIST else c.ROLL + 2 + k - ROLL


@compiled(cached=False, fast=True)
def weigh(own: Any, rows: Any, fallen: float, most: float) -> None:
    """Find the mass as which points and tangents are as stiff: parts of what bears on them, a point on no more than there is.

    Weights gain the speed ``fallen`` in a substep, none in an instant. Where nothing falls, forces alone are no weight.
    """
    total = 0.0
    for k in range(TANGENT):
        impulse = own[impulse_field(k) * _W]
        rows[WEIGHT + k] = BEARING * min(impulse / fallen, most) if fallen > 0.0 else 0.0
        total += rows[WEIGHT + k]
    for k in range(TANGENT, TWIST):
        rows[WEIGHT + k] = BEARING_GRIP * total


@compiled(cached=False, fast=True)
def begin_row(own: Any, rows: Any, k: int, velocity: Any, a: int, b: int, rigid: float, world: int) -> None:
    """Write the wrench of a row, its speed and its stiffness; it takes part if it can be moved.

    It is as stiff as if it moved the mass that bears on it, or more. Where the bodies are of two islands, the other one (`CUT`:
    1: a, 2: b) answers as if it were alone.
    """
    wrench = rows[WRENCH + 12 * k : WRENCH + 12 * k + 12]
    write_wrench(own, k, wrench)
    of_a, of_b = mobility(wrench, a, 0, world), mobility(wrench, b, 1, world)
    yielding, other = of_a + of_b, of_a if rows[CUT] == 1.0 else of_b if rows[CUT] == 2.0 else 0.0
    rows[ACTIVE + k] = 1.0 if yielding > 0.0 else 0.0
    rows[ROW_MASS + k] = 1.0 / yielding if yielding > 0.0 else 0.0
    stiff = rigid * (max(1.0, yielding * rows[WEIGHT + k]) if k < TWIST else 1.0)
    rows[STIFFNESS + k] = 1.0 / (yielding / stiff + other) if yielding > 0.0 else 0.0
    rows[SPEED + k], rows[IMPULSE + k] = along(wrench, velocity), own[impulse_field(k) * _W]
    rows[WANTED + k], rows[MOVED + k], rows[GIVEN + k], rows[STATE + k] = 0.0, 0.0, 0.0, OPEN
    rows[ACCEPTED + k], rows[BORNE + k], rows[BASE + k] = 0.0, 0.0, 0.0


@compiled(inline=True, cached=False, fast=True)
def first_row(bound: int) -> int:
    """First row of a bound: tangents, twist, rolling."""
    return TANGENT if bound == 0 else TWIST if bound == 1 else ROLL


@compiled(inline=True, cached=False, fast=True)
def bound_rows(bound: int) -> int:
    """Rows that have a bound in common."""
    return 2 if bound == 0 else 1 if bound == 1 else 3


@compiled(cached=False, fast=True)
def find_bounds(own: Any, rows: Any) -> None:
    """Bound friction, twist and rolling resistance by what the points carry with the solution at hand."""
    normal, lever = 0.0, 0.0
    for k in range(TANGENT):
        if rows[ACTIVE + k] != 0.0:
            carried = max(rows[IMPULSE + k] + rows[GIVEN + k], 0.0)
            normal += carried
            lever += carried * own[(c.P + c.POINT_FIELDS * k + c.LEVER) * _W]
    friction = own[c.FRICTION * _W]
    rows[BOUND], rows[BOUND + 1], rows[BOUND + 2] = friction * normal, friction * lever, own[c.ROLL * _W] * normal


@compiled(cached=False, fast=True)
def update_point_states(rows: Any, first: bool) -> bool:
    """Assume that points push or are open as the current solution implies; return whether nothing changes."""
    settled = True
    for k in range(TANGENT):
        if rows[ACTIVE + k] == 0.0:
            continue
        missing, stiffness = rows[WANTED + k] - rows[SPEED + k], rows[STIFFNESS + k]
        pull = rows[ROW_MASS + k] if first else stiffness
        wish = rows[IMPULSE + k] + rows[BASE + k] + pull * (missing - rows[MOVED + k])
        if not first:
            wish += -MISSED * stiffness if rows[STATE + k] == OPEN else MISSED * rows[ROW_MASS + k]
        state = HELD if wish > 0.0 else OPEN
        settled = settled and state == rows[STATE + k]
        rows[STATE + k] = state
        rows[CONSTANT + k] = rows[BASE + k] + stiffness * missing if state == HELD else -rows[IMPULSE + k]
    return settled


@compiled(cached=False, fast=True)
def update_bound_states(rows: Any, bound: int, first: bool) -> bool:
    """Assume that friction, twist or rolling resistance holds or slides; return whether that is nothing new."""
    begin, count = first_row(bound), bound_rows(bound)
    end, most = begin + count, rows[BOUND + bound]
    stiffness, was = rows[STIFFNESS + begin], rows[STATE + begin]
    if most <= MISSED * rows[ROW_MASS + begin]:
        for k in range(begin, end):
            rows[CONSTANT + k], rows[DIRECTION + k] = -rows[IMPULSE + k], 0.0
        rows[STATE + begin], rows[SLIDE + bound] = SLIDING, 0.0
        return True
    size = _wish(rows, begin, end, rows[ROW_MASS + begin] if first else stiffness)
    state = HELD if size <= most else SLIDING
    if first and state == SLIDING:
        size = _wish(rows, begin, end, stiffness)
    off = 0.0
    for k in range(begin, end):
        within = rows[CONSTANT + k] * min(1.0, most / (size + 1e-300))
        off = max(off, abs(within - rows[IMPULSE + k] - rows[GIVEN + k]))
    settled: bool = not first and off <= SLIPPED * rows[ROW_MASS + begin]
    rows[STATE + begin] = state
    if state == HELD:
        for k in range(begin, end):
            rows[CONSTANT + k] = rows[BASE + k] + stiffness * (rows[WANTED + k] - rows[SPEED + k])
            rows[DIRECTION + k] = 0.0
        return settled or was == HELD
    for k in range(begin, end):
        rows[DIRECTION + k] = rows[CONSTANT + k] / size
    _slide(rows, bound, most, most / size)
    return settled


@compiled(cached=False, fast=True)
def _wish(rows: Any, begin: int, end: int, stiffness: float) -> float:
    """Find the impulse that would hold, as a constant of the rows, and return its size."""
    square = 0.0
    for k in range(begin, end):
        wish = rows[IMPULSE + k] + rows[BASE + k] - stiffness * (rows[SPEED + k] + rows[MOVED + k] - rows[WANTED + k])
        rows[CONSTANT + k] = wish
        square += wish * wish
    return math.sqrt(square)


@compiled(cached=False, fast=True)
def _slide(rows: Any, bound: int, most: float, share: float) -> None:
    """Let rows slide with their greatest impulse, of which a share of the stiffness turns the direction."""
    begin, count = first_row(bound), bound_rows(bound)
    rows[SLIDE + bound] = share
    for k in range(begin, begin + count):
        left = rows[MOVED + k]
        for j in range(begin, begin + count):
            left -= rows[DIRECTION + k] * rows[DIRECTION + j] * rows[MOVED + j]
        turning = rows[STIFFNESS + begin] * share * left
        rows[CONSTANT + k] = most * rows[DIRECTION + k] - rows[IMPULSE + k] + turning


@compiled(cached=False, fast=True)
def bind_points(rows: Any) -> None:
    """Bound the impulses of points from below: none pulls."""
    for k in range(TANGENT):
        if rows[ACTIVE + k] != 0.0:
            rows[GIVEN + k] = max(rows[GIVEN + k], -rows[IMPULSE + k])


@compiled(cached=False, fast=True)
def bind(rows: Any) -> None:
    """Keep the impulses of the solution at hand within their bounds."""
    bind_points(rows)
    for bound in range(3):
        begin, end = first_row(bound), first_row(bound) + bound_rows(bound)
        if rows[ACTIVE + begin] == 0.0:
            continue
        square, most = 0.0, rows[BOUND + bound]
        for k in range(begin, end):
            square += (rows[IMPULSE + k] + rows[GIVEN + k]) ** 2
        share = min(1.0, most / math.sqrt(square)) if square > 0.0 else 0.0
        for k in range(begin, end):
            rows[GIVEN + k] = share * (rows[IMPULSE + k] + rows[GIVEN + k]) - rows[IMPULSE + k]


@compiled(cached=False, fast=True)
def fix(rows: Any) -> None:
    """Let all rows give what the bodies bear at the solution that was accepted, within their bounds, whatever moves.

    What laws would give there is far from it where rows are stiff.
    """
    for k in range(CONTACT_ROWS):
        rows[GIVEN + k] = rows[BORNE + k]
    bind(rows)
    for k in range(CONTACT_ROWS):
        rows[CONSTANT + k] = rows[GIVEN + k]
    for k in range(TANGENT):
        rows[STATE + k] = OPEN
    for bound in range(3):
        rows[STATE + first_row(bound)], rows[SLIDE + bound] = SLIDING, 0.0


@compiled(cached=False, fast=True)
def give_of(rows: Any, k: int, bound: int) -> float:
    """Impulse along a row with the solution at hand."""
    impulse: float = rows[CONSTANT + k]
    stiffness, moved = 0.0, 0.0
    if bound < 0:
        if rows[STATE + k] == HELD:
            stiffness, moved = rows[STIFFNESS + k], rows[MOVED + k]
    else:
        begin, end = first_row(bound), first_row(bound) + bound_rows(bound)
        stiffness, moved = rows[STIFFNESS + begin], rows[MOVED + k]
        if rows[STATE + begin] != HELD:
            stiffness *= rows[SLIDE + bound]
            for j in range(begin, end):
                moved -= rows[DIRECTION + k] * rows[DIRECTION + j] * rows[MOVED + j]
    return impulse - stiffness * moved

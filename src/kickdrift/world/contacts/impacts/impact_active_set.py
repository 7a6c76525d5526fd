"""Impulses of a round of impacts that sweeps would take thousands of turns to find: a light body between heavy ones.

The points that press are an active set, and elimination brings all of them to their target velocities at once. Where one of
them would have to pull, the impulses change only until its own reaches its bound, and it leaves the set, so that no step adds
energy. The sweeps go on from there, and may let points join. After M. Silcowitz, S. Niebe and K. Erleben, "Projected
Gauss-Seidel Subspace Minimization Method for Interactive Rigid Body Dynamics" (2010).
"""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.linear_algebra import lu_factor, lu_solve
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import applied, dot
from kickdrift.world.columns import point_at, symmetric_at
from kickdrift.world.contacts.impacts.impact_motion import is_moved
from kickdrift.world.contacts.impacts.impact_rows import (
    BOUNCE,
    IMPULSE,
    NORMAL,
    PLASTIC,
    ROW,
    RUBBING,
    TURN_A,
    TURN_B,
    bodies_of,
    is_left_out,
    missing_speed,
    point_of,
    press,
)
from kickdrift.world.contacts.impacts.impact_worklist import may_change, note_change
from kickdrift.world.layout import GROUP, INVERSE_INERTIA_IN_WORLD, INVERSE_LINEAR_MASS
from kickdrift.world.tables import IMPACT, INVERSE_MASS, KICKED, floats, rows

_MOST = 128  # points; larger groups are left to the sweeps
_ROOM = _MOST * _MOST
_SHIFT = 1e-12  # of a response: shares the impulse of points whose responses depend on each other, as those of a face


@compiled
def solve_pressed(world: int, sweep: int, part: int) -> None:
    """Bring the points that press to their target velocities, in each group of contacts that a sweep has still changed.

    Targets, bounds and points are those of a part of the round in `kickdrift.world.contacts.impacts.simultaneous_impact`.
    Movable bodies connect contacts to groups, and what happens in one does not depend on the others.
    """
    _find_groups(world)
    for first in range(rows(world, IMPACT)):
        if _group(world, first) == first and _solve_group(world, first, sweep, part):
            for hit in range(first, rows(world, IMPACT)):
                if _group(world, hit) == first:
                    note_change(world, int(floats(world, IMPACT)[hit, ROW]), sweep)


@compiled
def _find_groups(world: int) -> None:
    """Give the bodies of each group the number of its first hit."""
    impact, kicked, changed = floats(world, IMPACT), floats(world, KICKED), True
    for hit in range(rows(world, IMPACT)):
        for body in bodies_of(world, impact[hit]):
            if is_moved(world, body):
                kicked[body, GROUP] = hit
    while changed:
        changed = False
        for hit in range(rows(world, IMPACT)):
            group = _group(world, hit)
            for body in bodies_of(world, impact[hit]):
                if is_moved(world, body) and kicked[body, GROUP] != group:
                    kicked[body, GROUP], changed = group, True


@compiled(inline=True)
def _group(world: int, hit: int) -> int:
    """Return the least group of the movable bodies of a hit."""
    impact, kicked, group = floats(world, IMPACT), floats(world, KICKED), hit
    for body in bodies_of(world, impact[hit]):
        if is_moved(world, body):
            group = min(group, int(kicked[body, GROUP]))
    return group


@compiled
def _solve_group(world: int, first: int, sweep: int, part: int) -> bool:
    """Solve the points of a group that press; return whether any impulse has changed."""
    points, matrix = carray(floats_on_stack(_MOST), (_MOST,)), carray(floats_on_stack(_ROOM), (_ROOM,))
    pivots, change = carray(floats_on_stack(_MOST), (_MOST,)), carray(floats_on_stack(_MOST), (_MOST,))
    count, changed = _find_pressed(world, first, sweep, part, points), False
    while 0 < count <= _MOST:
        for i in range(count):
            for j in range(count):
                matrix[i * count + j] = _response(world, int(points[i]), int(points[j]))
            matrix[i * count + i] *= 1.0 + _SHIFT
            change[i] = _missing(world, int(points[i]), part)
        if not lu_factor(matrix[: count * count], pivots[:count]):
            return changed
        lu_solve(matrix[: count * count], pivots[:count], change[:count])
        share, blocking = 1.0, -1
        for i in range(count):
            above = max(_impulse_above_bound(world, int(points[i]), part), 0.0)  # rounding leaves some below
            if above + share * change[i] < 0.0:
                share, blocking = -above / change[i], i
        for i in range(count):
            hit, point = _hit_and_point(world, int(points[i]))
            press(world, hit, point, share * change[i])
        changed = True
        if blocking < 0:
            break
        count -= 1
        points[blocking] = points[count]
    return changed


@compiled
def _find_pressed(world: int, first: int, sweep: int, part: int, points: Any) -> int:
    """List the points of a group that press or approach, four to a contact, and return their number; 0 if it has settled.

    More than fit are only counted.
    """
    impact, count, settled = floats(world, IMPACT), 0, True
    for hit in range(first, rows(world, IMPACT)):
        if _group(world, hit) != first:
            continue
        settled = settled and not may_change(world, int(impact[hit, ROW]), sweep + 1)
        for k in range(4):
            which = 4 * hit + k
            if is_left_out(point_of(impact[hit], k), part):
                continue
            if _impulse_above_bound(world, which, part) > 0.0 or _missing(world, which, part) > 0.0:
                if count < _MOST:
                    points[count] = which
                count += 1
    return 0 if settled else count


@compiled(inline=True)
def _hit_and_point(world: int, which: int) -> tuple[Any, Any]:
    hit = floats(world, IMPACT)[which // 4]
    return hit, point_of(hit, which % 4)


@compiled(inline=True)
def _missing(world: int, which: int, part: int) -> float:
    """Return by how much the velocity of a point misses its target, m/s."""
    hit, point = _hit_and_point(world, which)
    return missing_speed(world, hit, point, part)


@compiled(inline=True)
def _impulse_above_bound(world: int, which: int, part: int) -> float:
    """Return how far the impulse of a point is above the least that it may be, N s."""
    hit, point = _hit_and_point(world, which)
    above: float = point[IMPULSE] + (hit[BOUNCE] * point[PLASTIC] if part == RUBBING else 0.0)
    return above


@compiled
def _response(world: int, which: int, other: int) -> float:
    """Return the change of the normal velocity of a point by a unit impulse at another, 1/kg."""
    (hit, point), (source_hit, source) = _hit_and_point(world, which), _hit_and_point(world, other)
    (a, b), (source_a, source_b) = bodies_of(world, hit), bodies_of(world, source_hit)
    aligned = dot(point_at(hit, NORMAL), point_at(source_hit, NORMAL))
    inverse_mass, total = floats(world, INVERSE_MASS), 0.0
    for body, turn, sign in ((a, TURN_A, -1.0), (b, TURN_B, 1.0)):
        for source_body, source_turn, source_sign in ((source_a, TURN_A, -1.0), (source_b, TURN_B, 1.0)):
            if body == source_body:
                inertia = symmetric_at(inverse_mass, body, INVERSE_INERTIA_IN_WORLD)
                rotation = dot(point_at(point, turn), applied(inertia, point_at(source, source_turn)))
                total += sign * source_sign * (inverse_mass[body, INVERSE_LINEAR_MASS] * aligned + rotation)
    return total

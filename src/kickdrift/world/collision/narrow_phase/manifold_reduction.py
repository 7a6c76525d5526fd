"""Manifold reduction: up to four points are chosen from the candidates of a contact."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, times
from kickdrift.world.collision.narrow_phase.manifold_candidates import CANDIDATE, SEPARATION, point_of
from kickdrift.world.contacts.layout import LEFT_OUT, REACHABLE

_STEADY = 0.95  # factor by which a candidate must be better than an earlier one, so that the choice does not flicker
# Of the extent of the chosen points from an edge: distances of a load inside of it and beyond it between which the edge matters
_NEAR_EDGE, _FAR_BEYOND = 0.2, 0.5
_MOST_REPLACED = 4  # points that are replaced at most
_THIN = 1e-6  # area of a triangle, over the square of its longest side, below which its third corner adds nothing


@compiled
def choose(
    candidates: Any, count: int, normal: Vector, tolerance: float, load: Vector, manifold: Any, chosen: Any
) -> int:
    """Choose up to four candidates, write their indices, and return their number.

    The lowest four, unless more than four are reachable (`kickdrift.world.contacts.layout.REACHABLE`): then four of these that
    span nearly the same area, and have an edge where a load near the border of all of them would tip. A polyhedron that rolls
    on many corners would otherwise sink in at the next of them, which is close to the one it stands on and adds no area.
    `load` is where the weight acts, in the frame of the candidates.
    """
    if count <= 4:
        for k in range(count):
            chosen[k] = k
        return count
    reachable, kept = 0, 4
    for k in range(count):
        reachable += candidates[CANDIDATE * k + SEPARATION] <= manifold[REACHABLE]
    if reachable <= 4:
        _choose_lowest(candidates, count, chosen)
    else:
        _drop_above(candidates, count, manifold[REACHABLE])
        count = reachable
        kept = _choose_by_area(candidates, count, normal, tolerance, chosen)
        if kept == 4:
            _surround(candidates, count, normal, load, chosen)
    manifold[LEFT_OUT] = math.inf
    for k in range(count):
        if not _is_chosen(chosen, kept, k):
            manifold[LEFT_OUT] = min(manifold[LEFT_OUT], candidates[CANDIDATE * k + SEPARATION])
    return kept


@compiled(inline=True)
def _is_chosen(chosen: Any, count: int, candidate: int) -> bool:
    found = False
    for k in range(count):
        found |= chosen[k] == candidate
    return found


@compiled
def _choose_lowest(candidates: Any, count: int, chosen: Any) -> None:
    """Choose the four candidates of smallest separation."""
    for kept in range(4):
        least = math.inf
        for k in range(count):
            gap = candidates[CANDIDATE * k + SEPARATION]
            if gap < least and not _is_chosen(chosen, kept, k):
                chosen[kept], least = k, gap


@compiled
def _drop_above(candidates: Any, count: int, highest: float) -> None:
    """Move candidates up to where those with a larger separation than the highest were."""
    kept = 0
    for k in range(count):
        if candidates[CANDIDATE * k + SEPARATION] <= highest:
            for j in range(CANDIDATE):
                candidates[CANDIDATE * kept + j] = candidates[CANDIDATE * k + j]
            kept += 1


@compiled
def _choose_by_area(candidates: Any, count: int, normal: Vector, tolerance: float, chosen: Any) -> int:
    """Choose up to four candidates that span nearly the same area as all of them, and return their number.

    The deepest; the farthest from it; the one that forms the largest triangle with both; and the one that adds the largest area
    to this.
    """
    first = count - 1
    for k in range(count - 1):
        if candidates[CANDIDATE * k + SEPARATION] < candidates[CANDIDATE * first + SEPARATION] - tolerance:
            first = k
    chosen[0] = first
    a = point_of(candidates, first)
    second, longest = count, 0.0
    for k in range(count):
        arm = cross(normal, minus(point_of(candidates, k), a))
        square = dot(arm, arm)
        if _STEADY * square > longest:
            second, longest = k, square
    if second == count:
        return 1
    chosen[1] = second
    b = point_of(candidates, second)
    third, largest, least = count, 0.0, _THIN * longest
    for k in range(count):
        area = _area(a, b, point_of(candidates, k), normal)
        if _STEADY * abs(area) > max(abs(largest), least):
            third, largest = k, area
    if third == count:
        return 2
    chosen[2] = third
    c = point_of(candidates, third)
    way = times(-1.0 if largest < 0.0 else 1.0, normal)
    fourth, most = count, least
    for k in range(count):
        p = point_of(candidates, k)
        added = max(_area(b, a, p, way), _area(c, b, p, way), _area(a, c, p, way))
        if _STEADY * added > most:
            fourth, most = k, added
    if fourth == count:
        return 3
    chosen[3] = fourth
    return 4


@compiled
def _surround(candidates: Any, count: int, normal: Vector, load: Vector, chosen: Any) -> None:
    """Replace chosen points until no candidate lies beyond the edge near which a load acts.

    Of regular prisms that lean with their centre of mass above the base, a quarter or a tenth of the inradius from its border,
    those of six, twelve and twenty sides rock for ever or fall at most angles without.
    """
    for _ in range(_MOST_REPLACED):
        one, two, inside = _edge_near(candidates, normal, load, chosen)
        if one == two:
            return
        a, b = point_of(candidates, int(chosen[one])), point_of(candidates, int(chosen[two]))
        third, fourth = _other(one, two, 0), _other(one, two, 1)
        area = _area(a, b, point_of(candidates, int(chosen[third])), normal)
        more = _area(a, b, point_of(candidates, int(chosen[fourth])), normal)
        beyond, most = count, _THIN * max(abs(area), abs(more))
        for k in range(count):
            added = -inside * _area(a, b, point_of(candidates, k), normal)
            if _STEADY * added > most:
                beyond, most = k, added
        if beyond == count:
            return
        chosen[third if _STEADY * abs(more) > abs(area) else fourth] = beyond


@compiled
def _edge_near(candidates: Any, normal: Vector, load: Vector, chosen: Any) -> tuple[int, int, float]:
    """Return the ends of the edge of the four chosen points that is nearest to a load, and the sign of areas inside of it.

    The ends are equal if the load is far from all edges.
    """
    one, two, inside, closest = 0, 0, 1.0, math.inf
    for i in range(1, 4):
        for k in range(i):
            a, b = point_of(candidates, int(chosen[i])), point_of(candidates, int(chosen[k]))
            area = _area(a, b, point_of(candidates, int(chosen[_other(i, k, 0)])), normal)
            more = _area(a, b, point_of(candidates, int(chosen[_other(i, k, 1)])), normal)
            if area * more < 0.0:  # a diagonal
                continue
            side, edge = 1.0 if area + more >= 0.0 else -1.0, length(cross(normal, minus(b, a)))
            off, extent = side * _area(a, b, load, normal), max(abs(area), abs(more))
            if -_FAR_BEYOND * extent < off < _NEAR_EDGE * extent and off < closest * edge:
                one, two, inside, closest = i, k, side, off / edge
    return one, two, inside


@compiled(inline=True)
def _other(i: int, k: int, which: int) -> int:
    """Return the first or the second of the numbers from 0 to 3 that are neither i nor k."""
    found = 0
    for n in range(4):
        if n != i and n != k:
            if found == which:
                return n
            found += 1
    return 0


@compiled(inline=True)
def _area(a: Vector, b: Vector, c: Vector, normal: Vector) -> float:
    """Return twice the area of a triangle, positive if it is counter-clockwise seen against the normal."""
    return dot(cross(minus(b, a), minus(c, a)), normal)

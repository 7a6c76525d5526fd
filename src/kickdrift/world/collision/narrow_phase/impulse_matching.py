"""Impulses of points that are found again, for warm starting: each point takes over that of the point it was.

The manifolds of a shape with the triangles of one surface are parts of one contact. Where the shape moves on to the next
triangle, a point that one manifold loses is found in another, whose point there takes over its impulse, and its share of the
friction. Otherwise the loads of four wheels, which no law determines, would change at each edge that one of them crosses:
those of a quarter of the weight each would become 1.8 and 0.2 quarters.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, minus
from kickdrift.world.columns import Fields, column, point_at, vector_at
from kickdrift.world.contacts.layout import (
    FEATURE,
    FRICTION_IMPULSE,
    NORMAL_IMPULSE,
    ON_A,
    POINT,
    POINT_SIZE,
    POINTS,
    ROLLING_IMPULSE,
    SHAPE_A,
    SHAPE_B,
    TWIST_IMPULSE,
)
from kickdrift.world.layout import LAST_LOST
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import CONTACT, LOST_POINT, MANIFOLD, PLACED, floats, integers, room, rows, set_rows

# Columns of LOST_POINT: points of triangles whose impulse no point of the same manifold has taken over
_SURFACE = column(LOST_POINT)  # first shape of its contact
_BEFORE = column(LOST_POINT)  # row, plus 1, of the point that the second shape has lost before it
_PLACE = column(LOST_POINT, 3, "m")  # where it would be now, in the frame of the surface
_SQUARE = column(LOST_POINT, 1, "m^2")  # squared distance of the nearest point now, or of those that are too far
_ROW = column(LOST_POINT)  # contact of that point, or -1
_POINT = column(LOST_POINT)
_IMPULSE = column(LOST_POINT, 1, "N s")
_FRICTION = column(LOST_POINT, 7)  # its share of the impulses of the contact that are not those of points
_SHARED = (*range(FRICTION_IMPULSE, FRICTION_IMPULSE + 3), TWIST_IMPULSE, *range(ROLLING_IMPULSE, ROLLING_IMPULSE + 3))

# Numbers of a manifold that are kept while its points are found again
_KEPT = Fields()
_KEPT.field(4 * POINT_SIZE)  # points
_OLD_IMPULSE = _KEPT.field(4, "N s")
OLD_SIZE = _KEPT.close()


@compiled
def keep_points(own: Any, before: int, old: Any) -> None:
    """Copy the points of a manifold, as many as there were before, and their normal impulses."""
    for k in range(before):
        for j in range(POINT_SIZE):
            old[POINT_SIZE * k + j] = own[POINT + POINT_SIZE * k + j]
        old[_OLD_IMPULSE + k] = own[NORMAL_IMPULSE + k]


@compiled
def take_over_impulses(own: Any, old: Any, before: int, count: int, near: float) -> None:
    """Give each point the impulse of the old point with its features, or else of the nearest one left within `near`.

    If a corner lies on an edge, rounding decides whether the point is the corner or a crossing of edges.
    """
    left = before
    for new in range(count):
        own[NORMAL_IMPULSE + new] = -1.0
        for k in range(before):
            if old[POINT_SIZE * k + FEATURE] == own[_id(new)]:
                own[NORMAL_IMPULSE + new] = old[_OLD_IMPULSE + k]
                old[_OLD_IMPULSE + k] = -1.0
                left -= 1
                break
    for new in range(count):
        if own[NORMAL_IMPULSE + new] >= 0.0:
            continue
        own[NORMAL_IMPULSE + new] = 0.0
        nearest, square = -1, near * near
        for k in range(before if left > 0 else 0):
            away = minus(point_at(own, POINT + POINT_SIZE * new + ON_A), point_at(old, POINT_SIZE * k + ON_A))
            if old[_OLD_IMPULSE + k] >= 0.0 and dot(away, away) < square:
                nearest, square = k, dot(away, away)
        if nearest >= 0:
            own[NORMAL_IMPULSE + new] = old[_OLD_IMPULSE + nearest]
            old[_OLD_IMPULSE + nearest] = -1.0
            left -= 1


@compiled
def reserve_lost_points(world: int) -> bool:
    """Whether there is room for all points that contacts may lose in the step; requests it if not."""
    if room(world, LOST_POINT) >= 4 * rows(world, CONTACT):
        return True
    ask_for_room(world, LOST_POINT, 4 * rows(world, CONTACT))
    return False


@compiled
def lose_points(world: int, row: int, old: Any, before: int, moved: Vector, near: float) -> None:
    """Note the old points of a triangle that have kept their impulses; `moved` is the way of the second shape since then."""
    contact, own, lost = integers(world, CONTACT), floats(world, MANIFOLD)[row], floats(world, LOST_POINT)
    placed, b = floats(world, PLACED), contact[row, SHAPE_B]
    total = 0.0
    for k in range(contact[row, POINTS]):
        total += own[NORMAL_IMPULSE + k]
    for k in range(before):
        total += max(old[_OLD_IMPULSE + k], 0.0)
    for k in range(before):
        impulse = old[_OLD_IMPULSE + k]
        if impulse <= 0.0:
            continue
        at = rows(world, LOST_POINT)
        lost[at, _SURFACE], lost[at, _BEFORE], lost[at, _IMPULSE] = contact[row, SHAPE_A], placed[b, LAST_LOST], impulse
        lost[at, _SQUARE], lost[at, _ROW] = near * near, -1
        for j in range(3):
            lost[at, _PLACE + j] = old[POINT_SIZE * k + ON_A + j] + moved[j]
        share = impulse / total if total > impulse else 1.0  # rounding may leave less than the last impulse
        for j in range(7):
            lost[at, _FRICTION + j] = own[_SHARED[j]] * share
            own[_SHARED[j]] -= lost[at, _FRICTION + j]
        total -= impulse
        placed[b, LAST_LOST] = at + 1
        set_rows(world, LOST_POINT, at + 1)


@compiled
def pass_on_impulses(t: float, h: float, world: int) -> None:
    """Add the impulses of points that shapes have lost on triangles to those of the nearest points on the same surface."""
    if rows(world, LOST_POINT) == 0:
        return
    contact, manifold, lost = integers(world, CONTACT), floats(world, MANIFOLD), floats(world, LOST_POINT)
    for row in range(rows(world, CONTACT)):
        last = int(floats(world, PLACED)[contact[row, SHAPE_B], LAST_LOST])
        for k in range(contact[row, POINTS] if last > 0 else 0):
            _offer(lost, last, contact[row, SHAPE_A], row, k, point_at(manifold[row], POINT + POINT_SIZE * k + ON_A))
    for at in range(rows(world, LOST_POINT)):
        row = int(lost[at, _ROW])
        if row >= 0:
            manifold[row, NORMAL_IMPULSE + int(lost[at, _POINT])] += lost[at, _IMPULSE]
            for j in range(7):
                manifold[row, _SHARED[j]] += lost[at, _FRICTION + j]


@compiled
def _offer(lost: Any, last: int, surface: int, row: int, point: int, at: Vector) -> None:
    """Let a point take over the impulses of those lost points of its shapes of which it is the nearest so far."""
    while last > 0:
        k = last - 1
        away = minus(at, vector_at(lost, k, _PLACE))
        if lost[k, _SURFACE] == surface and dot(away, away) < lost[k, _SQUARE]:
            lost[k, _ROW], lost[k, _POINT], lost[k, _SQUARE] = row, point, dot(away, away)
        last = int(lost[k, _BEFORE])


@compiled(inline=True)
def _id(point: int) -> int:
    return POINT + POINT_SIZE * point + FEATURE

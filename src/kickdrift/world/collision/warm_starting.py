"""Impulses of a manifold's points that are found again, for warm starting: each point takes over that of the point it was."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, minus
from kickdrift.world.columns import Fields, point_at
from kickdrift.world.contacts.layout import FEATURE, NORMAL_IMPULSE, ON_A, POINT, POINT_SIZE

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


@compiled(inline=True)
def _id(point: int) -> int:
    return POINT + POINT_SIZE * point + FEATURE

"""Clipping of one face by the sides of another (Sutherland and Hodgman 1974).

A polygon is a list of corners of `CORNER` numbers: a point, and the label of the side that begins there. Sides of the incident
face, the one that is clipped, keep their number k as label; sides cut by the k-th side of the reference face get -1 - k. The
labels before and after a corner thus identify it as a vertex of either face or as a crossing of two edges: the same features,
and so the same contact, whichever of the two faces clips the other.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector
from kickdrift.world.columns import Fields

# Numbers of a corner
_CORNER = Fields()
_CORNER.field(3, "m")  # point
LABEL = _CORNER.field()
CORNER = _CORNER.close()


@compiled
def clip(polygon: Any, count: int, spare: Any, normal: Vector, offset: float, slack: float, label: float) -> int:
    """Clip a convex polygon to normal . x <= offset, keeping corners that are outside by no more than the slack.

    Parameters
    ----------
    polygon, spare : pointers to floats
        The polygon, and scratch room for a polygon with two more corners, and a number per corner.
    count : int
        Number of corners.
    normal, offset
        The plane.
    slack : float
        Keeps a corner the same feature while rounding moves it back and forth across a side.
    label : float
        Label of the new side along the plane.

    Returns
    -------
    int
        New number of corners, at most one more.
    """
    outside = 0
    for k in range(count):
        at = CORNER * k
        height = polygon[at] * normal[0] + polygon[at + 1] * normal[1] + polygon[at + 2] * normal[2] - offset
        spare[k] = height
        if height > slack:
            outside += 1
    if outside == 0:
        return count
    kept = 0
    for k in range(count):
        following = k + 1 if k + 1 < count else 0
        here, there = spare[k], spare[following]
        at, to = CORNER * k, count + CORNER * kept
        if here <= slack:
            for i in range(CORNER):
                spare[to + i] = polygon[at + i]
            kept += 1
            if here >= 0.0 and there > slack:  # the corner is on the plane: no second one there
                spare[to + LABEL] = label
        if (here < 0.0 and there > slack) or (there < 0.0 and here > slack):
            to = count + CORNER * kept
            share = here / (here - there)
            for i in range(3):
                spare[to + i] = polygon[at + i] + share * (polygon[CORNER * following + i] - polygon[at + i])
            spare[to + LABEL] = label if here < 0.0 else polygon[at + LABEL]
            kept += 1
    for i in range(CORNER * kept):
        polygon[i] = spare[count + i]
    return kept


@compiled(inline=True)
def between(first: int, second: int, count: int) -> int:
    """Return the vertex between two adjacent sides of a face with `count` sides, the k-th of which begins at vertex k."""
    return first if first == second + 1 or (first == 0 and second == count - 1) else second

"""Normals of triangles: whether patches of a cloth, and the triangles around a particle, are flat, so that they touch nothing.

The normals, at present and predicted, are written with the boxes: see `swept_bounds`.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, plus
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import CORNERS, FLAT, FOLDED, NEXT_AROUND, NOT_KNOWN, STAR
from kickdrift.world.tables import FACE, FACE_STARS, FACE_TURN, ZONE, floats, integers

# Smallest cosine between the normals of a flat patch and a direction. Of six triangles around a vertex five may be in a patch,
# and if they are inclined by more than 30 degrees the first and the last may cross while the sixth is folded away.
_FLAT = 0.9
_BENT = 0.5  # likewise, of those of the triangles around a particle and their mean


@compiled
def is_flat(boxes: Any, m: int, n: int, o: int) -> bool:
    """Whether all normals in three boxes are close to one direction."""
    x, u = min(boxes[m, 0], boxes[n, 0], boxes[o, 0]), max(boxes[m, 3], boxes[n, 3], boxes[o, 3])
    y, v = min(boxes[m, 1], boxes[n, 1], boxes[o, 1]), max(boxes[m, 4], boxes[n, 4], boxes[o, 4])
    z, w = min(boxes[m, 2], boxes[n, 2], boxes[o, 2]), max(boxes[m, 5], boxes[n, 5], boxes[o, 5])
    middle, half = (0.5 * (x + u), 0.5 * (y + v), 0.5 * (z + w)), (0.5 * (u - x), 0.5 * (v - y), 0.5 * (w - z))
    square = dot(middle, middle)
    least = square - (abs(middle[0]) * half[0] + abs(middle[1]) * half[1] + abs(middle[2]) * half[2])
    flat: bool = least > 0.0 and least * least >= _FLAT * _FLAT * square
    return flat


@compiled(inline=True)
def forget_star(world: int, f: int) -> None:
    """Note that the triangles around the corners of a triangle have moved."""
    face, zone = integers(world, FACE), integers(world, ZONE)
    for k in range(3):
        zone[face[f, CORNERS + k], STAR] = NOT_KNOWN


@compiled
def is_flat_around(world: int, f: int, k: int) -> bool:
    """Whether all triangles around corner k of a triangle face one way, at present and predicted, so that none covers another.

    Projected along that direction they do not overlap: each is turned by less than a right angle, and their angles add up to
    one turn.
    """
    face, zone = integers(world, FACE), integers(world, ZONE)
    i = face[f, CORNERS + k]
    if zone[i, STAR] == NOT_KNOWN:
        zone[i, STAR] = FLAT if _have_one_side(world, _first_corner(world, 3 * f + k)) else FOLDED
    flat: bool = zone[i, STAR] == FLAT
    return flat


@compiled
def _first_corner(world: int, corner: int) -> int:
    """Return the corner with the lowest number around the particle of a corner, 3 f + k.

    Sums begin there: threads may ask for the same particle at different corners, and find the same.
    """
    after = integers(world, FACE_STARS)
    first: int = corner
    at: int = corner
    while True:
        at = after[at // 3, NEXT_AROUND + at % 3]
        first = min(first, at)
        if at == corner:
            return first


@compiled
def _have_one_side(world: int, corner: int) -> bool:
    """Whether the normals of the triangles around a corner, 3 f + k, are within `_BENT` of their mean."""
    after, turn = integers(world, FACE_STARS), floats(world, FACE_TURN)
    total, at = (0.0, 0.0, 0.0), corner
    while True:
        total = plus(total, plus(vector_at(turn, at // 3, 0), vector_at(turn, at // 3, 3)))
        at = after[at // 3, NEXT_AROUND + at % 3]
        if at == corner:
            break
    least = math.inf
    while True:
        least = min(least, dot(total, vector_at(turn, at // 3, 0)), dot(total, vector_at(turn, at // 3, 3)))
        at = after[at // 3, NEXT_AROUND + at % 3]
        if at == corner:
            break
    flat: bool = least > 0.0 and least * least > _BENT * _BENT * dot(total, total)
    return flat


@compiled(inline=True)
def least_cosine(world: int, f: int, g: int) -> float:
    """Return the smallest cosine between the normals of two triangles, at present and predicted."""
    turn = floats(world, FACE_TURN)
    a, b, c, d = vector_at(turn, f, 0), vector_at(turn, f, 3), vector_at(turn, g, 0), vector_at(turn, g, 3)
    return min(dot(a, c), dot(a, d), dot(b, c), dot(b, d))

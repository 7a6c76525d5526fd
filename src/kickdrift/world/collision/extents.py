"""Boxes along the world's axes that shapes fill, relative to their origins, by the kind of shape."""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, dot, length, turned
from kickdrift.world.collision.tree import Box
from kickdrift.world.shapes.kinds import BOX, CAPSULE, HULL, SPHERE
from kickdrift.world.shapes.mesh import TRIANGLE_SIZE
from kickdrift.world.shapes.polyhedron import HEADER, VERTICES

FIRST_TRIANGLE = 1  # of the numbers of a mesh


@compiled(inline=True)
def extent(kind: int, numbers: Any, begin: int, size: int, q: Quaternion) -> tuple[Box, float]:
    """Return the box of a shape with an orientation, and the radius of a ball about its origin that it is in.

    The numbers are those of all shapes, one after the other. A plane has no such box, and no kind beside those here.
    """
    if kind == SPHERE:
        r = numbers[begin]
        return (-r, -r, -r, r, r, r), r
    if kind == CAPSULE:
        r, half = numbers[begin], numbers[begin + 1]
        axis = turned(q, (0.0, 0.0, half))
        return _symmetric((abs(axis[0]) + r, abs(axis[1]) + r, abs(axis[2]) + r)), half + r
    if kind == BOX:
        sides = (numbers[begin], numbers[begin + 1], numbers[begin + 2])
        return _symmetric(turned_extents(q, sides)), length(sides)
    if kind == HULL:
        return _around(numbers, begin + HEADER, 3, int(numbers[begin + VERTICES]), 1, q)
    return _around(numbers, begin + FIRST_TRIANGLE, TRIANGLE_SIZE, parts(size), 3, q)


@compiled(inline=True)
def parts(size: int) -> int:
    """Return the number of triangles of a mesh that has so many numbers."""
    return (size - FIRST_TRIANGLE) // TRIANGLE_SIZE


@compiled(inline=True)
def triangle(numbers: Any, begin: int, part: int) -> Box:
    """Return the box of a triangle in the frame of its mesh."""
    at = begin + FIRST_TRIANGLE + TRIANGLE_SIZE * part
    x = (numbers[at], numbers[at + 3], numbers[at + 6])
    y = (numbers[at + 1], numbers[at + 4], numbers[at + 7])
    z = (numbers[at + 2], numbers[at + 5], numbers[at + 8])
    return (
        min(min(x[0], x[1]), x[2]),
        min(min(y[0], y[1]), y[2]),
        min(min(z[0], z[1]), z[2]),
        max(max(x[0], x[1]), x[2]),
        max(max(y[0], y[1]), y[2]),
        max(max(z[0], z[1]), z[2]),
    )


@compiled(inline=True)
def turned_extents(q: Quaternion, sides: Vector) -> Vector:
    """Return half the sides of what encloses a box of other half sides once it is turned: |R| sides."""
    w, x, y, z = q
    a, b, c = sides
    return (
        abs(1.0 - 2.0 * (y * y + z * z)) * a + abs(2.0 * (x * y - w * z)) * b + abs(2.0 * (x * z + w * y)) * c,
        abs(2.0 * (x * y + w * z)) * a + abs(1.0 - 2.0 * (x * x + z * z)) * b + abs(2.0 * (y * z - w * x)) * c,
        abs(2.0 * (x * z - w * y)) * a + abs(2.0 * (y * z + w * x)) * b + abs(1.0 - 2.0 * (x * x + y * y)) * c,
    )


@compiled(inline=True)
def _symmetric(half: Vector) -> Box:
    return (-half[0], -half[1], -half[2], half[0], half[1], half[2])


@compiled
def _around(numbers: Any, begin: int, width: int, count: int, points: int, q: Quaternion) -> tuple[Box, float]:
    """Enclose some points at the start of each of so many rows."""
    x, y, z = np.inf, np.inf, np.inf
    u, v, w = -np.inf, -np.inf, -np.inf
    reach = 0.0
    for row in range(count):
        for k in range(points):
            at = begin + width * row + 3 * k
            point = (numbers[at], numbers[at + 1], numbers[at + 2])
            reach = max(reach, dot(point, point))
            p = turned(q, point)
            x, y, z = min(x, p[0]), min(y, p[1]), min(z, p[2])
            u, v, w = max(u, p[0]), max(v, p[1]), max(w, p[2])
    return (x, y, z, u, v, w), np.sqrt(reach)

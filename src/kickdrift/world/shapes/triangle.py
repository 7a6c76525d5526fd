"""Triangles of surfaces."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, cross, dot, length, minus, times
from kickdrift.world.columns import Fields
from kickdrift.world.shapes.extents import Extent, around
from kickdrift.world.shapes.kind_numbers import TRIANGLE
from kickdrift.world.shapes.rays import MISS, Hit
from kickdrift.world.shapes.record import TRIANGLE_OF_SURFACE, Kind

# Numbers of a triangle
_TRIANGLE = Fields()
_TRIANGLE.field(9, "m")  # corners
ACTIVE_EDGES = _TRIANGLE.field(3)  # flags: see `kickdrift.world.shapes.mesh`
TRIANGLE_SIZE = _TRIANGLE.close()
FIRST_TRIANGLE = 1  # index of the first triangle in the numbers of a surface


@compiled(inline=True)
def triangles_of(size: int) -> int:
    """Return the number of triangles of a surface with `size` numbers."""
    return (size - FIRST_TRIANGLE) // TRIANGLE_SIZE


@compiled(inline=True)
def begin_of(begin: int, part: int) -> int:
    """Return where the numbers of a triangle begin, for a surface whose numbers begin at `begin`."""
    return begin + FIRST_TRIANGLE + TRIANGLE_SIZE * part


@compiled
def put_facing(u: Vector, v: Vector, w: Vector, point: Vector, numbers: Any) -> None:
    """Write the numbers of a triangle with its front towards a point and all edges active.

    Contacts are only with the front of a triangle, and not with edges inside a mesh.
    """
    if dot(cross(minus(v, u), minus(w, u)), minus(point, u)) < 0.0:
        v, w = w, v
    for k in range(3):
        numbers[k], numbers[3 + k], numbers[6 + k] = u[k], v[k], w[k]
    for k in range(ACTIVE_EDGES, TRIANGLE_SIZE):
        numbers[k] = 1.0


@compiled
def surface_extent(numbers: Any, q: Quaternion) -> Extent:
    """Return the bounds of a surface; see `kickdrift.world.shapes.record`."""
    return around(numbers, FIRST_TRIANGLE, TRIANGLE_SIZE, triangles_of(len(numbers)), 3, q)


@compiled(inline=True)
def triangle_box(numbers: Any, begin: int, part: int) -> Extent:
    """Return the bounds of a triangle in the frame of its surface."""
    at = begin_of(begin, part)
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


@compiled
def _ray(numbers: Any, origin: Vector, direction: Vector, limit: float) -> Hit:
    """Cast a ray at a triangle, from either side; see `kickdrift.world.shapes.rays`.

    Notes
    -----
    Woop, Benthin, Wald 2013, Watertight Ray/Triangle Intersection: corners are projected along the ray onto a coordinate plane.
    All triangles at an edge or a corner compute the same numbers, so that no ray slips through between them.
    """
    u = minus((numbers[0], numbers[1], numbers[2]), origin)
    v = minus((numbers[3], numbers[4], numbers[5]), origin)
    w = minus((numbers[6], numbers[7], numbers[8]), origin)
    ux, uy = _along_ray(u, direction)
    vx, vy = _along_ray(v, direction)
    wx, wy = _along_ray(w, direction)
    a, b, c = wx * vy - wy * vx, ux * wy - uy * wx, vx * uy - vy * ux
    if (a < 0.0 or b < 0.0 or c < 0.0) and (a > 0.0 or b > 0.0 or c > 0.0):
        return MISS
    across = cross(minus(v, u), minus(w, u))
    rise = dot(across, direction)
    if rise == 0.0:
        return MISS
    distance = dot(across, u) / rise
    if not 0.0 <= distance <= limit:
        return MISS
    normal = times(1.0 / length(across), across)
    return (distance, normal[0], normal[1], normal[2])


@compiled(inline=True)
def _along_ray(p: Vector, direction: Vector) -> tuple[float, float]:
    """Project a point along a ray onto the coordinate plane most perpendicular to it."""
    x, y, z = abs(direction[0]), abs(direction[1]), abs(direction[2])
    if x >= y and x >= z:
        return p[1] - direction[1] / direction[0] * p[0], p[2] - direction[2] / direction[0] * p[0]
    if y >= z:
        return p[2] - direction[2] / direction[1] * p[1], p[0] - direction[0] / direction[1] * p[1]
    return p[0] - direction[0] / direction[2] * p[2], p[1] - direction[1] / direction[2] * p[2]


RECORD = Kind(number=TRIANGLE, name="triangle", sort=TRIANGLE_OF_SURFACE, ray=_ray)

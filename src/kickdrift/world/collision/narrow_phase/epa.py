"""Overlaps that are deep for their shapes: the direction in which these come apart soonest, whichever features touch.

Where an edge has crossed the middle of a shape, its deepest point no longer tells the shortest way out. The expanding polytope
algorithm (van den Bergen, Proximity Queries and Penetration Depth Computation on 3D Game Objects, 2001) needs support points
only: a polytope in the Minkowski difference is expanded where its surface is nearest to the origin.
"""

from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled, specialise, unbound
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, cross, dot, length, minus, normal_to, plus, times
from kickdrift.world.collision.narrow_phase.manifold_points import put_normal, put_point
from kickdrift.world.collision.narrow_phase.shape_frames import directed_back, placed, placed_back
from kickdrift.world.columns import point_at
from kickdrift.world.contacts.layout import POINT
from kickdrift.world.shapes.closest_points import along
from kickdrift.world.shapes.frustum import Frustum, farthest, signed_distance
from kickdrift.world.shapes.polyhedron import support, vertex

# Of the tolerance of depths: an overlap beyond which the features that touch may be far from where they enter.
DEEP = 8.0

_EXACT = 1e-3  # of the depth
_CORNERS = 96
_FACES = 2 * _CORNERS - 4  # of a polyhedron all of whose faces are triangles
_CORNER, _FACE = 6, 7  # numbers of each: difference and point of the first shape; corners, normal and offset
_ALL_CORNERS, _ALL_FACES, _OUTLINE = _CORNER * _CORNERS, _FACE * _FACES, 6 * _FACES
_FEATURE = 1 << 23  # of the contact point

farthest_of_first: Any = unbound


@compiled(inline=True)
def _farthest_of_polyhedron(seen: Any, frame: Any, n: Vector) -> Vector:
    return vertex(seen, support(seen, n))


@compiled(inline=True)
def _farthest_of_frustum(a: Frustum, frame: Any, n: Vector) -> Vector:
    return placed(frame, farthest(a, directed_back(frame, n)))


@compiled(inline=True)
def is_off(f: Frustum, manifold: Any, on: int, tolerance: float) -> bool:
    """Whether the first contact point of a frustum is outside it; `on` is `ON_A` or `ON_B`, its place in the manifold."""
    distance, _ = signed_distance(f, point_at(manifold, POINT + on))
    return bool(distance > tolerance)


@compiled(inline=True)
def put_overlap(depth: float, normal: Vector, x: Vector, frame: Any, manifold: Any) -> int:
    """Write the contact point of an overlap that was found below; return 1, the number of points."""
    put_point(manifold, 0, placed_back(frame, x), along(x, depth, normal), _FEATURE)
    put_normal(manifold, directed_back(frame, times(-1.0, normal)))
    return 1


def _overlap(a: Any, frame: Any, f: Frustum) -> tuple[float, Vector, Vector]:
    """Find the smallest overlap of a shape and a frustum, in the frustum's frame.

    Parameters
    ----------
    a, frame
        The shape: a frustum, and its frame in the other's; or a polyhedron placed there.
    f : (3,) tuple
        The frustum.

    Returns
    -------
    depth : float
        By how far they overlap along the normal, m, exact to a thousandth; not positive if the two are apart.
    normal : (3,) tuple
        Unit vector from the frustum to the shape.
    x : (3,) tuple
        Contact point of the shape; that of the frustum is x + depth normal.
    """
    corners, faces = floats_on_stack(_ALL_CORNERS), floats_on_stack(_ALL_FACES)
    n, start = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(4):  # four corners that are not in one plane
        _put_corner(corners, k, farthest_of_first(a, frame, times(-1.0, n)), farthest(f, n))
        if k > 0:
            other = minus(farthest(f, times(-1.0, n)), farthest_of_first(a, frame, n))
            if abs(dot(n, minus(other, start))) > abs(dot(n, minus(_corner(corners, k), start))):
                _put_corner(corners, k, farthest_of_first(a, frame, n), farthest(f, times(-1.0, n)))
        start = _corner(corners, 0)
        if k == 1:
            way = minus(_corner(corners, 1), start)
            n = normal_to(times(1.0 / length(way), way))
        elif k == 2:
            n = cross(minus(_corner(corners, 1), start), minus(_corner(corners, 2), start))
            n = times(1.0 / length(n), n)
    total = plus(plus(start, _corner(corners, 1)), plus(_corner(corners, 2), _corner(corners, 3)))
    middle = times(0.25, total)
    for k in range(4):
        _put_face(faces, k, corners, k, (k + 1) % 4, (k + 2) % 4, middle)
    count, depth, normal = 4, np.inf, n
    for number in range(4, _CORNERS):
        face = _nearest_face(faces, count)
        n, offset = point_at(faces, face + 3), faces[face + 6]
        _put_corner(corners, number, farthest_of_first(a, frame, times(-1.0, n)), farthest(f, n))
        reach = dot(n, _corner(corners, number))
        if reach < depth:
            depth, normal = reach, n
        if reach - offset <= _EXACT * reach or reach <= 0.0:
            break
        count = _expand(faces, count, corners, number, middle)
    return depth, normal, _contact(faces, count, corners, normal)


@compiled(inline=True)
def _corner(corners: Any, k: int) -> Vector:
    return point_at(corners, _CORNER * k)


@compiled(inline=True)
def _point(corners: Any, k: int) -> Vector:
    return point_at(corners, _CORNER * k + 3)


@compiled(inline=True)
def _put_corner(corners: Any, k: int, x: Vector, y: Vector) -> None:
    at = _CORNER * k
    corners[at], corners[at + 1], corners[at + 2] = minus(y, x)
    corners[at + 3], corners[at + 4], corners[at + 5] = x


@compiled
def _put_face(faces: Any, k: int, corners: Any, p: int, q: int, r: int, middle: Vector) -> None:
    """Write the plane of three corners, whose normal points away from a point inside."""
    start, at = _corner(corners, p), _FACE * k
    n = cross(minus(_corner(corners, q), start), minus(_corner(corners, r), start))
    size = length(n)
    n = times((1.0 if dot(n, minus(start, middle)) >= 0.0 else -1.0) / max(size, 1e-300), n)
    faces[at], faces[at + 1], faces[at + 2] = p, q, r
    faces[at + 3], faces[at + 4], faces[at + 5] = n
    faces[at + 6] = dot(n, start) if size > 0.0 else np.inf


@compiled
def _nearest_face(faces: Any, count: int) -> int:
    """Return where the face begins whose plane is nearest to the origin, or farthest behind it."""
    nearest = 0
    for k in range(1, count):
        if faces[_FACE * k + 6] < faces[nearest + 6]:
            nearest = _FACE * k
    return nearest


@compiled
def _contact(faces: Any, count: int, corners: Any, normal: Vector) -> Vector:
    """Return the point of the first shape where a ray from the origin along the normal leaves the polytope."""
    best, x = -np.inf, (0.0, 0.0, 0.0)
    for face in range(0, _FACE * count, _FACE):
        if dot(point_at(faces, face + 3), normal) <= 0.0:
            continue
        p, q, r = int(faces[face]), int(faces[face + 1]), int(faces[face + 2])
        u, v, w = _corner(corners, p), _corner(corners, q), _corner(corners, r)
        volumes = (dot(normal, cross(v, w)), dot(normal, cross(w, u)), dot(normal, cross(u, v)))
        shares = times(1.0 / (volumes[0] + volumes[1] + volumes[2]), volumes)
        if min(shares) > best:
            best, x = min(shares), times(shares[0], _point(corners, p))
            x = along(along(x, shares[1], _point(corners, q)), shares[2], _point(corners, r))
    return x


@compiled
def _expand(faces: Any, count: int, corners: Any, number: int, middle: Vector) -> int:
    """Replace the faces that a new corner is above by those between it and their outline; return the number of faces."""
    outline = floats_on_stack(_OUTLINE)
    edges, k, p = 0, 0, _corner(corners, number)
    while k < count:
        at = _FACE * k
        if dot(point_at(faces, at + 3), p) <= faces[at + 6]:
            k += 1
            continue
        for side in range(3):
            edges = _toggle(outline, edges, faces[at + side], faces[at + (side + 1) % 3])
        count -= 1
        for i in range(_FACE):
            faces[at + i] = faces[_FACE * count + i]
    # Rounding may add edges to the outline of a face that is nearly flat. Where they are too many, the polytope stays open, and
    # the depth is a bound from above, as in every round.
    for edge in range(min(edges, _FACES - count)):
        _put_face(faces, count, corners, int(outline[2 * edge]), int(outline[2 * edge + 1]), number, middle)
        count += 1
    return count


@compiled
def _toggle(outline: Any, edges: int, p: float, q: float) -> int:
    """Add an edge to the outline, or remove it if it is there, as a side of two faces is; return the number of edges."""
    for k in range(edges):
        u, v = outline[2 * k], outline[2 * k + 1]
        if (u == p and v == q) or (u == q and v == p):
            outline[2 * k], outline[2 * k + 1] = outline[2 * edges - 2], outline[2 * edges - 1]
            return edges - 1
    outline[2 * edges], outline[2 * edges + 1] = p, q
    return edges + 1


overlap_of_polyhedron: Any = compiled(
    specialise(_overlap, "overlap_of_polyhedron", farthest_of_first=_farthest_of_polyhedron)
)
overlap_of_frusta: Any = compiled(specialise(_overlap, "overlap_of_frusta", farthest_of_first=_farthest_of_frustum))

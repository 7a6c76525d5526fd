"""Layout of convex polyhedra: vertices, planes, face loops and edges in one array of floats.

The array begins with `HEADER` numbers. They are followed by

- the vertices, three coordinates each;
- the planes of the faces, outward unit normal and offset (4): n . x <= offset inside;
- where the loop of each face begins among the entries of all loops, and where the last one ends (faces + 1);
- the vertices of all loops, each counter-clockwise as seen from outside;
- the edges of all loops: the one that begins at each of these vertices;
- the edges, each with its two vertices and the faces on its left and its right, as seen from outside (4).

Indices are floats, which hold them exactly.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_at
from kickdrift.core.vectors import Vector
from kickdrift.world.columns import Fields

Array = NDArray[np.float64]

# Numbers of the header
_HEADER = Fields()
VERTICES = _HEADER.field()  # number of vertices
FACES = _HEADER.field()
EDGES = _HEADER.field()
PLANES_AT = _HEADER.field()  # where the planes begin
LOOPS_AT = _HEADER.field()  # the starts of the loops
LOOP_VERTICES_AT = _HEADER.field()
LOOP_EDGES_AT = _HEADER.field()
EDGES_AT = _HEADER.field()
CENTRE = _HEADER.field(3, "m")  # an interior point: the mean of the vertices
THICKNESS = _HEADER.field(1, "m")  # half of the smallest distance between a face and the vertex farthest behind it
PUSHING = _HEADER.field()  # number of edges, the first ones, that may push: all, except for triangles of a mesh
HEADER = _HEADER.close()

MOST_VERTICES = 128
MOST_EDGES = 3 * MOST_VERTICES - 6  # Euler: of a polyhedron all of whose faces are triangles


@compiled(inline=True)
def pointer_to(numbers: Array) -> Any:
    """Return a pointer to the numbers of a polyhedron; an array would pass seven words in every call."""
    return floats_at(numbers.ctypes.data)


@compiled(inline=True)
def vertex(numbers: Any, index: int) -> Vector:
    """Return a vertex of a polyhedron."""
    at = HEADER + 3 * index
    return (numbers[at], numbers[at + 1], numbers[at + 2])


@compiled(inline=True)
def plane(numbers: Any, index: int) -> tuple[Vector, float]:
    """Return the outward unit normal of a face and its offset."""
    at = int(numbers[PLANES_AT]) + 4 * index
    return (numbers[at], numbers[at + 1], numbers[at + 2]), numbers[at + 3]


@compiled(inline=True)
def loop(numbers: Any, face: int) -> tuple[int, int]:
    """Return where the loop of a face starts and ends among the entries of all loops."""
    at = int(numbers[LOOPS_AT]) + face
    return int(numbers[at]), int(numbers[at + 1])


@compiled(inline=True)
def loop_vertex(numbers: Any, entry: int) -> int:
    """Return the vertex at an entry of the loops."""
    return int(numbers[int(numbers[LOOP_VERTICES_AT]) + entry])


@compiled(inline=True)
def loop_edge(numbers: Any, entry: int) -> int:
    """Return the edge that begins at the vertex of an entry of the loops."""
    return int(numbers[int(numbers[LOOP_EDGES_AT]) + entry])


@compiled(inline=True)
def edge(numbers: Any, index: int) -> tuple[int, int, int, int]:
    """Return the two vertices of an edge and the faces on its left and its right."""
    at = int(numbers[EDGES_AT]) + 4 * index
    return int(numbers[at]), int(numbers[at + 1]), int(numbers[at + 2]), int(numbers[at + 3])


@compiled
def support(numbers: Any, direction: Vector) -> int:
    """Return the support vertex in a direction, the first of equal ones."""
    best, farthest = 0, -np.inf
    for k in range(int(numbers[VERTICES])):
        at = HEADER + 3 * k
        way = numbers[at] * direction[0] + numbers[at + 1] * direction[1] + numbers[at + 2] * direction[2]
        if way > farthest:
            best, farthest = k, way
    return best


def polyhedron_numbers(vertices: Array, loops: Sequence[Sequence[int]]) -> Array:
    """Return the numbers of a closed convex polyhedron.

    Parameters
    ----------
    vertices : (V, 3) array
        m.
    loops : sequence of sequences of int
        Vertices of each face, counter-clockwise as seen from outside.
    """
    normals = np.array([face_normal(vertices[list(indices)]) for indices in loops])
    heights = normals @ vertices.T
    offsets = np.array([heights[face, list(indices)].mean() for face, indices in enumerate(loops)])
    sides: dict[tuple[int, int], int] = {
        (begin, end): face for face, indices in enumerate(loops) for begin, end in _steps(indices)
    }
    edges = [(begin, end) for begin, end in sides if begin < end]
    number = {edge: k for k, edge in enumerate(edges)}
    starts = np.cumsum([0, *map(len, loops)])
    loop_vertices = [index for indices in loops for index in indices]
    loop_edges = [number[min(step), max(step)] for indices in loops for step in _steps(indices)]
    edge_rows = [(begin, end, sides[begin, end], sides[end, begin]) for begin, end in edges]
    planes = np.column_stack((normals, offsets))
    parts = (vertices, planes, starts, loop_vertices, loop_edges, edge_rows)
    arrays = [np.asarray(part, dtype=np.float64).ravel() for part in parts]
    sizes = [array.size for array in arrays]
    header = np.zeros(HEADER)
    header[:CENTRE] = len(vertices), len(loops), len(edges), *(HEADER + np.cumsum(sizes)[:5])
    header[CENTRE : CENTRE + 3] = vertices.mean(axis=0)
    header[THICKNESS] = 0.5 * np.min(offsets - heights.min(axis=1))
    header[PUSHING] = len(edges)
    return np.concatenate((header, *arrays))


def face_normal(corners: Array) -> Array:
    """Return the unit normal of a polygon, (N, 3), weighted by area (Newell's method)."""
    arms = corners - corners[0]
    normal: Array = np.cross(arms[1:-1], arms[2:]).sum(axis=0)
    return normal / np.sqrt(normal @ normal)


def _steps(indices: Sequence[int]) -> list[tuple[int, int]]:
    return list(zip(indices, [*indices[1:], indices[0]], strict=True))

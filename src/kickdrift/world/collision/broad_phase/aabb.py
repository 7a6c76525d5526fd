"""Axis-aligned bounding boxes: overlap with each other and with half-spaces, and conversion to the frames of shapes."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import conjugate, dot, minus, turned, turned_back
from kickdrift.world.collision.broad_phase.bvh import Box
from kickdrift.world.collision.shape_poses import shape_pose
from kickdrift.world.shapes.extents import turned_extents
from kickdrift.world.tables import BOUNDS, floats


@compiled(inline=True)
def fat_bounds(world: int, shape: int) -> Box:
    """Return the fat bounds of a shape, with which its pairs were last sought."""
    box: Any = floats(world, BOUNDS)
    return (box[shape, 0], box[shape, 1], box[shape, 2], box[shape, 3], box[shape, 4], box[shape, 5])


@compiled(inline=True)
def boxes_overlap(a: Box, b: Box) -> bool:
    """Whether two boxes have points in common."""
    first = a[0] <= b[3] and a[1] <= b[4] and a[2] <= b[5]
    return first and b[0] <= a[3] and b[1] <= a[4] and b[2] <= a[5]


@compiled(inline=True)
def box_around(a: Box, b: Box) -> Box:
    """Return the smallest box around two boxes."""
    return (min(a[0], b[0]), min(a[1], b[1]), min(a[2], b[2]), max(a[3], b[3]), max(a[4], b[4]), max(a[5], b[5]))


@compiled
def reaches_under(world: int, plane: int, box: Box) -> bool:
    """Whether a box overlaps the half-space below a plane."""
    at, q = shape_pose(world, plane)
    n = turned(q, (0.0, 0.0, 1.0))
    # The deepest corner: n^T (centre - at) - |n|^T (half sides)
    lowest = (box[0] if n[0] > 0.0 else box[3], box[1] if n[1] > 0.0 else box[4], box[2] if n[2] > 0.0 else box[5])
    return dot(n, minus(lowest, at)) <= 0.0


@compiled
def box_in_frame(world: int, shape: int, box: Box) -> Box:
    """Return the bounds of a box along the axes of a shape's frame."""
    at, q = shape_pose(world, shape)
    centre = (0.5 * box[0] + 0.5 * box[3], 0.5 * box[1] + 0.5 * box[4], 0.5 * box[2] + 0.5 * box[5])
    half = turned_extents(conjugate(q), (box[3] - centre[0], box[4] - centre[1], box[5] - centre[2]))
    c = turned_back(q, minus(centre, at))
    return (c[0] - half[0], c[1] - half[1], c[2] - half[2], c[0] + half[0], c[1] + half[1], c[2] + half[2])

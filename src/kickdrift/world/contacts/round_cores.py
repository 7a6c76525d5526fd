"""Cores of round shapes: the part to which contact points are attached while the surface rolls.

The core of a ball is its centre, that of a capsule a segment; both touch at a radius from it along the normal. The core of a
cylinder or a cone is its axis: side and rims touch at a radius from it along the part of the normal perpendicular to it. This
is exact for rims and cylinders, and for cones, too: they touch planes along a line from the tip to the rim, and each of its
points has its own radius. Points of a flat end on which a shape stands are fixed in the body.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, cross, dot, turned
from kickdrift.world.collision.shape_properties import core_of
from kickdrift.world.layout import BEGIN, RADIUS, SHAPE_KIND
from kickdrift.world.shapes.frustum import radial
from kickdrift.world.shapes.kind_numbers import CAPSULE
from kickdrift.world.shapes.record import AXIS
from kickdrift.world.tables import GEOMETRY, PLACE, SHAPE, flat, floats, integers

# Radius of all points, or 0.0; the axis in the world's axes, or zeros; the direction of the radius, in the shape's frame
RollingCore = tuple[float, Vector, Vector]

_NONE: Vector = (0.0, 0.0, 0.0)
# Sine of the angle between a flat end and the surface below it, now or at the end of the step, below which its points are fixed
# in the body: the lowest point of the rim is determined by rounding then.
_STANDS = 0.05
_CENTRED = 1e-9  # of its size: distance of the centre of the body from the axis of a shape that turns about it
_ASTRAY = 0.01  # of the radius: distance by which points of the side may be off the plane of axis and normal


@compiled
def rolling_core(
    world: int, shape: int, radius: float, turn: Quaternion, way: Vector, normal: Vector, tilt: Vector
) -> RollingCore:
    """Return the core of a shape at a contact, whose direction is `way` in its frame and `normal` in the world's axes.

    `tilt` is the rotation vector of its body in the coming step, rad.
    """
    if core_of(world, shape) != AXIS:
        return radius, _NONE, way
    axis = turned(turn, (0.0, 0.0, 1.0))
    if abs(way[2]) + abs(dot(normal, cross(tilt, axis))) > math.sqrt(1.0 - _STANDS**2):
        return 0.0, _NONE, way
    _, x, y = radial(way[0], way[1])
    return 0.0, axis, (x, y, 0.0)


@compiled
def spin_axis(world: int, shape: int, turn: Quaternion, arm: Vector) -> Vector:
    """Return the axis of a solid of revolution if it passes through the centre of its body; zeros otherwise.

    Every normal of such a surface meets the axis, so that normal impulses have no torque about it. Points of a flat end, which
    are fixed in the body, are beside the true point of contact: with theirs, frictionless cylinders that land upright change
    their spin by up to 36 rad/s. `arm` is from the centre of the body to that of the shape.
    """
    if core_of(world, shape) != AXIS:
        return _NONE
    axis = turned(turn, (0.0, 0.0, 1.0))
    beside = cross(arm, axis)
    return axis if dot(beside, beside) <= (_CENTRED * floats(world, PLACE)[shape, RADIUS]) ** 2 else _NONE


@compiled(inline=True)
def half_axis(world: int, shape: int, turn: Quaternion) -> Vector:
    """Return the vector from the middle to the end of the core of a ball or a capsule, in the world's axes, m."""
    shapes = integers(world, SHAPE)
    if shapes[shape, SHAPE_KIND] != CAPSULE:
        return _NONE
    return turned(turn, (0.0, 0.0, flat(world, GEOMETRY)[shapes[shape, BEGIN] + 1]))


@compiled(inline=True)
def are_parallel(u: Vector, v: Vector, sine: float) -> bool:
    """Whether the sine of the angle between two half axes is at most `sine`; false for those of balls, which are zero."""
    across, sizes = cross(u, v), dot(u, u) * dot(v, v)
    return bool(sizes > 0.0 and dot(across, across) <= sine**2 * sizes)


@compiled(inline=True)
def rolls(shape: RollingCore) -> bool:
    """Whether any points of a shape are not fixed in its body."""
    return bool(shape[0] > 0.0 or dot(shape[1], shape[1]) > 0.0)


@compiled
def radius_at(shape: RollingCore, point: Vector) -> float:
    """Return the distance of a point of a shape from its core, m; 0.0 if the point is fixed in the body."""
    radius, axis, way = shape
    if dot(axis, axis) == 0.0:
        return radius
    out, beside = way[0] * point[0] + way[1] * point[1], way[0] * point[1] - way[1] * point[0]
    return out if abs(beside) <= _ASTRAY * out else 0.0

"""Of what is round, the core: what of a shape turns with its body while the rest rolls off.

The core of a ball is its centre, that of a capsule a segment, and both touch at a radius from it along the normal. That of a
cylinder or a cone is its axis: its side and its rims touch at a radius from it along the part of the normal at right angles to
it. That is exact for rims and cylinders, and for cones, too: they touch planes along a line from the tip to the rim, each of
its points at its own radius. Points of ends that stand are fixed in the body.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, cross, dot, turned
from kickdrift.world.layout import SHAPE_KIND
from kickdrift.world.shapes.frustum import radial
from kickdrift.world.shapes.kinds import CONE, CYLINDER
from kickdrift.world.tables import SHAPE, integers

# Radius of all points, or 0.0; the axis in the world's axes, or zeros; where the radius points, in the frame of the shape
RollingCore = tuple[float, Vector, Vector]

_NONE: Vector = (0.0, 0.0, 0.0)
# Sine of the angle between an end and what it stands on, below which its points are fixed in the body: where the rim is lowest
# is rounding then. What is that near to standing at the end of the step is fixed as well.
_STANDS = 0.05
_ASTRAY = 0.01  # of the radius, by which points of the side may be beside the normal


@compiled
def rolling_core(
    world: int, shape: int, radius: float, turn: Quaternion, way: Vector, normal: Vector, tilt: Vector
) -> RollingCore:
    """Return how a shape rolls on a contact that has a direction in its frame, and a normal in the world's axes.

    `tilt` is by how much its body is about to turn in a step.
    """
    if integers(world, SHAPE)[shape, SHAPE_KIND] not in (CYLINDER, CONE):
        return radius, _NONE, way
    axis = turned(turn, (0.0, 0.0, 1.0))
    if abs(way[2]) + abs(dot(normal, cross(tilt, axis))) > math.sqrt(1.0 - _STANDS**2):
        return 0.0, _NONE, way
    _, x, y = radial(way[0], way[1])
    return 0.0, axis, (x, y, 0.0)


@compiled(inline=True)
def rolls(shape: RollingCore) -> bool:
    """Whether any points of a shape are not fixed in its body."""
    return bool(shape[0] > 0.0 or dot(shape[1], shape[1]) > 0.0)


@compiled
def radius_at(shape: RollingCore, point: Vector) -> float:
    """Return how far a point of a shape is from the core that it rolls about; 0.0 if it is fixed in the body."""
    radius, axis, way = shape
    if dot(axis, axis) == 0.0:
        return radius
    out, beside = way[0] * point[0] + way[1] * point[1], way[0] * point[1] - way[1] * point[0]
    return out if abs(beside) <= _ASTRAY * out else 0.0

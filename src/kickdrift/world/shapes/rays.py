"""Ray casts at shapes: their interface, and functions that they share.

``ray(numbers, origin, direction, limit)`` works in the frame of the shape: `origin` is a point, `direction` a unit vector, and
hits beyond `limit` do not count. It returns the distance and the outward unit normal there: four floats, or infinity and zeros
without a hit. A ray that starts inside hits the surface where it leaves; its direction and the normal then point to the same
side. Triangles are hit from both sides.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length
from kickdrift.world.shapes.closest_points import along

Hit = tuple[float, float, float, float]
Chord = tuple[float, float]  # distances at which a line enters and leaves a convex set; empty if the first is greater

MISS: Hit = (math.inf, 0.0, 0.0, 0.0)
NO_CHORD: Chord = (math.inf, -math.inf)


@compiled(inline=True)
def ahead(chord: Chord, limit: float) -> float:
    """Return the distance of the first hit of a ray on a convex set, from the chord of its line; infinity without a hit."""
    enters, leaves = chord
    if enters > leaves:
        return math.inf
    distance = enters if enters >= 0.0 else leaves
    if distance > limit or (distance <= 0.0 and enters < 0.0):
        return math.inf
    return distance


@compiled(inline=True)
def through_ball(origin: Vector, direction: Vector, radius: float) -> Chord:
    """Return the chord of a line in a ball centred at the origin."""
    middle = -dot(origin, direction)
    miss = length(along(origin, middle, direction))
    if miss > radius:
        return NO_CHORD
    half = math.sqrt((radius - miss) * (radius + miss))
    return middle - half, middle + half


@compiled(inline=True)
def through_cylinder(origin: Vector, direction: Vector, radius: float, half: float) -> Chord:
    """Return the chord of a line in a cylinder about the z axis, between z = -half and half."""
    enters, leaves = -math.inf, math.inf
    slant = math.sqrt(direction[0] * direction[0] + direction[1] * direction[1])
    if slant > 0.0:
        x, y = direction[0] / slant, direction[1] / slant
        miss = abs(origin[0] * y - origin[1] * x)
        if miss > radius:
            return NO_CHORD
        middle, chord = -(origin[0] * x + origin[1] * y), math.sqrt((radius - miss) * (radius + miss))
        enters, leaves = (middle - chord) / slant, (middle + chord) / slant
    elif origin[0] * origin[0] + origin[1] * origin[1] > radius * radius:
        return NO_CHORD
    if direction[2] != 0.0:
        low, high = (-half - origin[2]) / direction[2], (half - origin[2]) / direction[2]
        enters, leaves = max(enters, min(low, high)), min(leaves, max(low, high))
    elif abs(origin[2]) > half:
        return NO_CHORD
    if enters > leaves:
        return NO_CHORD
    return enters, leaves

"""The direction that separates two cylinders or cones most, or in which they come apart soonest.

It is the axis of an end, a normal of a side, or that at a point where two rims cross, whichever separates them most. For deep
overlaps it may be another one (`kickdrift.world.collision.narrow_phase.epa`).
"""

import math
from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled, specialise, unbound
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times
from kickdrift.world.collision.narrow_phase.capsule_manifold import CROSSED
from kickdrift.world.collision.narrow_phase.shape_frames import directed, directed_back, placed
from kickdrift.world.shapes.closest_points import along
from kickdrift.world.shapes.frustum import Frustum, farthest, highest, radial, side_normal, signed_distance

# Directions about the axis that are tried, and two that are perpendicular to both axes: two thin rods that cross are separated
# in a range as narrow as they are. The minimum is between the best of these and its neighbour.
_TRIED = 8
_COS = np.cos(np.arange(_TRIED) * (2.0 * math.pi / _TRIED))
_SIN = np.sin(np.arange(_TRIED) * (2.0 * math.pi / _TRIED))
_ROUNDS, _SAME = 40, 1e-9  # of the search on the chord between two of these, and the part of the chord at which it ends
_TINY = 1e-300
_ITERATIONS = 4  # of Newton's method

# In a direction about the axis: a function to be minimised, its slope, and the normal of the two frusta there
Trial = tuple[float, float, Vector]

in_direction: Any = unbound


@compiled(inline=True)
def gap_along(f: Frustum, g: Frustum, frame: Any, normal: Vector) -> float:
    """Return the separation of two frusta along a direction in the first's frame; `frame` is the second's there."""
    n = directed_back(frame, times(-1.0, normal))
    return dot(normal, (frame[9], frame[10], frame[11])) - highest(f, normal) - highest(g, n)


@compiled
def separation(f: Frustum, g: Frustum, frame: Any, back: Any, margin: float) -> tuple[Vector, float]:
    """Find the direction along which two frusta are separated most, or one along which they are by more than the margin.

    Parameters
    ----------
    f, g : (3,) tuple
        The two.
    frame, back : pointer to floats
        Frame of the second in the first's, and of the first in the second's.
    margin : float
        Largest separation that counts, m.

    Returns
    -------
    normal : (3,) tuple
        Unit vector from the first to the second, in the first's frame.
    gap : float
        Separation along it, m.
    """
    normal, gap = _at_ends(f, g, frame)
    if gap > margin:
        return normal, gap
    own = _at_side(f, g, frame, *side_normal(f), frame[2], frame[5])
    other = _at_side(g, f, back, *side_normal(g), back[2], back[5])
    for n in (own, times(-1.0, directed(frame, other))):
        apart = gap_along(f, g, frame, n)
        if apart > gap:
            normal, gap = n, apart
    for upper in range(2):
        middle = (0.0, 0.0, f[2] if upper == 1 else -f[2])
        distance, _ = signed_distance(g, placed(back, middle))
        if gap > margin or distance - f[upper] > margin:
            continue
        n = times(-1.0, directed(frame, _at_rim(f, g, back, f[upper], middle[2], frame[2], frame[5])))
        apart = gap_along(f, g, frame, n)
        if apart > gap:
            normal, gap = _where_rims_cross(f, g, frame, n, apart)
    return normal, gap


@compiled(inline=True)
def _at_ends(f: Frustum, g: Frustum, frame: Any) -> tuple[Vector, float]:
    """Find the best of the axes of the ends, and the separation along it."""
    normal, gap = (0.0, 0.0, 1.0), -np.inf
    for upper in range(2):
        way = 2.0 * upper - 1.0
        own, other = (0.0, 0.0, way), (-way * frame[2], -way * frame[5], -way * frame[8])
        if f[upper] > 0.0 and gap_along(f, g, frame, own) > gap:
            normal, gap = own, gap_along(f, g, frame, own)
        if g[upper] > 0.0 and gap_along(f, g, frame, other) > gap:
            normal, gap = other, gap_along(f, g, frame, other)
    return normal, gap


@compiled
def _where_rims_cross(f: Frustum, g: Frustum, frame: Any, normal: Vector, gap: float) -> tuple[Vector, float]:
    """Improve a normal of two rims, and the separation along it, as far as it grows.

    The point of a rim that is deepest in the other is beside the normal by the square of the depth. This is Newton's method
    for the gradient D = y - x of the separation, with the support points x and y, on the sphere: a rim of radius r turns its
    support point by r / sin(angle between normal and axis) along its tangent, which is perpendicular to the normal.
    """
    for _ in range(_ITERATIONS):
        n = directed_back(frame, times(-1.0, normal))
        sine_f, x_f, y_f = radial(normal[0], normal[1])
        sine_g, x_g, y_g = radial(n[0], n[1])
        if min(sine_f, sine_g) < CROSSED:
            break
        x, y = farthest(f, normal), farthest(g, n)
        apart, first = minus(placed(frame, y), x), (-y_f, x_f, 0.0)
        other, second = directed(frame, (-y_g, x_g, 0.0)), cross(normal, first)
        c, s = dot(other, first), dot(other, second)
        bend_f, bend_g = (f[1] if x[2] > 0.0 else f[0]) / sine_f, (g[1] if y[2] > 0.0 else g[0]) / sine_g
        xx, xy, yy = bend_f + bend_g * c * c + gap, bend_g * c * s, bend_g * s * s + gap
        determinant = xx * yy - xy * xy
        if determinant == 0.0:
            break
        u, v = dot(apart, first), dot(apart, second)
        better = along(along(normal, (u * yy - v * xy) / determinant, first), (v * xx - u * xy) / determinant, second)
        better = times(1.0 / length(better), better)
        wider = gap_along(f, g, frame, better)
        if not wider > gap:
            break
        normal, gap = better, wider
    return normal, gap


@compiled(inline=True)
def _depth_of_rim(f: Frustum, g: Frustum, frame: Any, radius: float, z: float, x: float, y: float) -> Trial:
    """Return the signed distance of a point of a rim from the second frustum."""
    distance, n = signed_distance(g, placed(frame, (radius * x, radius * y, z)))
    return distance, dot(n, directed(frame, (-y, x, 0.0))), n


@compiled(inline=True)
def _gap_of_side(f: Frustum, g: Frustum, frame: Any, across: float, up: float, x: float, y: float) -> Trial:
    """Return the separation along a normal of the side of the first, negated, but for a constant."""
    n = (across * x, across * y, up)
    p = placed(frame, farthest(g, directed_back(frame, times(-1.0, n))))
    return -dot(n, p), p[0] * y - p[1] * x, n


def _minimise(f: Frustum, g: Frustum, frame: Any, across: float, up: float, axis_x: float, axis_y: float) -> Vector:
    """Return the normal at the minimum over all directions about the axis of the first frustum.

    Parameters
    ----------
    f, g : (3,) tuple
        Two frusta.
    frame : pointer to floats
        Frame of the first in the second's for a rim, and of the second in the first's for the side.
    across, up : float
        Components across and along the axis: of the points of a rim, or of the normals of the side.
    axis_x, axis_y : float
        Components of the axis of the second across that of the first.

    Notes
    -----
    As in `kickdrift.world.shapes.frustum.deepest`, on the chord of an arc: false position (Illinois), every third step a
    bisection. Where the slope jumps, the normals on both sides are combined into one that is perpendicular to the rim.
    """
    _, v, u = radial(axis_x, axis_y)
    x, y, least = -u, v, np.inf
    for k in range(-2, _TRIED):
        a, b = (_COS[k], _SIN[k]) if k >= 0 else (u, -v) if k == -1 else (-u, v)
        distance, _, _ = in_direction(f, g, frame, across, up, a, b)
        if distance < least:
            x, y, least = a, b, distance
    n_low: Vector
    _, slope, n_low = in_direction(f, g, frame, across, up, x, y)
    if slope == 0.0:
        return n_low
    sine = _SIN[1] if slope < 0.0 else -_SIN[1]
    u, v = _COS[1] * x - sine * y, _COS[1] * y + sine * x
    _, rise, n_high = in_direction(f, g, frame, across, up, u, v)
    if slope > 0.0:
        x, y, u, v, n_low, n_high, slope, rise = u, v, x, y, n_high, n_low, rise, slope
    # The slope changes its sign in between, even if it has changed back at the other end
    fall, rise = min(slope, -_TINY), max(rise, _TINY)
    low, high, below, above = 0.0, 1.0, fall, rise
    for turn in range(_ROUNDS):
        t = low + (high - low) * below / (below - above) if turn % 3 != 2 else 0.5 * (low + high)
        a, b = x + t * (u - x), y + t * (v - y)
        size = math.sqrt(a * a + b * b)
        _, slope, n = in_direction(f, g, frame, across, up, a / size, b / size)
        if slope == 0.0:
            n_low = n_high = n
            break
        if slope < 0.0:
            low, n_low, fall, below = t, n, slope, slope
            above *= 0.5
        else:
            high, n_high, rise, above = t, n, slope, slope
            below *= 0.5
        if high - low < _SAME:
            break
    share = rise / (rise - fall)
    mean = plus(times(share, n_low), times(1.0 - share, n_high))
    size = length(mean)
    return times(1.0 / size, mean) if size > CROSSED else n_low


_at_rim: Any = compiled(specialise(_minimise, "_at_rim", in_direction=_depth_of_rim))
_at_side: Any = compiled(specialise(_minimise, "_at_side", in_direction=_gap_of_side))

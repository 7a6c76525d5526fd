"""Pictures of shapes by casting a ray through each pixel: what is in front hides what is behind, to the pixel.

Rays meet shapes by the functions that worlds cast rays with, called by their addresses. `kickdrift.plots.lighting`
gives colours to what they meet.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import address_of, caller
from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, plus, times, turned, turned_back
from kickdrift.world.shapes.kind_numbers import TRIANGLE
from kickdrift.world.shapes.record import RAY
from kickdrift.world.shapes.shape_kinds import KINDS, RAYS

_meet = caller(RAY)

# Columns of what is known of each shape
KIND, BEGIN, END, LOOK = 0, 1, 2, 3  # between begin and end are its numbers
# Columns of its place, after its position (3) and orientation (4) in the world: a ball that holds it
MIDDLE, REACH = 7, 10
# Columns of a camera's numbers
EYE, RIGHT, UP, AHEAD, PERSPECTIVE, SCALE = 0, 3, 6, 9, 12, 13

NOTHING = -1
_NEARER = 1.0 - 1e-6  # where surfaces lie in each other, the shape that was looked at first is seen, without speckles


def ray_addresses(kinds: set[int]) -> NDArray[np.intp]:
    """Compile the functions by which rays meet kinds of shapes; return their addresses, by kind."""
    addresses = np.zeros(len(KINDS), dtype=np.intp)
    for kind in sorted(kinds):
        addresses[kind] = address_of(RAYS[kind], RAY)
    return addresses


@compiled(inline=True)
def three(numbers: Any, at: int) -> Vector:
    """Return three numbers of an array as a vector."""
    return (numbers[at], numbers[at + 1], numbers[at + 2])


@compiled(inline=True)
def ray(camera: Any, column: float, row: float, width: int, height: int) -> tuple[Vector, Vector]:
    """Return where the ray through a place of the picture begins, and its unit direction."""
    per_pixel = 2.0 * camera[SCALE] / height
    x, y = (column - 0.5 * width) * per_pixel, (0.5 * height - row) * per_pixel
    aside = plus(times(x, three(camera, RIGHT)), times(y, three(camera, UP)))
    if camera[PERSPECTIVE] == 0.0:
        return plus(three(camera, EYE), aside), three(camera, AHEAD)
    direction = plus(three(camera, AHEAD), aside)
    return three(camera, EYE), times(1.0 / length(direction), direction)


@compiled(inline=True)
def _span(middle: float, reach: float, near: float, far: float) -> tuple[float, float]:
    """Bounds of (x / z) for x within reach of the middle and z from near to far."""
    low, high = middle - reach, middle + reach
    return min(low / near, low / far), max(high / near, high / far)


@compiled
def _rectangle(camera: Any, centre: Vector, reach: float, width: int, height: int) -> tuple[int, int, int, int]:
    """Columns and rows of the picture, from and up to, that a ball may be seen in."""
    offset = minus(centre, three(camera, EYE))
    x, y, z = dot(offset, three(camera, RIGHT)), -dot(offset, three(camera, UP)), dot(offset, three(camera, AHEAD))
    near, far = 1.0, 1.0
    if camera[PERSPECTIVE] != 0.0:
        near, far = z - reach, z + reach
        if far <= 0.0:
            return 0, 0, 0, 0
        if near <= 0.0:
            return 0, width, 0, height
    pixels = 0.5 * height / camera[SCALE]
    left, right = _span(x, reach, near, far)
    top, bottom = _span(y, reach, near, far)
    return (
        max(0, int(min(0.5 * width + pixels * left, width))),
        min(width, int(max(0.5 * width + pixels * right, -1)) + 1),
        max(0, int(min(0.5 * height + pixels * top, height))),
        min(height, int(max(0.5 * height + pixels * bottom, -1)) + 1),
    )


@compiled
def _rectangle_of_triangle(camera: Any, place: Any, own: Any, width: int, height: int) -> tuple[int, int, int, int]:
    """Columns and rows of the picture, from and up to, that a triangle may be seen in: a fraction of those of its ball."""
    q = (place[3], place[4], place[5], place[6])
    pixels = 0.5 * height / camera[SCALE]
    left, right, top, bottom = math.inf, -math.inf, math.inf, -math.inf
    for corner in range(3):
        offset = minus(plus(three(place, 0), turned(q, three(own, 3 * corner))), three(camera, EYE))
        far = 1.0
        if camera[PERSPECTIVE] != 0.0:
            far = dot(offset, three(camera, AHEAD))
            if far <= 0.0:
                return _rectangle(camera, three(place, MIDDLE), place[REACH], width, height)
        x = 0.5 * width + pixels * dot(offset, three(camera, RIGHT)) / far
        y = 0.5 * height - pixels * dot(offset, three(camera, UP)) / far
        left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
    return (
        max(0, int(min(left, width))),
        min(width, int(max(right, -1)) + 1),
        max(0, int(min(top, height))),
        min(height, int(max(bottom, -1)) + 1),
    )


@compiled
def clear(distance: Any, owner: Any, normal: Any) -> None:
    """Begin a picture on which nothing is met."""
    distance[:] = math.inf
    owner[:] = NOTHING
    normal[:] = 0.0


@compiled(fast=True)
def cast(
    camera: Any,
    order: Any,
    shapes: Any,
    places: Any,
    numbers: Any,
    addresses: Any,
    distance: Any,
    owner: Any,
    normal: Any,
) -> None:
    """Find what the ray through each pixel meets before it meets what is known already.

    Parameters
    ----------
    camera : (14,) array
    order : array of int
        The shapes to look at, best the nearest first: what they hide is not looked at any more.
    shapes : (S, 4) array of int
        Kind, where its numbers begin and end, and its look.
    places : (S, 11) array
        Position, orientation, and middle and radius of a ball around the shape; the radius is infinite for planes.
    numbers : array
        Of all shapes.
    addresses : array of int
        By kind, of the functions by which rays meet them.
    distance, owner, normal : (H, W), (H, W) and (H, W, 3) array
        How far the ray goes, the shape that it meets, or `NOTHING`, and the normal there.
    """
    height, width = distance.shape
    per_pixel = 2.0 * camera[SCALE] / height
    parallel = camera[PERSPECTIVE] == 0.0
    for shape in order:
        place = places[shape]
        q = (place[3], place[4], place[5], place[6])
        own = numbers[shapes[shape, BEGIN] : shapes[shape, END]]
        address = addresses[shapes[shape, KIND]]
        left, right, top, bottom = 0, width, 0, height
        nearest = 0.0
        if place[REACH] < math.inf:
            if shapes[shape, KIND] == TRIANGLE:
                left, right, top, bottom = _rectangle_of_triangle(camera, place, own, width, height)
            else:
                left, right, top, bottom = _rectangle(camera, three(place, MIDDLE), place[REACH], width, height)
            offset = minus(three(place, MIDDLE), three(camera, EYE))
            nearest = (dot(offset, three(camera, AHEAD)) if parallel else length(offset)) - place[REACH]
        eye = turned_back(q, minus(three(camera, EYE), three(place, 0)))
        axes = (
            turned_back(q, three(camera, RIGHT)), turned_back(q, three(camera, UP)), turned_back(q, three(camera, AHEAD))
        )  # fmt: skip
        for row in range(top, bottom):
            upwards = times((0.5 * height - row - 0.5) * per_pixel, axes[1])
            for column in range(left, right):
                if distance[row, column] <= nearest:
                    continue
                aside = plus(upwards, times((column + 0.5 - 0.5 * width) * per_pixel, axes[0]))
                start, direction = eye, axes[2]
                if parallel:
                    start = plus(eye, aside)
                else:
                    direction = plus(direction, aside)
                    direction = times(1.0 / length(direction), direction)
                far, x, y, z = _meet(address, (own, start, direction, distance[row, column]))
                if far < _NEARER * distance[row, column]:
                    distance[row, column] = far
                    owner[row, column] = shape
                    x, y, z = turned(q, (x, y, z))
                    normal[row, column, 0], normal[row, column, 1], normal[row, column, 2] = x, y, z

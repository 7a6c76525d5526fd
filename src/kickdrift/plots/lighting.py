"""Light and colour for what the rays of a camera meet.

A lamp shines from one side, and shapes cast shadows; what it does not reach has the light of the sky. Edges are drawn
where one shape ends and another begins, and where faces meet.
"""

import math
from typing import Any

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, plus, times, turned_back
from kickdrift.plots.rendering import AHEAD, EYE, LOOK, NOTHING, RIGHT, SCALE, UP, ray, three
from kickdrift.world.shapes.record import BALL, CREASED, GLOSSY, GROUND

# Columns of a setting: direction to the lamp (3), colour of the background (3), distance of the lines on planes in m,
# and how far planes are seen, in m, from which point (3)
LAMP, BACKGROUND, GRID, FADE, SETTING = 0, 3, 6, 7, 11

_SKY, _FROM_ABOVE, _FROM_LAMP = 0.50, 0.14, 0.42  # light from all sides, more of it from above, and of the lamp
_GLOSS = 0.22  # of round shapes
_CREASE = 0.8  # cosine of the angle between faces from which on their edge is drawn
_EDGE, _MARK, _LINE = 0.55, 0.84, 0.93  # what edges, marks on balls and lines of the grid leave of the light


@compiled(fast=True)
def light(camera: Any, distance: Any, normal: Any, lamp: Any, reached: Any, lit: Any) -> None:
    """Compute how much of the lamp each pixel of a picture sees.

    Parameters
    ----------
    camera : (14,) array
    distance, normal : (H, W) and (H, W, 3) array
        As `cast` has filled them.
    lamp : (14,) array
        The lamp as a camera with parallel rays.
    reached : (K, K) array
        How far its rays go.
    lit : (H, W) array
        Is filled with numbers from 0, in shadow, to 1; the edges of shadows are soft.
    """
    height, width = distance.shape
    size = len(reached)
    pixel = 2.0 * lamp[SCALE] / size
    ahead = three(lamp, AHEAD)
    for row in range(height):
        for column in range(width):
            lit[row, column] = 1.0
            if distance[row, column] == math.inf:
                continue
            n = (normal[row, column, 0], normal[row, column, 1], normal[row, column, 2])
            if dot(n, ahead) >= 0.0:
                lit[row, column] = 0.0
                continue
            start, direction = ray(camera, column + 0.5, row + 0.5, width, height)
            point = plus(start, times(distance[row, column], direction))
            offset = minus(plus(point, times(2.0 * pixel, n)), three(lamp, EYE))
            x = math.floor(0.5 * size + dot(offset, three(lamp, RIGHT)) / pixel)
            y = math.floor(0.5 * size - dot(offset, three(lamp, UP)) / pixel)
            if 1 <= x < size - 1 and 1 <= y < size - 1:
                far = dot(offset, ahead)
                shaded = 0
                for i in range(-1, 2):
                    for j in range(-1, 2):
                        if reached[y + i, x + j] < far:
                            shaded += 1
                lit[row, column] = 1.0 - shaded / 9.0


@compiled(fast=True)
def paint(
    camera: Any, shapes: Any, places: Any, colours: Any, setting: Any, distance: Any, owner: Any, normal: Any, lit: Any,
    picture: Any,
) -> None:  # fmt: skip
    """Give each pixel its colour: the mean of those of the rays through it.

    Parameters
    ----------
    camera : (14,) array
    shapes, places : (S, 4) and (S, 11) array
        As `cast` takes them.
    colours : (S, 3) array
        From 0 to 1.
    setting : (11,) array
        Lamp and background; see this module.
    distance, owner, normal, lit : (n H, n W) or (n H, n W, 3) array
        As `cast` and `light` have filled them, for n x n rays a pixel.
    picture : (H, W, 3) array of uint8
        Is filled.
    """
    height, width, _ = picture.shape
    n = len(distance) // height
    for row in range(height):
        for column in range(width):
            total = (0.0, 0.0, 0.0)
            for i in range(n * row, n * (row + 1)):
                for j in range(n * column, n * (column + 1)):
                    colour = _colour(i, j, camera, shapes, places, colours, setting, distance, owner, normal, lit)
                    if _on_edge(shapes, owner, normal, i, j):
                        colour = times(_EDGE, colour)
                    total = plus(total, (min(1.0, colour[0]), min(1.0, colour[1]), min(1.0, colour[2])))
            for k in range(3):
                picture[row, column, k] = np.uint8(255.0 / (n * n) * total[k] + 0.5)


@compiled(fast=True, inline=True)
def _colour(
    row: int, column: int, camera: Any, shapes: Any, places: Any, colours: Any, setting: Any, distance: Any, owner: Any,
    normal: Any, lit: Any,
) -> Vector:  # fmt: skip
    """Return the colour that a ray sees."""
    background = three(setting, BACKGROUND)
    shape = owner[row, column]
    if shape == NOTHING:
        return background
    height, width = distance.shape
    look, place = shapes[shape, LOOK], places[shape]
    n = (normal[row, column, 0], normal[row, column, 1], normal[row, column, 2])
    start, direction = ray(camera, column + 0.5, row + 0.5, width, height)
    bright, gloss = _brightness(n, direction, three(setting, LAMP), lit[row, column], look)
    own = three(colours[shape], 0)
    q = (place[3], place[4], place[5], place[6])
    if look & GROUND:
        far = distance[row, column]
        point = plus(start, times(far, direction))
        local = turned_back(q, minus(point, three(place, 0)))
        bright *= _grid(local, setting[GRID], 2.0 * camera[SCALE] / height * far, -dot(direction, n))
        away = minus(point, three(setting, FADE + 1))
        seen = math.exp(-dot(away, away) / (setting[FADE] * setting[FADE]))
        return plus(times(bright * seen, own), times(1.0 - seen, background))
    if look & BALL:
        mark = turned_back(q, n)
        if mark[0] * mark[1] * mark[2] > 0.0:
            bright *= _MARK
    return plus(times(bright, own), (gloss, gloss, gloss))


@compiled(fast=True, inline=True)
def _brightness(n: Vector, direction: Vector, lamp: Vector, lit: float, look: int) -> tuple[float, float]:
    """Return how much light a surface has, and how much of the lamp is mirrored in it."""
    bright = _SKY + _FROM_ABOVE * (0.5 + 0.5 * n[2]) + _FROM_LAMP * lit * max(0.0, dot(n, lamp))
    if look & GLOSSY == 0:
        return bright, 0.0
    half = minus(lamp, direction)
    mirrored = max(0.0, dot(n, half)) / length(half)
    return bright, _GLOSS * lit * mirrored**40


@compiled(fast=True, inline=True)
def _grid(local: Vector, pitch: float, footprint: float, facing: float) -> float:
    """Return what the lines of a grid leave of the light at a point of a plane, where a pixel is so wide."""
    bright = 1.0
    for k in range(2):
        away = abs(local[k] / pitch - math.floor(local[k] / pitch + 0.5)) * pitch
        half = max(0.5 * footprint / max(facing, 0.05), 1e-9)
        cover = min(1.0, max(0.0, 1.5 - away / half)) * min(1.0, 0.1 * pitch / half)
        bright *= 1.0 - (1.0 - _LINE) * cover
    return bright


@compiled(fast=True, inline=True)
def _on_edge(shapes: Any, owner: Any, normal: Any, row: int, column: int) -> bool:
    """Whether a pixel is the last one of what it shows."""
    height, width = owner.shape
    own = owner[row, column]
    for side in range(4):
        i, j = row + (1, -1, 0, 0)[side], column + (0, 0, 1, -1)[side]
        if not (0 <= i < height and 0 <= j < width):
            continue
        other = owner[i, j]
        if own != other:
            first = own == NOTHING or shapes[own, LOOK] & GROUND != 0
            second = other == NOTHING or shapes[other, LOOK] & GROUND != 0
            if not (first and second):
                return True
        elif own != NOTHING and shapes[own, LOOK] & CREASED:
            turn = 0.0
            for k in range(3):
                turn += normal[row, column, k] * normal[i, j, k]
            if turn < _CREASE:
                return True
    return False

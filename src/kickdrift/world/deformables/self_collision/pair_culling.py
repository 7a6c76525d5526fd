"""Tests by predicted motion: whether two triangles stay apart as long as pairs remain valid, and how much pairs approach."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    CLOTH_RADIUS,
    CORNERS,
    PREDICTED_VELOCITY,
    SEARCH_AGE,
    SEARCH_HORIZON,
    SKIN,
)
from kickdrift.world.deformables.self_collision.closest_features import Corners, closing, less_mean
from kickdrift.world.deformables.self_collision.swept_bounds import predicted
from kickdrift.world.tables import CLOTH_NUMBERS, CLOTH_SEARCH, FACE, PARTICLE_PATH, floats, integers

Triangle = tuple[Vector, Vector, Vector]


@compiled(inline=True)
def are_apart(world: int, cloth: int, other: int, f: int, g: int) -> bool:
    """Whether two triangles stay far enough apart along a line between them, as most neighbours do."""
    numbers = floats(world, CLOTH_NUMBERS)
    (a, b, c), (u, v, w) = _corners(world, f)
    (p, q, r), (x, y, z) = _corners(world, g)
    kept = numbers[cloth, CLOTH_RADIUS] + numbers[cloth, SKIN] + numbers[other, CLOTH_RADIUS] + numbers[other, SKIN]
    way = minus(plus(plus(p, q), r), plus(plus(a, b), c))
    least = min(_gap(way, a, b, c, p, q, r), _gap(way, u, v, w, x, y, z))
    if least > 0.0 and least * least > kept * kept * dot(way, way):
        return True
    way = minus(_first(way, p, q, r), _first(times(-1.0, way), a, b, c))
    least = min(_gap(way, a, b, c, p, q, r), _gap(way, u, v, w, x, y, z))
    return least > 0.0 and least * least > kept * kept * dot(way, way)


@compiled(inline=True)
def _corners(world: int, f: int) -> tuple[Triangle, Triangle]:
    """Return the corners of a triangle, at present and predicted."""
    face, search = integers(world, FACE), floats(world, CLOTH_SEARCH)
    i, j, k = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
    now, then = search[0, SEARCH_AGE], search[0, SEARCH_HORIZON]
    at_present = (predicted(world, i, now), predicted(world, j, now), predicted(world, k, now))
    return at_present, (predicted(world, i, then), predicted(world, j, then), predicted(world, k, then))


@compiled(inline=True)
def _gap(way: Vector, a: Vector, b: Vector, c: Vector, p: Vector, q: Vector, r: Vector) -> float:
    """Return the separation of triangle p q r from triangle a b c along a direction, times its length."""
    return min(dot(way, p), dot(way, q), dot(way, r)) - max(dot(way, a), dot(way, b), dot(way, c))


@compiled(inline=True)
def _first(way: Vector, p: Vector, q: Vector, r: Vector) -> Vector:
    """Return the lowest corner along a direction."""
    x, y, z = dot(way, p), dot(way, q), dot(way, r)
    return (p if x <= z else r) if x <= y else (q if y <= z else r)


@compiled(inline=True)
def nearing(world: int, kind: int, at: Corners) -> float:
    """Bound the decrease of the distance of a pair by the predicted motion of its particles, m."""
    path, search = floats(world, PARTICLE_PATH), floats(world, CLOTH_SEARCH)
    h = search[0, SEARCH_HORIZON] - search[0, SEARCH_AGE]
    p, a, b, c = (
        times(h, vector_at(path, at[0], PREDICTED_VELOCITY)),
        times(h, vector_at(path, at[1], PREDICTED_VELOCITY)),
        times(h, vector_at(path, at[2], PREDICTED_VELOCITY)),
        times(h, vector_at(path, at[3], PREDICTED_VELOCITY)),
    )
    return closing(kind, less_mean(p, a, b, c))

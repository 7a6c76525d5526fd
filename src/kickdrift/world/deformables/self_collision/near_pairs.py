"""Pairs that are near each other: their nearest points, normals and responses, kept while impulses change velocities."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts.layout import PAIR_CHUNK
from kickdrift.world.deformables.chunks import Numbers, for_chunks
from kickdrift.world.deformables.layout import (
    CROSSING_COUNT,
    FIRST_HELD,
    GIVES,
    NEAR_AHEAD,
    NEXT_HELD,
    NONE_HELD,
    PAIR_APART,
    PAIR_DISTANCE,
    PAIR_GIVES,
    PAIR_KIND,
    PAIR_LAID,
    PAIR_NORMAL,
    PAIR_PARTICLES,
    PAIR_SEEN,
    PAIR_WEIGHTS,
    PARTICLE_INVERSE_MASS,
    TRAVELLED,
)
from kickdrift.world.deformables.self_collision.closest_features import EDGE_EDGE, Corners, Weights, nearest
from kickdrift.world.deformables.self_collision.untangling import CROSSING
from kickdrift.world.tables import (
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    INTERVAL_START,
    NEAR_PAIR,
    PARTICLE,
    ZONE,
    floats,
    integers,
    rows,
    set_rows,
)

_ABOVE = 0.99**2  # square of the cosine to the normal above which a vertex counts as above a triangle
_TOUCHING = 1.1  # of its distance: a pair that is closer at the start of an interval is held during it
_FARTHER = 1.5  # of a way: that for which a list of near pairs holds
_PAIRS_IN_CHUNK = 256


@compiled
def begin_interval(world: int) -> None:
    """List the pairs that touch at the start of an interval, and compute their nearest points and normals."""
    pair, numbers, search = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS), floats(world, CLOTH_SEARCH)
    search[0, FIRST_HELD], last, travelled = NONE_HELD, NONE_HELD, search[0, TRAVELLED]
    for row in range(rows(world, CLOTH_PAIR)):
        least, touches = (
            numbers[row, PAIR_APART] - (travelled - numbers[row, PAIR_SEEN]),
            _TOUCHING * numbers[row, PAIR_DISTANCE],
        )
        if pair[row, PAIR_KIND] == CROSSING or not least < touches or is_free(world, row):
            continue
        _lay(world, row)
        if numbers[row, PAIR_APART] < touches and numbers[row, PAIR_GIVES] > 0.0:
            pair[row, NEXT_HELD] = NONE_HELD
            if last == NONE_HELD:
                search[0, FIRST_HELD] = row
            else:
                pair[last, NEXT_HELD] = row
            last = row


@compiled
def note_near(world: int, ahead: float) -> None:
    """List the pairs that may come too close while particles move against each other by `ahead`, m, and those that cross.

    The list holds for a somewhat longer way, since impulses change velocities while it is used.
    """
    pair, numbers, search = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS), floats(world, CLOTH_SEARCH)
    near, travelled, count, farther = integers(world, NEAR_PAIR), search[0, TRAVELLED], 0, _FARTHER * ahead
    for_chunks(world, PAIR_CHUNK, _PAIRS_IN_CHUNK, 0, 0, rows(world, CLOTH_PAIR), (ahead, 0.0, 0.0, 0.0, 0.0))
    for row in range(rows(world, CLOTH_PAIR)):
        if pair[row, PAIR_KIND] == CROSSING:
            wanted = True
        elif numbers[row, PAIR_LAID] == travelled:
            wanted = numbers[row, PAIR_GIVES] > 0.0
        else:
            wanted = _may_touch(world, row, farther)
        if wanted:
            near[count, 0] = row
            count += 1
    set_rows(world, NEAR_PAIR, count)
    search[0, NEAR_AHEAD] = farther


@compiled
def lay_some(world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Compute the nearest points of some pairs that may come too close on a way, m, the first of the numbers."""
    pair, ahead = integers(world, CLOTH_PAIR), numbers[0]
    for row in range(first, last):
        if pair[row, PAIR_KIND] != CROSSING:
            is_laid(world, row, ahead)


@compiled(inline=True)
def is_laid(world: int, row: int, ahead: float) -> bool:
    """Compute the nearest points of a pair, if it may come too close and they are not known; whether they are known."""
    numbers, travelled = floats(world, CLOTH_PAIR_NUMBERS), floats(world, CLOTH_SEARCH)[0, TRAVELLED]
    if numbers[row, PAIR_LAID] != travelled:
        if not _may_touch(world, row, ahead):
            return False
        _lay(world, row)
    return True


@compiled(inline=True)
def _may_touch(world: int, row: int, ahead: float) -> bool:
    """Whether a pair may come too close while its particles move against each other by `ahead`, m."""
    numbers, travelled = floats(world, CLOTH_PAIR_NUMBERS), floats(world, CLOTH_SEARCH)[0, TRAVELLED]
    least = numbers[row, PAIR_APART] - (travelled - numbers[row, PAIR_SEEN])
    near: bool = least < numbers[row, PAIR_DISTANCE] + ahead
    return near and not is_free(world, row)


@compiled(inline=True)
def particles_of(world: int, row: int) -> Corners:
    """Return the particles of a pair."""
    pair = integers(world, CLOTH_PAIR)
    return (
        pair[row, PAIR_PARTICLES],
        pair[row, PAIR_PARTICLES + 1],
        pair[row, PAIR_PARTICLES + 2],
        pair[row, PAIR_PARTICLES + 3],
    )


@compiled(inline=True)
def is_free(world: int, row: int) -> bool:
    """Whether a particle of a pair is tangled, so that it may pass."""
    zone, (p, a, b, c) = integers(world, ZONE), particles_of(world, row)
    tangled: bool = (
        zone[p, CROSSING_COUNT] + zone[a, CROSSING_COUNT] + zone[b, CROSSING_COUNT] + zone[c, CROSSING_COUNT] > 0
    )
    return tangled


@compiled
def _lay(world: int, row: int) -> None:
    """Compute the nearest points, normal and response of a pair, which are kept while impulses change its velocities."""
    particle, numbers = floats(world, PARTICLE), floats(world, CLOTH_PAIR_NUMBERS)
    at = particles_of(world, row)
    p, a, b, c = at
    weights, way = nearest(
        integers(world, CLOTH_PAIR)[row, PAIR_KIND],
        vector_at(particle, p, 0),
        vector_at(particle, a, 0),
        vector_at(particle, b, 0),
        vector_at(particle, c, 0),
    )
    apart = length(way)
    takes = apart > 0.0 and not _is_beside(world, row, weights, way)
    numbers[row, PAIR_APART], numbers[row, PAIR_GIVES] = apart, response(world, at, weights) if takes else 0.0
    for k in range(4):
        numbers[row, PAIR_WEIGHTS + k] = weights[k]
    for k in range(3):
        numbers[row, PAIR_NORMAL + k] = way[k] / apart
    numbers[row, PAIR_SEEN] = numbers[row, PAIR_LAID] = floats(world, CLOTH_SEARCH)[0, TRAVELLED]


@compiled
def _is_beside(world: int, row: int, weights: Weights, way: Vector) -> bool:
    """Whether a pair is closest at the end of an edge, or beside a triangle and not above it.

    There another pair is as close. If such pairs were resolved, sliding sheets would catch on edges.
    """
    if weights[0] != 0.0 and weights[1] != 0.0 and weights[2] != 0.0 and weights[3] != 0.0:
        return False
    if integers(world, CLOTH_PAIR)[row, PAIR_KIND] == EDGE_EDGE:
        return True
    particle, (_, a, b, c) = floats(world, PARTICLE), particles_of(world, row)
    origin = vector_at(particle, a, 0)
    n = cross(minus(vector_at(particle, b, 0), origin), minus(vector_at(particle, c, 0), origin))
    return dot(n, way) ** 2 < _ABOVE * dot(n, n) * dot(way, way)


@compiled(inline=True)
def mobility(world: int, at: Corners, weights: Weights) -> float:
    """Return by how much the points of a pair move apart if its particles, except pinned ones, share a displacement, 1/kg."""
    particle, total = floats(world, PARTICLE), 0.0
    for k in range(4):
        total += weights[k] * weights[k] * particle[at[k], PARTICLE_INVERSE_MASS]
    return total


@compiled(inline=True)
def response(world: int, at: Corners, weights: Weights) -> float:
    """Return the change of the relative velocity of the points of a pair by a unit impulse between them, 1/kg."""
    total = 0.0
    for k in range(4):
        total += weights[k] * weights[k] * inverse_mass(world, at[k])
    return total


@compiled(inline=True)
def inverse_mass(world: int, i: int) -> float:
    """Return the inverse mass of a particle for impulses of pairs, 1/kg.

    One that is pinned to a dynamic body takes them as if it was free, and shares them with the body in the next part.
    """
    own: float = floats(world, PARTICLE)[i, PARTICLE_INVERSE_MASS]
    return own if own > 0.0 else float(floats(world, INTERVAL_START)[i, GIVES])

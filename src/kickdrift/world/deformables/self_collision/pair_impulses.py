"""Impulses between the particles of cloths that touch each other."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    CROSSING_COUNT,
    FIRST_HELD,
    INTERVAL,
    NEXT_HELD,
    NONE_HELD,
    PAIR_APART,
    PAIR_DISTANCE,
    PAIR_FRICTION,
    PAIR_GIVES,
    PAIR_KIND,
    PAIR_LAID,
    PAIR_NORMAL,
    PAIR_PARTICLES,
    PAIR_SEEN,
    PAIR_WEIGHTS,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    TRAVELLED,
)
from kickdrift.world.deformables.self_collision.proximity import (
    EDGE_EDGE,
    Corners,
    Weights,
    closing,
    less_mean,
    mixed,
    nearest,
)
from kickdrift.world.deformables.self_collision.swept_bounds import travels
from kickdrift.world.deformables.self_collision.untangling import CROSSING, untangle
from kickdrift.world.tables import (
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    PARTICLE,
    PARTICLE_SHIFT,
    ZONE,
    Table,
    floats,
    integers,
    rows,
)

_ABOVE = 0.99**2  # square of the cosine to the normal above which a vertex counts as above a triangle
_TOUCHING = 1.1  # of its distance: a pair that is closer at the start of an interval is held during it
_SOFT = 0.25  # fraction of the violation that is corrected in an interval


@compiled
def resolve_pairs(world: int, interval: float, part: float, push: float) -> None:
    """Stop pairs that would come closer than their distance in an interval, s, by impulses that act in its last part, s.

    Triangles that cross are moved apart, at most with the speed `push`, m/s, without gaining velocity.
    """
    if rows(world, CLOTH_PAIR) == 0:
        return
    pair, numbers = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS)
    travelled, ahead = floats(world, CLOTH_SEARCH)[0, TRAVELLED], travels(world, interval)
    for row in range(rows(world, CLOTH_PAIR)):
        if pair[row, PAIR_KIND] == CROSSING:
            untangle(world, row, interval * push)
            continue
        if numbers[row, PAIR_LAID] != travelled:
            least = numbers[row, PAIR_APART] - (travelled - numbers[row, PAIR_SEEN])
            if not least < numbers[row, PAIR_DISTANCE] + ahead or is_free(world, row):
                continue
            _lay(world, row)
            numbers[row, PAIR_SEEN] = numbers[row, PAIR_LAID] = travelled
        if numbers[row, PAIR_GIVES] > 0.0:
            _resolve(world, row, interval, part)


@compiled
def approach(world: int, h: float) -> float:
    """Bound the approach of the known pairs in a time h, s, with the present velocities, m."""
    pair, particle, most = integers(world, CLOTH_PAIR), floats(world, PARTICLE), 0.0
    for row in range(rows(world, CLOTH_PAIR)):
        if pair[row, PAIR_KIND] == CROSSING:
            continue
        p, a, b, c = particles_of(world, row)
        ways = less_mean(
            times(h, vector_at(particle, p, PARTICLE_VELOCITY)),
            times(h, vector_at(particle, a, PARTICLE_VELOCITY)),
            times(h, vector_at(particle, b, PARTICLE_VELOCITY)),
            times(h, vector_at(particle, c, PARTICLE_VELOCITY)),
        )
        most = max(most, closing(pair[row, PAIR_KIND], ways))
    return most


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
        numbers[row, PAIR_SEEN] = numbers[row, PAIR_LAID] = travelled
        if numbers[row, PAIR_APART] < touches and numbers[row, PAIR_GIVES] > 0.0:
            pair[row, NEXT_HELD] = NONE_HELD
            if last == NONE_HELD:
                search[0, FIRST_HELD] = row
            else:
                pair[last, NEXT_HELD] = row
            last = row


@compiled
def hold_pairs(world: int, part: float, push: float) -> None:
    """Apply impulses that keep pairs that touch from approaching in a part of an interval, s.

    Pairs that are closer than their distance are moved apart, at most with the speed `push`, m/s, without gaining velocity. If
    either were left to the end of the interval, stiff cloth that the pairs hold would swing freely until then, and the
    correction would do work each time: folds would never come to rest.
    """
    pair, numbers, particle = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS), floats(world, PARTICLE)
    row, share = int(floats(world, CLOTH_SEARCH)[0, FIRST_HELD]), _SOFT / floats(world, CLOTH_SEARCH)[0, INTERVAL]
    while row != NONE_HELD:
        at, weights, n = particles_of(world, row), _weights(numbers, row), vector_at(numbers, row, PAIR_NORMAL)
        gap = dot(n, mixed(weights, particle, at, 0)) - numbers[row, PAIR_DISTANCE]
        if gap < 0.0:
            out = min(-share * gap, part * push)
            add(world, PARTICLE, 0, at, weights, times(out / numbers[row, PAIR_GIVES], n))
        impulse = _stopping(world, row, mixed(weights, particle, at, PARTICLE_VELOCITY), -max(gap, 0.0) / part)
        add(world, PARTICLE, PARTICLE_VELOCITY, at, weights, impulse)
        row = pair[row, NEXT_HELD]


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
    """Compute the nearest points, normal and mobility of a pair, which are kept while impulses change its velocities."""
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
    numbers[row, PAIR_APART], numbers[row, PAIR_GIVES] = apart, mobility(world, at, weights) if takes else 0.0
    for k in range(4):
        numbers[row, PAIR_WEIGHTS + k] = weights[k]
    for k in range(3):
        numbers[row, PAIR_NORMAL + k] = way[k] / apart


@compiled
def _resolve(world: int, row: int, interval: float, part: float) -> None:
    """Give the particles of a pair the impulse that stops their approach; `hold_pairs` moves apart those that are too close."""
    particle, shift, numbers = floats(world, PARTICLE), floats(world, PARTICLE_SHIFT), floats(world, CLOTH_PAIR_NUMBERS)
    at, weights = particles_of(world, row), _weights(numbers, row)
    v, shifted = mixed(weights, particle, at, PARTICLE_VELOCITY), mixed(weights, shift, at, 0)
    moved, gap = plus(times(interval, v), shifted), numbers[row, PAIR_APART] - numbers[row, PAIR_DISTANCE]
    if gap > 0.0 and gap * gap > dot(moved, moved):
        return
    gap += dot(vector_at(numbers, row, PAIR_NORMAL), minus(moved, times(part, v)))
    give_late(world, at, weights, _stopping(world, row, v, -max(gap, 0.0) / part), interval - part)


@compiled(inline=True)
def _stopping(world: int, row: int, v: Vector, wanted: float) -> Vector:
    """Return the impulse that raises the normal component of the velocity v of a pair to `wanted`, m/s, with friction."""
    numbers = floats(world, CLOTH_PAIR_NUMBERS)
    gives, n = numbers[row, PAIR_GIVES], vector_at(numbers, row, PAIR_NORMAL)
    approach = dot(n, v)
    if approach >= wanted:
        return (0.0, 0.0, 0.0)
    given = (wanted - approach) / gives
    impulse = times(given, n)
    slip = minus(v, times(approach, n))
    speed = length(slip)
    if speed > 0.0:
        impulse = minus(impulse, times(min(numbers[row, PAIR_FRICTION] * given, speed / gives) / speed, slip))
    return impulse


@compiled(inline=True)
def _weights(numbers: Any, row: int) -> Weights:
    return (
        numbers[row, PAIR_WEIGHTS],
        numbers[row, PAIR_WEIGHTS + 1],
        numbers[row, PAIR_WEIGHTS + 2],
        numbers[row, PAIR_WEIGHTS + 3],
    )


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
    """Return the change of the relative velocity of the points of a pair by a unit impulse between them, 1/kg."""
    particle, total = floats(world, PARTICLE), 0.0
    for k in range(4):
        total += weights[k] * weights[k] * particle[at[k], PARTICLE_INVERSE_MASS]
    return total


@compiled(inline=True)
def give_late(world: int, at: Corners, weights: Weights, impulse: Vector, late: float) -> None:
    """Give the particles of a pair an impulse at the time `late`, s, in an interval: until then they do not move with it.

    An impulse that moved them for the whole interval would strain the cloth without being stopped by its forces, which do work
    on it afterwards. By that work folds tremble for ever.
    """
    add(world, PARTICLE, PARTICLE_VELOCITY, at, weights, impulse)
    add(world, PARTICLE_SHIFT, 0, at, weights, times(-late, impulse))


@compiled(inline=True)
def add(world: int, table: Table, first: int, at: Corners, weights: Weights, impulse: Vector) -> None:
    """Add the changes by an impulse between the points of a pair to three columns of its particles."""
    particle, values = floats(world, PARTICLE), floats(world, table)
    for k in range(4):
        share = weights[k] * particle[at[k], PARTICLE_INVERSE_MASS]
        for axis in range(3):
            values[at[k], first + axis] += share * impulse[axis]

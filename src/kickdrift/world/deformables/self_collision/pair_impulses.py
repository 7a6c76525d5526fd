"""Impulses between the particles of cloths that touch each other."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    FIRST_HELD,
    INTERVAL,
    NEAR_AHEAD,
    NEXT_HELD,
    NONE_HELD,
    PAIR_APART,
    PAIR_DISTANCE,
    PAIR_FRICTION,
    PAIR_GIVES,
    PAIR_KIND,
    PAIR_NORMAL,
    PAIR_WEIGHTS,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
)
from kickdrift.world.deformables.self_collision.closest_features import Corners, Weights, closing, less_mean, mixed
from kickdrift.world.deformables.self_collision.near_pairs import inverse_mass, is_laid, note_near, particles_of
from kickdrift.world.deformables.self_collision.swept_bounds import travels
from kickdrift.world.deformables.self_collision.untangling import CROSSING, untangle
from kickdrift.world.tables import (
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    NEAR_PAIR,
    PARTICLE,
    PARTICLE_SHIFT,
    Table,
    floats,
    integers,
    rows,
)

_SOFT = 0.25  # fraction of the violation that is corrected in an interval


@compiled
def resolve_pairs(world: int, interval: float, part: float, push: float, afresh: bool) -> None:
    """Stop pairs that would come closer than their distance in an interval, s, by impulses that act in its last part, s.

    Triangles that cross are moved apart, at most with the speed `push`, m/s, without gaining velocity. Pairs that are near are
    listed `afresh`, or else again once velocities have grown.
    """
    if rows(world, CLOTH_PAIR) == 0:
        return
    pair, numbers, near = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS), integers(world, NEAR_PAIR)
    ahead = travels(world, interval)
    if afresh or not ahead <= floats(world, CLOTH_SEARCH)[0, NEAR_AHEAD]:
        note_near(world, ahead)
    for k in range(rows(world, NEAR_PAIR)):
        row = near[k, 0]
        if pair[row, PAIR_KIND] == CROSSING:
            untangle(world, row, interval * push)
        elif is_laid(world, row, ahead) and numbers[row, PAIR_GIVES] > 0.0:
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
            move_apart(world, PARTICLE, at, weights, times(out / numbers[row, PAIR_GIVES], n))
        impulse = _stopping(world, row, mixed(weights, particle, at, PARTICLE_VELOCITY), -max(gap, 0.0) / part)
        add_impulse(world, at, weights, impulse)
        row = pair[row, NEXT_HELD]


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
    give_late(world, at, weights, _stopping(world, row, v, -max(gap, 0.0) / part), interval, part)


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


@compiled(inline=True)
def give_late(world: int, at: Corners, weights: Weights, impulse: Vector, interval: float, part: float) -> None:
    """Give the particles of a pair an impulse that acts in the last part of an interval, s; they do not move with it before.

    An impulse that moved them for the whole interval would strain the cloth without being stopped by its forces, which do work
    on it afterwards. By that work folds tremble for ever. Particles that are pinned to bodies do not move with it at all.
    """
    particle, shift = floats(world, PARTICLE), floats(world, PARTICLE_SHIFT)
    add_impulse(world, at, weights, impulse)
    for k in range(4):
        late = interval - part if particle[at[k], PARTICLE_INVERSE_MASS] > 0.0 else interval
        share = late * weights[k] * inverse_mass(world, at[k])
        for axis in range(3):
            shift[at[k], axis] -= share * impulse[axis]


@compiled(inline=True)
def add_impulse(world: int, at: Corners, weights: Weights, impulse: Vector) -> None:
    """Apply an impulse between the points of a pair to the velocities of its particles."""
    particle = floats(world, PARTICLE)
    for k in range(4):
        share = weights[k] * inverse_mass(world, at[k])
        for axis in range(3):
            particle[at[k], PARTICLE_VELOCITY + axis] += share * impulse[axis]


@compiled(inline=True)
def move_apart(world: int, table: Table, at: Corners, weights: Weights, way: Vector) -> None:
    """Add displacements of the particles of a pair, except pinned ones, to the first three columns of a table.

    The points of the pair move apart by `way`, kg m, times its mobility.
    """
    particle, values = floats(world, PARTICLE), floats(world, table)
    for k in range(4):
        share = weights[k] * particle[at[k], PARTICLE_INVERSE_MASS]
        for axis in range(3):
            values[at[k], axis] += share * way[axis]

"""Continuous collision detection of cloth in the drift of an interval, and impulses against crossings.

The time at which a pair gets too close while its particles move along straight lines is found by conservative advancement: its
steps are bounded by the distance, so that no crossing is missed (Li, Kaufman and Jiang, Codimensional incremental potential
contact, SIGGRAPH 2021, section 5.2). Such a pair gets an impulse that stops its approach there; pairs that are still too close
after some rounds move as rigid bodies (Bridson, Fedkiw and Anderson, Robust treatment of collisions, contact and friction for
cloth animation, SIGGRAPH 2002, section 7.3).
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import PAIR_APART, PAIR_KIND, PAIR_SEEN, PARTICLE_VELOCITY, TRAVELLED
from kickdrift.world.deformables.self_collision.closest_features import (
    Ways,
    Weights,
    closing,
    less_mean,
    mix,
    mixed,
    nearest,
)
from kickdrift.world.deformables.self_collision.impact_zones import begin_zones, join_zone, move_zones
from kickdrift.world.deformables.self_collision.near_pairs import is_free, mobility, particles_of, response
from kickdrift.world.deformables.self_collision.pair_impulses import give_late, move_apart
from kickdrift.world.deformables.self_collision.swept_bounds import travels
from kickdrift.world.deformables.self_collision.untangling import CROSSING
from kickdrift.world.tables import (
    CLOTH_PAIR,
    CLOTH_PAIR_NUMBERS,
    CLOTH_SEARCH,
    PARTICLE,
    PARTICLE_SHIFT,
    floats,
    integers,
    rows,
)

_NEAR = 0.1  # of the distance at the start of an interval: the smallest one allowed in it
_LOOKS = 60  # advancement steps, after which a pair counts as too close
_ROUNDS, _ZONE_ROUNDS = 4, 40
_NEVER = 2.0


@compiled
def stop_crossings(world: int, interval: float, part: float) -> None:
    """Ensure that nothing crosses in an interval, s, by impulses in its last part, s, and update TRAVELLED."""
    if rows(world, CLOTH_PAIR) == 0:
        return
    search = floats(world, CLOTH_SEARCH)
    for k in range(_ROUNDS + _ZONE_ROUNDS):
        if k == _ROUNDS:
            begin_zones(world)
        ahead, zones = travels(world, interval), k >= _ROUNDS
        if _stop(world, interval, part, search[0, TRAVELLED] + ahead, zones) == 0:
            search[0, TRAVELLED] += ahead
            return
        if zones:
            move_zones(world, interval)
    search[0, TRAVELLED] += travels(world, interval)


@compiled
def _stop(world: int, interval: float, part: float, travelled: float, zones: bool) -> int:
    """Stop pairs that get too close, or add them to zones; return their number. `travelled` is TRAVELLED after the drift."""
    pair, numbers, hits = integers(world, CLOTH_PAIR), floats(world, CLOTH_PAIR_NUMBERS), 0
    for row in range(rows(world, CLOTH_PAIR)):
        kind, near = pair[row, PAIR_KIND], numbers[row, PAIR_APART] <= travelled - numbers[row, PAIR_SEEN]
        if not near or kind == CROSSING or is_free(world, row):
            continue
        at = particles_of(world, row)
        ways = _ways(world, row, interval)
        bound = closing(kind, ways)
        time, weights, way = _time_of_hit(world, row, kind, ways, bound)
        if time == _NEVER or not mobility(world, at, weights) > 0.0:
            continue
        hits += 1
        if zones:
            for k in range(3):
                join_zone(world, at[0], at[k + 1])
            continue
        _correct(world, row, interval, part, weights, way)
    return hits


@compiled
def _correct(world: int, row: int, interval: float, part: float, weights: Weights, way: Vector) -> None:
    """Make the distance of a pair at the end of an interval, along `way`, as large as it is at its hit.

    An impulse stops its approach; approach due to shifts is compensated by a shift, which gives no velocity.
    """
    at, particle = particles_of(world, row), floats(world, PARTICLE)
    apart = length(way)
    n = times(1.0 / apart, way)
    start = mix(
        weights,
        vector_at(particle, at[0], 0),
        vector_at(particle, at[1], 0),
        vector_at(particle, at[2], 0),
        vector_at(particle, at[3], 0),
    )
    ways = _ways(world, row, interval)
    end = dot(n, plus(start, mix(weights, ways[0], ways[1], ways[2], ways[3])))
    if not end < apart:
        return
    wanted = (apart - end) / mobility(world, at, weights)
    approach = -dot(n, mixed(weights, particle, at, PARTICLE_VELOCITY))
    stopped = min(wanted, part * max(approach, 0.0) / response(world, at, weights))
    give_late(world, at, weights, times(stopped / part, n), interval, part)
    move_apart(world, PARTICLE_SHIFT, at, weights, times(wanted - stopped, n))


@compiled(inline=True)
def _ways(world: int, row: int, interval: float) -> Ways:
    """Return the displacements of the particles of a pair in an interval, less their mean."""
    p, a, b, c = particles_of(world, row)
    return less_mean(
        _way(world, p, interval), _way(world, a, interval), _way(world, b, interval), _way(world, c, interval)
    )


@compiled(inline=True)
def _way(world: int, i: int, interval: float) -> Vector:
    """Return the displacement of a particle in an interval, m."""
    drift = times(interval, vector_at(floats(world, PARTICLE), i, PARTICLE_VELOCITY))
    return plus(drift, vector_at(floats(world, PARTICLE_SHIFT), i, 0))


@compiled
def _time_of_hit(world: int, row: int, kind: int, ways: Ways, bound: float) -> tuple[float, Weights, Vector]:
    """Return the time from 0 to 1 at which a pair is too close, or `_NEVER`, with its weights and distance vector then."""
    at, particle = particles_of(world, row), floats(world, PARTICLE)
    p, a = vector_at(particle, at[0], 0), vector_at(particle, at[1], 0)
    b, c = vector_at(particle, at[2], 0), vector_at(particle, at[3], 0)
    time, weights, way = 0.0, (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    least = 0.0
    for look in range(_LOOKS):
        weights, way = nearest(
            kind,
            plus(p, times(time, ways[0])),
            plus(a, times(time, ways[1])),
            plus(b, times(time, ways[2])),
            plus(c, times(time, ways[3])),
        )
        apart = length(way)
        if look == 0:
            least = _NEAR * apart
            if apart > bound or apart == 0.0:
                return _NEVER, weights, way
        elif apart <= 1.5 * least:
            return time, weights, way
        time += (apart - least) / bound
        if time > 1.0:
            return _NEVER, weights, way
    return time, weights, way

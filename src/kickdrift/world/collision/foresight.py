"""How bodies move in a step, as far as it is known before: with the velocities at its start, and then as they were seen to.

A step in which impacts made bodies so fast that a contact was missed is done again (`missed`). What was seen of these bodies is
the search's to know then: up to a time, the kink, they fly as before, and from there on so that they end where they did.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, dot, exponential, length, minus, plus, product, times
from kickdrift.world.collision.acceleration import acceleration
from kickdrift.world.columns import column, quaternion_at, vector_at
from kickdrift.world.settings import STEP
from kickdrift.world.tables import DELTA_POSE, FORESEEN, MOTION, POSE, SETTINGS, STARTED_MOTION, STARTED_POSE, floats

IS_FORESEEN = column(FORESEEN)  # one of the two below, or 0.0
KINK = column(FORESEEN, 1, "s")  # since the start of the step
END_POSE = column(FORESEEN, 7)
END_MOTION = column(FORESEEN, 6, "m/s, rad/s")
OFF = column(FORESEEN, 1, "m")  # how far the body is from where it was expected at the end of a step
STRUCK = column(FORESEEN)  # 1.0 of bodies that a fast contact may strike
TURNED_FARTHER = column(FORESEEN, 1, "rad")  # and how much more it has turned

# While a step is done again for what has happened to the body in it; and in the step after that
KNOWN, WIDE = 1.0, 2.0


@compiled
def path(world: int, body: int, when: float) -> tuple[Vector, Quaternion]:
    """Return where a body is a time after the start of the step, if only gravity and forces act on it, or as was foreseen."""
    pose, motion, foreseen = floats(world, POSE), floats(world, MOTION), floats(world, FORESEEN)
    if foreseen[body, IS_FORESEEN] == KNOWN and when >= foreseen[body, KINK]:
        back = when - floats(world, SETTINGS)[0, STEP]
        at, q = vector_at(foreseen, body, END_POSE), quaternion_at(foreseen, body, END_POSE + 3)
        v, w, since = vector_at(foreseen, body, END_MOTION), vector_at(foreseen, body, END_MOTION + 3), back
    else:
        at, q = vector_at(pose, body, 0), quaternion_at(pose, body, 3)
        v, w, since = vector_at(motion, body, 0), vector_at(motion, body, 3), when
    at = plus(plus(at, times(since, v)), times(0.5 * since * since, acceleration(world, body)))
    return at, product(exponential(times(since, w)), q)


@compiled
def velocity_then(world: int, body: int, when: float) -> Vector:
    """Return the velocity of a body on its path."""
    foreseen, gained = floats(world, FORESEEN), acceleration(world, body)
    if foreseen[body, IS_FORESEEN] == KNOWN and when >= foreseen[body, KINK]:
        return plus(vector_at(foreseen, body, END_MOTION), times(when - floats(world, SETTINGS)[0, STEP], gained))
    return plus(vector_at(floats(world, MOTION), body, 0), times(when, gained))


@compiled(inline=True)
def fastest_turn(world: int, body: int) -> float:
    """Bound how fast a body turns on its path."""
    foreseen, turn = floats(world, FORESEEN), length(vector_at(floats(world, MOTION), body, 3))
    if foreseen[body, IS_FORESEEN] == KNOWN:
        turn = max(turn, length(vector_at(foreseen, body, END_MOTION + 3)))
    return turn


@compiled(inline=True)
def next_kink(world: int, body: int, when: float, end: float) -> float:
    """Return when the path of a body has its kink, if that is between two times; or the latter."""
    foreseen = floats(world, FORESEEN)
    if foreseen[body, IS_FORESEEN] == KNOWN and when < foreseen[body, KINK] < end:
        end = foreseen[body, KINK]
    return end


@compiled(inline=True)
def is_foreseen(world: int, body: int) -> bool:
    """Whether more is known of a body than how it begins the step."""
    foreseen: bool = floats(world, FORESEEN)[body, IS_FORESEEN] == KNOWN
    return foreseen


@compiled
def way_foreseen(world: int, body: int) -> float:
    """Bound how far a body gets on its path from where it is."""
    foreseen, step = floats(world, FORESEEN), floats(world, SETTINGS)[0, STEP]
    kink = foreseen[body, KINK]
    at, _ = path(world, body, kink)
    before = kink * length(vector_at(floats(world, MOTION), body, 0))
    jump = length(minus(at, vector_at(floats(world, POSE), body, 0)))
    after = length(minus(vector_at(foreseen, body, END_POSE), at))
    way: float = max(before, jump) + after + step * step * length(acceleration(world, body))
    return way


@compiled
def foresee(h: float, world: int, body: int) -> None:
    """Note how a body has moved in the step that is to be done again."""
    pose, motion, foreseen = floats(world, POSE), floats(world, MOTION), floats(world, FORESEEN)
    start, before = vector_at(floats(world, STARTED_POSE), body, 0), vector_at(floats(world, STARTED_MOTION), body, 0)
    gained = times(h, acceleration(world, body))
    at, after = vector_at(pose, body, 0), vector_at(motion, body, 0)
    # The path to the start, and that back from the end, are nearest to each other at the kink.
    faster = minus(minus(after, gained), before)
    apart = plus(minus(minus(at, start), times(h, after)), times(0.5 * h, gained))
    kink = -dot(apart, faster) / max(dot(faster, faster), 1e-300)
    foreseen[body, IS_FORESEEN], foreseen[body, KINK] = KNOWN, min(max(kink, 0.0), h)
    for k in range(7):
        foreseen[body, END_POSE + k] = pose[body, k]
    for k in range(6):
        foreseen[body, END_MOTION + k] = motion[body, k]


@compiled
def surprise(h: float, world: int, body: int) -> tuple[float, float]:
    """Return how far a body is off its path, and by how much it has turned farther; what is stopped is on its path."""
    started, motion = floats(world, STARTED_POSE), floats(world, STARTED_MOTION)
    foreseen, start = floats(world, FORESEEN), vector_at(started, body, 0)
    way = minus(vector_at(floats(world, POSE), body, 0), start)
    turn, most = length(vector_at(floats(world, DELTA_POSE), body, 3)), length(vector_at(motion, body, 3))
    v, gained = vector_at(motion, body, 0), acceleration(world, body)
    if is_foreseen(world, body):
        kink, end = foreseen[body, KINK], minus(vector_at(foreseen, body, END_POSE), start)
        corner = plus(times(kink, v), times(0.5 * kink * kink, gained))
        off = min(_distance(way, (0.0, 0.0, 0.0), corner), _distance(way, corner, end))
        most = max(most, length(vector_at(foreseen, body, END_MOTION + 3)))
    else:
        off = _distance(way, (0.0, 0.0, 0.0), plus(times(h, v), times(0.5 * h * h, gained)))
    return off, max(turn - h * most, 0.0)


@compiled(inline=True)
def _distance(point: Vector, start: Vector, end: Vector) -> float:
    """Distance of a point from the line from one point to another."""
    along, to = minus(end, start), minus(point, start)
    part = min(max(dot(to, along) / max(dot(along, along), 1e-300), 0.0), 1.0)
    off: float = length(minus(to, times(part, along)))
    return off


@compiled(inline=True)
def forget(world: int, body: int) -> None:
    """Know no more of a body than how it begins the step; bounds that hold its path are drawn anew in the next one."""
    foreseen = floats(world, FORESEEN)
    foreseen[body, IS_FORESEEN] = WIDE if foreseen[body, IS_FORESEEN] == KNOWN else 0.0

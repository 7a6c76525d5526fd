"""Particles pinned to bodies, which carry them and feel their pull.

A pinned particle has mass, weight and forces like the others. At every kick a body and the particles of a cloth that are pinned
to it get the impulses that make them move as one rigid body, so that the body carries their weight and inertia, and momentum is
conserved.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, cross, dot, length, minus, plus, times
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.deformables.body_contacts.body_impulses import displace, move_on
from kickdrift.world.deformables.body_contacts.pinned_corners import arm_of_pin
from kickdrift.world.deformables.layout import (
    FIRST_PIN,
    GIVES,
    LAST_PIN,
    MOST_WITHHELD,
    NOTED_DELTA,
    PARTICLE_MASS,
    PARTICLE_VELOCITY,
    PIN_POSITION,
    PINNED_BODY,
    PINNED_PARTICLE,
)
from kickdrift.world.deformables.particle_fields import force_on
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    DISPLACEMENT,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    POSITION,
    ROTATION,
    VELOCITY,
)
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_LOAD,
    DELTA_POSE,
    INTERVAL_START,
    INVERSE_MASS,
    MOTION,
    PARTICLE,
    PIN,
    PIN_NUMBERS,
    POSE,
    floats,
    integers,
    rows,
)


@compiled
def pull_bodies(world: int, cloth: int, part: float, fall: Vector, left: float, begins: bool) -> None:
    """Kick the particles of a cloth that are pinned to bodies, and these bodies, by forces in a part, s, and by `fall`, m/s.

    Bodies move with their changes of velocity for the time `left` in the substep, s. Where it begins, they have moved as if
    nothing was pinned to them, and not always with their velocity: contacts push them apart. So their displacements are shared
    with their particles like their momentum, as far as they are larger than those of loads at rest. Otherwise a rod that hit
    the floor turned by 0.4 rad about its axis, and a cloth of five times its mass on both sides gained 900 J.
    """
    own, pin = integers(world, CLOTH), integers(world, PIN)
    first, last = own[cloth, FIRST_PIN], own[cloth, LAST_PIN]
    for k in range(first + 1, last + 1):
        if k == last or pin[k, PINNED_BODY] != pin[first, PINNED_BODY]:
            _pull_body(world, first, k, part, fall, left, begins)
            first = k


@compiled
def _pull_body(world: int, first: int, last: int, part: float, fall: Vector, left: float, begins: bool) -> None:
    """Kick a range of pins, all of one body."""
    motion, body = floats(world, MOTION), integers(world, PIN)[first, PINNED_BODY]
    u, w = vector_at(motion, body, VELOCITY), vector_at(motion, body, ANGULAR_VELOCITY)
    if floats(world, INVERSE_MASS)[body, INVERSE_LINEAR_MASS] == 0.0:
        _carry(world, first, last, u, w)
        return
    moved = _freed_motion(world, first, last, left, (u, w)) if begins else (u, w)
    shift, turn = _shared(world, first, last, part, fall, (u, w))
    way, rotation = _shared(world, first, last, part, fall, moved) if begins else (shift, turn)
    _carry(world, first, last, shift, turn)
    move_on(world, body, minus(shift, u), minus(turn, w), 0.0)
    displace(world, body, times(left, minus(way, moved[0])), times(left, minus(rotation, moved[1])))


@compiled(inline=True)
def _carry(world: int, first: int, last: int, u: Vector, w: Vector) -> None:
    """Give pinned particles the velocities of their points of a body, which moves and turns with these."""
    pin, particle = integers(world, PIN), floats(world, PARTICLE)
    for k in range(first, last):
        v = plus(u, cross(w, arm_of_pin(world, k)))
        for j in range(3):
            particle[pin[k, PINNED_PARTICLE], PARTICLE_VELOCITY + j] = v[j]


@compiled
def _freed_motion(world: int, first: int, last: int, h: float, motion: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    """Return the motion of a body, plus the rates at which it has moved and turned beside it in a substep, s.

    Differences as large as loads that contacts hold are left out, which are also those of free flight with its midpoint.
    """
    delta, load, body = floats(world, DELTA_POSE), floats(world, CLOTH_LOAD), integers(world, PIN)[first, PINNED_BODY]
    (u, w), r, mass = motion, 0.0, 0.0
    for k in range(first, last):
        mass += floats(world, PARTICLE)[integers(world, PIN)[k, PINNED_PARTICLE], PARTICLE_MASS]
        r = max(r, length(vector_at(floats(world, PIN_NUMBERS), k, PIN_POSITION)))
    way = minus(minus(vector_at(delta, body, DISPLACEMENT), vector_at(load, body, NOTED_DELTA)), times(h, u))
    turn = minus(minus(vector_at(delta, body, ROTATION), vector_at(load, body, NOTED_DELTA + 3)), times(h, w))
    size = length(way) + r * length(turn)
    most = h * load[body, MOST_WITHHELD] * (1.0 + mass * floats(world, INVERSE_MASS)[body, INVERSE_LINEAR_MASS])
    beside = max(1.0 - most / size, 0.0) / h if size > 0.0 else 0.0
    return plus(u, times(beside, way)), plus(w, times(beside, turn))


@compiled
def _shared(
    world: int, first: int, last: int, part: float, fall: Vector, motion: tuple[Vector, Vector]
) -> tuple[Vector, Vector]:
    """Return velocity and angular velocity of a body that has these, and becomes rigid with what is pinned to it.

    With masses m at arms r and velocities v, the rigid motion (u, w) satisfies u (m_b + sum m) + w x c = m_b u_b + sum m v and
    w + S (I w + c x u) = w_b + S sum m r x v, where c = sum m r, I = sum m (r^2 - r r^T), and S is the body's inverse inertia.
    """
    pin, particle = integers(world, PIN), floats(world, PARTICLE)
    inverse, body = floats(world, INVERSE_MASS), integers(world, PIN)[first, PINNED_BODY]
    u, w = motion
    mass, lever, momentum, spin = 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # sum m r r^T
    for k in range(first, last):
        i, r = pin[k, PINNED_PARTICLE], arm_of_pin(world, k)
        m = particle[i, PARTICLE_MASS]
        v = plus(plus(vector_at(particle, i, PARTICLE_VELOCITY), fall), times(part / m, force_on(world, i)))
        momentum, spin = plus(momentum, times(m, v)), plus(spin, times(m, cross(r, v)))
        mass, lever = mass + m, plus(lever, times(m, r))
        xx, yy, zz = xx + m * r[0] * r[0], yy + m * r[1] * r[1], zz + m * r[2] * r[2]
        xy, xz, yz = xy + m * r[0] * r[1], xz + m * r[0] * r[2], yz + m * r[1] * r[2]
    own = 1.0 / inverse[body, INVERSE_LINEAR_MASS]
    share = 1.0 / (own + mass)
    straight = times(share, plus(times(own, u), momentum))
    x, y, z = lever
    xx, yy, zz = xx - share * x * x, yy - share * y * y, zz - share * z * z
    xy, xz, yz = xy - share * x * y, xz - share * x * z, yz - share * y * z
    inertia, turns = ((yy + zz, xx + zz, xx + yy, -xy, -xz, -yz), symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD))
    a = plus(applied(inertia, (turns[0], turns[3], turns[4])), (1.0, 0.0, 0.0))
    b = plus(applied(inertia, (turns[3], turns[1], turns[5])), (0.0, 1.0, 0.0))
    c = plus(applied(inertia, (turns[4], turns[5], turns[2])), (0.0, 0.0, 1.0))
    turn = _solved(a, b, c, plus(w, applied(turns, minus(spin, cross(lever, straight)))))
    return minus(straight, times(share, cross(turn, lever))), turn


@compiled(inline=True)
def _solved(a: Vector, b: Vector, c: Vector, right: Vector) -> Vector:
    """Solve three equations, whose rows are a, b and c."""
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    return times(1.0 / dot(a, bc), plus(times(right[0], bc), plus(times(right[1], ca), times(right[2], ab))))


@compiled
def note_inverse_masses(world: int) -> None:
    """Store the inverse masses that particles pinned to dynamic bodies have for impulses of pairs."""
    pin, particle, start = integers(world, PIN), floats(world, PARTICLE), floats(world, INTERVAL_START)
    for i in range(rows(world, PARTICLE)):
        start[i, GIVES] = 0.0
    for k in range(rows(world, PIN)):
        if floats(world, INVERSE_MASS)[pin[k, PINNED_BODY], INVERSE_LINEAR_MASS] > 0.0:
            start[pin[k, PINNED_PARTICLE], GIVES] = 1.0 / particle[pin[k, PINNED_PARTICLE], PARTICLE_MASS]


@compiled
def carry_pins(world: int, cloth: int, part: float, left: float) -> None:
    """Shift particles pinned to bodies so that they reach their points at the end of the substep, which is `left` away, s.

    The drift will add `part` times their velocity, which is subtracted here: the chord differs from the tangent.
    """
    own, pin, pose, particle = (
        integers(world, CLOTH),
        integers(world, PIN),
        floats(world, POSE),
        floats(world, PARTICLE),
    )
    for k in range(own[cloth, FIRST_PIN], own[cloth, LAST_PIN]):
        i = pin[k, PINNED_PARTICLE]
        goal = plus(vector_at(pose, pin[k, PINNED_BODY], POSITION), arm_of_pin(world, k))
        way = minus(goal, vector_at(particle, i, 0))
        for j in range(3):
            particle[i, j] += part * (way[j] / left - particle[i, PARTICLE_VELOCITY + j])

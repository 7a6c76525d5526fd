"""Loads of cloths on bodies as forces in the next substep, because contacts of bodies are solved before cloths move.

If cloths moved bodies as if these were free, their contacts would answer a substep late: a table under ten times its weight
sank by 6 mm, and a heavy body on cloth on a lighter one was thrown off. So the part of its kick that contacts leave to a body
is measured. Cloths push the body with this part of their impulses only; the rest acts in the next substep, where contacts hold
it.

In the substep of an impact, and on joints, which may be springs, bodies count as free, and contacts hold at most a few times
what they have held, and no more than what would move the body by a few slops. Without that, boxes that bounced under cloth
gained 200 times their energy, and a load on a box on a spring 3 kJ.

Bodies on load paths have their weight from the start of a substep, and cloths press on them part by part. So that they press
evenly, as friction needs it, the steady part of what they pressed with is predicted: bodies get it as a force before, and it is
taken back, part by part.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, length, minus, times
from kickdrift.world.collision.body_acceleration import RESTING_SUBSTEPS, acceleration
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.deformables.body_contacts.body_impulses import move_on
from kickdrift.world.deformables.layout import (
    GIVEN_CHANGE,
    GIVEN_FORCE,
    HELD,
    IS_ASLEEP,
    MOST_WITHHELD,
    NOTED_DELTA,
    NOTED_SPIN,
    NOTED_VELOCITY,
    STARTED_LOAD,
    STEADY_FORCE,
    STEADY_TORQUE,
    WITHHELD_CHANGE,
    WITHHELD_IMPULSE,
)
from kickdrift.world.free_rotation import turned_product
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    AWAKE,
    BODY_INERTIA,
    BODY_KIND,
    DAMPING,
    DISPLACEMENT,
    DYNAMIC,
    IN_HEAP,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    LINK_COUNT,
    ORIENTATION,
    SUBSTEP_FORCE,
    SUBSTEP_TORQUE,
    TURN_DAMPING,
    VELOCITY,
)
from kickdrift.world.settings import SLOP
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    BODY,
    CLOTH,
    CLOTH_LOAD,
    DELTA_POSE,
    FORCE,
    INERTIA,
    INVERSE_MASS,
    MOTION,
    POSE,
    SETTINGS,
    Tables,
    floats,
    integers,
    room,
    rows,
    set_rows,
)

_FREE = 0.99  # part of a kick that counts as all of it
_MOST = 4.0  # kicks that contacts hold in a substep
# Slops by which a load may move a body in a substep if contacts do not hold it after all. Without that bound, a box of 10 g
# under a cloth of 29 kg that fell on it was thrown at 460 m/s.
_FARTHEST = 4.0
_LEAST = 1e-2  # of a kick: components from which what is left of them is measured


@compiled
def predict_loads(t: float, h: float, world: int) -> None:
    """Add the loads of cloths to the forces on bodies, whose motion is noted."""
    if integers(world, CLOTH)[0, IS_ASLEEP] != 0:
        return
    load, motion, delta = floats(world, CLOTH_LOAD), floats(world, MOTION), floats(world, DELTA_POSE)
    for body in range(rows(world, CLOTH_LOAD)):
        spin = _spin(world, body)
        for k in range(3):
            load[body, NOTED_VELOCITY + k], load[body, NOTED_SPIN + k] = motion[body, VELOCITY + k], spin[k]
        for k in range(6):
            load[body, NOTED_DELTA + k] = delta[body, DISPLACEMENT + k]
    _add_forces(world, h, 1.0)


@compiled
def predict_later_loads(t: float, h: float, world: int) -> None:
    """Add the same loads to the forces at the end of a substep."""
    if integers(world, CLOTH)[0, IS_ASLEEP] == 0:
        _add_forces(world, h, 1.0)


@compiled
def _add_forces(world: int, h: float, sign: float) -> None:
    """Add `sign` times the loads of a substep, s, to the forces on bodies."""
    load, force = floats(world, CLOTH_LOAD), floats(world, FORCE)
    for body in range(rows(world, CLOTH_LOAD)):
        for k in range(6):
            push = load[body, STEADY_FORCE + k] + load[body, WITHHELD_IMPULSE + k] / h
            force[body, SUBSTEP_FORCE + k] += sign * push


@compiled
def begin_loads(world: int, h: float) -> None:
    """Begin the loads of a substep, s, and find what of their kick the contacts of bodies have held."""
    load = floats(world, CLOTH_LOAD)
    for body in range(rows(world, CLOTH_LOAD)):
        if _is_moved(world, body):
            _find_held(world, body, h)
        for k in range(6):
            load[body, WITHHELD_CHANGE + k] = load[body, GIVEN_CHANGE + k] = 0.0
    _add_forces(world, h, -1.0)


@compiled
def _find_held(world: int, body: int, h: float) -> None:
    """Find which part of a change of motion the contacts of a body hold, from what is left of its kick."""
    load, inertia, own = floats(world, CLOTH_LOAD), floats(world, INERTIA), integers(world, BODY)
    keep = 1.0 / (1.0 + h * inertia[body, DAMPING]), 1.0 / (1.0 + h * inertia[body, TURN_DAMPING])
    straight = times(keep[0] * h, acceleration(world, body))
    turning = times(keep[1] * h, vector_at(floats(world, FORCE), body, SUBSTEP_TORQUE))
    before = times(keep[0], vector_at(load, body, NOTED_VELOCITY)), times(keep[1], vector_at(load, body, NOTED_SPIN))
    moved = minus(vector_at(floats(world, MOTION), body, VELOCITY), before[0])
    turned = minus(_spin(world, body), before[1])
    farthest = _FARTHEST * floats(world, SETTINGS)[0, SLOP]
    load[body, MOST_WITHHELD] = min(_MOST * length(straight), farthest / h)
    joined = own[body, LINK_COUNT] > 0 and own[body, IN_HEAP] == 0
    for j in range(2):
        kick, change = (straight, moved) if j == 0 else (turning, turned)
        least = _LEAST * length(kick)
        for k in range(3):
            left = change[k] / kick[k] if abs(kick[k]) > least else 1.0
            rests = not joined and -RESTING_SUBSTEPS <= left < _FREE
            load[body, HELD + 3 * j + k] = 1.0 - math.sqrt(max(left, 0.0)) if rests else 0.0


@compiled(inline=True)
def _spin(world: int, body: int) -> Vector:
    """Return the angular momentum of a body."""
    return _moment_of(world, body, vector_at(floats(world, MOTION), body, ANGULAR_VELOCITY))


@compiled
def _moment_of(world: int, body: int, turn: Vector) -> Vector:
    """Return the angular momentum of a body for an angular velocity."""
    q = quaternion_at(floats(world, POSE), body, ORIENTATION)
    return turned_product(q, symmetric_at(floats(world, INERTIA), body, BODY_INERTIA), turn)


@compiled
def take_back_loads(world: int, share: float, h: float, left: float) -> None:
    """Take back a share of what bodies got by steady loads, for the time `left` in the substep h, s."""
    load, inverse, inertia = floats(world, CLOTH_LOAD), floats(world, INVERSE_MASS), floats(world, INERTIA)
    for body in range(rows(world, CLOTH_LOAD)):
        loaded = False
        for k in range(6):
            loaded = loaded or load[body, STEADY_FORCE + k] != 0.0
        if loaded and _is_moved(world, body):
            push, twist = vector_at(load, body, STEADY_FORCE), vector_at(load, body, STEADY_TORQUE)
            time = -share * h / (1.0 + h * inertia[body, DAMPING])
            shift = times(time * inverse[body, INVERSE_LINEAR_MASS], push)
            time = -share * h / (1.0 + h * inertia[body, TURN_DAMPING])
            turn = times(time, applied(symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD), twist))
            move_on(world, body, shift, turn, left)


@compiled
def measure_loads(world: int, h: float) -> None:
    """Store the loads of cloths in a substep, s, for the next one."""
    load, inverse = floats(world, CLOTH_LOAD), floats(world, INVERSE_MASS)
    slop = floats(world, SETTINGS)[0, SLOP]
    for body in range(rows(world, CLOTH_LOAD)):
        if not _is_moved(world, body):
            for k in range(18):
                load[body, WITHHELD_IMPULSE + k] = 0.0
            continue
        inverse_mass = inverse[body, INVERSE_LINEAR_MASS]
        mass = 1.0 / inverse_mass if inverse_mass > 0.0 else 0.0
        most = _FARTHEST * mass * slop / (h * h)
        for j in range(2):
            given = vector_at(load, body, GIVEN_CHANGE + 3 * j)
            withheld = vector_at(load, body, WITHHELD_CHANGE + 3 * j)
            given = times(mass, given) if j == 0 else _moment_of(world, body, given)
            withheld = times(mass, withheld) if j == 0 else _moment_of(world, body, withheld)
            for k in range(3):
                at = 3 * j + k
                steady = _common(given[k] / h, load[body, GIVEN_FORCE + at])
                load[body, STEADY_FORCE + at], load[body, GIVEN_FORCE + at] = steady, given[k] / h
                load[body, WITHHELD_IMPULSE + at] = withheld[k]
        force = length(vector_at(load, body, STEADY_FORCE))
        for k in range(6 if force > most else 0):
            load[body, STEADY_FORCE + k] *= most / force


@compiled(inline=True)
def _common(a: float, b: float) -> float:
    """Return the smaller of two numbers of one sign, otherwise zero: impacts and vibrations are not steady."""
    return math.copysign(min(abs(a), abs(b)), a) if a * b > 0.0 else 0.0


@compiled(inline=True)
def _is_moved(world: int, body: int) -> bool:
    """Whether forces move a body."""
    own = integers(world, BODY)
    moved: bool = own[body, BODY_KIND] == DYNAMIC and own[body, AWAKE] != 0
    return moved


@compiled
def note_loads(world: int) -> bool:
    """Save the loads for a rollback; False if there is no room for those of all bodies."""
    count = rows(world, POSE)
    if room(world, CLOTH_LOAD) < count:
        ask_for_room(world, CLOTH_LOAD, count)
        return False
    load, sleeps = floats(world, CLOTH_LOAD), integers(world, CLOTH)[0, IS_ASLEEP] != 0
    for body in range(count):
        for k in range(18):
            if sleeps or body >= rows(world, CLOTH_LOAD):
                load[body, WITHHELD_IMPULSE + k] = 0.0
            load[body, STARTED_LOAD + k] = load[body, WITHHELD_IMPULSE + k]
    set_rows(world, CLOTH_LOAD, count)
    return True


def roll_back_loads(tables: Tables) -> None:
    """Restore the loads at the start of the step."""
    load = tables.array(CLOTH_LOAD)
    load[:, WITHHELD_IMPULSE : WITHHELD_IMPULSE + 18] = load[:, STARTED_LOAD : STARTED_LOAD + 18]

"""Loads of cloths on bodies as forces in the next substep, for contacts and joints of bodies are solved before cloths move.

What a floor holds, it cannot hold in time: a table under ten times its weight would sink by 2 mm, and a heavy body on cloth on
a lighter one would be thrown off, since cloth finds the lighter one as easy to push as if it were free. So the part of their
kick that contacts and joints leave to a body is measured. Cloths push the body with this part of their impulses only; the rest
acts as a force in the next substep, where contacts can hold it.

Bodies on load paths have their weight from the start of a substep, and cloths press on them part by part. So that they press
evenly, as friction needs it, the steady part of what they pressed with is predicted: bodies get it as a force before, and it is
taken back, part by part.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, length, minus, times
from kickdrift.world.cloth.contacts.body_impulses import move_on
from kickdrift.world.cloth.layout import (
    CLOTH_FORCE,
    GIVEN_CHANGE,
    GIVEN_FORCE,
    HELD,
    IS_ASLEEP,
    NOTED_SPIN,
    NOTED_VELOCITY,
    STARTED_LOAD,
    STEADY_FORCE,
    STEADY_TORQUE,
    WITHHELD_CHANGE,
)
from kickdrift.world.collision.body_acceleration import acceleration
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.free_rotation import turned_product
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    AWAKE,
    BODY_INERTIA,
    BODY_KIND,
    DAMPING,
    DYNAMIC,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    ORIENTATION,
    SUBSTEP_FORCE,
    SUBSTEP_TORQUE,
    TURN_DAMPING,
    VELOCITY,
)
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    BODY,
    CLOTH,
    CLOTH_LOAD,
    FORCE,
    INERTIA,
    INVERSE_MASS,
    MOTION,
    POSE,
    Tables,
    floats,
    integers,
    room,
    rows,
    set_rows,
)

_FREE = 0.99  # part of a kick that counts as all of it
_LEAST = 1e-2  # of a kick: components from which what is left of them is measured


@compiled
def predict_loads(t: float, h: float, world: int) -> None:
    """Add the loads of cloths to the forces on bodies, whose motion is noted."""
    if integers(world, CLOTH)[0, IS_ASLEEP] != 0:
        return
    load, force, motion = floats(world, CLOTH_LOAD), floats(world, FORCE), floats(world, MOTION)
    for body in range(rows(world, CLOTH_LOAD)):
        spin = _spin(world, body)
        for k in range(3):
            load[body, NOTED_VELOCITY + k], load[body, NOTED_SPIN + k] = motion[body, VELOCITY + k], spin[k]
        for k in range(6):
            force[body, SUBSTEP_FORCE + k] += load[body, CLOTH_FORCE + k]


@compiled
def begin_loads(world: int, h: float) -> None:
    """Begin the loads of a substep, s, and find what of their kick the contacts of bodies have held."""
    load, force = floats(world, CLOTH_LOAD), floats(world, FORCE)
    for body in range(rows(world, CLOTH_LOAD)):
        if _is_moved(world, body):
            _find_held(world, body, h)
        for k in range(6):
            force[body, SUBSTEP_FORCE + k] -= load[body, CLOTH_FORCE + k]
            load[body, WITHHELD_CHANGE + k] = load[body, GIVEN_CHANGE + k] = 0.0


@compiled
def _find_held(world: int, body: int, h: float) -> None:
    """Find which part of a change of motion the contacts and joints of a body hold, from what is left of its kick."""
    load, inertia = floats(world, CLOTH_LOAD), floats(world, INERTIA)
    straight = times(h / (1.0 + h * inertia[body, DAMPING]), acceleration(world, body))
    torque = vector_at(floats(world, FORCE), body, SUBSTEP_TORQUE)
    turning = times(h / (1.0 + h * inertia[body, TURN_DAMPING]), torque)
    moved = minus(vector_at(floats(world, MOTION), body, VELOCITY), vector_at(load, body, NOTED_VELOCITY))
    turned = minus(_spin(world, body), vector_at(load, body, NOTED_SPIN))
    for j in range(2):
        kick, change = (straight, moved) if j == 0 else (turning, turned)
        least = _LEAST * length(kick)
        for k in range(3):
            left = change[k] / kick[k] if abs(kick[k]) > least else 1.0
            load[body, HELD + 3 * j + k] = 1.0 - math.sqrt(max(left, 0.0)) if left < _FREE else 0.0


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
    for body in range(rows(world, CLOTH_LOAD)):
        if not _is_moved(world, body):
            for k in range(18):
                load[body, CLOTH_FORCE + k] = 0.0
            continue
        inverse_mass = inverse[body, INVERSE_LINEAR_MASS]
        mass = 1.0 / inverse_mass if inverse_mass > 0.0 else 0.0
        for j in range(2):
            given = vector_at(load, body, GIVEN_CHANGE + 3 * j)
            withheld = vector_at(load, body, WITHHELD_CHANGE + 3 * j)
            given = times(mass, given) if j == 0 else _moment_of(world, body, given)
            withheld = times(mass, withheld) if j == 0 else _moment_of(world, body, withheld)
            for k in range(3):
                at = 3 * j + k
                steady = _common(given[k] / h, load[body, GIVEN_FORCE + at])
                load[body, STEADY_FORCE + at], load[body, GIVEN_FORCE + at] = steady, given[k] / h
                load[body, CLOTH_FORCE + at] = steady + withheld[k] / h


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
    load = floats(world, CLOTH_LOAD)
    for body in range(count):
        for k in range(18):
            if body >= rows(world, CLOTH_LOAD):
                load[body, CLOTH_FORCE + k] = 0.0
            load[body, STARTED_LOAD + k] = load[body, CLOTH_FORCE + k]
    set_rows(world, CLOTH_LOAD, count)
    return True


def roll_back_loads(tables: Tables) -> None:
    """Restore the loads at the start of the step."""
    load = tables.array(CLOTH_LOAD)
    load[:, CLOTH_FORCE : CLOTH_FORCE + 18] = load[:, STARTED_LOAD : STARTED_LOAD + 18]

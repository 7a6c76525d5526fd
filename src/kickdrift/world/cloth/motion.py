"""The stage of the step that moves cloths: the semi-implicit Euler method, with parts of a substep for what is stiff.

Fabrics resist stretching much more than bending: what is stiff is kicked in every part of a substep, bending in every so many
of them, as the impulse method does with forces of several speeds (see `kickdrift.methods.multirate`), and wind and gravity
once. All of these are forces between particles along what they are for, so that momentum and angular momentum are those of what
acts from outside, to the last digit.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import applied, cross, minus, plus, times, turned
from kickdrift.world.cloth.bending import add_bending
from kickdrift.world.cloth.contacts import resolve_contacts
from kickdrift.world.cloth.layout import (
    BENDING_PARTS,
    FIRST_PARTICLE,
    LAST_PARTICLE,
    LINEAR_DAMPING,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    PARTS,
    PIN_POSITION,
    PINNED_BODY,
    PINNED_PARTICLE,
)
from kickdrift.world.cloth.membrane import add_membrane
from kickdrift.world.cloth.wind import add_wind
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    ORIENTATION,
    POSITION,
    VELOCITY,
)
from kickdrift.world.settings import GRAVITY, PUSH_SPEED
from kickdrift.world.step_status import report_cloth
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    INVERSE_MASS,
    MOTION,
    PARTICLE,
    PARTICLE_FORCE,
    PIN,
    PIN_NUMBERS,
    POSE,
    SETTINGS,
    STARTED_PARTICLE,
    floats,
    integers,
    rows,
)


@compiled
def move_cloths(t: float, h: float, world: int) -> None:
    """Move all cloths through a substep, after the bodies have moved."""
    cloths = integers(world, CLOTH)
    _aim_pins(world, h)
    for cloth in range(rows(world, CLOTH)):
        add_wind(world, cloth, h)
        parts, every = cloths[cloth, PARTS], cloths[cloth, BENDING_PARTS]
        part = h / parts
        for k in range(parts):
            add_membrane(world, cloth, part)
            if k % every == 0:  # half at both ends of the substep, as in the velocity Verlet method
                share = 0.5 * (min(every, parts - k) + (min(every, parts) if k > 0 else 0))
                add_bending(world, cloth, every * part, share)
            _move(world, cloth, part)
        add_bending(world, cloth, every * part, 0.5 * (parts - (parts - 1) // every * every))
        _kick(world, cloth, part)
        _check(world, cloth)


@compiled
def _kick(world: int, cloth: int, part: float) -> None:
    """Add what the forces do in a part of a substep to the velocities, and let bodies feel those on what is pinned to them."""
    own, particle, force = integers(world, CLOTH), floats(world, PARTICLE), floats(world, PARTICLE_FORCE)
    _pull_bodies(world, part)
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        factor = part * particle[i, PARTICLE_INVERSE_MASS]
        for k in range(3):
            particle[i, PARTICLE_VELOCITY + k] += factor * force[i, k]
            force[i, k] = 0.0


@compiled
def _move(world: int, cloth: int, part: float) -> None:
    """Kick and drift the particles of a cloth through a part of a substep."""
    own, particle, settings = integers(world, CLOTH), floats(world, PARTICLE), floats(world, SETTINGS)
    _kick(world, cloth, part)
    fall = times(part, vector_at(settings, 0, GRAVITY))
    keep = 1.0 / (1.0 + part * floats(world, CLOTH_NUMBERS)[cloth, LINEAR_DAMPING])
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        if particle[i, PARTICLE_INVERSE_MASS] > 0.0:
            for k in range(3):
                particle[i, PARTICLE_VELOCITY + k] = keep * (particle[i, PARTICLE_VELOCITY + k] + fall[k])
    resolve_contacts(world, cloth, part, part * settings[0, PUSH_SPEED])
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        for k in range(3):
            particle[i, k] += part * particle[i, PARTICLE_VELOCITY + k]


@compiled
def _aim_pins(world: int, h: float) -> None:
    """Let what is pinned to bodies arrive with them at the end of the substep."""
    pin, pin_numbers, pose = integers(world, PIN), floats(world, PIN_NUMBERS), floats(world, POSE)
    particle = floats(world, PARTICLE)
    for k in range(rows(world, PIN)):
        i, body = pin[k, PINNED_PARTICLE], pin[k, PINNED_BODY]
        q = quaternion_at(pose, body, ORIENTATION)
        goal = plus(vector_at(pose, body, POSITION), turned(q, vector_at(pin_numbers, k, PIN_POSITION)))
        way = minus(goal, vector_at(particle, i, 0))
        for j in range(3):
            particle[i, PARTICLE_VELOCITY + j] = way[j] / h


@compiled
def _pull_bodies(world: int, part: float) -> None:
    """Give bodies the forces on what is pinned to them."""
    pin, force, pose = integers(world, PIN), floats(world, PARTICLE_FORCE), floats(world, POSE)
    particle, motion, inverse = floats(world, PARTICLE), floats(world, MOTION), floats(world, INVERSE_MASS)
    for k in range(rows(world, PIN)):
        i, body = pin[k, PINNED_PARTICLE], pin[k, PINNED_BODY]
        impulse = times(part, vector_at(force, i, 0))
        arm = minus(vector_at(particle, i, 0), vector_at(pose, body, POSITION))
        turn = applied(symmetric_at(inverse, body, INVERSE_INERTIA_IN_WORLD), cross(arm, impulse))
        for j in range(3):
            motion[body, VELOCITY + j] += inverse[body, INVERSE_LINEAR_MASS] * impulse[j]
            motion[body, ANGULAR_VELOCITY + j] += turn[j]
            force[i, j] = 0.0


@compiled
def _check(world: int, cloth: int) -> None:
    """See that all particles of a cloth are somewhere."""
    own, particle, total = integers(world, CLOTH), floats(world, PARTICLE), 0.0
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        for k in range(7):
            total += abs(particle[i, k])
    if not total < math.inf:
        report_cloth(world, cloth)


@compiled
def begin_cloths(t: float, h: float, world: int) -> None:
    """Keep the particles as they are, in case the step cannot be done."""
    now, before = floats(world, PARTICLE), floats(world, STARTED_PARTICLE)
    for i in range(rows(world, PARTICLE)):
        for k in range(PARTICLE.width):
            before[i, k] = now[i, k]

"""The stage of the step that moves cloths: the velocity Verlet method, in parts of a substep.

The first and the last kick of a substep are halves, so that a cloth at rest has no velocity. Forces between particles conserve
momentum and angular momentum to the last digit; contacts conserve angular momentum to first order.

Cloth-cloth contact is searched for less often: several parts form an interval, in which known pairs approach by no more than
the thickness. Pairs that touch at its start are held in each part; at its end the others are resolved, and crossings are
stopped on the straight lines from the positions at its start (Bridson, Fedkiw and Anderson, Robust treatment of collisions,
contact and friction for cloth animation, SIGGRAPH 2002, section 4).
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.contact_solver import resolve_contacts
from kickdrift.world.deformables.body_contacts.predicted_loads import begin_loads, measure_loads, take_back_loads
from kickdrift.world.deformables.forces.aerodynamics import add_wind
from kickdrift.world.deformables.forces.bending import add_bending
from kickdrift.world.deformables.forces.elasticity import add_elasticity, stiffening
from kickdrift.world.deformables.forces.membrane import add_membrane, largest_strain
from kickdrift.world.deformables.forces.rope_tension import add_tension
from kickdrift.world.deformables.layout import (
    CLOTH_RADIUS,
    DIMENSION,
    FIRST_PARTICLE,
    INTERVAL,
    IS_ASLEEP,
    LAST_PARTICLE,
    LINEAR_DAMPING,
    PARTICLE_VELOCITY,
    PARTS,
    ROPE,
    SEARCH_AGE,
    SHARED_PARTS,
    TURN,
    VOLUME,
)
from kickdrift.world.deformables.particle_fields import drift_particles, fill_lanes, kick_by_forces
from kickdrift.world.deformables.pins import carry_pins, note_inverse_masses, pull_bodies
from kickdrift.world.deformables.self_collision.cloth_pairs import find_cloth_pairs, meets
from kickdrift.world.deformables.self_collision.continuous_collision import stop_crossings
from kickdrift.world.deformables.self_collision.near_pairs import begin_interval
from kickdrift.world.deformables.self_collision.pair_impulses import approach, hold_pairs, resolve_pairs
from kickdrift.world.deformables.self_collision.swept_bounds import find_strays, set_frame
from kickdrift.world.deformables.tethers import hold_tethers
from kickdrift.world.settings import GRAVITY, PUSH_SPEED
from kickdrift.world.step.status import report_cloth
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    CLOTH_SEARCH,
    INTERVAL_START,
    PARTICLE,
    PARTICLE_SHIFT,
    SETTINGS,
    floats,
    integers,
    rows,
)

_TURNS = 4  # resumable sections of a part
_SWEEPS, _LAST_SWEEPS = 4, 12  # sweeps of impulses: with 1 and 4, heaps of many layers tremble twice as much at rest
_SEARCHES = 3  # largest number of searches for pairs while impulses against crossings move particles out of their boxes
_STIFF, _STIFFEST = 1.25, 400.0  # likewise of soft bodies, by their stiffness over that at rest
_WIDE, _WIDEST = 0.1, 10.0  # strains between which the number of parts grows


@compiled
def move_cloths(t: float, h: float, world: int) -> None:
    """Move all cloths through a substep, after the bodies have moved.

    All cloths use the same parts, since they may touch each other. If there is no room for pairs, the stage resumes from there.
    """
    search = floats(world, CLOTH_SEARCH)
    if integers(world, CLOTH)[0, IS_ASLEEP] != 0:
        return
    if search[0, TURN] == 0.0:
        if not find_cloth_pairs(world, h, h):
            return
        _begin(world, h)
    parts, each = int(search[0, SHARED_PARTS]), int(search[0, INTERVAL])
    part = h / parts
    for at in range(int(search[0, TURN]), _TURNS * (parts + 1)):
        k = at // _TURNS
        if at % _TURNS == 0:
            if k % each == 0 or k == parts:  # elsewhere the drift has copied the positions
                for cloth in range(rows(world, CLOTH)):
                    fill_lanes(world, cloth)
            if k % each == 0 and k < parts:
                begin_interval(world)
            left = h - k * part if k < parts else 0.0  # without rounding errors
            take_back_loads(world, (0.5 if k == 0 or k == parts else 1.0) / parts, h, left)
            _move(world, part, k == 0, k == parts, left)
        elif k == parts:
            _stop(world, part)
            break
        elif (k + 1) % each > 0 and k + 1 < parts:
            continue
        elif meets(world) and not _meet(world, at % _TURNS, h, (k % each + 1) * part, part):
            return
        search[0, TURN] = at + 1
    search[0, TURN] = 0.0
    measure_loads(world, h)
    for cloth in range(rows(world, CLOTH)):
        _check(world, cloth)


@compiled
def _begin(world: int, h: float) -> None:
    """Add the forces of the wind, and choose the number of parts of the substep, and that of the parts of an interval."""
    search, parts, least = floats(world, CLOTH_SEARCH), 1, math.inf
    begin_loads(world, h)
    for cloth in range(rows(world, CLOTH)):
        parts = max(parts, integers(world, CLOTH)[cloth, PARTS] * _parts_of_strain(world, cloth))
        least = min(least, 2.0 * floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS])
    for cloth in range(rows(world, CLOTH)):
        add_wind(world, cloth, h, h / parts)
    note_inverse_masses(world)
    set_frame(world)
    way = approach(world, h)
    search[0, SHARED_PARTS] = parts
    intervals = max(math.ceil(way / least), 1) if way < parts * least else parts
    search[0, INTERVAL] = math.ceil(parts / intervals)
    _note_start(world)


@compiled
def _note_start(world: int) -> None:
    """Store the positions of particles at the start of an interval."""
    particle, start = floats(world, PARTICLE), floats(world, INTERVAL_START)
    for i in range(rows(world, PARTICLE)):
        for k in range(3):
            start[i, k] = particle[i, k]


@compiled
def _move(world: int, part: float, begins: bool, ends: bool, left: float) -> None:
    """Kick all cloths, and, except at the end of the substep, drift."""
    for cloth in range(rows(world, CLOTH)):
        _push(world, cloth, part, begins, ends, left)
    if not ends:
        hold_pairs(world, part, floats(world, SETTINGS)[0, PUSH_SPEED])
        for cloth in range(rows(world, CLOTH)):
            carry_pins(world, cloth, part, left)
        drift_particles(world, part)


@compiled
def _meet(world: int, turn: int, h: float, interval: float, part: float) -> bool:
    """Do one section of the cloth-cloth contact of an interval, s; False if there is no room for pairs.

    Section 1 goes back to the start of the interval, 2 applies impulses, 3 stops crossings and moves to its end;
    impulses act in its last part, s.
    """
    if turn == 1:
        _go_back(world, interval)
    elif turn == 2:
        if not find_cloth_pairs(world, h, interval):
            return False
        for sweep in range(_SWEEPS):
            push = floats(world, SETTINGS)[0, PUSH_SPEED] if sweep == 0 else 0.0
            resolve_pairs(world, interval, part, push, sweep == 0)
    else:
        for _ in range(_SEARCHES):
            if not find_cloth_pairs(world, h, interval):
                return False
            stop_crossings(world, interval, part)
            if find_strays(world, interval) == 0:
                break
        _arrive(world, interval)
        floats(world, CLOTH_SEARCH)[0, SEARCH_AGE] += interval
        _note_start(world)
    return True


@compiled
def _stop(world: int, part: float) -> None:
    """Stop approaching pairs at the end of the substep, including particles that impulses between cloths press onto bodies."""
    for sweep in range(_LAST_SWEEPS if meets(world) else 0):
        resolve_pairs(world, part, part, 0.0, sweep == 0)
        for cloth in range(rows(world, CLOTH)):
            resolve_contacts(world, cloth, part, 0.0, 0.0)


@compiled
def _go_back(world: int, interval: float) -> None:
    """Move particles back to the start of the interval, with shifts such that they would drift to their present positions."""
    particle, start, shift = floats(world, PARTICLE), floats(world, INTERVAL_START), floats(world, PARTICLE_SHIFT)
    for i in range(rows(world, PARTICLE)):
        for k in range(3):
            shift[i, k] = particle[i, k] - start[i, k] - interval * particle[i, PARTICLE_VELOCITY + k]
            particle[i, k] = start[i, k]


@compiled
def _push(world: int, cloth: int, part: float, begins: bool, ends: bool, left: float) -> None:
    """Kick a cloth by its forces, and resolve its tethers and its contacts with shapes."""
    share, push = 0.5 if begins or ends else 1.0, 0.0 if ends else floats(world, SETTINGS)[0, PUSH_SPEED]
    # The damping impulse is whole at the end, since no change is known at the beginning of the next substep.
    damped = 0.0 if begins else 1.0 / part
    dimension = integers(world, CLOTH)[cloth, DIMENSION]
    if dimension == ROPE:
        add_tension(world, cloth, share, damped * part)
    elif dimension == VOLUME:
        add_elasticity(world, cloth, share, damped * part)
    else:
        add_membrane(world, cloth, share, damped)
    add_bending(world, cloth, share, damped)
    _kick(world, cloth, part, share, begins, left)
    hold_tethers(world, cloth, part, left)
    resolve_contacts(world, cloth, part, push, left)
    pull_bodies(world, cloth, 0.0, (0.0, 0.0, 0.0), left, False)


@compiled
def _parts_of_strain(world: int, cloth: int) -> int:
    """Return the number of parts into which each part is divided: a cloth strained by s is stiffer in shear by (1 + s)^2.

    Without it, sheets hit by balls of 10 m/s were lost; with it, those hit at 40 m/s are not.
    """
    if integers(world, CLOTH)[cloth, DIMENSION] == VOLUME:
        stiffer = stiffening(world, cloth)
        return 1 if stiffer < _STIFF else math.ceil(math.sqrt(min(stiffer, _STIFFEST)))
    strain = largest_strain(world, cloth)
    return 1 if strain < _WIDE else math.ceil(1.0 + 2.0 * min(strain, _WIDEST))


@compiled
def _kick(world: int, cloth: int, part: float, share: float, begins: bool, left: float) -> None:
    """Kick a cloth by its forces and by `share` of gravity in a part of a substep, s.

    Bodies are pulled by the particles that are pinned to them, and move with the change for the time `left` in the substep, s.
    """
    gravity = vector_at(floats(world, SETTINGS), 0, GRAVITY)
    fall = times(share * part, gravity)
    # At its start bodies have fallen for the whole substep already, and particles pinned to them fall with them.
    pull_bodies(world, cloth, part, times(left if begins else 0.0, gravity), left, begins)
    keep = 1.0 / (1.0 + share * part * floats(world, CLOTH_NUMBERS)[cloth, LINEAR_DAMPING])
    kick_by_forces(world, cloth, part, keep, fall)


@compiled
def _arrive(world: int, part: float) -> None:
    """Move all particles to the end of an interval, with their velocities and shifts."""
    particle, shift = floats(world, PARTICLE), floats(world, PARTICLE_SHIFT)
    for i in range(rows(world, PARTICLE)):
        for k in range(3):
            particle[i, k] += part * particle[i, PARTICLE_VELOCITY + k] + shift[i, k]
            shift[i, k] = 0.0


@compiled
def _check(world: int, cloth: int) -> None:
    """Report a cloth whose positions or velocities are not finite."""
    own, particle, total = integers(world, CLOTH), floats(world, PARTICLE), 0.0
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        for k in range(7):
            total += abs(particle[i, k])
    if not total < math.inf:
        report_cloth(world, cloth)

"""The stage of the step that moves cloths: the velocity Verlet method, in parts of a substep.

The first and the last kick of a substep are halves, so that what hangs still has no velocity. Forces between particles
keep momentum and angular momentum to the last digit; contacts keep angular momentum to first order.

Cloth meets cloth less often: several parts make an interval, in which no more is moved than the thickness, and at its end
what would cross on the straight line from where the interval began is stopped (Bridson, Fedkiw and Anderson, Robust treatment
of collisions, contact and friction for cloth animation, SIGGRAPH 2002, section 4).
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import times
from kickdrift.world.cloth.bending import add_bending
from kickdrift.world.cloth.contact_impulses import resolve_contacts
from kickdrift.world.cloth.crossings import stop_crossings
from kickdrift.world.cloth.lanes import drift_row
from kickdrift.world.cloth.layout import (
    CLOTH_RADIUS,
    FIRST_PARTICLE,
    FORCES,
    INTERVAL,
    IS_ASLEEP,
    LAST_PARTICLE,
    LINEAR_DAMPING,
    PARTICLE_INVERSE_MASS,
    PARTICLE_VELOCITY,
    PARTS,
    SEARCH_AGE,
    SEARCH_VALID,
    SHARED_PARTS,
    STIRRED,
    TURN,
)
from kickdrift.world.cloth.membrane import add_membrane, largest_strain
from kickdrift.world.cloth.pair_impulses import resolve_pairs
from kickdrift.world.cloth.pairs import find_pairs, meets
from kickdrift.world.cloth.particle_lanes import field_size, fill_lanes
from kickdrift.world.cloth.pins import carry_pins, pull_bodies
from kickdrift.world.cloth.swept import set_frame, stays, travels
from kickdrift.world.cloth.wind import add_wind
from kickdrift.world.columns import vector_at
from kickdrift.world.settings import GRAVITY, PUSH_SPEED
from kickdrift.world.step_status import report_cloth
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    CLOTH_PAIR,
    CLOTH_SEARCH,
    GROUP_STRAIN,
    INTERVAL_START,
    PARTICLE,
    PARTICLE_LANES,
    PARTICLE_SHIFT,
    SETTINGS,
    STARTED_PARTICLE,
    Tables,
    flat,
    floats,
    integers,
    rows,
    set_rows,
)

_TURNS = 4  # of a part
_SWEEPS, _LAST_SWEEPS = 4, 12  # of impulses: with 1 and 4 of them, heaps of many layers tremble twice as much at rest
_SEARCHES = 3  # for pairs, at most, while impulses that stop crossings make particles leave their boxes
_WIDE, _WIDEST = 0.1, 10.0  # strains, below and above which parts stay as many


@compiled
def move_cloths(t: float, h: float, world: int) -> None:
    """Move all cloths through a substep, after the bodies have moved.

    All of them take the same parts, as they touch each other. Where there is no room for pairs, the stage goes on from there.
    """
    search = floats(world, CLOTH_SEARCH)
    if integers(world, CLOTH)[0, IS_ASLEEP] != 0:
        return
    if search[0, TURN] == 0.0:
        _begin(world, h)
    parts, each = int(search[0, SHARED_PARTS]), int(search[0, INTERVAL])
    part = h / parts
    for at in range(int(search[0, TURN]), _TURNS * (parts + 1)):
        k = at // _TURNS
        if at % _TURNS == 0:
            _move(world, part, k == 0, k == parts, h - k * part)
        elif k == parts:
            _stop(world, part, each * part)
            break
        elif (k + 1) % each > 0 and k + 1 < parts:
            continue
        elif meets(world) and not _meet(world, at % _TURNS, h, (k % each + 1) * part):
            return
        search[0, TURN] = at + 1
    search[0, TURN] = 0.0
    for cloth in range(rows(world, CLOTH)):
        _check(world, cloth)


@compiled
def _begin(world: int, h: float) -> None:
    """Let the wind blow, and choose in how many parts a substep is done, and how many of them make an interval."""
    search, parts, least = floats(world, CLOTH_SEARCH), 1, math.inf
    for cloth in range(rows(world, CLOTH)):
        parts = max(parts, integers(world, CLOTH)[cloth, PARTS] * _parts_of_strain(world, cloth))
        least = min(least, 2.0 * floats(world, CLOTH_NUMBERS)[cloth, CLOTH_RADIUS])
    for cloth in range(rows(world, CLOTH)):
        add_wind(world, cloth, h, h / parts)
    set_frame(world)
    way = travels(world, h)
    search[0, SHARED_PARTS] = parts
    intervals = max(math.ceil(way / least), 1) if way < parts * least else parts  # which NaN is not
    search[0, INTERVAL] = math.ceil(parts / intervals)
    _note_start(world)


@compiled
def _note_start(world: int) -> None:
    """Note where an interval begins."""
    particle, start = floats(world, PARTICLE), floats(world, INTERVAL_START)
    for i in range(rows(world, PARTICLE)):
        for k in range(3):
            start[i, k] = particle[i, k]


@compiled
def _move(world: int, part: float, begins: bool, ends: bool, left: float) -> None:
    """Kick all cloths, and let them drift, but at the end."""
    for cloth in range(rows(world, CLOTH)):
        _push(world, cloth, part, begins, ends, left)
    if not ends:
        for cloth in range(rows(world, CLOTH)):
            carry_pins(world, cloth, part, left)
        _drift(world, part)


@compiled
def _drift(world: int, part: float) -> None:
    """Move all particles with their velocities through a part of a substep."""
    particle = floats(world, PARTICLE)
    for i in range(rows(world, PARTICLE)):
        drift_row(particle, i, part)


@compiled
def _meet(world: int, turn: int, h: float, interval: float) -> bool:
    """Do one of the turns in which cloths meet in an interval, s: to its start, impulses, to its end; False without room."""
    if turn == 1:
        _go_back(world, interval)
    elif turn == 2:
        if not find_pairs(world, h, interval):
            return False
        for sweep in range(_SWEEPS):
            resolve_pairs(world, interval, floats(world, SETTINGS)[0, PUSH_SPEED] if sweep == 0 else 0.0)
    else:
        for _ in range(_SEARCHES):
            if not find_pairs(world, h, interval):
                return False
            stop_crossings(world, interval)
            if stays(world, interval):
                break
        _arrive(world, interval)
        floats(world, CLOTH_SEARCH)[0, SEARCH_AGE] += interval
        _note_start(world)
    return True


@compiled
def _stop(world: int, part: float, interval: float) -> None:
    """Stop what approaches when the substep ends: what impulses between cloths press against bodies, too."""
    for _ in range(_LAST_SWEEPS if meets(world) else 0):
        resolve_pairs(world, interval, 0.0)
        for cloth in range(rows(world, CLOTH)):
            resolve_contacts(world, cloth, part, 0.0, 0.0)


@compiled
def _go_back(world: int, interval: float) -> None:
    """Bring particles back to where the interval began, with the shifts with which they would come to where they were."""
    particle, start, shift = floats(world, PARTICLE), floats(world, INTERVAL_START), floats(world, PARTICLE_SHIFT)
    for i in range(rows(world, PARTICLE)):
        for k in range(3):
            shift[i, k] = particle[i, k] - start[i, k] - interval * particle[i, PARTICLE_VELOCITY + k]
            particle[i, k] = start[i, k]


@compiled
def _push(world: int, cloth: int, part: float, begins: bool, ends: bool, left: float) -> None:
    """Kick a cloth by its forces, and by the shapes that it touches."""
    share = 0.5 if begins or ends else 1.0
    # That of damping is whole at the end, as nothing is known of changes where the next substep begins.
    damped = 0.0 if begins else 1.0 / part
    fill_lanes(world, cloth)
    add_membrane(world, cloth, share, damped)
    add_bending(world, cloth, share, damped)
    _kick(world, cloth, part, share, begins, left)
    resolve_contacts(world, cloth, part, 0.0 if ends else floats(world, SETTINGS)[0, PUSH_SPEED], left)


@compiled
def _parts_of_strain(world: int, cloth: int) -> int:
    """Return into how many each part is cut: what is stretched by s is stiffer against shear by (1 + s)^2.

    Without it sheets that balls of 10 m/s hit were lost; with it those of 40 m/s are not.
    """
    strain = largest_strain(world, cloth)
    return 1 if strain < _WIDE else math.ceil(1.0 + 2.0 * min(strain, _WIDEST))


@compiled
def _kick(world: int, cloth: int, part: float, share: float, begins: bool, left: float) -> None:
    """Add what the forces and a share of gravity do in a part of a substep to the velocities of a cloth.

    Bodies are pulled by the particles that are pinned to them, and move on with it for the time `left` in the substep, s.
    """
    own, particle = integers(world, CLOTH), floats(world, PARTICLE)
    fields, size = flat(world, PARTICLE_LANES), field_size(world)
    gravity = vector_at(floats(world, SETTINGS), 0, GRAVITY)
    fall = times(share * part, gravity)
    # Bodies have fallen for the whole substep where it begins, and what is pinned to them does so with them.
    pull_bodies(world, cloth, part, times(left if begins else 0.0, gravity), left)
    keep = 1.0 / (1.0 + share * part * floats(world, CLOTH_NUMBERS)[cloth, LINEAR_DAMPING])
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        inverse_mass = particle[i, PARTICLE_INVERSE_MASS]
        for k in range(3):
            if inverse_mass > 0.0:
                kick = part * inverse_mass * fields[(FORCES + k) * size + i] + fall[k]
                particle[i, PARTICLE_VELOCITY + k] = keep * (particle[i, PARTICLE_VELOCITY + k] + kick)
            fields[(FORCES + k) * size + i] = 0.0


@compiled
def _arrive(world: int, part: float) -> None:
    """Move all particles with their velocities to the end of an interval, and by what shifts them besides."""
    particle, shift = floats(world, PARTICLE), floats(world, PARTICLE_SHIFT)
    for i in range(rows(world, PARTICLE)):
        for k in range(3):
            particle[i, k] += part * particle[i, PARTICLE_VELOCITY + k] + shift[i, k]
            shift[i, k] = 0.0


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
    """Keep the cloths as they are, in case the step cannot be done, and note whether they were moved while they slept."""
    search, own, moved = floats(world, CLOTH_SEARCH), integers(world, CLOTH), False
    search[0, SEARCH_VALID] = search[0, SEARCH_AGE] = search[0, TURN] = 0.0
    set_rows(world, CLOTH_PAIR, 0)
    now, before = floats(world, PARTICLE), floats(world, STARTED_PARTICLE)
    for i in range(rows(world, PARTICLE)):
        for k in range(PARTICLE.width):
            moved = moved or now[i, k] != before[i, k]
            before[i, k] = now[i, k]
    if moved and own[0, IS_ASLEEP] != 0:
        own[0, IS_ASLEEP] = STIRRED


def roll_back_cloths(tables: Tables) -> None:
    """Bring the cloths back to where the step began."""
    tables.array(PARTICLE)[:] = tables.array(STARTED_PARTICLE)
    tables.array(PARTICLE_LANES)[:] = tables.array(PARTICLE_SHIFT)[:] = 0.0
    # Where a substep begins they are only read to be multiplied by zero, which of infinity is none.
    tables.array(GROUP_STRAIN)[:] = 0.0

"""The direct solver: RATTLE for an island. Newton's method before the drift, a projection after it.

A substep is symplectic, as the kick and the drift between are: impulses along the joints' directions at its start, such that
nothing is off at its end, and then the velocities' projection onto what the joints allow there. Hairer, Lubich, Wanner,
Geometric Numerical Integration, 2nd ed. (2006), section VII.1.4. Contacts are rows of the same equations. Which pieces of the
laws of axes and of contacts hold is assumed, and solved again as long as a solution lies on other ones: an active-set, or
semi-smooth Newton, method.

Where the substep is too long for that, as where a chain with a heavy end cracks like a whip, velocities are projected before
the drift too, and bodies are put back to where the joints hold them.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.direct.active_set import AS_ASSUMED, BY_LAWS, aim_island, solve
from kickdrift.world.direct.contact_impulses import forget_contacts, left_of_contacts
from kickdrift.world.direct.contacts import PRESS, REST, begin_contacts, is_cut, note_impulses
from kickdrift.world.direct.energy_losses import LONG_TURN
from kickdrift.world.direct.external_energy import driving_speed, energy_given
from kickdrift.world.direct.joint_impulses import end_relaxation, end_solution
from kickdrift.world.direct.layout import (
    AFTER_CONTACT,
    AFTER_JOINT,
    FIRST_CLOSING,
    FIRST_CONTACT,
    GIVEN_UP,
    HAS_JOINTS,
    LOST,
    RATIO,
)
from kickdrift.world.direct.loop_closures import begin_closings, stay_closings
from kickdrift.world.direct.node_selection import mass_of
from kickdrift.world.direct.position_correction import repair
from kickdrift.world.direct.velocities import begin_from_kick, fastest, kinetic_energy, note_velocities, take_back
from kickdrift.world.joints.free_fall import let_fall
from kickdrift.world.joints.layout import ANGULAR_PART, LINEAR_PART
from kickdrift.world.joints.right_hand_side import AHEAD, GENTLY, RELAX
from kickdrift.world.settings import PUSH_SPEED, RESIDUAL
from kickdrift.world.tables import ISLAND, KICKED, MOTION, NOTED, SETTINGS, floats, integers, rows

# Newton's method stops where the parts of their arms that joints are off by, times the ratio of masses, are below CLOSE. The
# usual island takes two steps; one that is not NEAR after QUICK of them begins again from velocities that joints allow.
# Each step squares what trees are off by: where that will do, no one looks whether the step has done so. Rotors that fly freely
# lose 4e-6 of their energy in 5 s with 1e-7, and 4e-4 with 1e-6, which is enough for what touches something.
QUICK, ROUNDS, CLOSE, CLOSE_TOUCHING, CLOSE_LOOPS, NEAR = 3, 6, 1e-7, 1e-6, 1e-9, 1e-5

# Given up is what is farther off than FAR at the end, in parts of the arms. A projection that leaves more than EXCESS times the
# energy that there was is done again without the laws of axes, which may add to it: they do in a substep that is too long.
FAR, EXCESS = 1e-3, 1.5

# Times the energy that heaps and what turns far may have after the drift. Of sixty chains of random rods that spin 46 gained
# more than a tenth with 1.02, and six do with 1.001.
KEPT = 1.001

# First guesses that are farther off than that are replaced by velocities that joints allow, from which no step leads astray.
POOR = 0.1

# Times the energy that is too much.
WILD = 4.0

# Square of a speed that no one notices, m^2/s^2.
_STILL = 1e-12


@compiled
def solve_islands(t: float, h: float, world: int) -> None:
    """Find the impulses with which nothing is off at the end of the substep, before the drift."""
    islands = integers(world, ISLAND)
    for island in range(rows(world, ISLAND)):
        note_velocities(island, world)
        note_impulses(island, False, world)
        islands[island, LOST] = 0
        if islands[island, HAS_JOINTS] == 0:
            _press(island, h, world)
            continue
        off = islands[island, RATIO] * aim_island(island, h, AHEAD, world)
        if not (off <= POOR and _approach(island, h, off, QUICK, world) <= NEAR) or _is_thrown(island, h, world):
            _take_care(island, h, world)
    for island in range(rows(world, ISLAND)):
        if is_cut(island, world):
            _hold(island, h, world)
        end_solution(island, h, world)
    let_fall(world)


@compiled
def relax_islands(t: float, h: float, world: int) -> None:
    """Take from the velocities what joints and contacts do not allow where bodies are now, after the drift."""
    islands = integers(world, ISLAND)
    for island in range(rows(world, ISLAND)):
        if islands[island, LOST] != 0:
            repair(island, h, world)
            note_velocities(island, world)
            note_impulses(island, False, world)
            _project(island, h, RELAX, REST, world)
        else:
            _rest(island, h, world)
    for island in range(rows(world, ISLAND)):
        if is_cut(island, world):
            aim_island(island, h, RELAX, world)
            stay_closings(island, world)
            solve(island, h, 0.0, REST, True, False, BY_LAWS, world)
        end_relaxation(island, h, world)


@compiled
def measure_islands(t: float, h: float, world: int) -> None:
    """Measure what is left unsolved of the contacts of islands: how fast points that press part or approach, at most."""
    settings = floats(world, SETTINGS)
    for island in range(rows(world, ISLAND)):
        settings[0, RESIDUAL] = max(settings[0, RESIDUAL], left_of_contacts(island, world))


@compiled(cached=False)
def _press(island: int, h: float, world: int) -> None:
    """Solve an island without joints: from impulses of the substep before, from none if those lead astray, or not at all.

    Impulses of a solution that was none may be far too large, and would throw the lightest body.
    """
    most = WILD * (fastest(island, KICKED, LINEAR_PART, world) + floats(world, SETTINGS)[0, PUSH_SPEED])
    for trial in range(2):
        if trial == 1:
            forget_contacts(island, world)
            note_velocities(island, world)
            note_impulses(island, False, world)
        begin_contacts(island, h, PRESS, world)
        solve(island, h, h, PRESS, True, True, BY_LAWS, world)
        if fastest(island, MOTION, LINEAR_PART, world) <= most:
            return
        take_back(island, world)


@compiled(cached=False)
def _rest(island: int, h: float, world: int) -> None:
    """Project velocities.

    Contacts, and joints of what turns far in a substep, give no more energy than there was after the kick, and than what drives
    the island from without; on joints, not much more: see `_gains`. Where they do, it is the velocities after the kick that are
    projected, without impulses of the substep.
    """
    for _ in range(2):
        solve_at_once(island, h, RELAX, REST, world)
        if not _gains(island, h, world):
            return
        begin_from_kick(island, world)


@compiled(cached=False)
def _gains(island: int, h: float, world: int) -> bool:
    """Whether an island has more energy than after the kick, and than what drives it has given: if it may have at all."""
    own = integers(world, ISLAND)[island]
    touches, joined = own[FIRST_CONTACT] < own[AFTER_CONTACT], own[HAS_JOINTS] != 0
    if not (touches or h * fastest(island, MOTION, ANGULAR_PART, world) > LONG_TURN):
        return False
    before, after = kinetic_energy(island, KICKED, world), kinetic_energy(island, MOTION, world)
    if joined:
        most = (EXCESS if touches else KEPT) * before
        return not (after <= most or after <= most + energy_given(island, world))
    speed = driving_speed(island, world)
    return not after <= KEPT * before + mass_of(island, world) * (speed * speed + _STILL)


@compiled(cached=False)
def _approach(island: int, h: float, off: float, most: int, world: int) -> float:
    """Take steps of Newton's method, and return how far joints will be off, times the ratio of masses."""
    own = integers(world, ISLAND)[island]
    ratio, closed = own[RATIO], own[AFTER_JOINT] > own[FIRST_CLOSING]
    touches = own[AFTER_CONTACT] > own[FIRST_CONTACT]
    close = CLOSE_LOOPS if closed else CLOSE_TOUCHING if touches else CLOSE
    for step in range(most):
        begin_closings(island, world)
        begin_contacts(island, h, PRESS, world)
        if not solve(island, h, h, PRESS, step == 0, True, BY_LAWS, world):
            return math.inf
        off = ratio * aim_island(island, h, AHEAD, world) if closed or off * off > close else off * off
        if off <= close:
            break
    return off


@compiled(cached=False)
def _is_thrown(island: int, h: float, world: int) -> bool:
    """Whether an island turns fast with far more energy than it had: at a distant, spurious solution."""
    if h * fastest(island, MOTION, ANGULAR_PART, world) <= LONG_TURN:
        return False
    most = WILD * (kinetic_energy(island, NOTED, world) + energy_given(island, world))
    thrown: bool = kinetic_energy(island, MOTION, world) > most
    return thrown


@compiled(cached=False)
def _take_care(island: int, h: float, world: int) -> None:
    """Begin with velocities that joints allow, and stay with them if no solution is found near to them.

    Impulses of the substep before that throw the island are no guess: where a substep found no solution, they may be anything.
    """
    islands = integers(world, ISLAND)
    if kinetic_energy(island, NOTED, world) > WILD * kinetic_energy(island, KICKED, world):
        begin_from_kick(island, world)
        note_velocities(island, world)
        note_impulses(island, False, world)
    _project(island, h, GENTLY, PRESS, world)
    energy = kinetic_energy(island, MOTION, world)
    off = islands[island, RATIO] * aim_island(island, h, AHEAD, world)
    off = _approach(island, h, off, ROUNDS, world)
    if not (
        off <= FAR * islands[island, RATIO]
        and kinetic_energy(island, MOTION, world) <= _lawful(island, h, world) * energy + energy_given(island, world)
    ):
        islands[island, LOST] = 1
        islands[island, GIVEN_UP] += 1
        _project(island, h, GENTLY, PRESS, world)


@compiled(cached=False)
def _lawful(island: int, h: float, world: int) -> float:
    """Part of its energy that an island may have before the drift: turned by an angle a in the substep, it has a^2 / 2 more.

    With a margin of a tenth: distant, spurious solutions have more, that of a grid of 4 x 4 balls by a sixth.
    """
    turn = h * fastest(island, NOTED, ANGULAR_PART, world)
    return 1.1 + 0.6 * min(turn, 1.5) ** 2


@compiled(cached=False)
def _hold(island: int, h: float, world: int) -> None:
    """Solve joints for what contacts with other islands have given: for the end of the substep where that is near."""
    islands = integers(world, ISLAND)
    near = islands[island, RATIO] * aim_island(island, h, AHEAD, world) <= POOR and islands[island, LOST] == 0
    if near:
        begin_closings(island, world)
    else:
        aim_island(island, h, GENTLY, world)
        stay_closings(island, world)
    solve(island, h, h if near else 0.0, PRESS, True, False, BY_LAWS, world)


@compiled(cached=False)
def solve_at_once(island: int, h: float, mode: int, task: int, world: int) -> None:
    """Project velocities onto what joints and contacts allow where bodies are."""
    aim_island(island, h, mode, world)
    stay_closings(island, world)
    begin_contacts(island, h, task, world)
    solve(island, h, 0.0, task, True, True, BY_LAWS, world)


@compiled(cached=False)
def _project(island: int, h: float, mode: int, task: int, world: int) -> None:
    """Go back to the velocities that were noted, and project them.

    Where that adds energy, a limit that has been passed by far throws what it holds: then without laws of axes, or not at all.
    """
    take_back(island, world)
    energy = kinetic_energy(island, MOTION, world)
    solve_at_once(island, h, mode, task, world)
    if kinetic_energy(island, MOTION, world) <= EXCESS * energy + energy_given(island, world):
        return
    take_back(island, world)
    aim_island(island, h, mode, world)
    stay_closings(island, world)
    begin_contacts(island, h, task, world)
    solve(island, h, 0.0, task, True, True, AS_ASSUMED, world)
    if not kinetic_energy(island, MOTION, world) <= EXCESS * energy + energy_given(island, world):
        take_back(island, world)

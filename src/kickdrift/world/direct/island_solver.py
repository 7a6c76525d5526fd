"""The direct solver: RATTLE for an island. Newton's method before the drift, a projection after it.

A substep is symplectic, as are its kicks (`half_kicks`) and its drift: impulses along the joint axes at its start, such that
the joints are satisfied at its end, and then a projection of the velocities onto those that the joints allow there. Hairer,
Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), section VII.1.4. Contacts are rows of the same equations.
The pieces of the laws of axes and contacts are assumed, and the equations are solved again until the solution lies on the
assumed ones: an active-set, or semi-smooth Newton, method.

If the substep is too long for that, as for a chain with a heavy end that cracks like a whip, velocities are projected before
the drift too, and the poses of bodies are corrected.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import (
    PRESS,
    begin_contacts,
    fastest_push,
    is_cut,
    note_impulses,
    push_less,
)
from kickdrift.world.direct.contact_impulses import forget_contacts, left_of_contacts
from kickdrift.world.direct.energy_bounds import energy_given
from kickdrift.world.direct.energy_guard import allowance
from kickdrift.world.direct.island_calls import aim_island, solve
from kickdrift.world.direct.island_velocities import (
    begin_from_kick,
    fastest,
    kinetic_energy,
    note_velocities,
    take_back,
)
from kickdrift.world.direct.islands import direct_islands
from kickdrift.world.direct.joint_impulses import end_solution
from kickdrift.world.direct.loop_closures import begin_closings, has_loops, stay_closings
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.right_hand_side import AHEAD, GENTLY
from kickdrift.world.settings import RESIDUAL
from kickdrift.world.tables import ISLAND, KICKED, MOTION, SETTINGS, floats, integers

# Newton's method stops when the joint errors, relative to the arms and times the mass ratio, are below CLOSE, with contacts
# CLOSE_TOUCHING, with loops CLOSE_LOOPS. Most islands take two steps; one that is not NEAR after ROUNDS steps starts again from
# velocities that joints allow. Each step squares the error of trees, so the last error is not evaluated.
# Rotors that fly freely lose 4e-6 of their energy in 5 s with 1e-7, and 4e-4 with 1e-6, which is enough with contacts.
ROUNDS, CLOSE, CLOSE_TOUCHING, CLOSE_LOOPS, NEAR = 6, 1e-7, 1e-6, 1e-9, 1e-5

# An island is given up if its error is above FAR at the end, relative to the arms.
FAR = 1e-3

# One with loops is, too, unless Newton's method divides its error by FEWER or comes NEAR. A bridge of planks in a straight line
# between two walls cannot move at all, but joints stop only the first order of its motion: their solution is a double root,
# around which Newton's method jumps.
FEWER = 10.0

# Initial guesses with a larger error are replaced by velocities that joints allow, from which Newton's method is safe.
POOR = 0.1

# The solution of a heap is spurious if a body is faster by this factor than the largest speed after the kick and the largest at
# which overlaps are to be pushed apart together.
WILD = 4.0


@compiled
def solve_islands(t: float, h: float, world: int) -> None:
    """Find and apply the impulses that satisfy joints and contacts at the end of the substep, before the drift."""
    islands = integers(world, ISLAND)
    for island in range(direct_islands(world)):
        note_velocities(world, island)
        note_impulses(world, island, False)
        islands[island, d.LOST] = 0
        if islands[island, d.HAS_JOINTS] == 0:
            _press(world, island, h)
            continue
        off = islands[island, d.RATIO] * aim_island(world, island, h, AHEAD)
        if not (off <= POOR and _approach(world, island, h, off) <= NEAR) or _is_wild(world, island, h):
            _solve_carefully(world, island, h)
    for island in range(direct_islands(world)):
        if is_cut(world, island):
            _solve_joints(world, island, h)
        end_solution(world, island)


@compiled
def measure_islands(t: float, h: float, world: int) -> None:
    """Include the contacts of islands in the residual: the largest normal speed of their loaded points."""
    settings = floats(world, SETTINGS)
    for island in range(direct_islands(world)):
        settings[0, RESIDUAL] = max(settings[0, RESIDUAL], left_of_contacts(world, island))


@compiled(cached=False)
def _press(world: int, island: int, h: float) -> None:
    """Solve an island without joints, warm started; if bodies become too fast, from zero impulses, and then pushing less.

    The impulses of a spurious solution may be far too large, and would throw the lightest body; so would the push apart of two
    heavy ones between which it is wedged. If nothing helps, the island is not solved at all.
    """
    most, share = 0.0, 1.0
    for trial in range(3):
        if trial == 1:
            forget_contacts(world, island)
            note_velocities(world, island)
            note_impulses(world, island, False)
        begin_contacts(world, island, h, PRESS)
        if trial == 2:
            push_less(world, island, share)
        else:
            most = WILD * (fastest(world, island, KICKED, j.LINEAR_PART) + fastest_push(world, island))
        solve(world, island, h, h, PRESS, True, True)
        reached = fastest(world, island, MOTION, j.LINEAR_PART)
        if reached <= most:
            return
        share = 0.5 * most / reached if reached < math.inf else 0.0
        take_back(world, island)


@compiled(cached=False)
def _is_wild(world: int, island: int, h: float) -> bool:
    """Whether bodies of an island in contact are far faster than after the kick, with energy that nothing has given.

    So are those of a solution in which contacts press against limits of joints: it threw jammed limbs up by 13 cm in a substep.
    """
    own = integers(world, ISLAND)[island]
    if own[d.FIRST_CONTACT] == own[d.AFTER_CONTACT]:
        return False
    most = WILD * (fastest(world, island, KICKED, j.LINEAR_PART) + fastest_push(world, island))
    if fastest(world, island, MOTION, j.LINEAR_PART) <= most:
        return False
    bound = allowance(world, island, h) * kinetic_energy(world, island, KICKED) + energy_given(world, island)
    return bool(kinetic_energy(world, island, MOTION) > bound)


@compiled(inline=True, cached=False)
def _close(world: int, island: int) -> float:
    """Return the error of joints, relative to the arms and times the mass ratio, at which Newton's method stops."""
    own = integers(world, ISLAND)[island]
    if has_loops(world, island):
        return CLOSE_LOOPS
    return CLOSE_TOUCHING if own[d.AFTER_CONTACT] > own[d.FIRST_CONTACT] else CLOSE


@compiled(cached=False)
def _approach(world: int, island: int, h: float, off: float) -> float:
    """Do up to ROUNDS steps of Newton's method, and return the error of joints times the mass ratio; infinity on failure."""
    ratio, closed, close = integers(world, ISLAND)[island, d.RATIO], has_loops(world, island), _close(world, island)
    for step in range(ROUNDS):
        begin_closings(world, island)
        begin_contacts(world, island, h, PRESS)
        if not solve(world, island, h, h, PRESS, step == 0, True):
            return math.inf
        off = ratio * aim_island(world, island, h, AHEAD) if closed or off * off > close else off * off
        if off <= close:
            break
    return off


@compiled(cached=False)
def _solve_carefully(world: int, island: int, h: float) -> None:
    """Solve from velocities that joints allow, and keep these if no solution is found near them."""
    islands = integers(world, ISLAND)
    project(world, island, h, GENTLY, PRESS)
    energy = kinetic_energy(world, island, MOTION)
    begun = islands[island, d.RATIO] * aim_island(world, island, h, AHEAD)
    bound = FAR * islands[island, d.RATIO]
    if has_loops(world, island):
        bound = min(bound, max(begun / FEWER, NEAR))
    if not (
        _approach(world, island, h, begun) <= bound
        and not _is_wild(world, island, h)
        and kinetic_energy(world, island, MOTION) <= allowance(world, island, h) * energy + energy_given(world, island)
    ):
        islands[island, d.LOST] = 1
        islands[island, d.GIVEN_UP] += 1
        project(world, island, h, GENTLY, PRESS)
        if _is_wild(world, island, h):
            begin_from_kick(world, island)
            solve_at_once(world, island, h, GENTLY, PRESS)


@compiled(cached=False)
def _solve_joints(world: int, island: int, h: float) -> None:
    """Solve the joints of an island after its contacts with other islands: for the end of the substep if the error is small.

    If it is negligible, which it is for two fifths of the ragdolls in a heap, since neighbours have hardly pushed, not at all.
    """
    islands = integers(world, ISLAND)
    off = islands[island, d.RATIO] * aim_island(world, island, h, AHEAD)
    near = off <= POOR and islands[island, d.LOST] == 0
    if near and off <= _close(world, island):
        return
    if near:
        begin_closings(world, island)
    else:
        aim_island(world, island, h, GENTLY)
        stay_closings(world, island)
    solve(world, island, h, h if near else 0.0, PRESS, True, False)


@compiled(cached=False)
def solve_at_once(world: int, island: int, h: float, mode: int, task: int) -> bool:
    """Project velocities onto those that joints and contacts allow at the present poses; return whether the laws hold."""
    aim_island(world, island, h, mode)
    stay_closings(world, island)
    begin_contacts(world, island, h, task)
    return solve(world, island, h, 0.0, task, True, True)


@compiled(cached=False)
def project(world: int, island: int, h: float, mode: int, task: int) -> None:
    """Go back to the noted velocities, and project them."""
    take_back(world, island)
    solve_at_once(world, island, h, mode, task)

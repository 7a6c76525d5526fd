"""RATTLE for an articulation: Newton's method before the drift, a projection after it.

A substep is symplectic, as the kick and the drift between are: impulses along the joints' directions at its start, such that
nothing is off at its end, and then the velocities' projection onto what the joints allow there. Hairer, Lubich, Wanner,
Geometric Numerical Integration, 2nd ed. (2006), section VII.1.4.

Where the substep is too long for that, as where a chain with a heavy end cracks like a whip, velocities are projected before
the drift too, which never adds to their energy, and bodies are put back to where the joints hold them.

The functions of this file are templates: the solution of the equations is bound to them by whoever has one.
"""

from typing import Any

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.vectors import length
from kickdrift.world.columns import vector_at
from kickdrift.world.joints.aim import AHEAD, GENTLY, RELAX, aim_all
from kickdrift.world.joints.energy import allowance, kinetic_energy
from kickdrift.world.joints.impulses import note_velocities
from kickdrift.world.joints.layout import (
    BEFORE,
    BEFORE_TURN,
    CLOSINGS,
    END,
    ENERGY,
    FIRST,
    IMPULSE,
    LINK_JOINT,
    LINKS,
    LOST,
    RATIO,
    RELAXING,
    SEQUENTIAL,
    SOLVED,
    TOUCHED,
)
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.settling import LAST_TRIALS, TRIALS, end_relaxation, end_solution, give_impulses, settle
from kickdrift.world.tables import (
    ARTICULATION,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    MOTION,
    floats,
    integers,
    rows,
)

# Solve the equations; solve them and give the impulses; do so without a gain of energy; put bodies back
answer = once = calm = repair = unbound
TREES, LOOPS = 0, 1
FOR = TREES  # which articulations a stage is for

# Newton's method stops where the parts of their arms that joints are off by, times the ratio of masses, are below CLOSE. Each
# step squares them, so that below SURE no one looks whether the step has done so. The usual articulation takes one step;
# a chain with an end 1000 times as heavy as its links takes two or three, and tears with one.
ROUNDS = 4
CLOSE, SURE = 1e-4, 0.03

# First guesses that are farther off than that, with a ratio of 100 at least, are replaced by velocities that the joints allow.
POOR = 1.0

# In parts of the arms: after contacts, which answer as joints allow at the start of the drift.
NOTICED = 1e-5

# Given up is what is farther off than that at the end, or has more energy than that times what there was before the joints
# did anything, and more than what motors and springs may add: there are solutions far away, which no one wants. Before the
# drift, velocities of what turns by an angle a in the substep lawfully have a^2 / 2 more; projections never add any. Turns
# beyond half a radian are not resolved, and lose energy rather than win it.
FAR, EXCESS, RESOLVED = 1e-3, 1.01, 0.5


def solve_articulations(t: float, h: float, world: int) -> None:
    """Give the impulses with which joints hold, of the articulations that the function bound to `once` is for."""
    articulations: Any = integers(world, ARTICULATION)
    work = floats(world, LINK_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        loops, ratio = LOOPS if articulations[row, CLOSINGS] > 0 else TREES, articulations[row, RATIO]
        if articulations[row, FIRST] == articulations[row, END] or articulations[row, SEQUENTIAL] != 0 or loops != FOR:
            continue
        if articulations[row, RELAXING] != 0:
            if articulations[row, LOST] != 0:
                repair(row, h, world)
            work[articulations[row, FIRST], ENERGY] = kinetic_energy(row, world)
            note_velocities(row, world)
            calm(row, h, RELAX, world)
            end_relaxation(row, h, world)
            continue
        off = aim_all(row, h, AHEAD, 0.0, world)
        if off * max(ratio, 100) > POOR:
            aim_all(row, h, GENTLY, 0.0, world)
            once(row, h, 0.0, world)
            off = aim_all(row, h, AHEAD, 0.0, world)
        for _ in range(ROUNDS):
            once(row, h, h, world)
            off = aim_all(row, h, AHEAD, 0.0, world) if off * ratio > SURE else off * off
            if off * ratio <= CLOSE:
                break
        articulations[row, LOST] = off * ratio > FAR or has_gained(row, h, _excess(row, h, world), world)
        if articulations[row, LOST] != 0:
            forget_warm_start(row, world)
            take_back(row, world)
            calm(row, h, GENTLY, world)
        end_solution(row, h, world)


def touch_up(t: float, h: float, world: int) -> None:
    """Take more steps of Newton's method where contacts have moved links so that joints would be off after the drift."""
    articulations: Any = integers(world, ARTICULATION)
    work = floats(world, LINK_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        loops = LOOPS if articulations[row, CLOSINGS] > 0 else TREES
        if articulations[row, FIRST] == articulations[row, END] or articulations[row, SEQUENTIAL] != 0 or loops != FOR:
            continue
        if articulations[row, LOST] != 0 or work[articulations[row, FIRST], TOUCHED] == 0.0:
            continue
        off, ratio = aim_all(row, h, AHEAD, 0.0, world), articulations[row, RATIO]
        if NOTICED < off < POOR:
            # No more than there was before contacts took some.
            before = work[articulations[row, FIRST], ENERGY]
            work[articulations[row, FIRST], ENERGY] = max(before, kinetic_energy(row, world))
            note_velocities(row, world)
            for _ in range(ROUNDS):
                once(row, h, h, world)
                off = aim_all(row, h, AHEAD, 0.0, world) if off * ratio > SURE else off * off
                if off * ratio <= CLOSE:
                    break
            if has_gained(row, h, _excess(row, h, world), world):
                take_back(row, world)
            end_solution(row, h, world)


def solve_once(row: int, h: float, ahead: float, world: int) -> None:
    """Solve the equations until all pieces of laws fit that were assumed, and give the impulses."""
    for trial in range(TRIALS + LAST_TRIALS):
        settled = settle(row, h, trial, world)
        if trial > 0 and settled:
            break
        answer(row, ahead, world)
    give_impulses(row, world)


def solve_calmly(row: int, h: float, mode: int, world: int) -> None:
    """Project velocities onto what joints allow; if pieces of laws are assumed that add energy, then without any laws."""
    aim_all(row, h, mode, 0.0, world)
    once(row, h, 0.0, world)
    if has_gained(row, h, EXCESS, world):
        take_back(row, world)
        aim_all(row, h, mode, 0.0, world)
        answer(row, 0.0, world)
        give_impulses(row, world)
        if has_gained(row, h, EXCESS, world):
            take_back(row, world)


@compiled(cached=False)
def has_gained(row: int, h: float, excess: float, world: int) -> bool:
    """Whether an articulation has more energy than its joints can have given it."""
    first = integers(world, ARTICULATION)[row, FIRST]
    gained = kinetic_energy(row, world) - excess * floats(world, LINK_NUMBERS)[first, ENERGY]
    return not (gained <= 0.0 or gained <= allowance(row, h, world))  # also where it is no number


@compiled(cached=False)
def _excess(row: int, h: float, world: int) -> float:
    """Part of its energy that an articulation may have after a solution for the end of the substep, by how fast it turned."""
    articulation: Any = integers(world, ARTICULATION)[row]
    work, fastest = floats(world, LINK_NUMBERS), 0.0
    for link in range(articulation[FIRST], articulation[FIRST] + articulation[LINKS]):
        fastest = max(fastest, h * length(vector_at(work, link, BEFORE_TURN)))
    return EXCESS + 0.6 * min(fastest, RESOLVED) ** 2


@compiled(cached=False)
def forget_warm_start(row: int, world: int) -> None:
    """Let impulses of the substep before be none: those of a wild solution would be wild here too."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, numbers = integers(world, LINK), floats(world, JOINT_NUMBERS)
    for link in range(articulation[FIRST], articulation[END]):
        if links[link, LINK_JOINT] >= 0:
            for k in range(6):
                numbers[links[link, LINK_JOINT], SOLVED + k] = 0.0


@compiled(cached=False)
def take_back(row: int, world: int) -> None:
    """Go back to the velocities that were noted; taking impulses back would leave the rounding of wild ones."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, motion, work = integers(world, LINK), floats(world, MOTION), floats(world, LINK_NUMBERS)
    numbers = floats(world, JOINT_NUMBERS)
    for link in range(articulation[FIRST], articulation[FIRST] + articulation[LINKS]):
        for k in range(6):
            motion[links[link, LINK_BODY], k] = work[link, BEFORE + k]
    for link in range(articulation[FIRST], articulation[END]):
        if links[link, LINK_JOINT] >= 0:
            for k in range(6):
                numbers[links[link, LINK_JOINT], IMPULSE + k] = numbers[links[link, LINK_JOINT], SOLVED + k]

"""The solution of articulations without loops, and what all solutions have in common."""

from typing import Any

from kickdrift.core.compilation import compiled, specialise, unbound
from kickdrift.core.vectors import dot
from kickdrift.world.joints.aim import AHEAD, GENTLY, RELAX, aim_all
from kickdrift.world.joints.articulated import factor, sweep
from kickdrift.world.joints.brakes import set_brakes
from kickdrift.world.joints.impulses import note_speeds, push_bodies
from kickdrift.world.joints.laws import end_laws, review_laws
from kickdrift.world.joints.layout import (
    AXES,
    CLOSINGS,
    END,
    FIRST,
    GIVEN,
    IMPULSE,
    LAST,
    LAWS,
    LINK_JOINT,
    LINKS,
    LOCKED,
    MOVED,
    RATIO,
    RELAXING,
    SEQUENTIAL,
    SIGN,
    SOLVED,
    TOTAL,
    WRENCH,
)
from kickdrift.world.joints.measure import vector_at
from kickdrift.world.tables import ARTICULATION, JOINT, JOINT_NUMBERS, LINK, LINK_NUMBERS, floats, integers, rows

# Solutions with other pieces of laws assumed, and then with axes let go only, which comes to an end. A few axes that change
# their minds take two or three.
TRIALS = 12
LAST_TRIALS = 12

# Steps of Newton's method at most, and where it stops: what joints are off by, in parts of their arms, times the ratio of
# masses. Each step squares the former. The usual articulation takes one step; a chain with an end 1000 times as heavy as its
# links takes two or three, and tears with one.
ROUNDS = 6
CLOSE = 1e-4

# Beyond this times the ratio of masses the search has come to nothing, and a gentle aim takes its place.
LOST = 0.1

# Halvings of a step that leads away from what it seeks: where a whip cracks.
HALVINGS = 4

# Angle by which a step may turn bodies against each other. Beyond it there are other solutions, which one does not want.
FARTHEST = 0.5


answer = unbound
TREES, LOOPS = 0, 1
FOR = TREES


def solve_articulations(t: float, h: float, world: int) -> None:
    """Give the impulses with which joints hold, of the articulations that the function bound to `answer` is for."""
    articulations: Any = integers(world, ARTICULATION)
    for row in range(rows(world, ARTICULATION)):
        loops = LOOPS if articulations[row, CLOSINGS] > 0 else TREES
        if articulations[row, FIRST] == articulations[row, END] or articulations[row, SEQUENTIAL] != 0 or loops != FOR:
            continue
        mode, off = RELAX if articulations[row, RELAXING] != 0 else AHEAD, 0.0
        for n in range(ROUNDS + 1):
            if mode == AHEAD:
                off = approach(row, off, n, h, world)
            else:
                aim_all(row, h, mode, world)
            if n > 0 and off * articulations[row, RATIO] <= CLOSE:
                break
            if n == ROUNDS:
                if off * articulations[row, RATIO] <= LOST:
                    break
                mode = GENTLY
                take_back(row, world)
                aim_all(row, h, mode, world)
            for trial in range(TRIALS + LAST_TRIALS):
                settled = settle(row, h, trial, world)
                if trial > 0 and settled:
                    break
                answer(row, h if mode == AHEAD else 0.0, world)
            give_impulses(row, h, world)
            if off * off * articulations[row, RATIO] <= CLOSE:
                break
        if mode == RELAX:
            end_relaxation(row, h, world)
        else:
            end_solution(row, h, world)


@compiled(cached=False)
def eliminate(row: int, ahead: float, world: int) -> None:
    """Solve an articulation without loops."""
    articulation: Any = integers(world, ARTICULATION)[row]
    factor(articulation[FIRST], articulation[LINKS], ahead, world)
    sweep(articulation[FIRST], articulation[LINKS], 1.0, world)


@compiled(cached=False)
def approach(row: int, before: float, n: int, h: float, world: int) -> float:
    """Aim, from halfway back as long as step n has led away, and return how far joints are off."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, numbers, work = integers(world, LINK), floats(world, JOINT_NUMBERS), floats(world, LINK_NUMBERS)
    off = aim_all(row, h, AHEAD, world)
    for _ in range(HALVINGS):
        if n == 0 or off < before:
            break
        for link in range(articulation[FIRST], articulation[END]):
            joint = links[link, LINK_JOINT]
            if joint >= 0:
                for k in range(6):
                    work[link, LAST + k] *= -0.5
                    numbers[joint, IMPULSE + k] += work[link, LAST + k]
                push_bodies(joint, work, link, LAST, world)
                for k in range(6):
                    work[link, LAST + k] *= -1.0
        off = aim_all(row, h, AHEAD, world)
    return off


@compiled(cached=False)
def take_back(row: int, world: int) -> None:
    """Take back all impulses since the warm start."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, numbers, work = integers(world, LINK), floats(world, JOINT_NUMBERS), floats(world, LINK_NUMBERS)
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint >= 0:
            for k in range(6):
                work[link, LAST + k] = numbers[joint, SOLVED + k] - numbers[joint, IMPULSE + k]
                numbers[joint, IMPULSE + k] = numbers[joint, SOLVED + k]
            push_bodies(joint, work, link, LAST, world)


@compiled(cached=False)
def settle(row: int, h: float, trial: int, world: int) -> bool:
    """Assume the pieces of laws that the solution so far points to, and say whether it was made with them."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, joints = integers(world, LINK), integers(world, JOINT)
    settled = True
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint >= 0 and joints[joint, LAWS] != 0:
            if trial > 0 and link < articulation[FIRST] + articulation[LINKS]:
                _split_impulse(link, joint, world)
            opened = trial > TRIALS
            settled = not review_laws(joint, link, h, articulation[RELAXING] != 0, opened, world) and settled
    return settled


@compiled(cached=False)
def _split_impulse(link: int, joint: int, world: int) -> None:
    """Split the impulse at a joint of a tree among its axes."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    force, torque = vector_at(work, link, WRENCH), vector_at(work, link, WRENCH + 3)
    for k in range(6):
        along = dot(vector_at(numbers, joint, AXES + 3 * k), force if k < 3 else torque)
        work[link, GIVEN + k] = links[link, SIGN] * along


@compiled(cached=False)
def give_impulses(row: int, h: float, world: int) -> None:
    """Give bodies the impulses that were found."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    numbers = floats(world, JOINT_NUMBERS)
    share = _share(row, h, world)
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint < 0:
            continue
        if link < articulation[FIRST] + articulation[LINKS]:
            _split_impulse(link, joint, world)
        for k in range(6):
            work[link, GIVEN + k] *= share
            numbers[joint, IMPULSE + k] += work[link, GIVEN + k]
            work[link, LAST + k] = work[link, GIVEN + k]
        push_bodies(joint, work, link, GIVEN, world)


@compiled(cached=False)
def _share(row: int, h: float, world: int) -> float:
    """Part of a step after which nothing has turned farther than Newton's method can see."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, joints, work = integers(world, LINK), integers(world, JOINT), floats(world, LINK_NUMBERS)
    fastest = 0.0
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint >= 0 and articulation[RELAXING] == 0:
            for k in range(3, 6):
                if not (joints[joint, LOCKED] | joints[joint, LAWS]) >> k & 1:
                    fastest = max(fastest, abs(work[link, MOVED + k]))
    return FARTHEST / (h * fastest) if h * fastest > FARTHEST else 1.0


@compiled(cached=False)
def end_solution(row: int, h: float, world: int) -> None:
    """Keep what was given before the drift."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, joints, numbers = integers(world, LINK), integers(world, JOINT), floats(world, JOINT_NUMBERS)
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint >= 0:
            for k in range(6):
                numbers[joint, SOLVED + k] = numbers[joint, IMPULSE + k]
            if joints[joint, LAWS] != 0:
                end_laws(joint, link, h, world)


@compiled(cached=False)
def end_relaxation(row: int, h: float, world: int) -> None:
    """Add up the impulses of the substep, and make ready for the next one."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, numbers = integers(world, LINK), floats(world, JOINT_NUMBERS)
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint >= 0:
            note_speeds(joint, world)
            if link < articulation[FIRST] + articulation[LINKS] and articulation[SEQUENTIAL] == 0:
                set_brakes(link, joint, h, world)
            for k in range(6):
                numbers[joint, TOTAL + k] += numbers[joint, IMPULSE + k]
                # The next substep begins as this one did. With the impulse of the relaxation, which bends the paths of what
                # turns, the first guess of Newton's method would be farther away.
                numbers[joint, IMPULSE + k] = numbers[joint, SOLVED + k]
    articulation[RELAXING] = 0


solve_trees = compiled(specialise(solve_articulations, "solve_trees", answer=eliminate, FOR=TREES))

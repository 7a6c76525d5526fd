"""The solution of articulations without loops, and what all solutions have in common."""

import math
from typing import Any

from kickdrift.core.compilation import compiled, specialise, unbound
from kickdrift.core.vectors import (
    Vector,
    applied,
    dot,
    exponential,
    inverse_symmetric,
    length,
    product,
    times,
    turned,
    turned_symmetric,
    unit,
)
from kickdrift.world.joints.aim import AHEAD, BEGIN, GENTLY, RELAX, REPAIR, aim_all
from kickdrift.world.joints.articulated import factor, sweep
from kickdrift.world.joints.brakes import set_brakes
from kickdrift.world.joints.impulses import note_speeds, push_bodies
from kickdrift.world.joints.laws import end_laws, review_laws
from kickdrift.world.joints.layout import (
    ANGULAR_PART,
    AXES,
    CLOSINGS,
    END,
    FIRST,
    GAIN,
    GIVEN,
    IMPULSE,
    LAST,
    LAWS,
    LINEAR_PART,
    LINK_JOINT,
    LINKS,
    LOST,
    RATIO,
    RELAXING,
    SEQUENTIAL,
    SIGN,
    SOLVED,
    TOTAL,
    TURN_RESPONSE,
    WRENCH,
)
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.measure import measure, quaternion_at, symmetric_at, vector_at
from kickdrift.world.tables import (
    ARTICULATION,
    JOINT,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    MOTION,
    POSE,
    RESPONSE,
    floats,
    integers,
    rows,
)
from kickdrift.world.tables import CHANGE as CHANGES

# Solutions with other pieces of laws assumed, and then with axes let go only, which comes to an end. A few axes that change
# their minds take two or three.
TRIALS = 12
LAST_TRIALS = 12

# Steps of Newton's method at most, and where it stops: what joints are off by, in parts of their arms, times the ratio of
# masses. Each step squares the former. The usual articulation takes one step; a chain with an end 1000 times as heavy as its
# links takes two or three, and tears with one.
ROUNDS = 4
CLOSE = 1e-4
SURE = 0.03

# Where the first guess is farther off than this, Newton's method begins from velocities that joints allow.
POOR = 1.0

# Energy with which it may end, in parts of that with which it began: there are solutions far away, which no one wants.
EXCESS = 1.01

# Where it is given up, and how often positions are then put right instead.
FAR = 1e-3
REPAIRS = 8

# Halvings of a step that leads away from what it seeks: where a whip cracks.
HALVINGS = 0


answer = once = repair = unbound
TREES, LOOPS = 0, 1
FOR = TREES


def solve_articulations(t: float, h: float, world: int) -> None:
    """Give the impulses with which joints hold, of the articulations that the function bound to `once` is for."""
    articulations: Any = integers(world, ARTICULATION)
    for row in range(rows(world, ARTICULATION)):
        loops, ratio = LOOPS if articulations[row, CLOSINGS] > 0 else TREES, articulations[row, RATIO]
        if articulations[row, FIRST] == articulations[row, END] or articulations[row, SEQUENTIAL] != 0 or loops != FOR:
            continue
        if articulations[row, RELAXING] != 0:
            if articulations[row, LOST] != 0:
                repair(row, h, world)
            aim_all(row, h, RELAX, 0.0, world)
            once(row, h, 0.0, world)
            end_relaxation(row, h, world)
            continue
        off, most = aim_all(row, h, BEGIN, 0.0, world), math.inf
        if off * max(ratio, 100) > POOR:
            aim_all(row, h, GENTLY, 0.0, world)
            once(row, h, 0.0, world)
            off, most = aim_all(row, h, BEGIN, 0.0, world), EXCESS * kinetic_energy(row, world)
        for _ in range(ROUNDS):
            once(row, h, h, world)
            off = approach(row, off, h, world) if off * ratio > SURE else off * off
            if off * ratio <= CLOSE:
                break
        articulations[row, LOST] = off * ratio > FAR or (most < math.inf and kinetic_energy(row, world) > most)
        if articulations[row, LOST] != 0:
            take_back(row, world)
            aim_all(row, h, GENTLY, 0.0, world)
            once(row, h, 0.0, world)
        end_solution(row, h, world)


def solve_once(row: int, h: float, ahead: float, world: int) -> None:
    """Solve the equations until all pieces of laws fit that were assumed, and give the impulses."""
    for trial in range(TRIALS + LAST_TRIALS):
        settled = settle(row, h, trial, world)
        if trial > 0 and settled:
            break
        answer(row, ahead, world)
    give_impulses(row, world)


def repair_positions(row: int, h: float, world: int) -> None:
    """Put bodies where joints hold them, by changes of position that have no velocity."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    for _ in range(REPAIRS):
        aim_all(row, h, REPAIR, 0.0, world)
        answer(row, -1.0, world)
        for link in range(articulation[FIRST], articulation[FIRST] + articulation[LINKS]):
            body = links[link, LINK_BODY]
            way, turn = times(h, vector_at(work, link, GAIN)), times(h, vector_at(work, link, GAIN + 3))
            turn = times(1.0 / max(1.0, 2.0 * length(turn)), turn)
            shift_body(body, way, turn, world)
        for link in range(articulation[FIRST], articulation[END]):
            if links[link, LINK_JOINT] >= 0:
                measure(links[link, LINK_JOINT], world)


@compiled(cached=False)
def shift_body(body: int, way: Vector, turn: Vector, world: int) -> None:
    """Change the pose of a body, and turn its angular velocity with it, which keeps its energy."""
    pose, change, motion, response = (
        floats(world, POSE),
        floats(world, CHANGES),
        floats(world, MOTION),
        floats(world, RESPONSE),
    )
    by = exponential(turn)
    q = unit(product(by, quaternion_at(pose, body, ANGULAR_PART)))
    w = turned(by, vector_at(motion, body, ANGULAR_PART))
    inverse = turned_symmetric(by, symmetric_at(response, body, TURN_RESPONSE))
    for k in range(3):
        pose[body, k] += way[k]
        change[body, k] += way[k]
        change[body, 3 + k] += turn[k]
        motion[body, 3 + k] = w[k]
    for k in range(4):
        pose[body, 3 + k] = q[k]
    for k in range(6):
        response[body, 1 + k] = inverse[k]


@compiled(cached=False)
def eliminate(row: int, ahead: float, world: int) -> None:
    """Solve an articulation without loops."""
    articulation: Any = integers(world, ARTICULATION)[row]
    factor(articulation[FIRST], articulation[LINKS], ahead, world)
    sweep(articulation[FIRST], articulation[LINKS], 1.0, world)


@compiled(cached=False)
def approach(row: int, before: float, h: float, world: int) -> float:
    """Aim anew, from halfway back as long as a step has led away, and return how far joints are off."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, numbers, work = integers(world, LINK), floats(world, JOINT_NUMBERS), floats(world, LINK_NUMBERS)
    off = aim_all(row, h, AHEAD, 0.0, world)
    for _ in range(HALVINGS):
        if off < before:
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
        off = aim_all(row, h, AHEAD, 0.0, world)
    return off


@compiled(cached=False)
def kinetic_energy(row: int, world: int) -> float:
    """Kinetic energy of the links of an articulation."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, motion, response = integers(world, LINK), floats(world, MOTION), floats(world, RESPONSE)
    total = 0.0
    for link in range(articulation[FIRST], articulation[FIRST] + articulation[LINKS]):
        body = links[link, LINK_BODY]
        v, w = vector_at(motion, body, LINEAR_PART), vector_at(motion, body, ANGULAR_PART)
        inverse = symmetric_at(response, body, TURN_RESPONSE)
        total += 0.5 * dot(v, v) / response[body, 0] if response[body, 0] > 0.0 else 0.0
        moments = inverse_symmetric(inverse)
        turning = 0.5 * dot(w, applied(moments, w))
        total += turning if turning < math.inf else 0.0
    return total


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
def give_impulses(row: int, world: int) -> None:
    """Give bodies the impulses that were found."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    numbers = floats(world, JOINT_NUMBERS)
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if joint < 0:
            continue
        if link < articulation[FIRST] + articulation[LINKS]:
            _split_impulse(link, joint, world)
        for k in range(6):
            numbers[joint, IMPULSE + k] += work[link, GIVEN + k]
            work[link, LAST + k] = work[link, GIVEN + k]
        push_bodies(joint, work, link, GIVEN, world)


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


_tree_once = compiled(cached=False)(specialise(solve_once, "solve_tree_once", answer=eliminate))
_repair_tree = compiled(cached=False)(specialise(repair_positions, "repair_tree", answer=eliminate))
solve_trees = compiled(specialise(solve_articulations, "solve_trees", once=_tree_once, repair=_repair_tree, FOR=TREES))

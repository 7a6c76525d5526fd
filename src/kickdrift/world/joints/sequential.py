"""Joints with too many loops for a direct solution, one after the other: each exact, all of them approached.

This is block Gauss-Seidel, as the solvers of games have it: what a joint gives is taken up by its neighbours in the next
substep, helped on by warm starting. Chains in it stretch under loads far heavier than themselves.

Locked axes are damped springs here, of frequency f and damping ratio z, written so that the mass drops out: with w = 2 pi f,
a = 2 z + h w and r = h w a, they take off w / a of the error in a second, r / (1 + r) of the impulse that a rigid joint would
give, and 1 / (1 + r) of the impulse so far. A grid of 20 x 20 that is rigid instead gains energy until it tears. Nordby,
Lacoursiere and Catto's soft constraints: E. Catto, Soft Constraints, Game Developers Conference (2011).
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import applied, cross
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.joints.aim import GENTLY, RELAX, aim, gentle_rate, gentle_share
from kickdrift.world.joints.equations import factor_equations, solve_equations
from kickdrift.world.joints.impulses import push_bodies
from kickdrift.world.joints.laws import end_laws, review_laws
from kickdrift.world.joints.layout import (
    ARM_A,
    ARM_B,
    AXES,
    BODY_A,
    BODY_B,
    CHANGE,
    END,
    FIRST,
    GIVEN,
    HELD,
    IMPULSE,
    LAWS,
    LINK_JOINT,
    LOCKED,
    MOVED,
    OFFSET,
    PUSH,
    RELAXING,
    SEQUENTIAL,
    SLOPE,
    SOLVED,
    TURN_RESPONSE,
)
from kickdrift.world.joints.measure import put_vector
from kickdrift.world.joints.settling import LAST_TRIALS, TRIALS, end_relaxation
from kickdrift.world.tables import (
    ARTICULATION,
    JOINT,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    RESPONSE,
    flat,
    floats,
    integers,
    rows,
)

# Columns of the second of the two rows of numbers that the joints share: of axis k, 12 numbers from 12 k
_TURNS = 0  # turns of a and b by a unit impulse's moment, before the response of the bodies
_ANSWERS = 6  # and after it


@compiled
def solve_in_turn(t: float, h: float, world: int) -> None:
    """Give the impulses with which joints hold, one joint after the other."""
    articulations: Any = integers(world, ARTICULATION)
    links, joints = integers(world, LINK), integers(world, JOINT)
    work, numbers = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    share = gentle_share(h)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, SEQUENTIAL] == 0:
            continue
        at, relaxing = articulations[row, OFFSET], articulations[row, RELAXING] != 0
        for link in range(articulations[row, FIRST], articulations[row, END]):
            joint = links[link, LINK_JOINT]
            aim(joint, at, h, RELAX if relaxing else GENTLY, gentle_rate(h), world)
            if not relaxing:
                for k in range(6):
                    work[at, CHANGE + k] *= 1.0 - share
            _solve(joint, at, h, relaxing, world)
            for k in range(6):
                if joints[joint, LOCKED] >> k & 1 and not relaxing:
                    work[at, GIVEN + k] -= share * numbers[joint, IMPULSE + k]
                numbers[joint, IMPULSE + k] += work[at, GIVEN + k]
                numbers[joint, SOLVED + k] = numbers[joint, IMPULSE + k]
            push_bodies(joint, work, at, GIVEN, world)
        if relaxing:
            end_relaxation(row, h, world)


@compiled(cached=False)
def _solve(joint: int, at: int, h: float, relaxing: bool, world: int) -> None:
    """Find the impulses of one joint for itself."""
    laws = integers(world, JOINT)[joint, LAWS]
    _find_answers(joint, at, world)
    for trial in range(TRIALS + LAST_TRIALS):
        settled = laws == 0 or not review_laws(joint, at, h, relaxing, trial > TRIALS, world)
        if trial > 0 and settled:
            break
        _solve_rows(joint, at, world)
    if not relaxing and laws != 0:
        end_laws(joint, at, h, world)


@compiled(cached=False)
def _find_answers(joint: int, at: int, world: int) -> None:
    """Find how both bodies turn by unit impulses along and about the axes."""
    joints, numbers, work = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, LINK_NUMBERS)
    response, wanted = floats(world, RESPONSE), joints[joint, LOCKED] | joints[joint, LAWS]
    for k in range(6):
        if wanted >> k & 1:
            axis = vector_at(numbers, joint, AXES + 3 * k)
            for side in range(2):
                arm = vector_at(numbers, joint, ARM_B if side == 1 else ARM_A)
                turn = cross(arm, axis) if k < 3 else axis
                put_vector(work, at + 1, 12 * k + _TURNS + 3 * side, turn)
                answer = applied(symmetric_at(response, joints[joint, BODY_A + side], TURN_RESPONSE), turn)
                put_vector(work, at + 1, 12 * k + _ANSWERS + 3 * side, answer)


@compiled(inline=True, cached=False)
def _answer(work: Any, at: int, lightness: float, k: int, other: int) -> float:
    """Speed along an axis by a unit impulse along another one."""
    total = lightness if k == other and k < 3 else 0.0
    for i in range(6):
        total += work[at + 1, 12 * k + _TURNS + i] * work[at + 1, 12 * other + _ANSWERS + i]
    return total


@compiled(cached=False)
def _solve_rows(joint: int, at: int, world: int) -> None:
    """Find the impulses along and about the axes for the pieces of laws that are assumed."""
    joints, work, numbers = integers(world, JOINT), floats(world, LINK_NUMBERS), flat(world, LINK_NUMBERS)
    held, begin = integers(world, LINK)[at, HELD], at * LINK_NUMBERS[1]
    lightness = floats(world, RESPONSE)[joints[joint, BODY_A], 0] + floats(world, RESPONSE)[joints[joint, BODY_B], 0]
    wanted, equations, m = joints[joint, LOCKED] | joints[joint, LAWS], 0, 0
    for k in range(6):
        if held >> k & 1 or work[at, SLOPE + k] > 0.0:
            equations |= 1 << k
            m += 1
        else:
            work[at, GIVEN + k] = work[at, PUSH + k]
    i = 0
    for k in range(6):
        if equations >> k & 1:
            right, give = work[at, CHANGE + k], 0.0
            if not held >> k & 1:
                right, give = work[at, PUSH + k] / work[at, SLOPE + k], 1.0 / work[at, SLOPE + k]
            j = 0
            for other in range(6):
                if equations >> other & 1:
                    numbers[begin + i * m + j] = _answer(work, at, lightness, k, other)
                    j += 1
                elif wanted >> other & 1:
                    right -= _answer(work, at, lightness, k, other) * work[at, GIVEN + other]
            numbers[begin + i * m + i] += give
            numbers[begin + m * m + i] = right
            numbers[begin + m * (m + 1) + i] = numbers[begin + i * m + i]
            i += 1
    solve_equations(numbers, begin, m, factor_equations(numbers, begin, m))
    i = 0
    for k in range(6):
        if equations >> k & 1:
            work[at, GIVEN + k] = numbers[begin + m * m + i]
            i += 1
    for k in range(6):
        if joints[joint, LAWS] >> k & 1:
            work[at, MOVED + k] = 0.0
            for other in range(6):
                if wanted >> other & 1:
                    work[at, MOVED + k] += _answer(work, at, lightness, k, other) * work[at, GIVEN + other]

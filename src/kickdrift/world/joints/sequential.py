"""Joints with too many loops for a direct solution, one after the other: each exact, all of them approached.

This is block Gauss-Seidel, as the solvers of games have it: what a joint gives is taken up by its neighbours in the next
substep, helped on by warm starting. Chains in it stretch under loads far heavier than themselves.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import cross, dot
from kickdrift.world.joints.aim import aim
from kickdrift.world.joints.equations import factor_equations, solve_equations
from kickdrift.world.joints.impulses import push_bodies
from kickdrift.world.joints.laws import end_laws, review_laws
from kickdrift.world.joints.layout import (
    ARM_A,
    ARM_B,
    AXES,
    BODY_A,
    CHANGE,
    END,
    FIRST,
    GIVEN,
    HELD,
    IMPULSE,
    LAWS,
    LINK_JOINT,
    MOVED,
    OFFSET,
    PUSH,
    RELAXING,
    SEQUENTIAL,
    SLOPE,
    SPEED,
)
from kickdrift.world.joints.measure import turn_by, vector_at
from kickdrift.world.joints.trees import LAST_TRIALS, TRIALS, end_relaxation
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

# Part of what joints are off by that a substep takes away. With all of it, impulses that put right what the neighbours put
# wrong add up.
_CORRECTION = 0.25


@compiled
def solve_in_turn(t: float, h: float, world: int) -> None:
    """Give the impulses with which joints hold, one joint after the other."""
    articulations: Any = integers(world, ARTICULATION)
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, SEQUENTIAL] == 0:
            continue
        at, relaxing = articulations[row, OFFSET], articulations[row, RELAXING] != 0
        for link in range(articulations[row, FIRST], articulations[row, END]):
            joint = links[link, LINK_JOINT]
            aim(joint, at, h, relaxing, world)
            if not relaxing:
                for k in range(6):
                    if links[at, HELD] >> k & 1:
                        speed = work[at, SPEED + k]
                        work[at, CHANGE + k] = _CORRECTION * (work[at, CHANGE + k] + speed) - speed
            _solve(joint, at, h, relaxing, world)
        if relaxing:
            end_relaxation(row, world)


@compiled(cached=False)
def _solve(joint: int, at: int, h: float, relaxing: bool, world: int) -> None:
    """Solve one joint for itself, and give its impulses."""
    joints, numbers, work = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, LINK_NUMBERS)
    for trial in range(TRIALS + LAST_TRIALS):
        settled = True
        if joints[joint, LAWS] != 0:
            settled = not review_laws(joint, at, h, relaxing, trial > TRIALS, world)
        if trial > 0 and settled:
            break
        _solve_rows(joint, at, world)
    for k in range(6):
        numbers[joint, IMPULSE + k] += work[at, GIVEN + k]
    push_bodies(joint, work, at, GIVEN, world)
    if not relaxing and joints[joint, LAWS] != 0:
        end_laws(joint, at, h, world)


@compiled(cached=False)
def _solve_rows(joint: int, at: int, world: int) -> None:
    """Find the impulses along and about the axes for the pieces of laws that are assumed."""
    links, work, all_numbers = integers(world, LINK), floats(world, LINK_NUMBERS), flat(world, LINK_NUMBERS)
    held, laws, begin = links[at, HELD], integers(world, JOINT)[joint, LAWS], at * LINK_NUMBERS[1]
    m = 0
    for k in range(6):
        if held >> k & 1 or work[at, SLOPE + k] > 0.0:
            m += 1
        else:
            work[at, GIVEN + k] = work[at, PUSH + k]
    right, scale, axes = begin + m * m, begin + m * (m + 1), begin + m * (m + 3)
    i = 0
    for k in range(6):
        if held >> k & 1 or work[at, SLOPE + k] > 0.0:
            all_numbers[axes + i] = k
            i += 1
    for i in range(m):
        k = int(all_numbers[axes + i])
        for j in range(i + 1):
            answer = _answer(joint, k, int(all_numbers[axes + j]), world)
            all_numbers[begin + i * m + j], all_numbers[begin + j * m + i] = answer, answer
        all_numbers[right + i] = work[at, CHANGE + k]
        if not held >> k & 1:
            all_numbers[begin + i * m + i] += 1.0 / work[at, SLOPE + k]
            all_numbers[right + i] = work[at, PUSH + k] / work[at, SLOPE + k]
        all_numbers[scale + i] = all_numbers[begin + i * m + i]
        for other in range(6):
            if work[at, GIVEN + other] != 0.0 and not (held >> other & 1 or work[at, SLOPE + other] > 0.0):
                all_numbers[right + i] -= _answer(joint, k, other, world) * work[at, GIVEN + other]
    solve_equations(all_numbers, begin, m, factor_equations(all_numbers, begin, m))
    for i in range(m):
        work[at, GIVEN + int(all_numbers[axes + i])] = all_numbers[right + i]
    for k in range(6):
        if laws >> k & 1:
            work[at, MOVED + k] = 0.0
            for other in range(6):
                if work[at, GIVEN + other] != 0.0:
                    work[at, MOVED + k] += _answer(joint, k, other, world) * work[at, GIVEN + other]


@compiled(cached=False)
def _answer(joint: int, k: int, other: int, world: int) -> float:
    """Speed along axis k that an impulse along another one gives both bodies of a joint."""
    joints, numbers, response = integers(world, JOINT), floats(world, JOINT_NUMBERS), floats(world, RESPONSE)
    one, two, total = vector_at(numbers, joint, AXES + 3 * k), vector_at(numbers, joint, AXES + 3 * other), 0.0
    for side in range(2):
        body, arm = joints[joint, BODY_A + side], vector_at(numbers, joint, ARM_B if side == 1 else ARM_A)
        total += dot(cross(arm, one) if k < 3 else one, turn_by(response, body, cross(arm, two) if other < 3 else two))
        if k < 3 and other < 3:
            total += response[body, 0] * dot(one, two)
    return total

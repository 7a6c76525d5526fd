"""Block Gauss-Seidel for articulations with too many loops for a direct solution: each joint is solved exactly, in turn.

As in the solvers of games, the effect of a joint reaches its neighbours in the next substeps, accelerated by warm starting.
Chains stretch under loads far heavier than themselves.

Locked axes are damped springs here, of frequency f and damping ratio z, written so that the mass drops out: with w = 2 pi f,
a = 2 z + h w and r = h w a, the error decays at the rate w / a, the impulse of a rigid joint is scaled by r / (1 + r), and
1 / (1 + r) of the accumulated impulse is removed. Soft constraints after E. Catto, Soft Constraints, Game Developers Conference
(2011), Nordby and Lacoursiere.

Grids of 10 x 10, 15 x 15 and 20 x 20 balls take 1.0, 1.3 and 2.6 ms a step, and 8, 96 and 377 ms directly; minimum degree
regardless of the tree would save a third, half and three fifths of the latter. The smallest keeps its energy in 5 s within
0.3 % directly, and loses 24 % in turn, and 10 % in turn with 64 substeps; the others lose 14 % directly and 4 % in turn, as
nets are thrown about in singular poses.
"""

import math
from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import applied
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.direct.active_set import TRIALS
from kickdrift.world.direct.contact_active_set import PRESS, REST
from kickdrift.world.direct.joint_impulses import end_joint, give_joint, turn_on
from kickdrift.world.direct.loop_closures import write_axis
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.gear_wrenches import mobility_of_gear
from kickdrift.world.joints.kinematics import put_vector
from kickdrift.world.joints.law_pieces import fix_laws, update_law_states
from kickdrift.world.joints.limits_motors import AFTER_DRIFT, BEFORE_DRIFT, begin_laws
from kickdrift.world.joints.right_hand_side import GENTLY, RELAX, write_right_hand_side
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, INVERSE_LINEAR_MASS
from kickdrift.world.tables import (
    ARTICULATION,
    INVERSE_MASS,
    JOINT,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    floats,
    integers,
    rows,
)

# Frequency of the springs, Hz, at most an eighth of that of substeps, and damping ratio. At a quarter, rigid grids of 14 x 14
# in flight gain tens of times their energy in 5 s; at an eighth they gain none, and hanging ones open 1.5 times as far.
_HERTZ, _DAMPING = 60.0, 2.0

# An axis whose pivot is less than this fraction of its diagonal element is held by the other axes already. One about which the
# bodies turn by less than this fraction of how they turn about all three is immovable, as out of the plane of a planar world.
_IMPLIED = 1e-10


@compiled
def solve_in_turn(t: float, h: float, world: int) -> None:
    """Solve and apply the impulses of joints, one joint after the other, before the drift."""
    articulations, links = integers(world, ARTICULATION), integers(world, LINK)
    work, numbers = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    speed = 2.0 * math.pi * min(_HERTZ, 0.125 / h)
    rate = speed / (2.0 * _DAMPING + h * speed)
    share = 1.0 / (1.0 + h * speed * (2.0 * _DAMPING + h * speed))
    for row in range(rows(world, ARTICULATION)):
        at = articulations[row, j.FIRST]  # all its joints use one row of LINK_NUMBERS, which stays in the cache
        for link in range(at, articulations[row, j.END] if articulations[row, j.SEQUENTIAL] != 0 else at):
            joint = links[link, j.LINK_JOINT]
            if joint < 0:
                continue
            write_right_hand_side(world, joint, at, h, GENTLY)
            for k in range(6):
                work[at, j.RIGHT_HAND_SIDE + k] = (1.0 - share) * (
                    work[at, j.RIGHT_HAND_SIDE + k] - rate * numbers[joint, j.MISALIGNMENT + k]
                )
            _solve(world, joint, at, h, BEFORE_DRIFT)
            for k in range(6):
                if links[at, j.HELD_AXES] >> k & 1:
                    work[at, j.AXIS_IMPULSE + k] -= share * numbers[joint, j.JOINT_IMPULSE + k]
            give_joint(world, joint, at, PRESS)
            end_joint(world, joint)


@compiled
def relax_in_turn(t: float, h: float, world: int) -> None:
    """Project the velocities onto what joints allow at the new poses, one joint after the other, after the drift."""
    articulations, links, joints = integers(world, ARTICULATION), integers(world, LINK), integers(world, JOINT)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, j.SEQUENTIAL] == 0:
            continue
        at = articulations[row, j.FIRST]
        for link in range(at, articulations[row, j.END]):
            if links[link, j.LINK_JOINT] >= 0:
                write_right_hand_side(world, links[link, j.LINK_JOINT], at, h, RELAX)
                _solve(world, links[link, j.LINK_JOINT], at, h, AFTER_DRIFT)
                give_joint(world, links[link, j.LINK_JOINT], at, REST)
        for link in range(at, articulations[row, j.END]):
            joint = links[link, j.LINK_JOINT]
            if joint >= 0:
                turn_on(world, joint, joints[joint, j.BODY_B], h)


@compiled(cached=False)
def _solve(world: int, joint: int, at: int, h: float, phase: int) -> None:
    """Find the impulses of one joint as if it were the only one."""
    laws, work = integers(world, JOINT)[joint, j.LAWS], floats(world, LINK_NUMBERS)
    active = integers(world, LINK)[at, j.HELD_AXES] | laws
    responses = carray(floats_on_stack(36), (6, 6))
    _find_responses(world, joint, at, active, responses)
    begin_laws(world, joint, at, h, phase)
    for trial in range(TRIALS + 1):
        settled = laws == 0 or update_law_states(world, joint, at, trial == 0)
        if trial > 0 and settled:
            break
        if trial == TRIALS:
            fix_laws(world, joint, at)
        _solve_axes(world, at, active, responses)
        for k in range(6):
            work[at, j.DELTA_SPEED + k] = 0.0
            for other in range(6):
                if active >> k & 1 and active >> other & 1:
                    work[at, j.DELTA_SPEED + k] += responses[k, other] * work[at, j.AXIS_IMPULSE + other]
            work[at, j.ACCEPTED_DELTA_SPEED + k] = work[at, j.DELTA_SPEED + k]
            work[at, j.ACCEPTED_IMPULSE + k] = work[at, j.AXIS_IMPULSE + k]


@compiled(cached=False)
def _find_responses(world: int, joint: int, at: int, active: int, responses: Any) -> None:
    """Find the changes of speed along each active axis by unit impulses along each, (6, 6)."""
    joints, response, numbers = integers(world, JOINT), floats(world, INVERSE_MASS), floats(world, JOINT_NUMBERS)
    wrenches, moved = carray(floats_on_stack(72), (6, 12)), carray(floats_on_stack(12), (1, 12))
    if joints[joint, j.LINEAR] == j.GEARED:
        k = joints[joint, j.PRINCIPAL]
        responses[k, k] = mobility_of_gear(world, joint, at)
        return
    turning = 0.0
    for side in range(2):
        for i in range(3):
            turning += response[joints[joint, j.BODY_A + side], INVERSE_INERTIA_IN_WORLD + i]
    for k in range(6):
        if not active >> k & 1:
            continue
        write_axis(numbers, joint, j.AXES, j.ARM_A, j.ARM_B, k, wrenches[k])
        for side in range(2):
            body, begin = joints[joint, j.BODY_A + side], 6 * side
            for i in range(begin, begin + 3):
                moved[0, i] = response[body, INVERSE_LINEAR_MASS] * wrenches[k, i]
            turn = vector_at(wrenches, k, begin + 3)
            put_vector(moved, 0, begin + 3, applied(symmetric_at(response, body, INVERSE_INERTIA_IN_WORLD), turn))
        for other in range(k + 1):
            if active >> other & 1:
                total = 0.0
                for i in range(12):
                    total += wrenches[other, i] * moved[0, i]
                responses[k, other], responses[other, k] = total, total
        if k >= 3 and responses[k, k] <= _IMPLIED * turning:
            responses[k, k] = 0.0


@compiled(cached=False)
def _solve_axes(world: int, at: int, active: int, responses: Any) -> None:
    """Find the impulses along the axes for the assumed pieces of laws.

    The equation of a held axis prescribes its change of speed, that of an open axis its impulse. Up to the scaling of rows the
    matrix is positive semidefinite, and needs no pivoting.
    """
    held, work = integers(world, LINK)[at, j.HELD_AXES], floats(world, LINK_NUMBERS)
    matrix = carray(floats_on_stack(42), (6, 7))
    for k in range(6):
        work[at, j.AXIS_IMPULSE + k] = 0.0
        if not active >> k & 1:
            continue
        is_held = held >> k & 1 != 0
        for m in range(6):
            if active >> m & 1:
                matrix[k, m] = responses[k, m] if is_held else work[at, j.SLOPE + k] * responses[k, m]
        matrix[k, 6] = work[at, j.RIGHT_HAND_SIDE + k] if is_held else work[at, j.PUSH + k]
        matrix[k, k] += 0.0 if is_held else 1.0
    for k in range(6):
        if not active >> k & 1:
            continue
        before = matrix[k, k]
        for i in range(k):
            if active >> i & 1 and matrix[i, i] > 0.0:
                share = matrix[k, i] / matrix[i, i]
                for m in range(i + 1, 7):
                    if m == 6 or active >> m & 1:
                        matrix[k, m] -= share * matrix[i, m]
        if not matrix[k, k] > _IMPLIED * before:
            matrix[k, k] = 0.0
    for k in range(5, -1, -1):
        if active >> k & 1 and matrix[k, k] > 0.0:
            total = matrix[k, 6]
            for m in range(k + 1, 6):
                if active >> m & 1:
                    total -= matrix[k, m] * work[at, j.AXIS_IMPULSE + m]
            work[at, j.AXIS_IMPULSE + k] = total / matrix[k, k]

"""Articulations with a few loops: equations that remain for the joints that close them, once the tree is eliminated.

The tree answers an impulse along each axis of each closing joint (a sweep without anything else), which gives the matrix
of these equations; with their solution as loads, a last sweep moves the tree.
"""

from typing import Any

from kickdrift.core.compilation import compiled, specialise
from kickdrift.core.vectors import cross, dot, plus
from kickdrift.world.columns import vector_at
from kickdrift.world.joints.articulated import factor, sweep
from kickdrift.world.joints.equations import factor_equations, solve_equations
from kickdrift.world.joints.layout import (
    ARM_A,
    ARM_A_AHEAD,
    ARM_B,
    ARM_B_AHEAD,
    AXES,
    AXES_AHEAD,
    CHANGE,
    END,
    FIRST,
    GAIN,
    GIVEN,
    HELD,
    LINK_A,
    LINK_JOINT,
    LINKS,
    LOAD,
    MOVED,
    OFFSET,
    PUSH,
    SLOPE,
)
from kickdrift.world.joints.measure import mobility
from kickdrift.world.joints.newton import LOOPS, solve_articulations, solve_calmly, solve_once, touch_up
from kickdrift.world.joints.repair import repair_positions
from kickdrift.world.tables import (
    ARTICULATION,
    ARTICULATION_NUMBERS,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    flat,
    floats,
    integers,
)


@compiled(cached=False)
def eliminate_with_loops(row: int, ahead: float, world: int) -> None:
    """Find changes of velocity, impulses at the joints of the tree, and those at the closing ones."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), flat(world, ARTICULATION_NUMBERS)
    first, closing, after = articulation[FIRST], articulation[FIRST] + articulation[LINKS], articulation[END]
    m, at = 0, articulation[OFFSET]
    for link in range(closing, after):
        for k in range(6):
            m += 1 if _has_equation(links, work, link, k) else 0
    right, axes = at + m * m, at + m * (m + 3)
    factor(first, closing - first, ahead, world)
    for last in range(2):
        # Once without the equations, which says what is missing, and once with the impulses that are their solution.
        for link in range(first, closing):
            for k in range(6):
                work[link, LOAD + k] = 0.0
        for link in range(closing, after):
            for k in range(6):
                if not _has_equation(links, work, link, k):
                    work[link, GIVEN + k] = work[link, PUSH + k]
                if last == 1 or not _has_equation(links, work, link, k):
                    _load(link, k, work[link, GIVEN + k], world)
        sweep(first, closing - first, 1.0, world)
        for link in range(closing, after):
            for k in range(6):
                work[link, MOVED + k] = _gained(link, k, world)
        if last == 1:
            break
        i = 0
        for link in range(closing, after):
            for k in range(6):
                if _has_equation(links, work, link, k):
                    held = links[link, HELD] >> k & 1
                    wanted = work[link, CHANGE + k] if held else work[link, PUSH + k] / work[link, SLOPE + k]
                    numbers[right + i], numbers[axes + i] = wanted - work[link, MOVED + k], 6 * link + k
                    i += 1
        _fill_matrix(row, m, world)
        solve_equations(numbers, at, m, factor_equations(numbers, at, m))
        for i in range(m):
            work[int(numbers[axes + i]) // 6, GIVEN + int(numbers[axes + i]) % 6] = numbers[right + i]


@compiled(inline=True, cached=False)
def _has_equation(links: Any, work: Any, link: int, k: int) -> bool:
    has: bool = links[link, HELD] >> k & 1 == 1 or work[link, SLOPE + k] > 0.0
    return has


@compiled(cached=False)
def _fill_matrix(row: int, m: int, world: int) -> None:
    """Find how the tree answers the impulses of closing joints."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), flat(world, ARTICULATION_NUMBERS)
    first, closing, at = articulation[FIRST], articulation[FIRST] + articulation[LINKS], articulation[OFFSET]
    scale, axes = at + m * (m + 1), at + m * (m + 3)
    for i in range(m):
        link, k = int(numbers[axes + i]) // 6, int(numbers[axes + i]) % 6
        for other in range(first, closing):
            for j in range(6):
                work[other, LOAD + j] = 0.0
        _load(link, k, 1.0, world)
        sweep(first, closing - first, 0.0, world)
        for j in range(m):
            other, axis = int(numbers[axes + j]) // 6, int(numbers[axes + j]) % 6
            numbers[at + j * m + i] = _gained(other, axis, world)
        give = 0.0 if links[link, HELD] >> k & 1 else 1.0 / work[link, SLOPE + k]
        numbers[at + i * m + i] += give
        numbers[scale + i] = mobility(links[link, LINK_JOINT], k, world) + give


@compiled(cached=False)
def _load(link: int, k: int, impulse: float, world: int) -> None:
    """Let an impulse along an axis of a closing joint act on the links that it joins."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    joint = links[link, LINK_JOINT]
    axis = vector_at(numbers, joint, AXES + 3 * k)
    for side in range(2):
        to = links[link, LINK_A + side]
        if to < 0:
            continue
        amount = impulse if side == 1 else -impulse
        arm = vector_at(numbers, joint, ARM_B if side == 1 else ARM_A)
        turn = cross(arm, axis) if k < 3 else axis
        for i in range(3):
            work[to, LOAD + 3 + i] += amount * turn[i]
            if k < 3:
                work[to, LOAD + i] += amount * axis[i]


@compiled(cached=False)
def _gained(link: int, k: int, world: int) -> float:
    """Change of speed along an axis of a closing joint."""
    links, work, total = integers(world, LINK), floats(world, LINK_NUMBERS), 0.0
    axis = vector_at(work, link, AXES_AHEAD + 3 * k)
    for side in range(2):
        of = links[link, LINK_A + side]
        if of < 0:
            continue
        gain = vector_at(work, of, GAIN + 3)
        if k < 3:
            arm = vector_at(work, link, ARM_B_AHEAD if side == 1 else ARM_A_AHEAD)
            gain = plus(vector_at(work, of, GAIN), cross(gain, arm))
        total += dot(axis, gain) if side == 1 else -dot(axis, gain)
    return float(total)


_once = compiled(cached=False)(specialise(solve_once, "solve_loops_once", answer=eliminate_with_loops))
_repair = compiled(cached=False)(specialise(repair_positions, "repair_loops", answer=eliminate_with_loops))
_calm = compiled(cached=False)(specialise(solve_calmly, "solve_loops_calmly", once=_once, answer=eliminate_with_loops))
solve_loops = compiled(
    specialise(solve_articulations, "solve_loops", once=_once, calm=_calm, repair=_repair, FOR=LOOPS)
)
touch_up_loops = compiled(specialise(touch_up, "touch_up_loops", once=_once, FOR=LOOPS))

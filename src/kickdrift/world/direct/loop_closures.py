"""Joints that close loops, in the equations of an island: stiff rows, as those of contacts, with two wrenches each."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross
from kickdrift.world.columns import vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import twelve
from kickdrift.world.direct.gear_assembly import add_gear, load_gear, moved_gear
from kickdrift.world.direct.matrix import add_row
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.gear_wrenches import mobility_of_gear
from kickdrift.world.joints.kinematics import mobility
from kickdrift.world.tables import ISLAND, ISLAND_JOINT, JOINT, JOINT_NUMBERS, LINK, LINK_NUMBERS, floats, integers

# Stiffness of a held axis: impulse per error of speed, over its effective mass. The residual of a solution is removed by the
# next one, which begins with its impulses. With 1e6 a scaffold at rest needs one more of them, and takes twice as long; with
# 1e8 rounding errors drive apart what has redundant joints: of 24 nets 14 keep their energy within 1 %, instead of 18.
_RIGID = 1e7


@compiled(inline=True, cached=False, fast=True)
def has_loops(world: int, island: int) -> bool:
    """Whether joints close loops in an island."""
    own = integers(world, ISLAND)[island]
    closed: bool = own[d.AFTER_JOINT] > own[d.FIRST_CLOSING]
    return closed


@compiled(cached=False, fast=True)
def write_axis(table: Any, row: int, axes: int, arm_a: int, arm_b: int, k: int, wrench: Any) -> None:
    """Write the wrench of a unit impulse along axis k of a joint, (12,)."""
    axis = vector_at(table, row, axes + 3 * k)
    nothing: Vector = (0.0, 0.0, 0.0)
    push = axis if k < 3 else nothing
    turn_a = cross(vector_at(table, row, arm_a), axis) if k < 3 else axis
    turn_b = cross(vector_at(table, row, arm_b), axis) if k < 3 else axis
    for i in range(3):
        wrench[i], wrench[3 + i], wrench[6 + i], wrench[9 + i] = -push[i], -turn_a[i], push[i], turn_b[i]


@compiled(inline=True, cached=False, fast=True)
def _is_gear(world: int, link: int) -> bool:
    """Whether a closing joint is a gear."""
    joints, links = integers(world, JOINT), integers(world, LINK)
    is_gear: bool = joints[links[link, j.LINK_JOINT], j.LINEAR] == j.GEARED
    return is_gear


@compiled(inline=True, cached=False, fast=True)
def _stiffness(world: int, link: int, k: int) -> float:
    """Return the impulse along an axis of a closing joint per change of speed; 0.0 along an immovable one."""
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    if links[link, j.HELD_AXES] >> k & 1:
        joint = links[link, j.LINK_JOINT]
        yielding = mobility_of_gear(world, joint, link) if _is_gear(world, link) else mobility(world, joint, k)
        return _RIGID / yielding if yielding > 0.0 else 0.0
    slope: float = work[link, j.SLOPE + k]
    return slope


@compiled(cached=False, fast=True)
def begin_closings(world: int, island: int) -> None:
    """Begin the solution of closing joints without impulses.

    With those of the substep before, a joint that is nearly redundant is an integral controller of its own error: as stiff as s
    times the mass that it moves, it is unstable for s < 0.4, and its error grows by up to 1.12 times a substep, however short
    that is. A grid of 8 x 8 balls then buckles within half a second with 16 substeps.
    """
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT)
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    for place in range(own[d.FIRST_CLOSING], own[d.AFTER_JOINT]):
        link = order[place, 0]
        joint = links[link, j.LINK_JOINT]
        for k in range(6):
            work[link, j.BEGUN + k] = -numbers[joint, j.JOINT_IMPULSE + k]


@compiled(cached=False, fast=True)
def stay_closings(world: int, island: int) -> None:
    """Begin the solution of closing joints with their present impulses."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT)
    work = floats(world, LINK_NUMBERS)
    for place in range(own[d.FIRST_CLOSING], own[d.AFTER_JOINT]):
        for k in range(6):
            work[order[place, 0], j.BEGUN + k] = 0.0


@compiled(cached=False, fast=True)
def refine_closings(world: int, island: int) -> float:
    """Begin the next solution with the impulses of the current one; return its largest residual speed, m/s or rad/s."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT)
    links, work, worst = integers(world, LINK), floats(world, LINK_NUMBERS), 0.0
    for place in range(own[d.FIRST_CLOSING], own[d.AFTER_JOINT]):
        link = order[place, 0]
        for k in range(6):
            if links[link, j.HELD_AXES] >> k & 1 and _stiffness(world, link, k) > 0.0:
                worst = max(worst, abs(work[link, j.RIGHT_HAND_SIDE + k] - work[link, j.DELTA_SPEED + k]))
                work[link, j.BEGUN + k] = work[link, j.AXIS_IMPULSE + k]
    return worst


@compiled(cached=False, fast=True)
def add_closings(world: int, island: int) -> None:
    """Add the rows of closing joints to the matrix of an island."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT)
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    start, ahead = twelve(), twelve()
    for place in range(own[d.FIRST_CLOSING], own[d.AFTER_JOINT]):
        link = order[place, 0]
        a, b = _node(links, link, 0), _node(links, link, 1)
        for k in range(6):
            stiffness = _stiffness(world, link, k)
            if stiffness > 0.0 and _is_gear(world, link):
                add_gear(world, link, stiffness)
            elif stiffness > 0.0:
                write_axis(numbers, links[link, j.LINK_JOINT], j.AXES, j.ARM_A, j.ARM_B, k, start)
                write_axis(work, link, j.AXES_AHEAD, j.ARM_A_AHEAD, j.ARM_B_AHEAD, k, ahead)
                add_row(world, a, b, stiffness, start, ahead)


@compiled(cached=False, fast=True)
def load_closings(world: int, island: int) -> None:
    """Add to the loads on the nodes of an island the impulses of its closing joints at no change of speed."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT)
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    start = twelve()
    for place in range(own[d.FIRST_CLOSING], own[d.AFTER_JOINT]):
        link = order[place, 0]
        for k in range(6):
            impulse = work[link, j.PUSH + k]
            if links[link, j.HELD_AXES] >> k & 1:
                impulse = work[link, j.BEGUN + k] + _stiffness(world, link, k) * work[link, j.RIGHT_HAND_SIDE + k]
            if impulse == 0.0:
                continue
            if _is_gear(world, link):
                load_gear(world, link, impulse)
                continue
            write_axis(numbers, links[link, j.LINK_JOINT], j.AXES, j.ARM_A, j.ARM_B, k, start)
            for side in range(2):
                to = links[link, j.LINK_A + side]
                if to >= 0:
                    for i in range(6):
                        work[to, j.CLOSING_IMPULSE + i] += impulse * start[6 * side + i]


@compiled(inline=True, cached=False, fast=True)
def _node(links: Any, link: int, side: int) -> int:
    """Return the node of a body of a closing joint; -1 if it is immovable."""
    to = links[link, j.LINK_A + side]
    node: int = links[to, j.NODE_ROW] if to >= 0 else -1
    return node


@compiled(cached=False, fast=True)
def predict_closings(world: int, island: int) -> None:
    """Find the changes of speed and the impulses along the axes of closing joints."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT)
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    ahead = twelve()
    for place in range(own[d.FIRST_CLOSING], own[d.AFTER_JOINT]):
        link = order[place, 0]
        for k in range(6):
            total = 0.0
            if _is_gear(world, link):
                total = moved_gear(world, link) if links[link, j.HELD_AXES] >> k & 1 else 0.0
            else:
                write_axis(work, link, j.AXES_AHEAD, j.ARM_A_AHEAD, j.ARM_B_AHEAD, k, ahead)
                for side in range(2):
                    to = links[link, j.LINK_A + side]
                    if to >= 0:
                        for i in range(6):
                            total += ahead[6 * side + i] * work[to, j.GAIN + i]
            work[link, j.DELTA_SPEED + k] = total
            stiffness = _stiffness(world, link, k)
            if links[link, j.HELD_AXES] >> k & 1:
                work[link, j.AXIS_IMPULSE + k] = work[link, j.BEGUN + k] + stiffness * (
                    work[link, j.RIGHT_HAND_SIDE + k] - total
                )
            else:
                work[link, j.AXIS_IMPULSE + k] = work[link, j.PUSH + k] - stiffness * total

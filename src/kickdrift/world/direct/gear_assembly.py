"""Gears in the equations of an island: closing joints of one row, with up to four wrenches."""

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.direct_bodies import node_of
from kickdrift.world.direct.matrix import block_of
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.gear_wrenches import geared_body
from kickdrift.world.tables import BLOCK, LINK, LINK_NUMBERS, floats, integers


@compiled(cached=False)
def geared_link(world: int, link: int, i: int) -> int:
    """Return the row of `LINK` of the body on which the i-th wrench of a gear acts; -1 for an immovable one."""
    row: int = node_of(world, geared_body(world, integers(world, LINK)[link, j.LINK_JOINT], i))
    return row


@compiled(cached=False)
def add_gear(world: int, link: int, stiffness: float) -> None:
    """Add the row of a gear to the matrix of an island."""
    links, work, blocks = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, BLOCK)
    for i in range(4):
        for other in range(4):
            one, two = geared_link(world, link, i), geared_link(world, link, other)
            if one < 0 or two < 0:
                continue
            a, b = links[one, j.NODE_ROW], links[two, j.NODE_ROW]
            block = block_of(world, min(a, b), max(a, b)) if a != b else 0
            at = d.UPPER_BLOCK if a < b else d.LOWER_BLOCK
            for m in range(6):
                scaled = stiffness * work[link, j.START_WRENCHES + 6 * i + m]
                for n in range(6):
                    added = scaled * work[link, j.AHEAD_WRENCHES + 6 * other + n]
                    if a == b:
                        work[one, j.ARTICULATED_INERTIA + 6 * m + n] += added
                    else:
                        blocks[block, at + 6 * m + n] += added


@compiled(cached=False)
def load_gear(world: int, link: int, impulse: float) -> None:
    """Add the impulse of a gear to the loads on nodes."""
    work = floats(world, LINK_NUMBERS)
    for i in range(4):
        to = geared_link(world, link, i)
        if to >= 0:
            for m in range(6):
                work[to, j.CLOSING_IMPULSE + m] += impulse * work[link, j.START_WRENCHES + 6 * i + m]


@compiled(cached=False)
def moved_gear(world: int, link: int) -> float:
    """Return the change of the speed of a gear in the current solution."""
    work, total = floats(world, LINK_NUMBERS), 0.0
    for i in range(4):
        to = geared_link(world, link, i)
        if to >= 0:
            for m in range(6):
                total += work[link, j.AHEAD_WRENCHES + 6 * i + m] * work[to, j.GAIN + m]
    return total

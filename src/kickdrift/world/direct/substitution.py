"""Forward and back substitution with the factored matrix of an island."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.spatial import inner, plus_scaled, put_spatial, spatial_at
from kickdrift.core.vectors import Vector, cross, dot, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.factorisation import arms
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.kinematics import put_vector
from kickdrift.world.tables import BLOCK, JOINT_NUMBERS, LINK, LINK_NUMBERS, NEIGHBOUR, NODE, floats, integers

_NOTHING: Vector = (0.0, 0.0, 0.0)


@compiled(cached=False, fast=True)
def substitute(world: int, first: int, after: int) -> None:
    """Find the changes of velocity (`GAIN`) for the loads on the nodes, and the impulses at joints (`JOINT_WRENCH`)."""
    nodes, links, work = integers(world, NODE), integers(world, LINK), floats(world, LINK_NUMBERS)
    for node in range(first, after):
        link = nodes[node, d.LINK_ROW]
        for k in range(6):
            work[link, j.BIAS_IMPULSE + k] = -work[link, j.CLOSING_IMPULSE + k]
    for node in range(first, after):
        if links[nodes[node, d.LINK_ROW], j.LINK_JOINT] >= 0:
            _forward_link(world, node)
        else:
            _forward_free(world, node)
    for node in range(after - 1, first - 1, -1):
        if links[nodes[node, d.LINK_ROW], j.LINK_JOINT] >= 0:
            _back_link(world, node)
        else:
            _back_free(world, node)


@compiled(cached=False, fast=True)
def _forward_link(world: int, node: int) -> None:
    """Find the impulse at a link's joint if its parent and its neighbours do not move, and pass it on to these."""
    nodes, links, neighbours = integers(world, NODE), integers(world, LINK), integers(world, NEIGHBOUR)
    work, numbers, blocks = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS), floats(world, BLOCK)
    link, parent = nodes[node, d.LINK_ROW], nodes[node, d.PARENT_NODE]
    joint, begin = links[link, j.LINK_JOINT], nodes[node, d.FIRST_NEIGHBOUR]
    end = begin + nodes[node, d.NEIGHBOURS]
    held, sign = links[link, j.HELD_AXES], links[link, j.SIGN]
    own, other = arms(numbers, joint, j.ARM_A, j.ARM_B, sign)
    # In registers, not in the table: the compiler cannot know that writes to it do not alias the next reads.
    push = vector_at(work, link, j.BIAS_IMPULSE)
    turn = minus(vector_at(work, link, j.BIAS_IMPULSE + 3), cross(own, push))
    gain: tuple[Vector, Vector] = (_NOTHING, _NOTHING)
    for k in range(6):
        if held >> k & 1:
            wanted = times(sign * work[link, j.RIGHT_HAND_SIDE + k], vector_at(work, link, j.AXES_AHEAD + 3 * k))
            gain = (plus(gain[0], wanted), gain[1]) if k < 3 else (gain[0], plus(gain[1], wanted))
        else:
            axis, column = vector_at(numbers, joint, j.AXES + 3 * k), j.COUPLING + 6 * k
            extra = sign * work[link, j.PUSH + k] - dot(axis, push if k < 3 else turn)
            work[link, j.DELTA_SPEED + k] = extra
            extra *= work[link, j.YIELD + k]
            push = plus(push, times(extra, vector_at(work, link, column)))
            turn = plus(turn, times(extra, vector_at(work, link, column + 3)))
            for block in range(begin, end):
                to = nodes[neighbours[block, 0], d.LINK_ROW]
                coupling = spatial_at(blocks, block, d.BLOCK_COUPLING + 6 * k)
                put_spatial(
                    work, to, j.BIAS_IMPULSE, plus_scaled(spatial_at(work, to, j.BIAS_IMPULSE), extra, coupling)
                )
    push = plus(push, _product(work, link, j.ARTICULATED_INERTIA, gain))
    turn = plus(turn, _product(work, link, j.ARTICULATED_INERTIA + 18, gain))
    put_vector(work, link, j.GAIN, gain[0])
    put_vector(work, link, j.GAIN + 3, gain[1])
    put_vector(work, link, j.BIAS_IMPULSE, push)
    put_vector(work, link, j.BIAS_IMPULSE + 3, turn)
    for block in range(begin, end):
        to = nodes[neighbours[block, 0], d.LINK_ROW]
        _add_product(world, block, d.LOWER_BLOCK, link, to, j.BIAS_IMPULSE)
    if parent >= 0:
        above = nodes[parent, d.LINK_ROW]
        put_vector(work, above, j.BIAS_IMPULSE, plus(vector_at(work, above, j.BIAS_IMPULSE), push))
        turn = plus(turn, cross(other, push))
        put_vector(work, above, j.BIAS_IMPULSE + 3, plus(vector_at(work, above, j.BIAS_IMPULSE + 3), turn))


@compiled(inline=True, cached=False, fast=True)
def _product(m: Any, row: int, at: int, x: tuple[Vector, Vector]) -> Vector:
    """Return three rows of a block times six numbers."""
    return (
        dot(vector_at(m, row, at), x[0]) + dot(vector_at(m, row, at + 3), x[1]),
        dot(vector_at(m, row, at + 6), x[0]) + dot(vector_at(m, row, at + 9), x[1]),
        dot(vector_at(m, row, at + 12), x[0]) + dot(vector_at(m, row, at + 15), x[1]),
    )


@compiled(inline=True, cached=False, fast=True)
def _add_product(world: int, block: int, at: int, of: int, to: int, target: int) -> None:
    """Add the product of a block and the change of velocity of a link to six numbers of another."""
    blocks, work = floats(world, BLOCK), floats(world, LINK_NUMBERS)
    for i in range(6):
        total = 0.0
        for k in range(6):
            total += blocks[block, at + 6 * i + k] * work[of, j.GAIN + k]
        work[to, target + i] += total


@compiled(cached=False, fast=True)
def _back_link(world: int, node: int) -> None:
    """Find the change of velocity of a link, from those of its parent and its neighbours, and the impulse at its joint."""
    nodes, links, neighbours = integers(world, NODE), integers(world, LINK), integers(world, NEIGHBOUR)
    work, blocks = floats(world, LINK_NUMBERS), floats(world, BLOCK)
    link, parent = nodes[node, d.LINK_ROW], nodes[node, d.PARENT_NODE]
    begin = nodes[node, d.FIRST_NEIGHBOUR]
    end = begin + nodes[node, d.NEIGHBOURS]
    held, sign = links[link, j.HELD_AXES], links[link, j.SIGN]
    own, other = arms(work, link, j.ARM_A_AHEAD, j.ARM_B_AHEAD, sign)
    v: Vector = (0.0, 0.0, 0.0)
    w: Vector = (0.0, 0.0, 0.0)
    if parent >= 0:
        above = nodes[parent, d.LINK_ROW]
        w = vector_at(work, above, j.GAIN + 3)
        v = plus(vector_at(work, above, j.GAIN), cross(w, other))
    push = plus(vector_at(work, link, j.BIAS_IMPULSE), _product(work, link, j.ARTICULATED_INERTIA, (v, w)))
    turn = plus(vector_at(work, link, j.BIAS_IMPULSE + 3), _product(work, link, j.ARTICULATED_INERTIA + 18, (v, w)))
    put_vector(work, link, j.JOINT_WRENCH, push)
    put_vector(work, link, j.JOINT_WRENCH + 3, turn)
    for block in range(begin, end):
        _add_product(world, block, d.UPPER_BLOCK, nodes[neighbours[block, 0], d.LINK_ROW], link, j.JOINT_WRENCH)
    v, w = plus(v, vector_at(work, link, j.GAIN)), plus(w, vector_at(work, link, j.GAIN + 3))
    for k in range(5, -1, -1):
        if held >> k & 1:
            continue
        row = j.PASSING + 6 * k
        extra = (
            work[link, j.DELTA_SPEED + k] - dot(vector_at(work, link, row), v) - dot(vector_at(work, link, row + 3), w)
        )
        for block in range(begin, end):
            of = nodes[neighbours[block, 0], d.LINK_ROW]
            extra -= inner(spatial_at(blocks, block, d.BLOCK_PASSING + 6 * k), spatial_at(work, of, j.GAIN))
        extra *= work[link, j.YIELD + k]
        work[link, j.DELTA_SPEED + k] = sign * extra
        change = times(extra, vector_at(work, link, j.AXES_AHEAD + 3 * k))
        v, w = (plus(v, change), w) if k < 3 else (v, plus(w, change))
    put_vector(work, link, j.GAIN, plus(v, cross(own, w)))
    put_vector(work, link, j.GAIN + 3, w)


@compiled(cached=False, fast=True)
def _forward_free(world: int, node: int) -> None:
    """Find the change of velocity of a free node if its neighbours do not move, and the loads that it passes on to them."""
    nodes, neighbours = integers(world, NODE), integers(world, NEIGHBOUR)
    work = floats(world, LINK_NUMBERS)
    link, begin = nodes[node, d.LINK_ROW], nodes[node, d.FIRST_NEIGHBOUR]
    for i in range(6):
        total = -work[link, j.BIAS_IMPULSE + i]
        for k in range(i):
            total -= work[link, j.ARTICULATED_INERTIA + 6 * i + k] * work[link, j.GAIN + k]
        work[link, j.GAIN + i] = total
    for i in range(5, -1, -1):
        total = work[link, j.GAIN + i]
        for k in range(i + 1, 6):
            total -= work[link, j.ARTICULATED_INERTIA + 6 * i + k] * work[link, j.GAIN + k]
        work[link, j.GAIN + i] = total * work[link, j.ARTICULATED_INERTIA + 7 * i]
    for block in range(begin, begin + nodes[node, d.NEIGHBOURS]):
        to = nodes[neighbours[block, 0], d.LINK_ROW]
        _add_product(world, block, d.LOWER_BLOCK, link, to, j.BIAS_IMPULSE)


@compiled(cached=False, fast=True)
def _back_free(world: int, node: int) -> None:
    """Correct the change of velocity of a free node for those of its neighbours."""
    nodes, neighbours = integers(world, NODE), integers(world, NEIGHBOUR)
    work, blocks = floats(world, LINK_NUMBERS), floats(world, BLOCK)
    link, begin = nodes[node, d.LINK_ROW], nodes[node, d.FIRST_NEIGHBOUR]
    for block in range(begin, begin + nodes[node, d.NEIGHBOURS]):
        of = nodes[neighbours[block, 0], d.LINK_ROW]
        for i in range(6):
            total = 0.0
            for m in range(6):
                total += blocks[block, d.UPPER_BLOCK + 6 * i + m] * work[of, j.GAIN + m]
            work[link, j.GAIN + i] -= total

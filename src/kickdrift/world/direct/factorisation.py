"""The matrix of an island, eliminated node by node.

The equations are H v = b for the changes v of the velocities of all nodes, six numbers each. H is the sum of the inertia of the
bodies and, for each active row of a contact or of a closing joint, its stiffness times its two wrenches, J^T D J. Joints of the
tree are not rows: a link moves with its parent except along the open axes, so that its own velocity is replaced,
v = X (v of the parent) + open axes, and its row of the matrix added to that of its parent by X^T. Without contacts that is the
articulated-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 7.3), exact for locked axes at any ratio
of masses and linear in the number of joints; neighbours that contacts and loops add are carried along as fill, as in any
sparse factorisation. Free nodes are eliminated by blocks.

Velocities act at the end of the substep, impulses at its start, so that X and X^T have arms of their own (`AHEAD`) and H is not
quite symmetric. Moving the point of reference of a block from O to P, with s = O - P: to each row's angular part s x its linear
part is added, and then the same to each column's.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.spatial import plus_scaled, put_spatial, scaled, spatial_at
from kickdrift.core.vectors import Vector, dot, times
from kickdrift.world.columns import vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.blocks import (
    add_block,
    add_scaled,
    block_at,
    move_impulses,
    move_velocities,
    put_block,
    rows_along,
)
from kickdrift.world.direct.loop_closures import has_loops
from kickdrift.world.direct.matrix import block_of
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.kinematics import put_vector
from kickdrift.world.tables import BLOCK, JOINT_NUMBERS, LINK, LINK_NUMBERS, NEIGHBOUR, NODE, floats, integers


@compiled(inline=True, cached=False, fast=True)
def arms(table: Any, row: int, column_a: int, column_b: int, sign: int) -> tuple[Vector, Vector]:
    """Return the vectors from the centres of mass of a link and of its parent to their joint."""
    if sign > 0:
        return vector_at(table, row, column_b), vector_at(table, row, column_a)
    return vector_at(table, row, column_a), vector_at(table, row, column_b)


@compiled(cached=False, fast=True)
def factor(world: int, first: int, after: int) -> None:
    """Eliminate the nodes of an island in their order."""
    nodes, links = integers(world, NODE), integers(world, LINK)
    for node in range(first, after):
        if links[nodes[node, d.LINK_ROW], j.LINK_JOINT] >= 0:
            _eliminate_link(world, node)
        else:
            _eliminate_free(world, node)


@compiled(cached=False, fast=True)
def _eliminate_link(world: int, node: int) -> None:
    """Replace the velocity of a link by that of its parent and its open axes."""
    nodes, links, neighbours = integers(world, NODE), integers(world, LINK), integers(world, NEIGHBOUR)
    work, numbers, blocks = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS), floats(world, BLOCK)
    link, parent = nodes[node, d.LINK_ROW], nodes[node, d.PARENT_NODE]
    joint, begin = links[link, j.LINK_JOINT], nodes[node, d.FIRST_NEIGHBOUR]
    end = begin + nodes[node, d.NEIGHBOURS]
    own, other = arms(numbers, joint, j.ARM_A, j.ARM_B, links[link, j.SIGN])
    own_ahead, other_ahead = arms(work, link, j.ARM_A_AHEAD, j.ARM_B_AHEAD, links[link, j.SIGN])
    own, own_ahead = times(-1.0, own), times(-1.0, own_ahead)
    inertia = move_velocities(block_at(work, link, j.ARTICULATED_INERTIA), own_ahead)
    put_block(work, link, j.ARTICULATED_INERTIA, move_impulses(inertia, own))
    for row in range(begin, end):
        put_block(blocks, row, d.UPPER_BLOCK, move_impulses(block_at(blocks, row, d.UPPER_BLOCK), own))
        put_block(blocks, row, d.LOWER_BLOCK, move_velocities(block_at(blocks, row, d.LOWER_BLOCK), own_ahead))
    for k in range(6):
        work[link, j.YIELD + k] = 0.0
        if not links[link, j.HELD_AXES] >> k & 1:
            _eliminate_axis(world, node, link, joint, k, begin, end)
    if parent < 0:
        return
    above = nodes[parent, d.LINK_ROW]
    inertia = move_velocities(block_at(work, link, j.ARTICULATED_INERTIA), other_ahead)
    add_block(work, above, j.ARTICULATED_INERTIA, move_impulses(inertia, other))
    for row in range(begin, end):
        _hand_up(world, row, neighbours[row, 0], parent, other, other_ahead)


@compiled(cached=False, fast=True)
def _hand_up(world: int, row: int, neighbour: int, parent: int, other: Vector, other_ahead: Vector) -> None:
    """Couple the parent of a link to a neighbour of the link."""
    blocks = floats(world, BLOCK)
    if neighbour == parent:
        table, target = floats(world, LINK_NUMBERS), integers(world, NODE)[parent, d.LINK_ROW]
        to, back = j.ARTICULATED_INERTIA, j.ARTICULATED_INERTIA
    else:
        table, target = blocks, block_of(world, min(parent, neighbour), max(parent, neighbour))
        to, back = (d.UPPER_BLOCK, d.LOWER_BLOCK) if parent < neighbour else (d.LOWER_BLOCK, d.UPPER_BLOCK)
    add_block(table, target, to, move_impulses(block_at(blocks, row, d.UPPER_BLOCK), other))
    add_block(table, target, back, move_velocities(block_at(blocks, row, d.LOWER_BLOCK), other_ahead))


@compiled(inline=True, cached=False, fast=True)
def _columns_along(work: Any, link: int, at: int, axis: Vector) -> Vector:
    """Return the product of three columns of three rows of the inertia with an axis, in registers."""
    first = j.ARTICULATED_INERTIA + at
    return (
        dot(axis, vector_at(work, link, first)),
        dot(axis, vector_at(work, link, first + 6)),
        dot(axis, vector_at(work, link, first + 12)),
    )


@compiled(cached=False, fast=True)
def _eliminate_axis(world: int, node: int, link: int, joint: int, k: int, begin: int, end: int) -> None:
    """Eliminate an open axis of a joint from the inertia of the bodies attached to it, and from its coupling to neighbours."""
    work, numbers, blocks = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS), floats(world, BLOCK)
    axis, ahead = vector_at(numbers, joint, j.AXES + 3 * k), vector_at(work, link, j.AXES_AHEAD + 3 * k)
    half = 0 if k < 3 else 3
    row, column = j.PASSING + 6 * k, j.COUPLING + 6 * k
    along = rows_along(work, link, j.ARTICULATED_INERTIA + 6 * half, axis)
    put_spatial(work, link, row, along)
    push, turn = _columns_along(work, link, half, ahead), _columns_along(work, link, 18 + half, ahead)
    put_vector(work, link, column, push)
    put_vector(work, link, column + 3, turn)
    stiff = dot(axis, push if k < 3 else turn) + work[link, j.SLOPE + k]
    # Below zero where a loop passes a dead point: its impulses of the start then act against its velocities of the end.
    island = integers(world, NODE)[node, d.NODE_ISLAND]
    give = 1.0 / stiff if stiff > 0.0 or (stiff < 0.0 and has_loops(world, island)) else 0.0
    work[link, j.YIELD + k] = give
    for i in range(3):
        add_scaled(work, link, j.ARTICULATED_INERTIA + 6 * i, -give * push[i], along)
        add_scaled(work, link, j.ARTICULATED_INERTIA + 18 + 6 * i, -give * turn[i], along)
    if begin == end:
        return
    for block in range(begin, end):
        put_spatial(blocks, block, d.BLOCK_PASSING + 6 * k, rows_along(blocks, block, d.UPPER_BLOCK + 6 * half, axis))
        for i in range(6):
            blocks[block, d.BLOCK_COUPLING + 6 * k + i] = dot(
                ahead, vector_at(blocks, block, d.LOWER_BLOCK + 6 * i + half)
            )
    for block in range(begin, end):
        passing = spatial_at(blocks, block, d.BLOCK_PASSING + 6 * k)
        for i in range(6):
            add_scaled(blocks, block, d.UPPER_BLOCK + 6 * i, -give * work[link, column + i], passing)
            coupling = blocks[block, d.BLOCK_COUPLING + 6 * k + i]
            add_scaled(blocks, block, d.LOWER_BLOCK + 6 * i, -give * coupling, along)
    for one in range(begin, end):
        for two in range(begin, end):
            _subtract(world, one, two, d.BLOCK_COUPLING + 6 * k, d.BLOCK_PASSING + 6 * k, give, 1)


@compiled(inline=True, cached=False, fast=True)
def _subtract_product(
    m: Any, row: int, at: int, blocks: Any, one: int, two: int, left: int, right: int, factor_: float, inner: int
) -> None:
    for i in range(6):
        total = spatial_at(m, row, at + 6 * i)
        for k in range(inner):
            share = factor_ * blocks[one, left + inner * i + k]
            total = plus_scaled(total, -share, spatial_at(blocks, two, right + 6 * k))
        put_spatial(m, row, at + 6 * i, total)


@compiled(cached=False, fast=True)
def _subtract(world: int, one: int, two: int, left: int, right: int, factor_: float, inner: int) -> None:
    """Subtract from the block of two neighbours the product of the blocks that couple a node to both.

    The blocks are 6 x `inner` and `inner` x 6, from the columns `left` and `right` on.
    """
    neighbours, nodes, blocks = integers(world, NEIGHBOUR), integers(world, NODE), floats(world, BLOCK)
    a, b = neighbours[one, 0], neighbours[two, 0]
    if a == b:
        work, link = floats(world, LINK_NUMBERS), nodes[a, d.LINK_ROW]
        _subtract_product(work, link, j.ARTICULATED_INERTIA, blocks, one, two, left, right, factor_, inner)
        return
    target, to = block_of(world, min(a, b), max(a, b)), d.UPPER_BLOCK if a < b else d.LOWER_BLOCK
    _subtract_product(blocks, target, to, blocks, one, two, left, right, factor_, inner)


@compiled(cached=False, fast=True)
def _eliminate_free(world: int, node: int) -> None:
    """Eliminate a node by blocks: its matrix is factored in place, without pivots, since it is all but symmetric."""
    nodes, work, blocks = integers(world, NODE), floats(world, LINK_NUMBERS), floats(world, BLOCK)
    link, begin = nodes[node, d.LINK_ROW], nodes[node, d.FIRST_NEIGHBOUR]
    end = begin + nodes[node, d.NEIGHBOURS]
    for k in range(6):
        pivot = work[link, j.ARTICULATED_INERTIA + 7 * k]
        work[link, j.ARTICULATED_INERTIA + 7 * k] = 1.0 / pivot if pivot > 0.0 else 0.0
        for i in range(k + 1, 6):
            share = work[link, j.ARTICULATED_INERTIA + 6 * i + k] * work[link, j.ARTICULATED_INERTIA + 7 * k]
            work[link, j.ARTICULATED_INERTIA + 6 * i + k] = share
            for m in range(k + 1, 6):
                work[link, j.ARTICULATED_INERTIA + 6 * i + m] -= share * work[link, j.ARTICULATED_INERTIA + 6 * k + m]
    for block in range(begin, end):
        for i in range(6):
            for k in range(i):
                share = work[link, j.ARTICULATED_INERTIA + 6 * i + k]
                add_scaled(
                    blocks, block, d.UPPER_BLOCK + 6 * i, -share, spatial_at(blocks, block, d.UPPER_BLOCK + 6 * k)
                )
        for i in range(5, -1, -1):
            for k in range(i + 1, 6):
                share = work[link, j.ARTICULATED_INERTIA + 6 * i + k]
                add_scaled(
                    blocks, block, d.UPPER_BLOCK + 6 * i, -share, spatial_at(blocks, block, d.UPPER_BLOCK + 6 * k)
                )
            upper = scaled(work[link, j.ARTICULATED_INERTIA + 7 * i], spatial_at(blocks, block, d.UPPER_BLOCK + 6 * i))
            put_spatial(blocks, block, d.UPPER_BLOCK + 6 * i, upper)
    for one in range(begin, end):
        for two in range(begin, end):
            _subtract(world, one, two, d.LOWER_BLOCK, d.UPPER_BLOCK, 1.0, 6)

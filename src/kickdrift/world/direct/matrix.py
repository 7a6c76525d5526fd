"""Assembly of the matrix of an island: inertias of bodies, and rows times their stiffness.

Stiffnesses, or the inverse of the compliance, are set where the rows are: in `contact_rows`, `loop_closures` and the joints.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.spatial import spatial_of
from kickdrift.core.vectors import Symmetric, cross, inverse_symmetric, plus, times
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.blocks import add_scaled
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.kinematics import put_vector
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, INVERSE_LINEAR_MASS
from kickdrift.world.tables import BLOCK, INVERSE_MASS, LINK, LINK_NUMBERS, MOTION, NEIGHBOUR, NODE, floats, integers

# Ratio by which the inertia about locked axes exceeds the mass or the other moments. With 1e8, both the rotation about these
# axes and the rounding errors are parts in 1e8, which the next substep corrects.
_IMMOVABLE = 1e8


@compiled(inline=True, cached=False, fast=True)
def _divided(s: Symmetric, divisor: float) -> Symmetric:
    """Divide a symmetric matrix by a number."""
    return (s[0] / divisor, s[1] / divisor, s[2] / divisor, s[3] / divisor, s[4] / divisor, s[5] / divisor)


@compiled(inline=True, cached=False, fast=True)
def _about_one_axis(w: Symmetric, trace: float) -> Symmetric:
    """Return the moments of a body whose inverse moments w, with this trace, are those about one axis u alone: w = trace u u^T.

    With the other inverse moments raised from zero, the cofactor along u would be their square, and smaller than rounding.
    """
    immovable = _IMMOVABLE / trace
    part = (1.0 / trace - immovable) / trace
    return (
        immovable + part * w[0], immovable + part * w[1], immovable + part * w[2], part * w[3], part * w[4], part * w[5]
    )  # fmt: skip


@compiled(cached=False, fast=True)
def put_inertia(world: int, link: int, ahead: float) -> None:
    """Write the 6 x 6 inertia of the body of a link about its centre of mass, for velocities that act for a time `ahead`, s.

    A change dw of its angular velocity w turns it, after a time h, by h T dw with T = 1 + h w x / 2 + ...: velocities
    ahead are T dw, and the inertia is I T^-1, where T^-1 = 1 - h w x / 2 + (h w x)^2 / 12 up to h^4. For a
    `CORRECTION` all bodies have unit mass, so that light ones are not moved far on behalf of heavy ones.
    """
    work, response = floats(world, LINK_NUMBERS), floats(world, INVERSE_MASS)
    body = integers(world, LINK)[link, j.LINK_BODY]
    for k in range(36):
        work[link, j.ARTICULATED_INERTIA + k] = 0.0
    w = symmetric_at(response, body, INVERSE_INERTIA_IN_WORLD)
    trace = w[0] + w[1] + w[2]
    mass = (
        1.0 / response[body, INVERSE_LINEAR_MASS] if response[body, INVERSE_LINEAR_MASS] > 0.0 else _IMMOVABLE / trace
    )
    if trace > 0.0:
        c = cross((w[3], w[1], w[5]), (w[4], w[5], w[2]))
        minors = w[0] * w[1] + w[1] * w[2] + w[2] * w[0] - w[3] * w[3] - w[4] * w[4] - w[5] * w[5]
        if minors < trace * trace / _IMMOVABLE:
            moments = _about_one_axis(w, trace)
        else:
            if w[0] * c[0] + w[3] * c[1] + w[4] * c[2] < 1e-14 * trace * trace * trace:
                least = trace / _IMMOVABLE
                w = (w[0] + least, w[1] + least, w[2] + least, w[3], w[4], w[5])
            moments = inverse_symmetric(w)
    else:
        immovable = _IMMOVABLE * mass
        moments = (immovable, immovable, immovable, 0.0, 0.0, 0.0)
    if ahead == d.CORRECTION:
        mass, moments = 1.0, _divided(moments, mass)
    turn = times(max(ahead, 0.0), vector_at(floats(world, MOTION), body, j.ANGULAR_PART))
    for k in range(3):
        work[link, j.ARTICULATED_INERTIA + 7 * k] = mass
        row = (moments[3], moments[1], moments[5]) if k == 1 else (moments[4], moments[5], moments[2])
        row = (moments[0], moments[3], moments[4]) if k == 0 else row
        once = cross(turn, row)
        row = plus(row, plus(times(0.5, once), times(1.0 / 12.0, cross(turn, once))))
        put_vector(work, link, j.ARTICULATED_INERTIA + 21 + 6 * k, row)


@compiled(cached=False, fast=True)
def clear_blocks(world: int, first: int, after: int) -> None:
    """Set the blocks that couple the nodes of an island to zero."""
    nodes, blocks = integers(world, NODE), floats(world, BLOCK)
    for node in range(first, after):
        begin = nodes[node, d.FIRST_NEIGHBOUR]
        for row in range(begin, begin + nodes[node, d.NEIGHBOURS]):
            for k in range(72):
                blocks[row, k] = 0.0


@compiled(cached=False, fast=True)
def block_of(world: int, a: int, b: int) -> int:
    """Return the row of the block of two neighbours, of which a is eliminated first."""
    nodes, neighbours = integers(world, NODE), integers(world, NEIGHBOUR)
    row: int = nodes[a, d.FIRST_NEIGHBOUR]
    while neighbours[row, 0] != b:
        row += 1
    return row


@compiled(cached=False, fast=True)
def add_row(world: int, a: int, b: int, stiffness: float, start: Any, ahead: Any) -> None:
    """Add the product of the stiffness and both wrenches of a row to the matrix.

    Parameters
    ----------
    a, b : int
        Nodes of both bodies; -1 for an immovable one.
    stiffness : float
        Impulse per change of speed.
    start, ahead : (12,) array
        Wrench of a unit impulse at the start of the substep, and derivative of the speed by the velocities at its end.
    """
    nodes, work = integers(world, NODE), floats(world, LINK_NUMBERS)
    for side in range(2):
        node = b if side == 1 else a
        if node >= 0:
            link = nodes[node, d.LINK_ROW]
            speeds = spatial_of(ahead, 6 * side)
            for i in range(6):
                add_scaled(work, link, j.ARTICULATED_INERTIA + 6 * i, stiffness * start[6 * side + i], speeds)
    if a >= 0 and b >= 0:
        blocks = floats(world, BLOCK)
        row, upper, lower = block_of(world, min(a, b), max(a, b)), d.UPPER_BLOCK, d.LOWER_BLOCK
        if b < a:
            upper, lower = d.LOWER_BLOCK, d.UPPER_BLOCK
        speeds_of_a, speeds_of_b = spatial_of(ahead, 0), spatial_of(ahead, 6)
        for i in range(6):
            add_scaled(blocks, row, upper + 6 * i, stiffness * start[i], speeds_of_b)
            add_scaled(blocks, row, lower + 6 * i, stiffness * start[6 + i], speeds_of_a)

"""The inertia of bodies as their joints feel it: what it is, and more where a light body hangs between great forces.

A body that is pulled at its ends by F swings about with frequency sqrt(K / I), K = h^2 (r . F 1 - r F^T) for an arm r: the
geometric stiffness of its joints. Substeps too long to follow that, h^2 K > 4 I, would let it grow without bound, as for the
light links of a chain with a heavy end. Only there, as much as it takes of h^2 K / 4 is added to the inertia: with all of it
the swing is that of the implicit midpoint rule, without damping and for any h. Momentum is kept, angular momentum in proportion
to what is added. Tournier, Nesme, Gilles, Faure, ACM Trans. Graph. 34 (2015) 132; Andrews, Teichmann, Kry, Comput. Graph.
Forum 36 (2017) 235.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, inverse_symmetric, length, plus, times
from kickdrift.world.joints.layout import (
    ARM_A,
    ARM_B,
    AXES,
    BODY,
    END,
    FIRST,
    LINK_A,
    LINK_JOINT,
    LINKS,
    MOMENTS,
    PULL,
    SEQUENTIAL,
    TURN_RESPONSE,
    TURNING,
)
from kickdrift.world.joints.measure import symmetric_at, vector_at
from kickdrift.world.tables import ARTICULATION, JOINT_NUMBERS, LINK, LINK_NUMBERS, RESPONSE, floats, integers, rows

# Of bodies that cannot turn, or turn about some axes only, as if they were heavier than they are: with 1e8, what they then
# turn and what is lost to rounding are both parts in 1e8, which the next substep corrects.
IMMOVABLE = 1e8


@compiled
def weigh_links(t: float, h: float, world: int) -> None:
    """Fill in the inertia of all links as they stand."""
    articulations: Any = integers(world, ARTICULATION)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, SEQUENTIAL] == 0:
            weigh(articulations[row, FIRST], articulations[row, LINKS], articulations[row, END], h, world)


@compiled(cached=False)
def weigh(first: int, count: int, after: int, h: float, world: int) -> None:
    """Fill in the inertia of the links of an articulation."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    for link in range(first, after):
        for k in range(6):
            work[link, MOMENTS + k] = 0.0
    for link in range(first, after):
        joint = links[link, LINK_JOINT]
        if joint < 0:
            continue
        force = (0.0, 0.0, 0.0)
        for k in range(3):
            force = plus(force, times(h * numbers[joint, PULL + k], vector_at(numbers, joint, AXES + 3 * k)))
        for side in range(2):
            body = links[link, LINK_A + side]
            if body >= 0:
                if side == 1:
                    _add_stiffness(work, body, vector_at(numbers, joint, ARM_B), force)
                else:
                    _add_stiffness(work, body, vector_at(numbers, joint, ARM_A), times(-1.0, force))
    for link in range(first, min(after, first + count)):
        _weigh_link(link, world)


@compiled(inline=True, cached=False)
def _add_stiffness(work: Any, link: int, arm: Vector, force: Vector) -> None:
    """Add a bound of h^2 K from above that pushes nothing: its greatest eigenvalue, but none about the mean direction."""
    size = length(arm) * length(force)
    least = 0.5 * (dot(arm, force) + size)
    if not least > 1e-9 * size:
        return
    along = plus(times(1.0 / length(arm), arm), times(1.0 / length(force), force))
    share = least / dot(along, along)
    for k in range(3):
        work[link, MOMENTS + k] += least - share * along[k] * along[k]
    work[link, MOMENTS + 3] -= share * along[0] * along[1]
    work[link, MOMENTS + 4] -= share * along[0] * along[2]
    work[link, MOMENTS + 5] -= share * along[1] * along[2]


@compiled(cached=False)
def _weigh_link(link: int, world: int) -> None:
    """Replace the geometric stiffness of a link by its inertia, with what has to be added."""
    work, response = floats(world, LINK_NUMBERS), floats(world, RESPONSE)
    body = integers(world, LINK)[link, BODY]
    w = symmetric_at(response, body, TURN_RESPONSE)
    stiff = symmetric_at(work, link, MOMENTS)
    own = w
    ratio = w[0] * stiff[0] + w[1] * stiff[1] + w[2] * stiff[2]
    ratio += 2.0 * (w[3] * stiff[3] + w[4] * stiff[4] + w[5] * stiff[5])
    trace = w[0] + w[1] + w[2]
    if trace > 0.0:
        c = cross((w[3], w[1], w[5]), (w[4], w[5], w[2]))
        if w[0] * c[0] + w[3] * c[1] + w[4] * c[2] < 1e-14 * trace * trace * trace:
            least = trace / IMMOVABLE
            w = (w[0] + least, w[1] + least, w[2] + least, w[3], w[4], w[5])
        moments = inverse_symmetric(w)
    else:
        turn = IMMOVABLE / response[body, 0]
        moments = (turn, turn, turn, 0.0, 0.0, 0.0)
    if ratio > 1.0:
        share = 0.25 * (1.0 - 1.0 / ratio)
        moments = (
            moments[0] + share * stiff[0], moments[1] + share * stiff[1], moments[2] + share * stiff[2],
            moments[3] + share * stiff[3], moments[4] + share * stiff[4], moments[5] + share * stiff[5],
        )  # fmt: skip
        own = inverse_symmetric(moments)
    for k in range(6):
        work[link, MOMENTS + k] = moments[k]
        work[link, TURNING + k] = own[k]

"""All joints of a tree of bodies at once: two sweeps over the tree, exact and linear in the number of joints.

The first goes from the leaves to the root and eliminates bodies and open axes: what is left of a subtree is the inertia that
the other side of its joint feels, 6x6, and the impulse that the joint passes on if that side stays as it is. The second
goes back and finds the changes of velocity. Locked axes take no equations, so nothing can be redundant, and no ratio of
masses makes them any softer. Featherstone, Rigid Body Dynamics Algorithms (2008), section 7.3, in maximal coordinates; as
an elimination in block order it is the one of Baraff, SIGGRAPH 96.

Moving the point of reference of inertia A, B, B^T, C (impulse = A v + B w, angular impulse = B^T v + C w) from O to P, with
s = O - P: to each row's angular part s x its linear part is added, and then the same to each column's.
"""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Symmetric, Vector, cross, dot, inverse_symmetric, minus, plus, times
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.joints.layout import (
    ANGULAR_PART,
    ARM_A,
    ARM_A_AHEAD,
    ARM_B,
    ARM_B_AHEAD,
    AXES,
    AXES_AHEAD,
    BODY,
    CHANGE,
    COUPLING,
    GAIN,
    HELD,
    IMPACT,
    INERTIA,
    LINK_JOINT,
    LOAD,
    MOVED,
    PARENT,
    PASSING,
    PUSH,
    SIGN,
    SLOPE,
    TURN_RESPONSE,
    WRENCH,
    YIELD,
    int64,
)
from kickdrift.world.joints.measure import put_vector
from kickdrift.world.tables import JOINT_NUMBERS, LINK, LINK_NUMBERS, MOTION, RESPONSE, floats, integers

# Of bodies that cannot turn, or turn about some axes only, as if they were heavier than they are: with 1e8, what they
# then turn and what is lost to rounding are both parts in 1e8, which the next substep corrects.
_IMMOVABLE = 1e8

_ONLY = int64(0)  # row of a buffer


@compiled(inline=True, cached=False)
def arms(table: Any, row: int, column_a: int, column_b: int, sign: int) -> tuple[Vector, Vector]:
    """From the centre of mass of a link and of its parent to their joint."""
    if sign > 0:
        return vector_at(table, row, column_b), vector_at(table, row, column_a)
    return vector_at(table, row, column_a), vector_at(table, row, column_b)


@compiled(inline=True, cached=False)
def _move(m: Any, row: int, s: Vector, ahead: Vector) -> None:
    """Move the point of reference of a 6x6 inertia by -s, and that of the velocities by another arm."""
    for i in range(6):
        turn = cross(ahead, vector_at(m, row, 6 * i))
        for k in range(3):
            m[row, 6 * i + 3 + k] += turn[k]
    for j in range(6):
        turn = cross(s, (m[row, j], m[row, 6 + j], m[row, 12 + j]))
        m[row, 18 + j] += turn[0]
        m[row, 24 + j] += turn[1]
        m[row, 30 + j] += turn[2]


@compiled(inline=True, cached=False)
def divided(s: Symmetric, divisor: float) -> Symmetric:
    """Divide a symmetric matrix by a number."""
    return (s[0] / divisor, s[1] / divisor, s[2] / divisor, s[3] / divisor, s[4] / divisor, s[5] / divisor)


@compiled(cached=False)
def _own_inertia(link: int, ahead: float, world: int) -> None:
    """Fill in the inertia of the body alone, about its centre of mass.

    A change dw of its angular velocity w turns it, after a time h, by h T dw with T = 1 + h w x / 2 + ...: velocities
    ahead are T dw, and the inertia is I T^-1, where T^-1 = 1 - h w x / 2 + (h w x)^2 / 12 up to h^4. A negative time is for
    changes of position alone: then all bodies weigh the same, so that light ones are not thrown about for heavy ones.
    """
    work, response = floats(world, LINK_NUMBERS), floats(world, RESPONSE)
    body = integers(world, LINK)[link, BODY]
    for k in range(36):
        work[link, INERTIA + k] = 0.0
    w = symmetric_at(response, body, TURN_RESPONSE)
    trace = w[0] + w[1] + w[2]
    mass = 1.0 / response[body, 0] if response[body, 0] > 0.0 else _IMMOVABLE / trace
    if trace > 0.0:
        c = cross((w[3], w[1], w[5]), (w[4], w[5], w[2]))
        if w[0] * c[0] + w[3] * c[1] + w[4] * c[2] < 1e-14 * trace * trace * trace:
            least = trace / _IMMOVABLE
            w = (w[0] + least, w[1] + least, w[2] + least, w[3], w[4], w[5])
        moments = inverse_symmetric(w)
    else:
        immovable = _IMMOVABLE * mass
        moments = (immovable, immovable, immovable, 0.0, 0.0, 0.0)
    if ahead < 0.0:
        mass, moments, ahead = 1.0, divided(moments, mass), 0.0
    turn = times(ahead, vector_at(floats(world, MOTION), body, ANGULAR_PART))
    for k in range(3):
        work[link, INERTIA + 7 * k] = mass
        row = (moments[3], moments[1], moments[5]) if k == 1 else (moments[4], moments[5], moments[2])
        row = (moments[0], moments[3], moments[4]) if k == 0 else row
        once = cross(turn, row)
        row = plus(row, plus(times(0.5, once), times(1.0 / 12.0, cross(turn, once))))
        put_vector(work, link, INERTIA + 21 + 6 * k, row)


@compiled(cached=False)
def factor(first: int, count: int, ahead: float, world: int) -> None:
    """Eliminate bodies and open axes from the leaves to the root, for velocities that act for a time `ahead`."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    moved = carray(floats_on_stack(36), (1, 36))
    for link in range(first, first + count):
        _own_inertia(link, ahead, world)
    for link in range(first + count - 1, first - 1, -1):
        joint, parent = links[link, LINK_JOINT], links[link, PARENT]
        if joint < 0:
            _factor_free(link, world)
            continue
        own, other = arms(numbers, joint, ARM_A, ARM_B, links[link, SIGN])
        own_ahead, other_ahead = arms(work, link, ARM_A_AHEAD, ARM_B_AHEAD, links[link, SIGN])
        _move(work, link, times(-1.0, own), times(-1.0, own_ahead))
        _eliminate(link, joint, links[link, HELD], world)
        if parent >= 0:
            for k in range(36):
                moved[_ONLY, k] = work[link, INERTIA + k]
            _move(moved, _ONLY, other, other_ahead)
            for k in range(36):
                work[parent, INERTIA + k] += moved[_ONLY, k]


@compiled(cached=False)
def _eliminate(link: int, joint: int, held: int, world: int) -> None:
    """Take the open axes of a joint out of the inertia of what hangs on it."""
    work, numbers = floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    for k in range(6):
        work[link, YIELD + k] = 0.0
        if held >> k & 1:
            continue
        axis, ahead = vector_at(numbers, joint, AXES + 3 * k), vector_at(work, link, AXES_AHEAD + 3 * k)
        half = 0 if k < 3 else 3
        row, column = PASSING + 6 * k, COUPLING + 6 * k
        for j in range(6):
            work[link, row + j] = (
                axis[0] * work[link, INERTIA + 6 * half + j]
                + axis[1] * work[link, INERTIA + 6 * half + 6 + j]
                + axis[2] * work[link, INERTIA + 6 * half + 12 + j]
            )
        for i in range(6):
            work[link, column + i] = dot(ahead, vector_at(work, link, INERTIA + 6 * i + half))
        stiff = dot(ahead, vector_at(work, link, row + half)) + work[link, SLOPE + k]
        give = 1.0 / stiff if stiff > 0.0 else 0.0
        work[link, YIELD + k] = give
        for i in range(6):
            share = give * work[link, column + i]
            for j in range(6):
                work[link, INERTIA + 6 * i + j] -= share * work[link, row + j]


@compiled(cached=False)
def _factor_free(link: int, world: int) -> None:
    """Factor the inertia of a tree that floats in place, without pivots: it is all but symmetric."""
    work = floats(world, LINK_NUMBERS)
    for k in range(6):
        pivot = work[link, INERTIA + 7 * k]
        work[link, INERTIA + 7 * k] = 1.0 / pivot if pivot > 0.0 else 0.0
        for i in range(k + 1, 6):
            share = work[link, INERTIA + 6 * i + k] * work[link, INERTIA + 7 * k]
            work[link, INERTIA + 6 * i + k] = share
            for j in range(k + 1, 6):
                work[link, INERTIA + 6 * i + j] -= share * work[link, INERTIA + 6 * k + j]


@compiled(inline=True, cached=False)
def solve_free(work: Any, link: int) -> None:
    """Change of velocity of the root of a tree that floats."""
    for i in range(6):
        total = -work[link, IMPACT + i]
        for k in range(i):
            total -= work[link, INERTIA + 6 * i + k] * work[link, GAIN + k]
        work[link, GAIN + i] = total
    for i in range(5, -1, -1):
        total = work[link, GAIN + i]
        for k in range(i + 1, 6):
            total -= work[link, INERTIA + 6 * i + k] * work[link, GAIN + k]
        work[link, GAIN + i] = total * work[link, INERTIA + 7 * i]


@compiled(cached=False)
def sweep(first: int, count: int, weight: float, world: int) -> None:
    """Find the changes of velocity and the impulses at the joints, for the loads on the bodies.

    With a weight of zero instead of one, joints pass on loads and do nothing of their own.
    """
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    for link in range(first, first + count):
        for k in range(6):
            work[link, IMPACT + k] = -work[link, LOAD + k]
    for link in range(first + count - 1, first - 1, -1):
        joint, parent = links[link, LINK_JOINT], links[link, PARENT]
        if joint >= 0:
            own, other = arms(numbers, joint, ARM_A, ARM_B, links[link, SIGN])
            _gather(link, joint, own, weight, world)
            if parent >= 0:
                push = vector_at(work, link, IMPACT)
                turn = plus(vector_at(work, link, IMPACT + 3), cross(other, push))
                for k in range(3):
                    work[parent, IMPACT + k] += push[k]
                    work[parent, IMPACT + 3 + k] += turn[k]
    for link in range(first, first + count):
        joint, parent = links[link, LINK_JOINT], links[link, PARENT]
        if joint < 0:
            solve_free(work, link)
        else:
            own, other = arms(work, link, ARM_A_AHEAD, ARM_B_AHEAD, links[link, SIGN])
            v, w = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
            if parent >= 0:
                w = vector_at(work, parent, GAIN + 3)
                v = plus(vector_at(work, parent, GAIN), cross(w, other))
            _spread(link, joint, own, v, w, world)


@compiled(cached=False)
def _gather(link: int, joint: int, own: Vector, weight: float, world: int) -> None:
    """Impulse that a joint passes on if its other side stays as it is, about the point where it acts."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    held, sign = links[link, HELD], weight * links[link, SIGN]
    push = vector_at(work, link, IMPACT)
    put_vector(work, link, IMPACT + 3, minus(vector_at(work, link, IMPACT + 3), cross(own, push)))
    for k in range(6):
        work[link, GAIN + k] = 0.0
    for k in range(6):
        axis, half = vector_at(numbers, joint, AXES + 3 * k), 0 if k < 3 else 3
        if held >> k & 1:
            ahead = vector_at(work, link, AXES_AHEAD + 3 * k)
            for i in range(3):
                work[link, GAIN + half + i] += sign * work[link, CHANGE + k] * ahead[i]
        else:
            extra = sign * work[link, PUSH + k] - dot(axis, vector_at(work, link, IMPACT + half))
            work[link, MOVED + k] = extra
            extra *= work[link, YIELD + k]
            for i in range(6):
                work[link, IMPACT + i] += extra * work[link, COUPLING + 6 * k + i]
    _add_product(work, link, GAIN, IMPACT)


@compiled(inline=True, cached=False)
def _add_product(work: Any, link: int, source: int, target: int) -> None:
    """Add to six numbers the inertia of a link times six others."""
    for i in range(6):
        total = 0.0
        for j in range(6):
            total += work[link, INERTIA + 6 * i + j] * work[link, source + j]
        work[link, target + i] += total


@compiled(cached=False)
def _spread(link: int, joint: int, own: Vector, v: Vector, w: Vector, world: int) -> None:
    """Change of velocity of a link, from that of the other side of its joint, and the impulse at the joint."""
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    held, sign = links[link, HELD], links[link, SIGN]
    for k in range(6):
        work[link, WRENCH + k] = work[link, IMPACT + k]
    wanted = (vector_at(work, link, GAIN), vector_at(work, link, GAIN + 3))
    put_vector(work, link, GAIN, v)
    put_vector(work, link, GAIN + 3, w)
    _add_product(work, link, GAIN, WRENCH)
    put_vector(work, link, GAIN, plus(v, wanted[0]))
    put_vector(work, link, GAIN + 3, plus(w, wanted[1]))
    for k in range(5, -1, -1):
        if held >> k & 1:
            continue
        extra = work[link, MOVED + k]
        for i in range(6):
            extra -= work[link, PASSING + 6 * k + i] * work[link, GAIN + i]
        extra *= work[link, YIELD + k]
        work[link, MOVED + k] = sign * extra
        ahead, half = vector_at(work, link, AXES_AHEAD + 3 * k), 0 if k < 3 else 3
        for i in range(3):
            work[link, GAIN + half + i] += extra * ahead[i]
    turn = vector_at(work, link, GAIN + 3)
    put_vector(work, link, GAIN, plus(vector_at(work, link, GAIN), cross(own, turn)))

"""How an articulation answers an impulse on one of its links: along the way to the root and back, by the factors at hand.

What `kickdrift.world.joints.articulated.sweep` does for all links at once is linear in the impulses. So those of one contact
after the other are carried up to the root, each joint keeping what it is asked (`STIRRED`), and the velocity of a link is
found when its next contact needs it, along its own way down.
"""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.joints.articulated import arms, solve_free
from kickdrift.world.joints.layout import (
    ARM_A,
    ARM_A_AHEAD,
    ARM_B,
    ARM_B_AHEAD,
    AXES,
    AXES_AHEAD,
    CHILD,
    COUPLING,
    GAIN,
    IMPACT,
    LINK_JOINT,
    PARENT,
    PASSING,
    SIGN,
    STIRRED,
    YIELD,
)
from kickdrift.world.tables import JOINT_NUMBERS, LINK, LINK_NUMBERS, floats, integers


@compiled(cached=False)
def carry_up(link: int, push: Vector, turn: Vector, world: int) -> None:
    """Let an impulse and an angular impulse act on a link at its centre of mass."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    p, t = times(-1.0, push), times(-1.0, turn)
    while link >= 0:
        joint = links[link, LINK_JOINT]
        if joint < 0:
            for k in range(3):
                work[link, IMPACT + k] += p[k]
                work[link, IMPACT + 3 + k] += t[k]
            return
        own, other = arms(numbers, joint, ARM_A, ARM_B, links[link, SIGN])
        t = minus(t, cross(own, p))
        for k in range(6):
            if work[link, YIELD + k] > 0.0:
                asked = -dot(vector_at(numbers, joint, AXES + 3 * k), p if k < 3 else t)
                work[link, STIRRED + k] += asked
                asked *= work[link, YIELD + k]
                p = plus(p, times(asked, vector_at(work, link, COUPLING + 6 * k)))
                t = plus(t, times(asked, vector_at(work, link, COUPLING + 6 * k + 3)))
        t = plus(t, cross(other, p))
        link = links[link, PARENT]


@compiled(cached=False)
def bring_down(link: int, world: int) -> tuple[Vector, Vector]:
    """Return the change of velocity of a link by all that has been carried up."""
    links, work = integers(world, LINK), floats(world, LINK_NUMBERS)
    at = link
    while links[at, PARENT] >= 0:
        links[links[at, PARENT], CHILD] = at
        at = links[at, PARENT]
    v, w = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if links[at, LINK_JOINT] < 0:
        solve_free(work, at)
        v, w = vector_at(work, at, GAIN), vector_at(work, at, GAIN + 3)
    else:
        v, w = _across(at, v, w, work, links)
    while at != link:
        at = links[at, CHILD]
        v, w = _across(at, v, w, work, links)
    return v, w


@compiled(cached=False)
def _across(link: int, v: Vector, w: Vector, work: Any, links: Any) -> tuple[Vector, Vector]:
    """From the velocity of a link's parent to its own."""
    own, other = arms(work, link, ARM_A_AHEAD, ARM_B_AHEAD, links[link, SIGN])
    v = plus(v, cross(w, other))
    for j in range(6):
        k = 5 - j
        if work[link, YIELD + k] > 0.0:
            row = PASSING + 6 * k
            extra = work[link, STIRRED + k] - dot(vector_at(work, link, row), v)
            extra = work[link, YIELD + k] * (extra - dot(vector_at(work, link, row + 3), w))
            ahead = times(extra, vector_at(work, link, AXES_AHEAD + 3 * k))
            if k < 3:
                v = plus(v, ahead)
            else:
                w = plus(w, ahead)
    return plus(v, cross(own, w)), w

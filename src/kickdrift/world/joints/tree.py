"""Which joints form trees, which close loops in them, and in which order they are solved."""

import heapq
from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.flight import LINK_COUNT, LINK_PLACE, MASS
from kickdrift.world.joints.equations import room_for
from kickdrift.world.joints.layout import (
    BODY,
    BODY_A,
    BODY_B,
    BROKEN,
    CLOSINGS,
    END,
    FIRST,
    KIND,
    LAWS,
    LINK_A,
    LINK_B,
    LINK_JOINT,
    LINKS,
    LOCKED,
    NONE,
    OFFSET,
    PARENT,
    RATIO,
    REMOVED,
    SEQUENTIAL,
    SIGN,
)
from kickdrift.world.tables import (
    ARTICULATION,
    ARTICULATION_NUMBERS,
    INERTIA,
    JOINT,
    LINK,
    LINK_NUMBERS,
    RESPONSE,
    Tables,
)
from kickdrift.world.tables import BODY as BODIES

# Equations of closing joints that an articulation may have; with more, its joints are solved one after the other. A matrix
# of 60 takes 15 us, and a sweep over the tree for each equation more than that where the tree is large.
MOST_EQUATIONS = 60


class _Edge(NamedTuple):
    joint: int
    a: int
    b: int
    weight: int  # locked axes: joints with few of them are better where they close a loop


class _Direct(NamedTuple):
    links: list[list[int]]
    closings: list[list[int]]
    equations: int
    ratio: int


def arrange(tables: Tables) -> None:
    """Write the articulations of a world and their links, for all joints that hold something that moves."""
    edges = _edges(tables)
    direct: list[_Direct] = []
    sequential: list[list[int]] = []
    joints = tables.array(JOINT)
    for members in _components(edges):
        links, closings = _span(members, tables)
        axes = [int(joints[edge.joint, LOCKED] | joints[edge.joint, LAWS]) for edge in closings]
        equations = sum(each.bit_count() for each in axes)
        if equations > MOST_EQUATIONS:
            sequential.append([link[1] for link in links if link[1] != NONE] + [edge.joint for edge in closings])
        else:
            place = {link[0]: k for k, link in enumerate(links)}
            closing = [[edge.joint, place.get(edge.a, NONE), place.get(edge.b, NONE)] for edge in closings]
            masses = tables.array(INERTIA)[[link[0] for link in links], MASS]
            direct.append(_Direct(links, closing, equations, int(np.ceil(masses.max() / masses.min()))))
    _write(tables, direct, sequential)


def _edges(tables: Tables) -> list[_Edge]:
    """Joints that hold something that moves; a body that nothing moves is -1."""
    joints = tables.array(JOINT)
    moves: NDArray[np.bool_] = np.any(tables.array(RESPONSE)[:, :7] != 0.0, axis=1)
    there = np.flatnonzero((joints[:, KIND] != REMOVED) & (joints[:, BROKEN] == 0))
    edges = []
    for joint in there.tolist():
        a, b = (int(body) if moves[body] else NONE for body in joints[joint, [BODY_A, BODY_B]])
        if a != NONE or b != NONE:
            edges.append(_Edge(joint, a, b, int(joints[joint, LOCKED]).bit_count()))
    return edges


def _components(edges: list[_Edge]) -> list[list[_Edge]]:
    """Joints that hang together by bodies that move, in the order of their first joints."""
    root: dict[int, int] = {}

    def find(body: int) -> int:
        while root.setdefault(body, body) != body:
            root[body] = root[root[body]]
            body = root[body]
        return body

    for edge in edges:
        if NONE not in (edge.a, edge.b):
            root[find(edge.a)] = find(edge.b)
    parts: dict[int, list[_Edge]] = {}
    for edge in edges:
        parts.setdefault(find(edge.a if edge.a != NONE else edge.b), []).append(edge)
    return list(parts.values())


def _span(edges: list[_Edge], tables: Tables) -> tuple[list[list[int]], list[_Edge]]:
    """Grow a tree from what nothing moves, or from the heaviest body, along the joints that lock most.

    Returns
    -------
    links : list of [body, joint, parent, sign]
        Parents come first; `parent` counts from the first link.
    closings : list
        The joints that the tree does without.
    """
    at: dict[int, list[_Edge]] = defaultdict(list)
    for edge in edges:
        at[edge.a].append(edge)
        at[edge.b].append(edge)
    links: list[list[int]] = []
    place: dict[int, int] = {NONE: NONE}
    if NONE not in at:
        heaviest = max(at, key=lambda body: (tables.array(INERTIA)[body, MASS], -body))
        links.append([heaviest, NONE, NONE, 1])
        place = {heaviest: 0}
    start = next(iter(place))
    heap = [(-edge.weight, edge.joint, edge) for edge in at[start]]
    heapq.heapify(heap)
    used = set()
    while heap:
        edge = heapq.heappop(heap)[2]
        child, parent, sign = (edge.b, edge.a, 1) if edge.a in place else (edge.a, edge.b, -1)
        if child in place:
            continue
        used.add(edge.joint)
        place[child] = len(links)
        links.append([child, edge.joint, place[parent], sign])
        for further in at[child]:
            if further.joint not in used:
                heapq.heappush(heap, (-further.weight, further.joint, further))
    return links, [edge for edge in edges if edge.joint not in used]


def _write(tables: Tables, direct: list[_Direct], sequential: list[list[int]]) -> None:
    """Fill in the tables; the joints solved one after the other share the last two rows of numbers."""
    table = tables.resize(ARTICULATION, len(direct) + len(sequential))
    size = sum(len(each.links) + len(each.closings) for each in direct)
    tables.resize(LINK_NUMBERS, size + 2 * bool(sequential))
    rows = tables.resize(LINK, size + sum(map(len, sequential)))
    table[:] = 0
    tables.array(LINK_NUMBERS)[:] = 0.0
    tables.array(BODIES)[:, [LINK_PLACE, LINK_COUNT]] = 0
    rows[:] = 0
    rows[:, [PARENT, LINK_A, LINK_B]] = NONE
    first = offset = 0
    for row, (links, closings, equations, ratio) in zip(table, direct, strict=False):
        row[[FIRST, LINKS, CLOSINGS, END, OFFSET, RATIO]] = first, len(links), len(closings), first, offset, ratio
        for k, (body, joint, parent, sign) in enumerate(links, first):
            rows[k, [BODY, LINK_JOINT, SIGN]] = body, joint, sign
            tables.array(BODIES)[body, [LINK_PLACE, LINK_COUNT]] = k + 1, len(links)
            rows[k, PARENT] = NONE if parent == NONE else first + parent
        first += len(links)
        for k, (joint, a, b) in enumerate(closings, first):
            rows[k, [LINK_JOINT, SIGN]] = joint, 1
            rows[k, [LINK_A, LINK_B]] = [NONE if link == NONE else row[FIRST] + link for link in (a, b)]
        first += len(closings)
        offset += room_for(equations)
    for row, members in zip(table[len(direct) :], sequential, strict=True):
        row[[FIRST, LINKS, END, SEQUENTIAL, OFFSET]] = first, len(members), first, 1, size
        rows[first : first + len(members), LINK_JOINT] = members
        first += len(members)
    tables.resize(ARTICULATION_NUMBERS, offset)

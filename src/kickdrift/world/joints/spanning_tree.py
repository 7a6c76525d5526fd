"""Joints that form trees, and joints that close loops in them."""

import heapq
from collections import defaultdict
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.joints import layout as j
from kickdrift.world.layout import LINK_COUNT, LINK_PLACE, MASS
from kickdrift.world.tables import (
    ARTICULATION,
    BODY,
    GRAPH,
    INERTIA,
    INVERSE_MASS,
    JOINT,
    JOINT_NUMBERS,
    LINK,
    LINK_NUMBERS,
    Tables,
)

# Pairs of neighbours that elimination may meet, per node, and of how many nodes at least; with more of them, the joints of an
# articulation are solved one after the other. A pair takes 0.8 us in a step of four substeps: a grid of 8 x 8 balls 2.3 ms.
_PAIRS, _NODES = 50, 100

# Columns that are written here
_OF_LINK = [j.LINK_BODY, j.LINK_JOINT, j.PARENT, j.SIGN, j.LINK_A, j.LINK_B]
_OF_PART = [j.FIRST, j.LINKS, j.CLOSINGS, j.SEQUENTIAL]


class _Edge(NamedTuple):
    joint: int
    a: int
    b: int
    weight: int  # locked axes: joints with few of them are better where they close a loop
    bodies: tuple[int, ...] = ()  # bodies of a gear, along which no tree grows


class _Part(NamedTuple):
    links: list[list[int]]
    closings: list[list[int]]
    sequential: bool


def arrange(tables: Tables) -> None:
    """Write the articulations of a world and their links, for all joints that hold a movable body."""
    edges = _edges(tables)
    parts: list[_Part] = []
    for members in _components(edges):
        links, closings = _span_all(members, tables)
        place = {link[0]: k for k, link in enumerate(links)}
        rows = [[edge.joint, place.get(edge.a, j.NONE), place.get(edge.b, j.NONE)] for edge in closings]
        pairs = [pair for edge in closings for pair in combinations(edge.bodies or (edge.a, edge.b), 2)]
        coupled = [(place[a], place[b]) for a, b in pairs if a in place and b in place and a != b]
        parts.append(_Part(links, rows, bool(closings) and _is_dense(links, coupled)))
    _write(tables, parts)


def add_unjoined(tables: Tables, places: NDArray[np.int64]) -> None:
    """Give bodies without joints rows of `LINK` after those of joints, in the order of the `LINK_PLACE` that they had.

    The next step finds the bodies of heaps anew, but until then treats those of the last step as such.
    """
    joined = int(tables.array(GRAPH)[0, j.JOINED_ROWS])
    unjoined = np.flatnonzero((places > 0) & (tables.array(BODY)[:, LINK_PLACE] == 0))
    unjoined = unjoined[np.argsort(places[unjoined], kind="stable")]
    count = joined + len(unjoined)
    tables.resize(LINK_NUMBERS, count)
    tables.resize(LINK, count)[joined:, _OF_LINK] = j.NONE
    tables.array(LINK)[joined:, j.LINK_BODY], tables.array(LINK)[joined:, j.SIGN] = unjoined, 1
    tables.array(BODY)[unjoined, LINK_PLACE], tables.array(BODY)[unjoined, LINK_COUNT] = np.arange(joined, count) + 1, 1


def _edges(tables: Tables) -> list[_Edge]:
    """Return the joints that hold a movable body; immovable bodies are -1."""
    joints = tables.array(JOINT)
    moves: NDArray[np.bool_] = np.any(tables.array(INVERSE_MASS)[:, :7] != 0.0, axis=1)
    there = np.flatnonzero(joints[:, j.JOINT_KIND] != j.REMOVED_JOINT)
    edges = []
    for joint in there.tolist():
        a, b = (int(body) if moves[body] else j.NONE for body in joints[joint, [j.BODY_A, j.BODY_B]])
        if a != j.NONE or b != j.NONE:
            bodies: tuple[int, ...] = ()
            if joints[joint, j.LINEAR] == j.GEARED:
                geared = joints[joint, j.GEARED_JOINTS : j.GEARED_JOINTS + 2]
                bodies = tuple(joints[geared][:, [j.BODY_A, j.BODY_B]].ravel().tolist())
            edges.append(_Edge(joint, a, b, int(joints[joint, j.LOCKED]).bit_count(), bodies))
    return edges


def _components(edges: list[_Edge]) -> list[list[_Edge]]:
    """Return the joints connected by movable bodies, in the order of their first joints."""
    root: dict[int, int] = {}

    def find(body: int) -> int:
        while root.setdefault(body, body) != body:
            root[body] = root[root[body]]
            body = root[body]
        return body

    for edge in edges:
        if j.NONE not in (edge.a, edge.b):
            root[find(edge.a)] = find(edge.b)
    parts: dict[int, list[_Edge]] = {}
    for edge in edges:
        parts.setdefault(find(edge.a if edge.a != j.NONE else edge.b), []).append(edge)
    return list(parts.values())


def _span_all(edges: list[_Edge], tables: Tables) -> tuple[list[list[int]], list[_Edge]]:
    """Grow a tree in each part that is connected without gears; return links and closing joints as `_span`, gears last."""
    links: list[list[int]] = []
    closings: list[_Edge] = []
    for held in _components([edge for edge in edges if not edge.bodies]):
        grown, others = _span(held, tables)
        first = len(links)
        links += [
            [body, joint, parent if parent == j.NONE else first + parent, sign] for body, joint, parent, sign in grown
        ]
        closings += others
    return links, closings + [edge for edge in edges if edge.bodies]


def _span(edges: list[_Edge], tables: Tables) -> tuple[list[list[int]], list[_Edge]]:
    """Grow a tree from the immovable bodies, or from the heaviest body, along the joints with the most locked axes.

    Returns
    -------
    links : list of [body, joint, parent, sign]
        Parents come first; `parent` counts from the first link.
    closings : list
        The joints that are not in the tree.
    """
    at: dict[int, list[_Edge]] = defaultdict(list)
    for edge in edges:
        at[edge.a].append(edge)
        at[edge.b].append(edge)
    links: list[list[int]] = []
    place: dict[int, int] = {j.NONE: j.NONE}
    if j.NONE not in at:
        heaviest = max(at, key=lambda body: (tables.array(INERTIA)[body, MASS], -body))
        links.append([heaviest, j.NONE, j.NONE, 1])
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


def _is_dense(links: list[list[int]], coupled: list[tuple[int, int]]) -> bool:
    """Whether nodes have too many neighbours where they are eliminated as `kickdrift.world.direct.islands` does it."""
    near: list[set[int]] = [set() for _ in links]
    children, gone, left = [0] * len(links), [False] * len(links), _PAIRS * max(_NODES, len(links))
    for _, _, parent, _ in links:
        if parent != j.NONE:
            children[parent] += 1
    for a, b in coupled:
        near[a].add(b)
        near[b].add(a)
    heap = [(len(near[node]), node) for node in range(len(links)) if children[node] == 0]
    heapq.heapify(heap)
    while heap:
        degree, node = heapq.heappop(heap)
        if gone[node] or degree != len(near[node]):
            continue  # it has other neighbours since, and is in the heap once more
        gone[node], parent = True, links[node][2]
        left -= degree * degree
        if left < 0:
            return True
        all_near = near[node] | {parent} if near[node] and parent != j.NONE else near[node]
        for other in all_near:
            near[other] = (near[other] | all_near) - {other, node}
            if children[other] == 0:
                heapq.heappush(heap, (len(near[other]), other))
        if parent != j.NONE:
            children[parent] -= 1
            if children[parent] == 0:
                heapq.heappush(heap, (len(near[parent]), parent))
    return False


def _write(tables: Tables, parts: list[_Part]) -> None:
    """Fill in the tables; numbers of links begin anew only if the links are other ones."""
    places = np.zeros((tables.count(BODY), 2), dtype=np.int64)
    articulations = np.zeros((len(parts), len(_OF_PART)), dtype=np.int64)
    rows: list[tuple[int, ...]] = []
    first = 0
    for row, (links, closings, sequential) in zip(articulations, parts, strict=True):
        row[:] = first, len(links), len(closings), sequential
        for k, (body, joint, parent, sign) in enumerate(links, first):
            places[body] = (-k - 1, 0) if sequential else (k + 1, len(links))
            rows.append((body, joint, j.NONE if parent == j.NONE else first + parent, sign, j.NONE, j.NONE))
        ends = [[j.NONE if link == j.NONE else first + link for link in closing[1:]] for closing in closings]
        rows += [(0, closing[0], j.NONE, 1, *pair) for closing, pair in zip(closings, ends, strict=True)]
        first += len(links) + len(closings)
    links_now = np.array(rows, dtype=np.int64).reshape(-1, len(_OF_LINK))
    tables.array(BODY)[:, [LINK_PLACE, LINK_COUNT]] = places
    graph = tables.resize(GRAPH, 1)[0]
    same = np.array_equal(links_now, tables.array(LINK)[: graph[j.JOINED_ROWS], _OF_LINK])
    if same and np.array_equal(articulations, tables.array(ARTICULATION)[:, _OF_PART]):
        return
    tables.resize(LINK, first)[:] = 0
    tables.resize(LINK_NUMBERS, first)[:] = 0.0
    tables.resize(ARTICULATION, len(parts))[:] = 0
    tables.array(LINK)[:, _OF_LINK], tables.array(ARTICULATION)[:, _OF_PART] = links_now, articulations
    tables.array(ARTICULATION)[:, j.END] = articulations[:, 0]
    tables.array(JOINT_NUMBERS)[:, j.BRAKE : j.BRAKE + 3] = 0.0  # of joints that close loops it stays so
    graph[j.JOINED_ROWS] = first

"""Elimination order of the nodes of an island by minimum degree, and symbolic factorisation, with sets of nodes as bits."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.direct_bodies import nodes_of_contact
from kickdrift.world.direct.gear_assembly import geared_link
from kickdrift.world.joints import layout as j
from kickdrift.world.step.status import has_room
from kickdrift.world.tables import (
    ADJACENCY,
    BLOCK,
    ISLAND,
    ISLAND_CONTACT,
    ISLAND_JOINT,
    JOINT,
    LINK,
    NEIGHBOUR,
    NODE,
    integers,
    rows,
    set_rows,
)

_BITS = 62  # nodes per word of a bit set


@compiled(cached=False)
def order_nodes(world: int, island: int) -> bool:
    """Find the elimination order of an island, children before parents, and its fill; return whether there was room."""
    links, nodes, own = integers(world, LINK), integers(world, NODE), integers(world, ISLAND)[island]
    first, after = own[d.FIRST_NODE], own[d.AFTER_NODE]
    n = after - first
    words = (n + _BITS - 1) // _BITS
    if not has_room(world, ADJACENCY, n * (words + 2)):
        return False
    bits = integers(world, ADJACENCY)
    coupled = _couple(world, island, words)
    if not coupled:
        for place in range(first, after):
            parent = links[nodes[place, d.LINK_ROW], j.PARENT]
            nodes[place, d.PARENT_NODE] = links[parent, j.NODE_ROW] if parent >= 0 else j.NONE
            nodes[place, d.FIRST_NEIGHBOUR], nodes[place, d.NEIGHBOURS] = rows(world, NEIGHBOUR), 0
        return True
    # After the bits: for each node the number of children left, -1 once it is eliminated, and its row of LINK.
    children, member = n * words, n * (words + 1)
    for i in range(n):
        bits[children + i, 0], bits[member + i, 0] = 0, nodes[first + i, d.LINK_ROW]
    for i in range(n):
        parent = links[bits[member + i, 0], j.PARENT]
        if parent >= 0:
            bits[children + links[parent, j.NODE_ROW] - first, 0] += 1
    for place in range(first, after):
        best, fewest = -1, 1 << 60
        for i in range(n):
            if bits[children + i, 0] == 0:
                degree = _count(bits, i, words)
                if degree < fewest:
                    best, fewest = i, degree
        parent = links[bits[member + best, 0], j.PARENT]
        p = links[parent, j.NODE_ROW] - first if parent >= 0 else -1
        if not _eliminate(world, best, p, words, place):
            return False
        bits[children + best, 0] = -1
        if p >= 0:
            bits[children + p, 0] -= 1
        nodes[place, d.LINK_ROW] = bits[member + best, 0]
    _place_neighbours(world, first, after, member)
    return True


@compiled(cached=False)
def _place_neighbours(world: int, first: int, after: int, member: int) -> None:
    """Replace parents and neighbours by their places in the order of elimination."""
    links, nodes = integers(world, LINK), integers(world, NODE)
    neighbours, bits = integers(world, NEIGHBOUR), integers(world, ADJACENCY)
    for place in range(first, after):
        links[nodes[place, d.LINK_ROW], j.NODE_ROW] = place
    for place in range(first, after):
        parent = links[nodes[place, d.LINK_ROW], j.PARENT]
        nodes[place, d.PARENT_NODE] = links[parent, j.NODE_ROW] if parent >= 0 else j.NONE
        begin = nodes[place, d.FIRST_NEIGHBOUR]
        for row in range(begin, begin + nodes[place, d.NEIGHBOURS]):
            neighbours[row, 0] = links[bits[member + neighbours[row, 0], 0], j.NODE_ROW]


@compiled(inline=True, cached=False)
def _set(bits: Any, i: int, m: int, words: int) -> None:
    bits[i * words + m // _BITS, 0] |= 1 << (m % _BITS)


@compiled(inline=True, cached=False)
def _clear(bits: Any, i: int, m: int, words: int) -> None:
    bits[i * words + m // _BITS, 0] &= ~(1 << (m % _BITS))


@compiled(inline=True, cached=False)
def _unite(world: int, island: int, a: int, b: int, words: int) -> None:
    """Couple the nodes of two rows of LINK."""
    links, bits, first = (
        integers(world, LINK),
        integers(world, ADJACENCY),
        integers(world, ISLAND)[island, d.FIRST_NODE],
    )
    i, m = links[a, j.NODE_ROW] - first, links[b, j.NODE_ROW] - first
    _set(bits, i, m, words)
    _set(bits, m, i, words)


@compiled(inline=True, cached=False)
def _lowest(word: int) -> int:
    """Return the index of the lowest bit that is set in a word."""
    lowest, place = word & -word, 0
    while lowest > 1:
        lowest >>= 1
        place += 1
    return place


@compiled(cached=False)
def _count(bits: Any, i: int, words: int) -> int:
    """Return the number of neighbours of a node."""
    total = 0
    for w in range(words):
        word = bits[i * words + w, 0]
        while word != 0:
            word &= word - 1
            total += 1
    return total


@compiled(cached=False)
def _couple(world: int, island: int, words: int) -> bool:
    """Write the adjacency of nodes by contacts and closing joints, and return whether there is any."""
    links, own = integers(world, LINK), integers(world, ISLAND)[island]
    bits, order = integers(world, ADJACENCY), integers(world, ISLAND_CONTACT)
    closings, joints = integers(world, ISLAND_JOINT), integers(world, JOINT)
    coupled = False
    for k in range((own[d.AFTER_NODE] - own[d.FIRST_NODE]) * words):
        bits[k, 0] = 0
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        a, b = nodes_of_contact(world, order[k, 0])
        if a >= 0 and b >= 0 and links[a, j.ROOT] == links[b, j.ROOT]:
            _unite(world, island, a, b, words)
            coupled = True
    for k in range(own[d.FIRST_CLOSING], own[d.AFTER_JOINT]):
        a, b = links[closings[k, 0], j.LINK_A], links[closings[k, 0], j.LINK_B]
        if a >= 0 and b >= 0:
            _unite(world, island, a, b, words)
            coupled = True
        if joints[links[closings[k, 0], j.LINK_JOINT], j.LINEAR] == j.GEARED:
            for one in range(4):
                for two in range(one):
                    a, b = geared_link(world, closings[k, 0], one), geared_link(world, closings[k, 0], two)
                    if a >= 0 and b >= 0 and a != b:
                        _unite(world, island, a, b, words)
    return coupled


@compiled(cached=False)
def _eliminate(world: int, i: int, parent: int, words: int, place: int) -> bool:
    """Eliminate a node: write its neighbours, as indices in the list so far, and couple them and its parent to each other."""
    nodes, neighbours, bits = integers(world, NODE), integers(world, NEIGHBOUR), integers(world, ADJACENCY)
    count = _count(bits, i, words)
    row = rows(world, NEIGHBOUR)
    if not (has_room(world, NEIGHBOUR, row + count) and has_room(world, BLOCK, row + count)):
        return False
    nodes[place, d.FIRST_NEIGHBOUR], nodes[place, d.NEIGHBOURS] = row, count
    for w in range(words):
        word = bits[i * words + w, 0]
        while word != 0:
            m = w * _BITS + _lowest(word)
            neighbours[row, 0] = m
            row += 1
            word &= word - 1
    set_rows(world, NEIGHBOUR, row)
    if parent >= 0 and count > 0:
        _set(bits, i, parent, words)
    for w in range(words):
        word = bits[i * words + w, 0]
        while word != 0:
            m = w * _BITS + _lowest(word)
            word &= word - 1
            for v in range(words):
                bits[m * words + v, 0] |= bits[i * words + v, 0]
            _clear(bits, m, m, words)
            _clear(bits, m, i, words)
    return True

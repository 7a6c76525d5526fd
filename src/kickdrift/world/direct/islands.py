"""Islands of nodes, and the order in which their nodes are eliminated, with the fill that this makes."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare import LINKED
from kickdrift.world.direct.layout import (
    AFTER_CLOSING,
    AFTER_CONTACT,
    AFTER_NODE,
    FIRST_CLOSING,
    FIRST_CONTACT,
    FIRST_NEIGHBOUR,
    FIRST_NODE,
    LINK_ROW,
    LOST,
    NEIGHBOURS,
    NODE_ISLAND,
    PARENT_NODE,
    RATIO,
)
from kickdrift.world.flight import LINK_PLACE, MASS
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.layout import (
    CLOSINGS,
    END,
    FIRST,
    LINK_A,
    LINK_B,
    LINKS,
    NONE,
    PARENT,
    PLACE,
    ROOT,
    SEQUENTIAL,
    SIZE,
)
from kickdrift.world.tables import (
    ADJACENCY,
    ARTICULATION,
    BLOCK,
    BODY,
    COLOURS,
    GROUPS,
    INERTIA,
    ISLAND,
    ISLAND_CLOSING,
    ISLAND_CONTACT,
    LINK,
    NEIGHBOUR,
    NODE,
    Table,
    floats,
    integers,
    room,
    rows,
    set_rows,
)
from kickdrift.world.trouble import ask_for_room

_BITS = 62  # of a word that tell nodes

# Nodes that contacts unite to an island. Contacts between larger ones are solved by each of them in turn.
LARGEST = 40


@compiled
def find_islands(t: float, h: float, world: int) -> None:
    """Sort nodes, contacts and closing joints into islands, and find in which order nodes are eliminated."""
    links, colours = integers(world, LINK), integers(world, COLOURS)
    contacts = colours[LINKED, 2] - colours[LINKED, 1]
    n = _join(world)
    if not (
        _has_room(world, NODE, n)
        and _has_room(world, ISLAND, n)
        and _has_room(world, ISLAND_CONTACT, 2 * contacts)
        and _has_room(world, ISLAND_CLOSING, rows(world, LINK))
    ):
        return
    islands = integers(world, ISLAND)
    count = 0
    for row in range(rows(world, LINK)):
        if links[row, ROOT] == row:
            links[row, PLACE] = count
            for column in range(16):
                islands[count, column] = 0
            count += 1
    set_rows(world, ISLAND, count)
    _sort_contacts(world)
    _sort_closings(world)
    _sort_nodes(world)
    set_rows(world, NODE, n)
    set_rows(world, NEIGHBOUR, 0)
    for island in range(count):
        if not _order(world, island):
            return
    set_rows(world, BLOCK, rows(world, NEIGHBOUR))


@compiled(inline=True)
def _has_room(world: int, table: Table, count: int) -> bool:
    """Whether a table has room for so many rows; asks for it if not."""
    if count > room(world, table):
        ask_for_room(world, table, count)
        return False
    return True


@compiled(cached=False)
def _first_of(links: Any, row: int) -> int:
    while links[row, ROOT] != row:
        row = links[row, ROOT]
    return row


@compiled(cached=False)
def node_of(world: int, body: int) -> int:
    """Row of LINK of a body that is solved directly; -1 of others, and of what sleeps."""
    row: int = integers(world, BODY)[body, LINK_PLACE] - 1
    return row if row >= 0 and integers(world, LINK)[row, ROOT] >= 0 else -1


@compiled(cached=False)
def _join(world: int) -> int:
    """Unite the nodes that joints and contacts hold together, and count the nodes."""
    links, articulations = integers(world, LINK), integers(world, ARTICULATION)
    groups, colours = integers(world, GROUPS), integers(world, COLOURS)
    joined, n = 0, 0
    for row in range(rows(world, LINK)):
        links[row, ROOT] = NONE
    for row in range(rows(world, ARTICULATION)):
        first, end = articulations[row, FIRST], articulations[row, FIRST] + articulations[row, LINKS]
        joined = max(joined, end + articulations[row, CLOSINGS])
        if articulations[row, END] > first and articulations[row, SEQUENTIAL] == 0:
            links[first, SIZE] = end - first
            for link in range(first, end):
                links[link, ROOT] = first
                n += 1
    for row in range(joined, rows(world, LINK)):
        links[row, ROOT], links[row, SIZE] = row, 1
        n += 1
    for g in range(colours[LINKED, 1], colours[LINKED, 2]):
        a, b = node_of(world, groups[g, 0]), node_of(world, groups[g, c.WIDTH])
        if a >= 0 and b >= 0:
            a, b = _first_of(links, a), _first_of(links, b)
            if a != b and links[a, SIZE] + links[b, SIZE] <= LARGEST:
                links[max(a, b), ROOT] = min(a, b)
                links[min(a, b), SIZE] += links[max(a, b), SIZE]
    for row in range(rows(world, LINK)):
        if links[row, ROOT] >= 0:
            links[row, ROOT] = _first_of(links, row)
    return n


@compiled(cached=False)
def islands_of_contact(world: int, g: int) -> tuple[int, int]:
    """Islands of a group of the linked colour; -1 for the second where there is but one."""
    links, groups = integers(world, LINK), integers(world, GROUPS)
    a, b = node_of(world, groups[g, 0]), node_of(world, groups[g, c.WIDTH])
    one = links[links[a, ROOT], PLACE] if a >= 0 else -1
    two = links[links[b, ROOT], PLACE] if b >= 0 else -1
    if one < 0:
        return two, -1
    return one, two if two != one else -1


@compiled(cached=False)
def _begin(islands: Any, count: int, first: int, after: int) -> None:
    """From how many each island has, counted in its second column, to where they begin."""
    total = 0
    for island in range(count):
        size = islands[island, after]
        islands[island, first], islands[island, after] = total, total
        total += size


@compiled(cached=False)
def _sort_contacts(world: int) -> None:
    colours, islands, order = integers(world, COLOURS), integers(world, ISLAND), integers(world, ISLAND_CONTACT)
    first, end = colours[LINKED, 1], colours[LINKED, 2]
    for g in range(first, end):
        for island in islands_of_contact(world, g):
            if island >= 0:
                islands[island, AFTER_CONTACT] += 1
    _begin(islands, rows(world, ISLAND), FIRST_CONTACT, AFTER_CONTACT)
    for g in range(first, end):
        for island in islands_of_contact(world, g):
            if island >= 0:
                order[islands[island, AFTER_CONTACT], 0] = g - first
                islands[island, AFTER_CONTACT] += 1
    set_rows(world, ISLAND_CONTACT, 2 * (end - first))


@compiled(cached=False)
def _sort_closings(world: int) -> None:
    links, articulations = integers(world, LINK), integers(world, ARTICULATION)
    islands, order, count = integers(world, ISLAND), integers(world, ISLAND_CLOSING), 0
    for turn in range(2):
        for row in range(rows(world, ARTICULATION)):
            first, closings = articulations[row, FIRST], articulations[row, CLOSINGS]
            if closings == 0 or links[first, ROOT] < 0:
                continue
            island = links[links[first, ROOT], PLACE]
            for closing in range(first + articulations[row, LINKS], articulations[row, END]):
                if turn == 1:
                    order[islands[island, AFTER_CLOSING], 0] = closing
                    count += 1
                islands[island, AFTER_CLOSING] += 1
        if turn == 0:
            _begin(islands, rows(world, ISLAND), FIRST_CLOSING, AFTER_CLOSING)
    set_rows(world, ISLAND_CLOSING, count)


@compiled(cached=False)
def _sort_nodes(world: int) -> None:
    """Write nodes by island, the last link first: children before their parents."""
    links, islands, nodes = integers(world, LINK), integers(world, ISLAND), integers(world, NODE)
    inertia = floats(world, INERTIA)
    for row in range(rows(world, LINK)):
        if links[row, ROOT] >= 0:
            islands[links[links[row, ROOT], PLACE], AFTER_NODE] += 1
    _begin(islands, rows(world, ISLAND), FIRST_NODE, AFTER_NODE)
    for back in range(rows(world, LINK)):
        row = rows(world, LINK) - 1 - back
        if links[row, ROOT] >= 0:
            island = links[links[row, ROOT], PLACE]
            place = islands[island, AFTER_NODE]
            nodes[place, LINK_ROW], nodes[place, NODE_ISLAND] = row, island
            islands[island, AFTER_NODE] += 1
    for island in range(rows(world, ISLAND)):
        least, greatest = 1e300, 0.0
        for place in range(islands[island, FIRST_NODE], islands[island, AFTER_NODE]):
            mass = inertia[links[nodes[place, LINK_ROW], LINK_BODY], MASS]
            least, greatest = min(least, mass), max(greatest, mass)
        islands[island, RATIO], islands[island, LOST] = int(greatest / least + 1.0), 0
    for place in range(islands[rows(world, ISLAND) - 1, AFTER_NODE] if rows(world, ISLAND) > 0 else 0):
        links[nodes[place, LINK_ROW], PLACE] = place


@compiled(cached=False)
def _order(world: int, island: int) -> bool:
    """Find the order of elimination of an island, the least coupled node first, and who is coupled to whom by then."""
    links, nodes, own = integers(world, LINK), integers(world, NODE), integers(world, ISLAND)[island]
    first, after = own[FIRST_NODE], own[AFTER_NODE]
    n = after - first
    words = (n + _BITS - 1) // _BITS
    if not _has_room(world, ADJACENCY, n * (words + 2)):
        return False
    bits = integers(world, ADJACENCY)
    coupled = _couple(world, island, words)
    if not coupled:
        for place in range(first, after):
            parent = links[nodes[place, LINK_ROW], PARENT]
            nodes[place, PARENT_NODE] = links[parent, PLACE] if parent >= 0 else NONE
            nodes[place, FIRST_NEIGHBOUR], nodes[place, NEIGHBOURS] = rows(world, NEIGHBOUR), 0
        return True
    # After the bits: of each node how many of its children are left (-1: it is gone), and which it was in the list.
    children, member = n * words, n * (words + 1)
    for i in range(n):
        bits[children + i, 0], bits[member + i, 0] = 0, nodes[first + i, LINK_ROW]
    for i in range(n):
        parent = links[bits[member + i, 0], PARENT]
        if parent >= 0:
            bits[children + links[parent, PLACE] - first, 0] += 1
    for place in range(first, after):
        best, fewest = -1, 1 << 60
        for i in range(n):
            if bits[children + i, 0] == 0:
                degree = _count(bits, i, words)
                if degree < fewest:
                    best, fewest = i, degree
        parent = links[bits[member + best, 0], PARENT]
        p = links[parent, PLACE] - first if parent >= 0 else -1
        if not _eliminate(world, first, best, p, words, place):
            return False
        bits[children + best, 0] = -1
        if p >= 0:
            bits[children + p, 0] -= 1
        nodes[place, LINK_ROW] = bits[member + best, 0]
    _place_neighbours(world, first, after, member)
    return True


@compiled(cached=False)
def _place_neighbours(world: int, first: int, after: int, member: int) -> None:
    """Say of parents and neighbours where in the order they are, now that it is known."""
    links, nodes = integers(world, LINK), integers(world, NODE)
    neighbours, bits = integers(world, NEIGHBOUR), integers(world, ADJACENCY)
    for place in range(first, after):
        links[nodes[place, LINK_ROW], PLACE] = place
    for place in range(first, after):
        parent = links[nodes[place, LINK_ROW], PARENT]
        nodes[place, PARENT_NODE] = links[parent, PLACE] if parent >= 0 else NONE
        begin = nodes[place, FIRST_NEIGHBOUR]
        for row in range(begin, begin + nodes[place, NEIGHBOURS]):
            neighbours[row, 0] = links[bits[member + neighbours[row, 0], 0], PLACE]


@compiled(inline=True, cached=False)
def _set(bits: Any, i: int, j: int, words: int) -> None:
    bits[i * words + j // _BITS, 0] |= 1 << (j % _BITS)


@compiled(inline=True, cached=False)
def _clear(bits: Any, i: int, j: int, words: int) -> None:
    bits[i * words + j // _BITS, 0] &= ~(1 << (j % _BITS))


@compiled(cached=False)
def _count(bits: Any, i: int, words: int) -> int:
    total = 0
    for w in range(words):
        word = bits[i * words + w, 0]
        while word != 0:
            word &= word - 1
            total += 1
    return total


@compiled(cached=False)
def _couple(world: int, island: int, words: int) -> bool:
    """Write which nodes contacts and closing joints couple, and say whether they do at all."""
    links, groups, own = integers(world, LINK), integers(world, GROUPS), integers(world, ISLAND)[island]
    bits, order = integers(world, ADJACENCY), integers(world, ISLAND_CONTACT)
    closings, begin = integers(world, ISLAND_CLOSING), integers(world, COLOURS)[LINKED, 1]
    first, coupled = own[FIRST_NODE], False
    for k in range((own[AFTER_NODE] - first) * words):
        bits[k, 0] = 0
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        g = begin + order[k, 0]
        a, b = node_of(world, groups[g, 0]), node_of(world, groups[g, c.WIDTH])
        if a >= 0 and b >= 0 and links[a, ROOT] == links[b, ROOT]:
            i, j = links[a, PLACE] - first, links[b, PLACE] - first
            _set(bits, i, j, words)
            _set(bits, j, i, words)
            coupled = True
    for k in range(own[FIRST_CLOSING], own[AFTER_CLOSING]):
        a, b = links[closings[k, 0], LINK_A], links[closings[k, 0], LINK_B]
        if a >= 0 and b >= 0:
            i, j = links[a, PLACE] - first, links[b, PLACE] - first
            _set(bits, i, j, words)
            _set(bits, j, i, words)
            coupled = True
    return coupled


@compiled(cached=False)
def _eliminate(world: int, first: int, i: int, parent: int, words: int, place: int) -> bool:
    """Couple what a node is coupled to, its parent among it, and write its neighbours (by their place in the list so far)."""
    nodes, neighbours, bits = integers(world, NODE), integers(world, NEIGHBOUR), integers(world, ADJACENCY)
    count = _count(bits, i, words)
    row = rows(world, NEIGHBOUR)
    if not (_has_room(world, NEIGHBOUR, row + count) and _has_room(world, BLOCK, row + count)):
        return False
    nodes[place, FIRST_NEIGHBOUR], nodes[place, NEIGHBOURS] = row, count
    for w in range(words):
        word = bits[i * words + w, 0]
        while word != 0:
            lowest = word & -word
            j = w * _BITS
            while lowest > 1:
                lowest >>= 1
                j += 1
            neighbours[row, 0] = j
            row += 1
            word &= word - 1
    set_rows(world, NEIGHBOUR, row)
    if parent >= 0 and count > 0:
        _set(bits, i, parent, words)
    for w in range(words):
        word = bits[i * words + w, 0]
        while word != 0:
            lowest = word & -word
            j = w * _BITS
            while lowest > 1:
                lowest >>= 1
                j += 1
            word &= word - 1
            for v in range(words):
                bits[j * words + v, 0] |= bits[i * words + v, 0]
            _clear(bits, j, j, words)
            _clear(bits, j, i, words)
    return True

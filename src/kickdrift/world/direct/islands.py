"""Islands of nodes, their contacts and joints, and the elimination order of their nodes."""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.filters_and_sensors import is_solid
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_lookup import linked_contacts
from kickdrift.world.direct.direct_bodies import body_of, nodes_of_contact
from kickdrift.world.direct.ordering import order_nodes
from kickdrift.world.direct.unconverged_heaps import LARGEST as HEAP_LARGEST
from kickdrift.world.disjoint_sets import first_of, unite
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import LINK_PLACE, MASS
from kickdrift.world.step.status import has_room
from kickdrift.world.tables import (
    ARTICULATION,
    BLOCK,
    BODY,
    CONTACT,
    GRAPH,
    INERTIA,
    ISLAND,
    ISLAND_CONTACT,
    ISLAND_JOINT,
    LINK,
    NEIGHBOUR,
    NODE,
    floats,
    integers,
    rows,
    set_rows,
)

# Largest number of nodes that contacts unite to an island with joints, since fill grows fast. Contacts between larger islands
# are solved by each of them in turn. Sixteen ragdolls take 3.2 ms a step with 12 to 40 nodes, and 4.7 ms with 64. An
# island that contains a tree of more than 16 nodes may have twice as many as the tree: if a track of 33 links and the vehicle
# of 3 bodies within it are solved in turn, a drop by 2 cm turns 17 J into 370 MJ.
LARGEST = 32


@compiled
def find_islands(t: float, h: float, world: int) -> None:
    """Sort nodes, contacts and joints into islands, and find the elimination order of nodes."""
    links, contacts = integers(world, LINK), linked_contacts(world)
    n = _unite_nodes(world)
    if not (
        has_room(world, NODE, n)
        and has_room(world, ISLAND, n)
        and has_room(world, ISLAND_CONTACT, 2 * contacts)
        and has_room(world, ISLAND_JOINT, rows(world, LINK))
    ):
        return
    islands, body = integers(world, ISLAND), integers(world, BODY)
    count = 0
    for in_turn in (False, True):
        for row in range(rows(world, LINK)):
            if links[row, j.ROOT] == row and (body[links[row, j.LINK_BODY], LINK_PLACE] < 0) == in_turn:
                links[row, j.NODE_ROW] = count
                for column in range(ISLAND.width):
                    islands[count, column] = 0
                islands[count, d.GROUP] = count
                count += 1
        if not in_turn:
            integers(world, GRAPH)[0, j.DIRECT_ISLANDS] = count
    set_rows(world, ISLAND, count)
    _sort_contacts(world)
    _sort_joints(world)
    _sort_nodes(world)
    set_rows(world, NODE, n)
    set_rows(world, NEIGHBOUR, 0)
    for island in range(direct_islands(world)):
        if not order_nodes(world, island):
            return
    set_rows(world, BLOCK, rows(world, NEIGHBOUR))
    _find_touching(world)


@compiled(inline=True)
def direct_islands(world: int) -> int:
    """Return how many islands are solved directly: the first ones."""
    count: int = integers(world, GRAPH)[0, j.DIRECT_ISLANDS]
    return count


@compiled(cached=False)
def _unite_nodes(world: int) -> int:
    """Unite nodes that are connected by joints or contacts, and return the number of nodes."""
    links, articulations = integers(world, LINK), integers(world, ARTICULATION)
    joined, n = 0, 0
    for row in range(rows(world, LINK)):
        links[row, j.ROOT] = j.NONE
    for row in range(rows(world, ARTICULATION)):
        first, end = articulations[row, j.FIRST], articulations[row, j.FIRST] + articulations[row, j.LINKS]
        joined = max(joined, end + articulations[row, j.CLOSINGS])
        if articulations[row, j.END] > first:
            links[first, j.ISLAND_SIZE], links[first, j.ISLAND_ROOM] = end - first, max(LARGEST, 2 * (end - first))
            for link in range(first, end):
                links[link, j.ROOT] = first
                n += 1
    for row in range(joined, rows(world, LINK)):
        links[row, j.ROOT], links[row, j.ISLAND_SIZE], links[row, j.ISLAND_ROOM] = row, 1, LARGEST
        n += 1
    for index in range(linked_contacts(world)):
        a, b = nodes_of_contact(world, index)
        if a >= 0 and b >= 0:
            a, b = first_of(links, j.ROOT, a), first_of(links, j.ROOT, b)
            most = max(links[a, j.ISLAND_ROOM], links[b, j.ISLAND_ROOM]) if min(a, b) < joined else HEAP_LARGEST
            if a != b and links[a, j.ISLAND_SIZE] + links[b, j.ISLAND_SIZE] <= most:
                links[max(a, b), j.ROOT] = min(a, b)
                links[min(a, b), j.ISLAND_SIZE] += links[max(a, b), j.ISLAND_SIZE]
                links[min(a, b), j.ISLAND_ROOM] = most
    for row in range(rows(world, LINK)):
        if links[row, j.ROOT] >= 0:
            links[row, j.ROOT] = first_of(links, j.ROOT, row)
    return n


@compiled(cached=False)
def islands_of_contact(world: int, index: int) -> tuple[int, int]:
    """Return the islands of a contact that is solved directly; -1 for the second if there is only one."""
    links = integers(world, LINK)
    a, b = nodes_of_contact(world, index)
    one = links[links[a, j.ROOT], j.NODE_ROW] if a >= 0 else -1
    two = links[links[b, j.ROOT], j.NODE_ROW] if b >= 0 else -1
    if one < 0:
        return two, -1
    return one, two if two != one else -1


@compiled(cached=False)
def _begin_ranges(world: int, first: int, after: int) -> None:
    """Replace the number of items of each island, in the column `after`, by where its items begin, in both columns."""
    islands, total = integers(world, ISLAND), 0
    for island in range(rows(world, ISLAND)):
        size = islands[island, after]
        islands[island, first], islands[island, after] = total, total
        total += size


@compiled(cached=False)
def _sort_contacts(world: int) -> None:
    """Write the contacts of each island; one between two islands belongs to both, and unites their groups."""
    islands, order, count = integers(world, ISLAND), integers(world, ISLAND_CONTACT), linked_contacts(world)
    for index in range(count):
        one, two = islands_of_contact(world, index)
        for island in (one, two):
            if island >= 0:
                islands[island, d.AFTER_CONTACT] += 1
        if two >= 0:
            unite(islands, d.GROUP, one, two)
    _begin_ranges(world, d.FIRST_CONTACT, d.AFTER_CONTACT)
    for index in range(count):
        for island in islands_of_contact(world, index):
            if island >= 0:
                order[islands[island, d.AFTER_CONTACT], 0] = index
                islands[island, d.AFTER_CONTACT] += 1
    set_rows(world, ISLAND_CONTACT, 2 * count)


@compiled(cached=False)
def _sort_joints(world: int) -> None:
    """Write the joints of each island: first those of its trees, then those that close loops, and gears."""
    islands, order, links = integers(world, ISLAND), integers(world, ISLAND_JOINT), integers(world, LINK)
    articulations, count = integers(world, ARTICULATION), 0
    for row in range(rows(world, ARTICULATION)):
        island = _island_of_articulation(world, row)
        if island >= 0:
            islands[island, d.AFTER_JOINT] += articulations[row, j.END] - articulations[row, j.FIRST]
            count += articulations[row, j.END] - articulations[row, j.FIRST]
    _begin_ranges(world, d.FIRST_JOINT, d.AFTER_JOINT)
    for closing in range(2):
        for island in range(rows(world, ISLAND)):
            islands[island, d.FIRST_CLOSING] = islands[island, d.AFTER_JOINT]
        for row in range(rows(world, ARTICULATION)):
            island = _island_of_articulation(world, row)
            if island < 0:
                continue
            first, middle = articulations[row, j.FIRST], articulations[row, j.FIRST] + articulations[row, j.LINKS]
            for link in range(middle if closing else first, articulations[row, j.END] if closing else middle):
                if links[link, j.LINK_JOINT] >= 0:
                    order[islands[island, d.AFTER_JOINT], 0] = link
                    islands[island, d.AFTER_JOINT] += 1
    set_rows(world, ISLAND_JOINT, count)


@compiled(inline=True)
def _island_of_articulation(world: int, row: int) -> int:
    """Return the island of an articulation; -1 if it sleeps."""
    links = integers(world, LINK)
    root = links[integers(world, ARTICULATION)[row, j.FIRST], j.ROOT]
    island: int = links[root, j.NODE_ROW] if root >= 0 else -1
    return island


@compiled(cached=False)
def _sort_nodes(world: int) -> None:
    """Write the nodes of each island, children before their parents, and the mass ratio of each island."""
    links, islands, nodes = integers(world, LINK), integers(world, ISLAND), integers(world, NODE)
    inertia = floats(world, INERTIA)
    for row in range(rows(world, LINK)):
        if links[row, j.ROOT] >= 0:
            islands[links[links[row, j.ROOT], j.NODE_ROW], d.AFTER_NODE] += 1
    _begin_ranges(world, d.FIRST_NODE, d.AFTER_NODE)
    for row in range(rows(world, LINK) - 1, -1, -1):
        if links[row, j.ROOT] >= 0:
            island = links[links[row, j.ROOT], j.NODE_ROW]
            place = islands[island, d.AFTER_NODE]
            nodes[place, d.LINK_ROW], nodes[place, d.NODE_ISLAND] = row, island
            islands[island, d.AFTER_NODE] += 1
    for island in range(rows(world, ISLAND)):
        least, greatest = 1e300, 0.0
        for place in range(islands[island, d.FIRST_NODE], islands[island, d.AFTER_NODE]):
            mass = inertia[body_of(world, place), MASS]
            least, greatest = min(least, mass), max(greatest, mass)
            links[nodes[place, d.LINK_ROW], j.NODE_ROW] = place
        islands[island, d.RATIO], islands[island, d.LOST] = int(greatest / least + 1.0), 0
        islands[island, d.HAS_JOINTS] = int(islands[island, d.AFTER_JOINT] > islands[island, d.FIRST_JOINT])


@compiled(cached=False)
def _find_touching(world: int) -> None:
    """Note which islands have contacts, whoever solves these: among their own bodies only, or with others."""
    contacts, bodies, links = integers(world, CONTACT), integers(world, BODY), integers(world, LINK)
    islands, nodes = integers(world, ISLAND), integers(world, NODE)
    for row in range(rows(world, CONTACT)):
        if not is_solid(contacts, row):
            continue
        a = abs(bodies[contacts[row, c.BODY_A], LINK_PLACE]) - 1
        b = abs(bodies[contacts[row, c.BODY_B], LINK_PLACE]) - 1
        one = nodes[links[a, j.NODE_ROW], d.NODE_ISLAND] if a >= 0 and links[a, j.ROOT] >= 0 else j.NONE
        two = nodes[links[b, j.NODE_ROW], d.NODE_ISLAND] if b >= 0 and links[b, j.ROOT] >= 0 else j.NONE
        for island in (one, two):
            if island >= 0:
                islands[island, d.TOUCHES] = max(islands[island, d.TOUCHES], 1 if one == two else 2)

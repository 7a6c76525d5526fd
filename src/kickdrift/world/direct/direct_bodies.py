"""Selection of the bodies that are solved directly: links of articulations, free bodies near them, and unsolved heaps."""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.filters_and_sensors import is_solid
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_lookup import linked_bodies
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import AWAKE, BODY_KIND, DYNAMIC, IN_HEAP, INVERSE_LINEAR_MASS, LINK_COUNT, LINK_PLACE, MASS
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import (
    BODY,
    CONTACT,
    GRAPH,
    INERTIA,
    INVERSE_MASS,
    ISLAND,
    LINK,
    LINK_NUMBERS,
    NODE,
    floats,
    integers,
    room,
    rows,
    set_rows,
)

# Largest number of contacts between a free body and the nearest link; bodies farther away are left to the sweeps.
FARTHEST = 6


@compiled
def find_nodes(t: float, h: float, world: int) -> None:
    """Give bodies of unsolved heaps, and free bodies near links, a row of `LINK` for this step."""
    body, contact, joined = integers(world, BODY), integers(world, CONTACT), integers(world, GRAPH)[0, j.JOINED_ROWS]
    _remove_nodes(world, joined, rows(world, LINK))
    count = _add_heaps(world, joined)
    if count < 0:
        return
    for _ in range(FARTHEST):
        begun = count
        for row in range(rows(world, CONTACT)):
            if not is_solid(contact, row):
                continue
            a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
            node_a, node_b = _is_node(world, a, begun), _is_node(world, b, begun)
            if node_a == node_b:
                continue
            new = b if node_a else a
            if body[new, LINK_PLACE] != 0 or not moves(world, new):
                continue
            if not _add_node(world, new, joined, count):
                return
            count += 1
        if count == begun:
            break
    set_rows(world, LINK, count)
    set_rows(world, LINK_NUMBERS, max(count, rows(world, LINK_NUMBERS)))


@compiled(cached=False)
def _add_heaps(world: int, joined: int) -> int:
    """Give bodies of unsolved heaps a row of `LINK`; return the number of rows, or -1 if there is no room."""
    body, count = integers(world, BODY), joined
    for row in range(rows(world, BODY)):
        if body[row, IN_HEAP] != 0 and body[row, LINK_PLACE] == 0 and moves(world, row):
            if not _add_node(world, row, joined, count):
                return -1
            count += 1
    return count


@compiled(cached=False)
def _add_node(world: int, row: int, joined: int, count: int) -> bool:
    """Give a body a row of `LINK`; return whether there was room."""
    body, links = integers(world, BODY), integers(world, LINK)
    if count >= min(room(world, LINK), room(world, LINK_NUMBERS)):
        _remove_nodes(world, joined, count)
        ask_for_room(world, LINK, count + 64)
        return False
    body[row, LINK_PLACE], body[row, LINK_COUNT] = count + 1, 1
    links[count, j.LINK_BODY], links[count, j.LINK_JOINT], links[count, j.PARENT] = row, j.NONE, j.NONE
    links[count, j.SIGN], links[count, j.LINK_A], links[count, j.LINK_B] = 1, j.NONE, j.NONE
    return True


@compiled(inline=True)
def moves(world: int, row: int) -> bool:
    """Whether impulses move a body."""
    body, response = integers(world, BODY), floats(world, INVERSE_MASS)
    does: bool = body[row, BODY_KIND] == DYNAMIC and body[row, AWAKE] != 0 and response[row, INVERSE_LINEAR_MASS] > 0.0
    return does


@compiled(inline=True)
def _is_node(world: int, row: int, begun: int) -> bool:
    """Whether a body was a node already when the round began."""
    body = integers(world, BODY)
    is_node: bool = body[row, AWAKE] != 0 and 0 < body[row, LINK_PLACE] <= begun
    return is_node


@compiled(cached=False)
def _remove_nodes(world: int, joined: int, count: int) -> None:
    """Remove the rows of `LINK` from `joined` on: those of the last step, or of a stage that is run again."""
    body, links = integers(world, BODY), integers(world, LINK)
    for row in range(joined, count):
        body[links[row, j.LINK_BODY], LINK_PLACE], body[links[row, j.LINK_BODY], LINK_COUNT] = 0, 0
    set_rows(world, LINK, joined)


@compiled(cached=False)
def node_of(world: int, body: int) -> int:
    """Return the row of LINK of a body that is solved directly; -1 for others, and for sleeping ones."""
    row: int = integers(world, BODY)[body, LINK_PLACE] - 1
    return row if row >= 0 and integers(world, LINK)[row, j.ROOT] >= 0 else -1


@compiled(cached=False)
def nodes_of_contact(world: int, index: int) -> tuple[int, int]:
    """Return the rows of LINK of the bodies of a contact that is solved directly, -1 as in `node_of`."""
    a, b = linked_bodies(world, index)
    return node_of(world, a), node_of(world, b)


@compiled(cached=False)
def place_in(world: int, island: int, body: int) -> int:
    """Return the place of a body in the order of elimination; -1 if it does not belong to the island."""
    link = node_of(world, body)
    place: int = integers(world, LINK)[link, j.NODE_ROW] if link >= 0 else -1
    return place if place >= 0 and integers(world, NODE)[place, d.NODE_ISLAND] == island else -1


@compiled(cached=False)
def is_across(world: int, island: int, body: int) -> bool:
    """Whether a body at a contact of an island belongs to another one."""
    return place_in(world, island, body) < 0 and node_of(world, body) >= 0


@compiled(inline=True)
def body_of(world: int, node: int) -> int:
    """Return the body of a node."""
    body: int = integers(world, LINK)[integers(world, NODE)[node, d.LINK_ROW], j.LINK_BODY]
    return body


@compiled(cached=False)
def mass_of(world: int, island: int) -> float:
    """Return the mass of an island, kg."""
    own, total = integers(world, ISLAND)[island], 0.0
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        total += floats(world, INERTIA)[body_of(world, node), MASS]
    return total

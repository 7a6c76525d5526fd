"""The contacts of an island in its equations: what is wanted of them, what they add, and what the solution gives them."""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.prepare import LINKED
from kickdrift.world.direct.contact_rows import (
    RIGID,
    RIGID_BOUNCE,
    along,
    begin_row,
    bind,
    bind_points,
    bound_rows,
    find_bounds,
    first_row,
    fix,
    give_of,
    impulse_field,
    review_bound,
    review_points,
)
from kickdrift.world.direct.factorisation import add_row
from kickdrift.world.direct.islands import node_of
from kickdrift.world.direct.layout import (
    ACTIVE,
    AFTER_CONTACT,
    CONSTANT,
    CUT,
    DIRECTION,
    FIRST_CONTACT,
    GIVEN,
    HELD,
    HITS,
    IMPULSE,
    LINK_ROW,
    MOVED,
    NODE_ISLAND,
    NODES,
    SLIDE,
    SPEED,
    START,
    STATE,
    STIFFNESS,
    TANGENT,
    WANTED,
    WRENCH,
)
from kickdrift.world.joints.impulses import push_body
from kickdrift.world.joints.layout import GAIN, LOAD, PLACE
from kickdrift.world.settings import PUSH_SPEED
from kickdrift.world.tables import (
    CHANGE,
    COLOURS,
    CONTACT_ROW,
    GROUPS,
    ISLAND,
    ISLAND_CONTACT,
    LANES,
    LINK,
    LINK_NUMBERS,
    MOTION,
    NODE,
    SETTINGS,
    Table,
    flat,
    floats,
    integers,
)

_SIZE = c.FIELDS * c.WIDTH
_COLUMNS = CONTACT_ROW.width

# What the contacts of a solution are to do
PRESS = (
    0  # bodies that overlap are pushed apart, and those apart may come as near as they are by the end of the substep
)
REST = 1  # nothing moves on
BOUNCE = 2  # points that hit leave with the speed that restitution gives them
SMOOTH_BOUNCE = 3  # the same without friction

# Part of an overlap that is pushed out in a substep.
_PUSHED = 0.2


@compiled(inline=True, cached=False, fast=True)
def contact_row(index: int, world: int) -> Any:
    """Return the numbers of a contact, counted from the first of the linked colour."""
    return flat(world, CONTACT_ROW)[_COLUMNS * index : _COLUMNS * (index + 1)]


@compiled(inline=True, cached=False, fast=True)
def constraint(index: int, world: int) -> Any:
    """Return the constraint of a contact, in lane 0 of its group."""
    g = integers(world, COLOURS)[LINKED, 1] + index
    return flat(world, LANES)[g * _SIZE : (g + 1) * _SIZE]


@compiled(cached=False, fast=True)
def read_both(table: Table, a: int, b: int, numbers: Any, world: int) -> None:
    """Read the first six numbers of both bodies of a contact."""
    columns = floats(world, table)
    for k in range(6):
        numbers[k], numbers[6 + k] = columns[a, k], columns[b, k]


@compiled(inline=True, cached=False, fast=True)
def twelve() -> Any:
    """Return room for the velocities of two bodies, or for what acts on them."""
    return carray(floats_on_stack(12), (12,))


@compiled(cached=False, fast=True)
def begin_contacts(island: int, h: float, task: int, world: int) -> None:
    """Say what is wanted of the rows of all contacts of an island, as bodies move now."""
    own = integers(world, ISLAND)[island]
    order = integers(world, ISLAND_CONTACT)
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        _begin_contact(order[k, 0], island, h, task, world)


@compiled(cached=False, fast=True)
def _begin_contact(index: int, island: int, h: float, task: int, world: int) -> None:
    groups, links = integers(world, GROUPS), integers(world, LINK)
    g = integers(world, COLOURS)[LINKED, 1] + index
    own, numbers = constraint(index, world), contact_row(index, world)
    a, b = groups[g, 0], groups[g, c.WIDTH]
    velocity, change = twelve(), twelve()
    read_both(MOTION, a, b, velocity, world)
    read_both(CHANGE, a, b, change, world)
    push = floats(world, SETTINGS)[0, PUSH_SPEED]
    numbers[CUT], rigid = 0.0, RIGID if task < BOUNCE else RIGID_BOUNCE
    for side in range(2):
        link = node_of(world, b if side == 1 else a)
        numbers[NODES + side] = -1.0
        if link >= 0 and integers(world, NODE)[links[link, PLACE], NODE_ISLAND] == island:
            numbers[NODES + side] = links[link, PLACE]
        elif link >= 0:
            numbers[CUT] = 1.0 + side
    for k in range(10):
        there = own[(c.P + c.POINT_FIELDS * k + c.POINT_MASS) * c.WIDTH] > 0.0 if k < TANGENT else True
        if not there or (k >= 7 and own[c.ROLL * c.WIDTH] == 0.0):
            numbers[ACTIVE + k], numbers[GIVEN + k], numbers[STATE + k] = 0.0, 0.0, 0.0
            continue
        if k >= TANGENT and task in (PRESS, SMOOTH_BOUNCE):  # friction is as it was in the end of the substep before
            numbers[ACTIVE + k] = 0.0
            continue
        begin_row(own, numbers, k, velocity, a, b, int(numbers[CUT]), rigid, world)
        if k < TANGENT:
            gap = own[(c.P + c.POINT_FIELDS * k + c.GAP) * c.WIDTH]
            gap += along(numbers[WRENCH + 12 * k : WRENCH + 12 * k + 12], change)
            if task == PRESS:
                numbers[WANTED + k] = -gap / h if gap > 0.0 else min(-_PUSHED * gap / h, push)
            elif task == REST and gap > 0.0 and numbers[IMPULSE + k] == 0.0:
                numbers[ACTIVE + k] = 0.0
            elif task >= BOUNCE:
                numbers[ACTIVE + k] = 1.0 if numbers[HITS + k] >= 0.0 else 0.0
                numbers[WANTED + k], numbers[IMPULSE + k] = numbers[HITS + k], 0.0
        else:
            if task >= BOUNCE:
                numbers[IMPULSE + k] = 0.0
            numbers[DIRECTION + k] = 0.0
            if k < TANGENT + 2:
                numbers[WANTED + k] = own[(c.SLIDE + k - TANGENT) * c.WIDTH]
    find_bounds(own, numbers)


@compiled(cached=False, fast=True)
def left_of_contacts(island: int, world: int) -> float:
    """Return how fast points that carry something part or approach, at most, m/s."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    groups, begin, velocity, most = integers(world, GROUPS), integers(world, COLOURS)[LINKED, 1], twelve(), 0.0
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        numbers, fields = contact_row(order[k, 0], world), constraint(order[k, 0], world)
        read_both(MOTION, groups[begin + order[k, 0], 0], groups[begin + order[k, 0], c.WIDTH], velocity, world)
        for i in range(TANGENT):
            if numbers[ACTIVE + i] != 0.0 and fields[impulse_field(i) * c.WIDTH] > 0.0:
                most = max(most, abs(along(numbers[WRENCH + 12 * i : WRENCH + 12 * i + 12], velocity)))
    return most


@compiled(cached=False, fast=True)
def is_cut(island: int, world: int) -> bool:
    """Whether an island touches another one."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    cut = False
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        cut = cut or contact_row(order[k, 0], world)[CUT] != 0.0
    return cut


@compiled(cached=False, fast=True)
def note_impulses(island: int, back: bool, world: int) -> None:
    """Keep the impulses that a substep begins with, or go back to them."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        numbers, fields = contact_row(order[k, 0], world), constraint(order[k, 0], world)
        for i in range(10):
            if back:
                fields[impulse_field(i) * c.WIDTH] = numbers[START + i]
            else:
                numbers[START + i] = fields[impulse_field(i) * c.WIDTH]


@compiled(cached=False, fast=True)
def review_contacts(island: int, task: int, first: bool, opened: bool, world: int) -> bool:
    """Assume pieces of the laws of contacts as the solution at hand says; return whether it was made with them."""
    own, order, settled = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), True
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        numbers = contact_row(order[k, 0], world)
        settled = review_points(numbers, first, opened) and settled
        if task != PRESS and not first and not opened:
            find_bounds(constraint(order[k, 0], world), numbers)
        for bound in range(0 if task in (REST, BOUNCE) else 3, 3):
            if numbers[ACTIVE + first_row(bound)] != 0.0:
                settled = review_bound(numbers, bound, first, opened) and settled
    return settled


@compiled(cached=False, fast=True)
def fix_contacts(island: int, world: int) -> None:
    """Let the contacts of an island give what they do by the solution at hand, within their bounds."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        fix(contact_row(order[k, 0], world))


@compiled(cached=False, fast=True)
def refine_contacts(island: int, world: int) -> float:
    """Begin with the impulses of the solution at hand, and return the greatest speed that it leaves where rows hold, m/s."""
    own, order, worst = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), 0.0
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        numbers = contact_row(order[k, 0], world)
        for i in range(10):
            first = i if i < TANGENT else first_row(0 if i < 6 else 1 if i == 6 else 2)
            if numbers[ACTIVE + i] != 0.0 and numbers[STATE + first] == HELD:
                missing = numbers[WANTED + i] - numbers[SPEED + i]
                if numbers[CUT] != 0.0:
                    continue
                if i < TANGENT + 2:
                    worst = max(worst, abs(missing - numbers[MOVED + i]))
                numbers[CONSTANT + i] = numbers[GIVEN + i] + numbers[STIFFNESS + first] * missing
    return worst


@compiled(cached=False, fast=True)
def add_contacts(island: int, world: int) -> None:
    """Add the rows of contacts to the matrix of an island."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    wrench = twelve()
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        numbers = contact_row(order[k, 0], world)
        a, b = int(numbers[NODES]), int(numbers[NODES + 1])
        for i in range(TANGENT):
            if numbers[ACTIVE + i] != 0.0 and numbers[STATE + i] == HELD:
                row = numbers[WRENCH + 12 * i : WRENCH + 12 * i + 12]
                add_row(a, b, numbers[STIFFNESS + i], row, row, world)
        for bound in range(3):
            begin = first_row(bound)
            held = numbers[STATE + begin] == HELD
            stiffness = numbers[STIFFNESS + begin] * (1.0 if held else numbers[SLIDE + bound])
            if numbers[ACTIVE + begin] == 0.0 or stiffness == 0.0:
                continue
            end = begin + bound_rows(bound)
            for i in range(begin, end):
                row = numbers[WRENCH + 12 * i : WRENCH + 12 * i + 12]
                for m in range(12):
                    wrench[m] = row[m]
                if not held:
                    for j in range(begin, end):
                        share = numbers[DIRECTION + i] * numbers[DIRECTION + j]
                        for m in range(12):
                            wrench[m] -= share * numbers[WRENCH + 12 * j + m]
                add_row(a, b, stiffness, row, wrench, world)


@compiled(cached=False, fast=True)
def load_contacts(island: int, world: int) -> None:
    """Add to the loads on the nodes of an island what its contacts give if no speed changes."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        numbers = contact_row(order[k, 0], world)
        a, b = int(numbers[NODES]), int(numbers[NODES + 1])
        for i in range(10):
            if numbers[ACTIVE + i] != 0.0:
                _load(a, b, numbers[CONSTANT + i], numbers[WRENCH + 12 * i : WRENCH + 12 * i + 12], world)


@compiled(cached=False, fast=True)
def _load(a: int, b: int, impulse: float, wrench: Any, world: int) -> None:
    """Let an impulse along a row act on the nodes of a contact."""
    nodes, work = integers(world, NODE), floats(world, LINK_NUMBERS)
    for side in range(2):
        node = b if side == 1 else a
        if node >= 0:
            link = nodes[node, LINK_ROW]
            for i in range(6):
                work[link, LOAD + i] += impulse * wrench[6 * side + i]


@compiled(cached=False, fast=True)
def predict_contacts(island: int, world: int) -> None:
    """Find the changes of speed and the impulses along the rows, for the solution at hand."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    nodes, work = integers(world, NODE), floats(world, LINK_NUMBERS)
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        numbers = contact_row(order[k, 0], world)
        for i in range(10):
            if numbers[ACTIVE + i] == 0.0:
                continue
            total = 0.0
            for side in range(2):
                node = int(numbers[NODES + side])
                if node >= 0:
                    link = nodes[node, LINK_ROW]
                    for m in range(6):
                        total += numbers[WRENCH + 12 * i + 6 * side + m] * work[link, GAIN + m]
            numbers[MOVED + i] = total
        for i in range(10):
            if numbers[ACTIVE + i] != 0.0:
                numbers[GIVEN + i] = give_of(numbers, i, -1 if i < TANGENT else 0 if i < 6 else 1 if i == 6 else 2)


@compiled(cached=False, fast=True)
def give_contacts(island: int, task: int, world: int) -> None:
    """Give bodies the impulses that were found, none of which pulls."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    groups, begin = integers(world, GROUPS), integers(world, COLOURS)[LINKED, 1]
    given = twelve()
    for k in range(own[FIRST_CONTACT], own[AFTER_CONTACT]):
        index = order[k, 0]
        numbers, own_fields = contact_row(index, world), constraint(index, world)
        for m in range(12):
            given[m] = 0.0
        if task in (PRESS, SMOOTH_BOUNCE):
            bind_points(numbers)
        else:
            bind(numbers)
        for i in range(10):
            if numbers[ACTIVE + i] == 0.0:
                continue
            impulse = numbers[GIVEN + i]
            if task < BOUNCE:
                own_fields[impulse_field(i) * c.WIDTH] = numbers[IMPULSE + i] + impulse
            for m in range(12):
                given[m] += impulse * numbers[WRENCH + 12 * i + m]
        for side in range(2):
            if numbers[NODES + side] >= 0.0 or numbers[CUT] == 1.0 + side:
                body, at = groups[begin + index, c.WIDTH * side], 6 * side
                push = (given[at], given[at + 1], given[at + 2])
                push_body(body, push, (given[at + 3], given[at + 4], given[at + 5]), world)

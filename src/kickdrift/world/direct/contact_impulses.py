"""Impulses of the contacts of an island from a solution of its equations."""

from kickdrift.core.compilation import compiled
from kickdrift.core.spatial import inner, plus_scaled, put_spatial_of, spatial_at, spatial_of
from kickdrift.world.columns import point_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import BOUNCE, PRESS, REST, read_both, twelve
from kickdrift.world.direct.contact_lookup import contact_row, linked_bodies, linked_constraint
from kickdrift.world.direct.contact_rows import bind, bind_points, bound_of, first_row, give_of, impulse_field
from kickdrift.world.direct.contact_wrenches import along, wrench_of, write_wrench
from kickdrift.world.impulses import push_body
from kickdrift.world.joints import layout as j
from kickdrift.world.tables import ISLAND, ISLAND_CONTACT, LINK_NUMBERS, MOTION, NODE, floats, integers


@compiled(cached=False, fast=True)
def refine_contacts(world: int, island: int) -> float:
    """Begin the next solution with the impulses of the current one; return the largest residual speed of held rows, m/s."""
    own, order, worst = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), 0.0
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers = contact_row(world, order[k, 0])
        if numbers[d.CUT] != 0.0:
            continue
        for i in range(d.CONTACT_ROWS):
            first = i if i < d.TANGENT else first_row(bound_of(i))
            if numbers[d.ACTIVE + i] != 0.0 and numbers[d.STATE + first] == d.HELD:
                if i < d.TWIST:
                    worst = max(worst, abs(numbers[d.WANTED + i] - numbers[d.SPEED + i] - numbers[d.MOVED + i]))
                numbers[d.BASE + i] = numbers[d.GIVEN + i]
    return worst


@compiled(cached=False, fast=True)
def predict_contacts(world: int, island: int) -> None:
    """Find the changes of speed and the impulses along the rows of contacts, for the current solution."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    nodes, work = integers(world, NODE), floats(world, LINK_NUMBERS)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers = contact_row(world, order[k, 0])
        for i in range(d.CONTACT_ROWS):
            if numbers[d.ACTIVE + i] == 0.0:
                continue
            total = 0.0
            for side in range(2):
                node = int(numbers[d.NODES + side])
                if node >= 0:
                    wrench = spatial_of(numbers, d.WRENCH + 12 * i + 6 * side)
                    total += inner(wrench, spatial_at(work, nodes[node, d.LINK_ROW], j.GAIN))
            numbers[d.MOVED + i] = total
        for i in range(d.CONTACT_ROWS):
            if numbers[d.ACTIVE + i] != 0.0:
                numbers[d.GIVEN + i] = give_of(numbers, i)


@compiled(cached=False, fast=True)
def give_contacts(world: int, island: int, task: int) -> None:
    """Apply the impulses of contacts to the bodies, within their bounds."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    given = twelve()
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        index, bodies = order[k, 0], linked_bodies(world, order[k, 0])
        numbers, own_fields = contact_row(world, index), linked_constraint(world, index)
        for m in range(12):
            given[m] = 0.0
        if task in (PRESS, BOUNCE):
            bind_points(numbers)
        else:
            bind(numbers)
        for i in range(d.CONTACT_ROWS):
            if numbers[d.ACTIVE + i] == 0.0:
                continue
            impulse = numbers[d.GIVEN + i]
            if task < BOUNCE:
                own_fields[impulse_field(i) * c.WIDTH] = numbers[d.IMPULSE + i] + impulse
            for at in range(0, 12, 6):
                wrench = spatial_of(numbers, d.WRENCH + 12 * i + at)
                put_spatial_of(given, at, plus_scaled(spatial_of(given, at), impulse, wrench))
        for side in range(2):
            if numbers[d.NODES + side] >= 0.0 or numbers[d.CUT] == 1.0 + side:
                body, at = bodies[1] if side == 1 else bodies[0], 6 * side
                push_body(world, body, point_at(given, at), point_at(given, at + 3))


@compiled(cached=False, fast=True)
def forget_contacts(world: int, island: int) -> None:
    """Undo the impulses with which contacts were warm started."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers, fields = contact_row(world, order[k, 0]), linked_constraint(world, order[k, 0])
        for i in range(d.CONTACT_ROWS):
            numbers[d.ACTIVE + i], numbers[d.IMPULSE + i] = 1.0, fields[impulse_field(i) * c.WIDTH]
            numbers[d.GIVEN + i] = -numbers[d.IMPULSE + i]
            write_wrench(fields, i, wrench_of(numbers, i))
    give_contacts(world, island, REST)


@compiled(cached=False, fast=True)
def left_of_contacts(world: int, island: int) -> float:
    """Return the largest normal speed of points that carry an impulse, m/s."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    velocity, most = twelve(), 0.0
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers, fields = contact_row(world, order[k, 0]), linked_constraint(world, order[k, 0])
        a, b = linked_bodies(world, order[k, 0])
        read_both(world, MOTION, a, b, velocity)
        for i in range(d.TANGENT):
            if numbers[d.ACTIVE + i] != 0.0 and fields[impulse_field(i) * c.WIDTH] > 0.0:
                most = max(most, abs(along(wrench_of(numbers, i), velocity)))
    return most

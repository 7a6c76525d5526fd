"""From manifolds to constraints: coloured so that no two of a colour move the same body, and laid out in lanes."""

from numba import carray

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts import prepare_simd as r
from kickdrift.world.contacts.contact_solver_simd import SWEEP
from kickdrift.world.contacts.gather import gather, softness
from kickdrift.world.contacts.transposing import fetch_rows
from kickdrift.world.flight import AWAKE, LINK_PLACE
from kickdrift.world.settings import SLOP, STEP, SUBSTEPS
from kickdrift.world.step_status import ask_for_room
from kickdrift.world.tables import (
    BODY,
    COLOURED,
    COLOURS,
    CONTACT,
    CONTACT_ROW,
    GROUPS,
    INVERSE_MASS,
    LANES,
    MANIFOLD,
    SETTINGS,
    SWEEPS,
    flat,
    flat_integers,
    floats,
    integers,
    room,
    rows,
    set_rows,
)

_COLOURS = 62
_MANY = 250  # groups, whose manifolds do not fit into a megabyte
_RAW, _SCRATCH = r.RAW * c.WIDTH, r.SCRATCH_SIZE

sweep = caller(SWEEP)

OVERFLOW = _COLOURS  # contacts that found no colour: one by one, in groups of their own
LINKED = OVERFLOW + 1  # and those that are solved directly: see `kickdrift.world.direct`


@compiled
def colour(t: float, h: float, world: int) -> None:
    """Give every contact that has points a colour, and every colour its groups of lanes.

    Greedy, in the order of the contacts: the first colour that neither body has yet. Bodies that do not move have none.
    """
    contact, inverse_mass, body = integers(world, CONTACT), floats(world, INVERSE_MASS), integers(world, BODY)
    taken, colours = integers(world, COLOURED), integers(world, COLOURS)
    for k in range(rows(world, COLOURED)):
        taken[k, 0] = 0
    for k in range(LINKED + 1):
        colours[k, c.COLOUR_CONTACTS] = 0
    for row in range(rows(world, CONTACT)):
        contact[row, c.PLACE_IN_GROUPS] = -1
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        if contact[row, c.POINTS] == 0 or contact[row, c.CONTACT_STATE] & c.SENSOR:
            continue
        if body[a, AWAKE] == 0 and body[b, AWAKE] == 0:
            continue
        moves_a, moves_b = inverse_mass[a, 0] > 0.0, inverse_mass[b, 0] > 0.0
        node_a, node_b = body[a, LINK_PLACE] > 0, body[b, LINK_PLACE] > 0
        if (node_a or node_b) and (node_a or not moves_a) and (node_b or not moves_b):
            contact[row, c.PLACE_IN_GROUPS] = LINKED
            colours[LINKED, c.COLOUR_CONTACTS] += 1
            continue
        used = (taken[a, 0] if moves_a else 0) | (taken[b, 0] if moves_b else 0)
        k = 0
        while k < _COLOURS and used >> k & 1:
            k += 1
        if k < _COLOURS:
            if moves_a:
                taken[a, 0] |= 1 << k
            if moves_b:
                taken[b, 0] |= 1 << k
        contact[row, c.PLACE_IN_GROUPS] = k
        colours[k, c.COLOUR_CONTACTS] += 1
    first = 0
    for k in range(LINKED + 1):
        count = colours[k, c.COLOUR_CONTACTS]
        colours[k, c.FIRST_GROUP] = first
        first += count if k >= OVERFLOW else (count + c.WIDTH - 1) // c.WIDTH
        colours[k, c.AFTER_GROUP] = first
    if first > room(world, GROUPS):
        ask_for_room(world, GROUPS, first)
        return
    if first * c.FIELDS * c.WIDTH > room(world, LANES):
        ask_for_room(world, LANES, first * c.FIELDS * c.WIDTH)
        return
    if colours[LINKED, c.COLOUR_CONTACTS] > room(world, CONTACT_ROW):
        ask_for_room(world, CONTACT_ROW, colours[LINKED, c.COLOUR_CONTACTS])
        return
    set_rows(world, CONTACT_ROW, colours[LINKED, c.COLOUR_CONTACTS])
    set_rows(world, GROUPS, first)


@compiled(inline=True)
def lanes_of(world: int, g: int) -> int:
    """Lanes of a group that are worked on: the first one alone where its contact is solved directly."""
    count: int = integers(world, SWEEPS)[0, c.LANE_COUNT]
    return 1 if g >= integers(world, COLOURS)[LINKED, c.FIRST_GROUP] else count


@compiled
def prepare(t: float, h: float, world: int) -> None:
    """Fill the groups with constraints."""
    contact, colours, groups = integers(world, CONTACT), integers(world, COLOURS), integers(world, GROUPS)
    lanes = flat(world, LANES)
    for g in range(rows(world, GROUPS)):
        for lane in range(c.WIDTH):
            groups[g, c.BODIES_A + lane], groups[g, c.BODIES_B + lane], groups[g, c.GROUP_CONTACTS + lane] = 0, 0, -1
    for k in range(LINKED + 1):
        colours[k, c.COLOUR_CONTACTS] = 0
    for row in range(rows(world, CONTACT)):
        k = contact[row, c.PLACE_IN_GROUPS]
        if k < 0:
            continue
        index = colours[k, c.COLOUR_CONTACTS]
        colours[k, c.COLOUR_CONTACTS] += 1
        group, lane = colours[k, c.FIRST_GROUP] + index // c.WIDTH, index % c.WIDTH
        if k >= OVERFLOW:
            group, lane = colours[k, c.FIRST_GROUP] + index, 0
        contact[row, c.PLACE_IN_GROUPS] = group * c.WIDTH + lane
        groups[group, c.BODIES_A + lane] = contact[row, c.BODY_A]
        groups[group, c.BODIES_B + lane] = contact[row, c.BODY_B]
        groups[group, c.GROUP_CONTACTS + lane] = row
    raw, sweeps, settings = carray(floats_on_stack(_RAW), (_RAW,)), integers(world, SWEEPS), floats(world, SETTINGS)
    slop = settings[0, SLOP]
    substep = settings[0, STEP] / settings[0, SUBSTEPS]
    scratch = carray(floats_on_stack(_SCRATCH), (_SCRATCH,))
    soft, softer = softness(world, True), softness(world, False)
    for k in range(_SCRATCH):
        scratch[k] = 0.0
    numbers, many = flat_integers(world, GROUPS), rows(world, GROUPS) > _MANY
    for g in range(rows(world, GROUPS)):
        if many and g + 1 < rows(world, GROUPS):
            for k in range(0, MANIFOLD.width, 8):  # a cache line each
                fetch_rows(floats(world, MANIFOLD), k, numbers, GROUPS.width * (g + 1) + c.GROUP_CONTACTS)
        n = lanes_of(world, g)
        for lane in range(n):
            scratch[r.MARK * c.WIDTH + lane] = 1.0
            row = groups[g, c.GROUP_CONTACTS + lane]
            if row >= 0:
                gather(world, row, soft, softer, raw[lane:], scratch[lane:])
                continue
            for k in range(r.RAW):
                raw[k * c.WIDTH + lane] = 0.0
            for k in range(r.INERTIA_A, r.MARK):
                scratch[k * c.WIDTH + lane] = 0.0
        own = lanes[g * c.FIELDS * c.WIDTH : (g + 1) * c.FIELDS * c.WIDTH]
        sweep(sweeps[0, c.FILL], (own, raw, substep, 0.0, 0.0, n))
        sweep(sweeps[0, c.REFRESH], (own, scratch, slop, 0.0, 0.0, n))
        sweep(sweeps[0, c.REFRESH_FRICTION], (own, scratch, 0.0, 0.0, 0.0, n))

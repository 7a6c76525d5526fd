"""Contacts of links, solved with the answer of the whole articulation.

A foot of 1 kg on which 75 kg stand answers an impulse from the ground like 76 kg. A contact that took it for 1 kg would push it
up at a speed that the joints then hand on to all the rest, and gain energy from step to step. So these contacts are solved
after the joints, one after the other, each with what the joints make of its impulses (by the factors of the joints' own
solution), and at the end the joints are given what they passed on. It is projected Gauss-Seidel in the coordinates of the
joints, as engines for robots have it: Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 11.

Joints that close loops are left out of the answer, which makes it too large: such contacts come to rest more slowly.

A row of `LINK_CONTACTS` is the answers of `kickdrift.world.contacts.coupled`, 12 numbers a row of the contact, and ANSWERED.
"""

from typing import Any

from kickdrift.core.compilation import compiled, specialise
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.coupled import (
    bounces,
    forget,
    grip,
    note_hits,
    press,
)
from kickdrift.world.contacts.impact import slowest_bounce
from kickdrift.world.contacts.looking import RESTITUTION as BOUNCINESS
from kickdrift.world.contacts.prepare import LINKED
from kickdrift.world.flight import LINK_COUNT
from kickdrift.world.joints.answers import (
    answer_as_of_now,
    ask_nothing,
    compare_pieces,
    find_answers,
    link_row,
    read_both,
    stir,
    twelve,
)
from kickdrift.world.joints.falling import let_fall
from kickdrift.world.joints.handing import hand_on, is_touched
from kickdrift.world.joints.impulses import push_body
from kickdrift.world.joints.layout import (
    LOAD,
)
from kickdrift.world.joints.propagation import bring_down
from kickdrift.world.settings import PUSH_SPEED
from kickdrift.world.tables import (
    ARTICULATION,
    BODY,
    CHANGE,
    COLOURS,
    CONTACT,
    GROUPS,
    KICKED,
    LANES,
    LINK_CONTACTS,
    LINK_NUMBERS,
    MOTION,
    PLACE,
    SETTINGS,
    flat,
    floats,
    integers,
    rows,
)

_SIZE = c.FIELDS * c.WIDTH
_BOUNCE_SWEEPS = 50  # so that what lands flat does not turn

SOFT = 1.0


def _touch(t: float, h: float, world: int) -> None:
    """Solve all contacts of links, softly where `SOFT` is 1.0, and with friction where it is 0.0."""
    colours, groups = integers(world, COLOURS), integers(world, GROUPS)
    answers, lanes = floats(world, LINK_CONTACTS), flat(world, LANES)
    first, end = colours[LINKED, 1], colours[LINKED, 2]
    ask_nothing(world)
    if first == end:
        if SOFT > 0.0:
            let_fall(world)
        return
    if SOFT > 0.0:
        answer_as_of_now(h, world)
    compare_pieces(h, world)
    find_answers(first, end, world)
    velocity, given, moved, slowest = twelve(), twelve(), twelve(), slowest_bounce(h, world)
    wrench, other, bounced = twelve(), twelve(), False
    for g in range(first, end):
        own, answer = lanes[g * _SIZE : (g + 1) * _SIZE], answers[g - first]
        _read_velocities(g, velocity, world)
        read_both(CHANGE, g, moved, world)
        for k in range(12):
            given[k] = 0.0
        if SOFT > 0.0:
            e = _restitution(groups[g, 2 * c.WIDTH], world)
            read_both(KICKED, g, other, world)
            note_hits(own, answer, moved, wrench, e, slowest, h, other, velocity)
            press(own, answer, moved, wrench, SOFT, h, floats(world, SETTINGS)[0, PUSH_SPEED], velocity, given)
        else:
            bounced = bounced or bounces(answer)
            grip(own, answer, wrench, other, velocity, given)
            press(own, answer, moved, wrench, SOFT, h, 0.0, velocity, given)
        _give_both(g, given, world)
    if bounced:
        _bounce(h, world)
    for row in range(rows(world, ARTICULATION)):
        if is_touched(row, world):
            hand_on(row, SOFT > 0.0, world)
    if SOFT > 0.0:
        let_fall(world)


@compiled(cached=False)
def _restitution(row: int, world: int) -> float:
    """Coefficient of restitution of a contact that `kickdrift.world.contacts.impact` leaves to its articulation."""
    contact, place, body = integers(world, CONTACT)[row], floats(world, PLACE), integers(world, BODY)
    if max(body[contact[c.BODY_A], LINK_COUNT], body[contact[c.BODY_B], LINK_COUNT]) < 2:
        return 0.0
    e: float = max(place[contact[c.SHAPE_A], BOUNCINESS], place[contact[c.SHAPE_B], BOUNCINESS])
    return e


@compiled(cached=False)
def _bounce(h: float, world: int) -> None:
    """Sweep over all points of contacts that bounce until they have the velocities wanted, and forget their impulses.

    All at once: of two links that are hit, the second would push the first one on through their joint, and gain energy.
    """
    colours, groups = integers(world, COLOURS), integers(world, GROUPS)
    answers, lanes, first = floats(world, LINK_CONTACTS), flat(world, LANES), colours[LINKED, 1]
    velocity, given, moved, wrench = twelve(), twelve(), twelve(), twelve()
    for _ in range(_BOUNCE_SWEEPS):
        for g in range(first, colours[LINKED, 2]):
            if bounces(answers[g - first]):
                own = lanes[g * _SIZE : (g + 1) * _SIZE]
                _read_velocities(g, velocity, world)
                read_both(CHANGE, g, moved, world)
                for k in range(12):
                    given[k] = 0.0
                press(own, answers[g - first], moved, wrench, 0.0, h, 0.0, velocity, given)
                _give_both(g, given, world)
    for g in range(first, colours[LINKED, 2]):
        if bounces(answers[g - first]):
            integers(world, CONTACT)[groups[g, 2 * c.WIDTH], c.STATE] |= c.HIT
            forget(lanes[g * _SIZE : (g + 1) * _SIZE])


@compiled(cached=False)
def _read_velocities(g: int, velocity: Any, world: int) -> None:
    """Read the velocities of both bodies of a contact, with what has been asked of their joints so far."""
    read_both(MOTION, g, velocity, world)
    for side in range(2):
        link = link_row(integers(world, GROUPS)[g, c.WIDTH * side], world)
        if link >= 0:
            v, w = bring_down(link, world)
            for k in range(3):
                velocity[6 * side + k] += v[k]
                velocity[6 * side + 3 + k] += w[k]


@compiled(cached=False)
def _give_both(g: int, wrench: Any, world: int) -> None:
    """Give both bodies what a contact has found: at once, or, a link, for the joints to hand on."""
    work = floats(world, LINK_NUMBERS)
    for side in range(2):
        body, own = integers(world, GROUPS)[g, c.WIDTH * side], wrench[6 * side :]
        link = link_row(body, world)
        if link < 0:
            push_body(body, (own[0], own[1], own[2]), (own[3], own[4], own[5]), world)
            continue
        for k in range(6):
            work[link, LOAD + k] += own[k]
        stir(link, own, world)


solve_link_contacts = compiled(specialise(_touch, "solve_link_contacts", SOFT=1.0))
relax_link_contacts = compiled(specialise(_touch, "relax_link_contacts", SOFT=0.0))

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

from numba import carray

from kickdrift.core.compilation import compiled, specialise
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import applied, length
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.coupled import ANSWERED, ROWS, bounces, grip, note_hits, press, slid_past, write_row
from kickdrift.world.contacts.impact import slowest_bounce
from kickdrift.world.contacts.looking import RESTITUTION as BOUNCINESS
from kickdrift.world.contacts.prepare import LINKED
from kickdrift.world.flight import LINK_COUNT, LINK_PLACE
from kickdrift.world.joints.aim import look_here
from kickdrift.world.joints.articulated import factor
from kickdrift.world.joints.falling import let_fall
from kickdrift.world.joints.handing import hand_on, is_touched
from kickdrift.world.joints.layout import (
    ANEW,
    ANGULAR_PART,
    FIRST,
    IMPACT,
    LINK_JOINT,
    LINKS,
    LOAD,
    NONE,
    PIECES,
    SEQUENTIAL,
    SLOPE,
    STIRRED,
    TOUCHED,
    TURN_RESPONSE,
    YIELD,
)
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.propagation import bring_down, carry_up
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
    LINK,
    LINK_CONTACTS,
    LINK_NUMBERS,
    MOTION,
    PLACE,
    RESPONSE,
    SETTINGS,
    Table,
    flat,
    floats,
    integers,
    rows,
)

_SIZE = c.FIELDS * c.WIDTH
_BOUNCE_SWEEPS = 50  # over the points of a manifold, so that one that lands flat does not turn
_FAST = 0.03  # turn in a substep beyond which answers are found for each, and not for the step

SOFT = 1.0


def _touch(t: float, h: float, world: int) -> None:
    """Solve all contacts of links, softly where `SOFT` is 1.0, and with friction where it is 0.0."""
    colours, groups = integers(world, COLOURS), integers(world, GROUPS)
    answers, lanes = floats(world, LINK_CONTACTS), flat(world, LANES)
    first, end = colours[LINKED, 1], colours[LINKED, 2]
    _forget(world)
    if first == end:
        if SOFT > 0.0:
            let_fall(world)
        return
    if SOFT > 0.0:
        _answer_as_of_now(h, world)
    _compare_pieces(h, world)
    _find_answers(first, end, world)
    velocity, given, moved, slowest = _twelve(), _twelve(), _twelve(), slowest_bounce(h, world)
    wrench, other = _twelve(), _twelve()
    for g in range(first, end):
        own, answer = lanes[g * _SIZE : (g + 1) * _SIZE], answers[g - first]
        for side in range(2):
            row = groups[g, c.WIDTH * side]
            _velocity(row, _link(row, world), velocity[6 * side :], world)
        _read(CHANGE, g, moved, world)
        for k in range(12):
            given[k] = 0.0
        if SOFT > 0.0:
            e = _restitution(groups[g, 2 * c.WIDTH], world)
            _read(KICKED, g, other, world)
            note_hits(own, answer, moved, wrench, e, slowest, h, other, velocity)
            press(own, answer, moved, wrench, SOFT, h, floats(world, SETTINGS)[0, PUSH_SPEED], velocity, given)
        else:
            grip(own, answer, moved, wrench, other, velocity, given)
            for _ in range(_BOUNCE_SWEEPS if bounces(answer) else 1):
                press(own, answer, moved, wrench, SOFT, h, 0.0, velocity, given)
        for side in range(2):
            row = groups[g, c.WIDTH * side]
            _give(row, _link(row, world), given[6 * side :], world)
    for row in range(rows(world, ARTICULATION)):
        if is_touched(row, world):
            hand_on(row, SOFT > 0.0, world)
    if SOFT > 0.0:
        let_fall(world)


@compiled(inline=True, cached=False)
def _link(body: int, world: int) -> int:
    """Row of the link that a body is, or NONE: one whose joints found no solution answers as if it were alone."""
    link = integers(world, BODY)[body, LINK_PLACE] - 1
    return NONE if link >= 0 and floats(world, LINK_NUMBERS)[link, ANEW] < 0.0 else link


@compiled(cached=False)
def _restitution(row: int, world: int) -> float:
    """Coefficient of restitution of a contact that `kickdrift.world.contacts.impact` leaves to its articulation."""
    contact, place, body = integers(world, CONTACT)[row], floats(world, PLACE), integers(world, BODY)
    if max(body[contact[c.BODY_A], LINK_COUNT], body[contact[c.BODY_B], LINK_COUNT]) < 2:
        return 0.0
    e: float = max(place[contact[c.SHAPE_A], BOUNCINESS], place[contact[c.SHAPE_B], BOUNCINESS])
    return e


@compiled(inline=True, cached=False)
def _twelve() -> Any:
    return carray(floats_on_stack(12), (12,))


@compiled(cached=False)
def _forget(world: int) -> None:
    """Begin with nothing asked of any joint."""
    articulations, links, work = integers(world, ARTICULATION), integers(world, LINK), floats(world, LINK_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, SEQUENTIAL] == 0:
            for link in range(articulations[row, FIRST], articulations[row, FIRST] + articulations[row, LINKS]):
                work[link, TOUCHED] = 0.0
                for k in range(6):
                    work[link, LOAD + k] = 0.0
                    work[link, STIRRED + k] = 0.0
                    if links[link, LINK_JOINT] < 0:
                        work[link, IMPACT + k] = 0.0


@compiled(cached=False)
def _answer_as_of_now(h: float, world: int) -> None:
    """Let articulations that turn fast answer as their joints hold now, instead of at the end of the substep.

    The answer for the end is the less symmetric the farther they turn, and contacts that take it for one gain energy.
    """
    articulations, links = integers(world, ARTICULATION), integers(world, LINK)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, SEQUENTIAL] != 0:
            continue
        first, count, fastest = articulations[row, FIRST], articulations[row, LINKS], 0.0
        for link in range(first, first + count):
            fastest = max(fastest, h * length(vector_at(floats(world, MOTION), links[link, LINK_BODY], ANGULAR_PART)))
        if fastest > _FAST:
            for link in range(first, first + count):
                if links[link, LINK_JOINT] >= 0:
                    look_here(links[link, LINK_JOINT], link, world)
            factor(first, count, 0.0, world)


@compiled(cached=False)
def _compare_pieces(h: float, world: int) -> None:
    """Say of each articulation whether it answers in another way than before: turns fast, or has laws on other pieces."""
    articulations, links, work = integers(world, ARTICULATION), integers(world, LINK), floats(world, LINK_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, SEQUENTIAL] == 0:
            first, after, anew = articulations[row, FIRST], articulations[row, FIRST] + articulations[row, LINKS], 0.0
            for link in range(first, after):
                pieces = 0
                for k in range(6):
                    pieces |= (1 << k if work[link, YIELD + k] > 0.0 else 0) | (
                        64 << k if work[link, SLOPE + k] > 0.0 else 0
                    )
                turn = h * length(vector_at(floats(world, MOTION), links[link, LINK_BODY], ANGULAR_PART))
                anew = 1.0 if pieces != work[link, PIECES] or turn > _FAST else anew
                work[link, PIECES] = pieces
            for link in range(first, after):
                work[link, ANEW] = anew


@compiled(cached=False)
def _find_answers(first: int, end: int, world: int) -> None:
    """Find how bodies answer the rows of contacts: once a step, and where the articulation has changed how it does."""
    answers, groups = floats(world, LINK_CONTACTS), integers(world, GROUPS)
    lanes, work, wrench, backwards = flat(world, LANES), floats(world, LINK_NUMBERS), _twelve(), _twelve()
    moved = _twelve()
    for g in range(first, end):
        anew = False
        for side in range(2):
            place = integers(world, BODY)[groups[g, c.WIDTH * side], LINK_PLACE] - 1
            anew = anew or (place >= 0 and work[place, ANEW] != 0.0)
        if answers[g - first, ANSWERED] != 0.0 and not anew:
            continue
        answers[g - first, ANSWERED] = 1.0
        own = lanes[g * _SIZE : (g + 1) * _SIZE]
        _read(CHANGE, g, moved, world)
        slid = slid_past(own, moved)
        for row in range(ROWS):
            write_row(own, row, slid, wrench)
            for k in range(12):
                backwards[k] = -wrench[k]
            for side in range(2):
                place = _link(groups[g, c.WIDTH * side], world)
                _stir(place, wrench[6 * side :], world)
            for side in range(2):
                of = groups[g, c.WIDTH * side]
                _answer(of, _link(of, world), wrench[6 * side :], answers[g - first, 12 * row + 6 * side :], world)
            for side in range(2):
                place = _link(groups[g, c.WIDTH * side], world)
                _stir(place, backwards[6 * side :], world)
    _forget(world)


@compiled(cached=False)
def _read(table: Table, g: int, numbers: Any, world: int) -> None:
    """Read the first six numbers of both bodies of a contact."""
    groups, columns = integers(world, GROUPS), floats(world, table)
    for side in range(2):
        for k in range(6):
            numbers[6 * side + k] = columns[groups[g, c.WIDTH * side], k]


@compiled(cached=False)
def _stir(link: int, wrench: Any, world: int) -> None:
    if link >= 0:
        carry_up(link, (wrench[0], wrench[1], wrench[2]), (wrench[3], wrench[4], wrench[5]), world)


@compiled(cached=False)
def _answer(body: int, link: int, wrench: Any, answer: Any, world: int) -> None:
    """Velocity that a body has been given: by what has been carried up, or by its own wrench if it is no link."""
    response = floats(world, RESPONSE)
    if link >= 0:
        v, w = bring_down(link, world)
    else:
        m = response[body, 0]
        v = (m * wrench[0], m * wrench[1], m * wrench[2])
        w = applied(symmetric_at(response, body, TURN_RESPONSE), (wrench[3], wrench[4], wrench[5]))
    for k in range(3):
        answer[k], answer[3 + k] = v[k], w[k]


@compiled(cached=False)
def _velocity(body: int, link: int, velocity: Any, world: int) -> None:
    motion = floats(world, MOTION)
    for k in range(6):
        velocity[k] = motion[body, k]
    if link >= 0:
        v, w = bring_down(link, world)
        for k in range(3):
            velocity[k] += v[k]
            velocity[3 + k] += w[k]


@compiled(cached=False)
def _give(body: int, link: int, wrench: Any, world: int) -> None:
    """Give a body what a contact has found: at once, or, of a link, for the joints to hand on."""
    motion, response, work = floats(world, MOTION), floats(world, RESPONSE), floats(world, LINK_NUMBERS)
    if link < 0:
        turn = applied(symmetric_at(response, body, TURN_RESPONSE), (wrench[3], wrench[4], wrench[5]))
        for k in range(3):
            motion[body, k] += response[body, 0] * wrench[k]
            motion[body, 3 + k] += turn[k]
        return
    for k in range(6):
        work[link, LOAD + k] += wrench[k]
    _stir(link, wrench, world)


solve_link_contacts = compiled(specialise(_touch, "solve_link_contacts", SOFT=1.0))
relax_link_contacts = compiled(specialise(_touch, "relax_link_contacts", SOFT=0.0))

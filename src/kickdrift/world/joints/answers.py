"""How bodies answer the rows of contacts of links: with what their joints make of it.

Found by the factors of the joints' own solution, once a step, and again where an articulation has come to answer in another
way.
"""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import applied, length
from kickdrift.world.columns import symmetric_at, vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.coupled import ANSWERED, ROWS, write_row
from kickdrift.world.flight import LINK_PLACE
from kickdrift.world.joints.aim import look_here
from kickdrift.world.joints.articulated import factor
from kickdrift.world.joints.layout import (
    ANEW,
    ANGULAR_PART,
    FIRST,
    IMPACT,
    LINK_JOINT,
    LINKS,
    LOAD,
    LOST,
    PIECES,
    SEQUENTIAL,
    SLOPE,
    STIRRED,
    TOUCHED,
    TURN_RESPONSE,
    WILD,
    YIELD,
)
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.propagation import bring_down, carry_up
from kickdrift.world.tables import (
    ARTICULATION,
    BODY,
    GROUPS,
    LANES,
    LINK,
    LINK_CONTACTS,
    LINK_NUMBERS,
    MOTION,
    RESPONSE,
    Table,
    flat,
    floats,
    integers,
    rows,
)

_SIZE = c.FIELDS * c.WIDTH
# Turns in a substep: beyond the first, answers are found for each, and not for the step; beyond the second, impulses of the
# substep before are forgotten.
_FAST, _WILD_TURN = 0.03, 0.3


@compiled(inline=True, cached=False)
def link_row(body: int, world: int) -> int:
    """Row of the link that a body is; -1 if it is none."""
    link: int = integers(world, BODY)[body, LINK_PLACE] - 1
    return link


@compiled(inline=True, cached=False)
def twelve() -> Any:
    """Return room for the velocities of two bodies, or for what acts on them."""
    return carray(floats_on_stack(12), (12,))


@compiled(cached=False)
def ask_nothing(world: int) -> None:
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
def answer_as_of_now(h: float, world: int) -> None:
    """Let articulations that turn fast answer as their joints hold now, instead of at the end of the substep.

    The answer for the end is the less symmetric the farther they turn, and contacts that take it for one gain energy.
    """
    articulations, links = integers(world, ARTICULATION), integers(world, LINK)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, SEQUENTIAL] != 0:
            continue
        first, count = articulations[row, FIRST], articulations[row, LINKS]
        if _fastest_turn(row, h, world) > _FAST:
            for link in range(first, first + count):
                if links[link, LINK_JOINT] >= 0:
                    look_here(links[link, LINK_JOINT], link, world)
            factor(first, count, 0.0, world)


@compiled(cached=False)
def _fastest_turn(row: int, h: float, world: int) -> float:
    """Greatest angle by which a link of an articulation turns in the substep."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, motion, fastest = integers(world, LINK), floats(world, MOTION), 0.0
    for link in range(articulation[FIRST], articulation[FIRST] + articulation[LINKS]):
        fastest = max(fastest, h * length(vector_at(motion, links[link, LINK_BODY], ANGULAR_PART)))
    return fastest


@compiled(cached=False)
def compare_pieces(h: float, world: int) -> None:
    """Say of each articulation whether it answers in another way than before: turns fast, or has laws on other pieces."""
    articulations, work = integers(world, ARTICULATION), floats(world, LINK_NUMBERS)
    for row in range(rows(world, ARTICULATION)):
        if articulations[row, SEQUENTIAL] == 0:
            first, after = articulations[row, FIRST], articulations[row, FIRST] + articulations[row, LINKS]
            fastest = _fastest_turn(row, h, world)
            anew = 1.0 if fastest > _FAST else 0.0
            for link in range(first, after):
                pieces = 0
                for k in range(6):
                    pieces |= (1 << k if work[link, YIELD + k] > 0.0 else 0) | (
                        64 << k if work[link, SLOPE + k] > 0.0 else 0
                    )
                anew = 1.0 if pieces != work[link, PIECES] else anew
                work[link, PIECES] = pieces
            wild = articulations[row, LOST] != 0 or fastest > _WILD_TURN
            for link in range(first, after):
                work[link, ANEW] = WILD if wild else anew
                if wild:
                    work[link, PIECES] = -1.0  # so that what is found now is not kept


@compiled(cached=False)
def find_answers(first: int, end: int, world: int) -> None:
    """Find how bodies answer the rows of contacts: once a step, and where the articulation has changed how it does."""
    answers, groups = floats(world, LINK_CONTACTS), integers(world, GROUPS)
    lanes, work, wrench, backwards = flat(world, LANES), floats(world, LINK_NUMBERS), twelve(), twelve()
    for g in range(first, end):
        anew = False
        for side in range(2):
            place = link_row(groups[g, c.WIDTH * side], world)
            anew = anew or (place >= 0 and work[place, ANEW] != 0.0)
        if answers[g - first, ANSWERED] != 0.0 and not anew:
            continue
        answers[g - first, ANSWERED] = 1.0
        own = lanes[g * _SIZE : (g + 1) * _SIZE]
        for row in range(ROWS):
            write_row(own, row, wrench)
            for k in range(12):
                backwards[k] = -wrench[k]
            for side in range(2):
                place = link_row(groups[g, c.WIDTH * side], world)
                stir(place, wrench[6 * side :], world)
            for side in range(2):
                of = groups[g, c.WIDTH * side]
                _answer(of, link_row(of, world), wrench[6 * side :], answers[g - first, 12 * row + 6 * side :], world)
            for side in range(2):
                place = link_row(groups[g, c.WIDTH * side], world)
                stir(place, backwards[6 * side :], world)
    ask_nothing(world)


@compiled(cached=False)
def read_both(table: Table, g: int, numbers: Any, world: int) -> None:
    """Read the first six numbers of both bodies of a contact."""
    groups, columns = integers(world, GROUPS), floats(world, table)
    for side in range(2):
        for k in range(6):
            numbers[6 * side + k] = columns[groups[g, c.WIDTH * side], k]


@compiled(cached=False)
def stir(link: int, wrench: Any, world: int) -> None:
    """Let an impulse and an angular impulse act on a body, if it is a link."""
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

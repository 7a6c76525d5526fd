"""Contacts that begin and end."""

from typing import NamedTuple

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, minus, plus, turned
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.collision.shape_poses import shape_pose
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.layout import BEGINS, FIRST_BODY, FROM_SENSOR, SECOND_BODY
from kickdrift.world.step.status import ask_for_room
from kickdrift.world.tables import CONTACT, EVENTS, MANIFOLD, Tables, floats, integers, room, rows, set_rows


class ContactEvent(NamedTuple):
    """The beginning or end of a contact between two bodies; each pair of shapes of compound bodies has its own events.

    Attributes
    ----------
    begins : bool
        True if it begins, False if it ends.
    body_a, body_b : Body
    sensor : bool
        Whether one of the shapes is a sensor.
    """

    begins: bool
    body_a: Body
    body_b: Body
    sensor: bool


@compiled
def note_touching(t: float, h: float, world: int) -> None:
    """Append to EVENTS the contacts that began or stopped touching in the step."""
    contact, events = integers(world, CONTACT), integers(world, EVENTS)
    count = rows(world, EVENTS)
    changed = 0
    for row in range(rows(world, CONTACT)):
        changed += _touches(world, row) != contact[row, c.CONTACT_STATE] & c.TOUCHING
    if count + changed > room(world, EVENTS):
        ask_for_room(world, EVENTS, count + changed)
        return
    for row in range(rows(world, CONTACT)):
        now = _touches(world, row)
        contact[row, c.CONTACT_STATE] &= ~c.BOUNCED
        state = contact[row, c.CONTACT_STATE]
        if now == state & c.TOUCHING:
            continue
        contact[row, c.CONTACT_STATE] = state ^ c.TOUCHING
        events[count, BEGINS] = now
        events[count, FIRST_BODY], events[count, SECOND_BODY] = contact[row, c.BODY_A], contact[row, c.BODY_B]
        events[count, FROM_SENSOR] = (state & c.SENSOR) // c.SENSOR
        count += 1
    set_rows(world, EVENTS, count)


@compiled
def _touches(world: int, row: int) -> int:
    """Return TOUCHING if a contact carries an impulse or has bounced or, for a sensor, if its shapes overlap; 0 otherwise."""
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    points = contact[row, c.POINTS]
    if contact[row, c.CONTACT_STATE] & c.SENSOR:
        return _overlap(world, row)
    if contact[row, c.CONTACT_STATE] & c.BOUNCED:
        return c.TOUCHING
    if contact[row, c.PLACE_IN_GROUPS] < 0:
        return contact[row, c.CONTACT_STATE] & c.TOUCHING if points > 0 else 0
    for k in range(points):
        if manifold[row, c.NORMAL_IMPULSE + k] > 0.0:
            return c.TOUCHING
    return 0


@compiled
def _overlap(world: int, row: int) -> int:
    """Return TOUCHING if the shapes of a contact overlap at one of its points, or 0."""
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    at_a, turn_a = shape_pose(world, contact[row, c.SHAPE_A])
    at_b, turn_b = shape_pose(world, contact[row, c.SHAPE_B])
    normal = turned(turn_a, vector_at(manifold, row, c.NORMAL))
    for k in range(contact[row, c.POINTS]):
        p = c.POINT + c.POINT_SIZE * k
        on_a = plus(at_a, turned(turn_a, vector_at(manifold, row, p + c.ON_A)))
        on_b = plus(at_b, turned(turn_b, vector_at(manifold, row, p + c.ON_B)))
        if dot(normal, minus(on_b, on_a)) <= 0.0:
            return c.TOUCHING
    return 0


def events(tables: Tables, bodies: Bodies) -> list[ContactEvent]:
    """Return the contacts that have begun or ended, in order."""
    return [
        ContactEvent(
            bool(row[BEGINS]),
            bodies.handle(int(row[FIRST_BODY])),
            bodies.handle(int(row[SECOND_BODY])),
            bool(row[FROM_SENSOR]),
        )
        for row in np.asarray(tables.array(EVENTS))
    ]


def forget_contacts(tables: Tables, body: int) -> None:
    """Drop the events of a body that is removed and mark its contacts as not touching, since its row may be reused."""
    events_, contacts = tables.array(EVENTS), tables.array(CONTACT)
    kept = events_[(events_[:, FIRST_BODY] != body) & (events_[:, SECOND_BODY] != body)].copy()
    events_[: len(kept)] = kept
    tables.resize(EVENTS, len(kept))
    contacts[(contacts[:, c.BODY_A] == body) | (contacts[:, c.BODY_B] == body), c.CONTACT_STATE] &= ~c.TOUCHING


def touching(tables: Tables, bodies: Bodies) -> list[tuple[Body, Body]]:
    """Return the pairs of bodies that touch, each once, however many of their shapes do."""
    rows_ = tables.array(CONTACT)
    touch = rows_[rows_[:, c.CONTACT_STATE] & c.TOUCHING != 0][:, [c.BODY_A, c.BODY_B]].tolist()
    pairs = {(min(pair), max(pair)): pair for pair in reversed(touch)}
    return [(bodies.handle(a), bodies.handle(b)) for a, b in reversed(pairs.values())]

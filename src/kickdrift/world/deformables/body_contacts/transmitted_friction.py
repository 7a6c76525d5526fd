"""Friction between the bodies on both sides of a cloth, passed on through it at once.

What one contact loses the other one gains, so that the cloth keeps its velocity; what is left of both bounds acts on the cloth.
Sweeps over the two contacts of a light particle change the velocities of heavy bodies by its mass over theirs only. All three
steps, of either contact alone and of both together, lower the same convex function within the same bounds.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, dot, length, minus, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.body_contacts.contact_motion import push_touched
from kickdrift.world.deformables.body_contacts.load_path import carrier_of
from kickdrift.world.deformables.layout import (
    CARRIED_BY,
    CONTACT_FRICTION,
    CONTACT_IMPULSE,
    MOVES_BODY,
    PASSED_FRICTION,
    SHARES,
)
from kickdrift.world.tables import CLOTH_CONTACT, CLOTH_CONTACT_NUMBERS, floats, integers


@compiled
def pass_on_friction(world: int, row: int, slip: Vector, response: float, left: float) -> None:
    """Let bodies on both sides of a cloth change the velocity at which they slide past each other by -`slip`, m/s.

    `response` is their inverse mass along it, 1/kg.
    """
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    own, before = vector_at(numbers, row, CONTACT_IMPULSE + 1), vector_at(numbers, row, PASSED_FRICTION)
    friction = minus(before, times(1.0 / response, slip)) if response > 0.0 else before
    friction = minus(within(plus(own, friction), friction_bound(world, row)), own)
    friction = times(_part_held(world, row, before, friction), friction)
    change = minus(friction, before)
    for j in range(3):
        numbers[row, PASSED_FRICTION + j] = friction[j]
    for k in range(3):
        on = integers(world, CLOTH_CONTACT)[row, CARRIED_BY + k]
        for j in range(3 if on >= 0 else 0):
            numbers[on, PASSED_FRICTION + j] -= numbers[row, SHARES + k] * change[j]
    _push_both(world, row, change, left)


@compiled(inline=True)
def friction_bound(world: int, row: int) -> float:
    """Return Coulomb's bound of the friction of a contact on a load path in this part, N s."""
    numbers = floats(world, CLOTH_CONTACT_NUMBERS)
    bound: float = numbers[row, CONTACT_FRICTION] * numbers[row, CONTACT_IMPULSE]
    return bound


@compiled(inline=True)
def within(v: Vector, most: float) -> Vector:
    """Return a vector, shortened to a length."""
    return times(min(most / max(length(v), 1e-300), 1.0), v)


@compiled
def _part_held(world: int, row: int, before: Vector, friction: Vector) -> float:
    """Return which part of a friction to be passed on, N s, instead of `before`, is within the bounds of what carries it."""
    numbers, part = floats(world, CLOTH_CONTACT_NUMBERS), 1.0
    for k in range(3):
        on, share = carrier_of(world, row, k), numbers[row, SHARES + k]
        if on < 0:
            continue
        bound = friction_bound(world, on)
        own, passed = vector_at(numbers, on, CONTACT_IMPULSE + 1), vector_at(numbers, on, PASSED_FRICTION)
        others, more = plus(plus(own, passed), times(share, before)), times(-share, friction)
        spare, a, b = bound * bound - dot(others, others), dot(more, more), dot(others, more)
        if spare <= 0.0:
            return 0.0
        if a > 0.0:
            part = min(part, (math.sqrt(b * b + a * spare) - b) / a)
    return part


@compiled
def _push_both(world: int, row: int, impulse: Vector, left: float) -> None:
    """Apply an impulse to the bodies on both sides of the cloth, N s: to what carries it, and its opposite to the other one."""
    contact, numbers = integers(world, CLOTH_CONTACT), floats(world, CLOTH_CONTACT_NUMBERS)
    if dot(impulse, impulse) == 0.0:
        return
    push_touched(world, row, times(-1.0, impulse), left)
    for k in range(3):
        on = contact[row, CARRIED_BY + k]
        if on >= 0 and contact[on, MOVES_BODY] != 0:
            push_touched(world, on, times(numbers[row, SHARES + k], impulse), left)

"""The contacts of an island in its equations: their right-hand sides, and the assumed pieces of their laws."""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import length
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_lookup import contact_row, linked_bodies, linked_constraint
from kickdrift.world.direct.contact_rows import (
    GRIP,
    PRESSING,
    RIGID,
    RIGID_BOUNCE,
    SLIPPED,
    begin_row,
    bound_rows,
    find_bounds,
    first_row,
    fix_rows,
    impulse_field,
    share_stiffness,
    update_bound_states,
    update_point_states,
    weigh,
)
from kickdrift.world.direct.contact_wrenches import along, wrench_of
from kickdrift.world.direct.direct_bodies import is_across, mass_of, place_in
from kickdrift.world.joints.limits_motors import AFTER_DRIFT, BEFORE_DRIFT, IN_IMPACT
from kickdrift.world.settings import GRAVITY, PUSH_SPEED
from kickdrift.world.tables import DELTA_POSE, ISLAND, ISLAND_CONTACT, MOTION, SETTINGS, Table, floats, integers

# Fraction by which bounds of friction may differ from mu times their normal impulses. With less, the steps of sixteen ragdolls
# in a heap take up to three times as long.
_NEAR = 0.01

# Tasks of the contacts in a solution. PRESS: overlapping bodies are pushed apart, and separated ones may close their gap by the
# end of the substep.
PRESS = 0
REST = 1  # touching points do not approach
BOUNCE = 2  # points that hit leave with the speed of restitution, without friction
BOUNCE_FRICTION = 3  # friction of a bounce, which acts on the part of the motion that restitution leaves alone


@compiled(inline=True, cached=False, fast=True)
def phase_of(task: int) -> int:
    """Return when the laws of joints act in a task."""
    return BEFORE_DRIFT if task == PRESS else AFTER_DRIFT if task == REST else IN_IMPACT


@compiled(cached=False, fast=True)
def read_both(world: int, table: Table, a: int, b: int, numbers: Any) -> None:
    """Read the first six numbers of both bodies of a contact."""
    columns = floats(world, table)
    for k in range(6):
        numbers[k], numbers[6 + k] = columns[a, k], columns[b, k]


@compiled(inline=True, cached=False, fast=True)
def twelve() -> Any:
    """Return an array on the stack for the velocities of two bodies, or a wrench on both, (12,)."""
    return carray(floats_on_stack(12), (12,))


@compiled(cached=False, fast=True)
def begin_contacts(world: int, island: int, h: float, task: int) -> None:
    """Set the right-hand sides of all contacts of an island from the present velocities."""
    own = integers(world, ISLAND)[island]
    order = integers(world, ISLAND_CONTACT)
    fallen, mass = h * length(vector_at(floats(world, SETTINGS), 0, GRAVITY)), mass_of(world, island)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        weigh(
            linked_constraint(world, order[k, 0]),
            contact_row(world, order[k, 0]),
            fallen if task < BOUNCE else 0.0,
            mass,
        )
        _begin_contact(world, order[k, 0], island, h, task)


@compiled(cached=False, fast=True)
def _begin_contact(world: int, index: int, island: int, h: float, task: int) -> None:
    own, numbers = linked_constraint(world, index), contact_row(world, index)
    a, b = linked_bodies(world, index)
    velocity, change = twelve(), twelve()
    read_both(world, MOTION, a, b, velocity)
    read_both(world, DELTA_POSE, a, b, change)
    numbers[d.CUT] = 0.0
    for side in range(2):
        body = b if side == 1 else a
        numbers[d.NODES + side] = place_in(world, island, body)
        if is_across(world, island, body):
            numbers[d.CUT] = 1.0 + side
    presses, lever, returned = _begin_points(world, own, numbers, velocity, change, a, b, h, task)
    _begin_friction(world, own, numbers, velocity, a, b, task, presses, lever, returned)
    find_bounds(own, numbers)


@compiled(cached=False, fast=True)
def _begin_points(
    world: int, own: Any, numbers: Any, velocity: Any, change: Any, a: int, b: int, h: float, task: int
) -> tuple[bool, float, float]:
    """Set the target speeds of the points; return whether any is active, and their largest distance from the centre, m.

    Return also, for the friction of a bounce, which fraction of the smooth impulses restitution has given: e / (1 + e).
    """
    rigid = PRESSING if task == PRESS else RIGID if task == REST else RIGID_BOUNCE
    push, presses, lever, returned = floats(world, SETTINGS)[0, PUSH_SPEED], False, 0.0, 0.0
    for k in range(d.TANGENT):
        at = (c.P + c.POINT_FIELDS * k) * c.WIDTH
        if own[at + c.POINT_MASS * c.WIDTH] <= 0.0:
            numbers[d.ACTIVE + k], numbers[d.GIVEN + k], numbers[d.STATE + k] = 0.0, 0.0, 0.0
            continue
        speed, given = numbers[d.SPEED + k], numbers[d.GIVEN + k]
        begin_row(world, own, numbers, k, velocity, a, b, rigid)
        gap = own[at + c.GAP * c.WIDTH] + along(wrench_of(numbers, k), change)
        if task == PRESS:
            numbers[d.WANTED + k] = -gap / h if gap > 0.0 else min(-own[c.BIAS_RATE * c.WIDTH] * gap, push)
        elif task == REST and (
            (gap > 0.0 and numbers[d.IMPULSE + k] == 0.0)
            or numbers[d.SPEED + k] < -own[c.BOUNCE_THRESHOLD * c.WIDTH]  # it will bounce in the next substep
        ):
            numbers[d.ACTIVE + k] = 0.0
        elif task >= BOUNCE:
            numbers[d.ACTIVE + k] = 1.0 if numbers[d.HITS + k] >= 0.0 else 0.0
            numbers[d.WANTED + k], numbers[d.IMPULSE + k] = (
                numbers[d.HITS + k],
                given if task == BOUNCE_FRICTION else 0.0,
            )
            if task == BOUNCE_FRICTION and numbers[d.HITS + k] > 0.0:
                returned = numbers[d.HITS + k] / (numbers[d.HITS + k] - speed)
        presses, lever = presses or numbers[d.ACTIVE + k] != 0.0, max(lever, own[at + c.LEVER * c.WIDTH])
    return presses, lever, returned


@compiled(cached=False, fast=True)
def _begin_friction(
    world: int,
    own: Any,
    numbers: Any,
    velocity: Any,
    a: int,
    b: int,
    task: int,
    presses: bool,
    lever: float,
    returned: float,
) -> None:
    """Set the right-hand sides of friction, torsion and rolling resistance, if they can act."""
    grip = RIGID_BOUNCE if task >= BOUNCE else GRIP
    for bound in range(3):
        reach = own[(c.ROLL_RESISTANCE if bound == 2 else c.FRICTION) * c.WIDTH] * (lever if bound == 1 else 1.0)
        # Before the drift friction keeps the impulses of the substep before.
        if task in (PRESS, BOUNCE) or _is_idle(own, bound, reach if presses else 0.0):
            for k in range(first_row(bound), first_row(bound) + bound_rows(bound)):
                if task == BOUNCE:
                    begin_row(world, own, numbers, k, velocity, a, b, grip)
                numbers[d.ACTIVE + k], numbers[d.GIVEN + k], numbers[d.STATE + k] = 0.0, 0.0, 0.0
            continue
        for k in range(first_row(bound), first_row(bound) + bound_rows(bound)):
            speed = numbers[d.SPEED + k]
            begin_row(world, own, numbers, k, velocity, a, b, grip)
            numbers[d.DIRECTION + k] = 0.0
            if bound == 0:
                numbers[d.WANTED + k] = own[(c.SURFACE_SPEED + k - d.TANGENT) * c.WIDTH]
            if task == BOUNCE_FRICTION:
                numbers[d.IMPULSE + k] = 0.0
                numbers[d.WANTED + k] += returned * (numbers[d.SPEED + k] - speed)
        if bound == 2:
            share_stiffness(numbers)


@compiled(inline=True, cached=False, fast=True)
def _is_idle(own: Any, bound: int, reach: float) -> bool:
    """Whether friction, torsion or rolling resistance has neither a bound above zero nor an impulse to be removed."""
    idle = reach == 0.0
    for k in range(first_row(bound), first_row(bound) + bound_rows(bound)):
        idle = idle and own[impulse_field(k) * c.WIDTH] == 0.0
    return idle


@compiled(cached=False, fast=True)
def fastest_push(world: int, island: int) -> float:
    """Return the largest speed at which overlapping bodies of an island are to be pushed apart, m/s."""
    own, order, most = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), 0.0
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers = contact_row(world, order[k, 0])
        for i in range(d.TANGENT):
            if numbers[d.ACTIVE + i] != 0.0:
                most = max(most, numbers[d.WANTED + i])
    return most


@compiled(cached=False, fast=True)
def push_less(world: int, island: int, share: float) -> None:
    """Reduce the speeds at which overlapping bodies of an island are to be pushed apart to a share of them."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers = contact_row(world, order[k, 0])
        for i in range(d.TANGENT):
            numbers[d.WANTED + i] *= share if numbers[d.WANTED + i] > 0.0 else 1.0


@compiled(cached=False, fast=True)
def is_cut(world: int, island: int) -> bool:
    """Whether an island touches another one that is solved directly."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    cut = False
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        cut = cut or contact_row(world, order[k, 0])[d.CUT] != 0.0
    return cut


@compiled(cached=False, fast=True)
def note_impulses(world: int, island: int, back: bool) -> None:
    """Store the impulses with which the substep begins, or, with `back`, restore them."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers, fields = contact_row(world, order[k, 0]), linked_constraint(world, order[k, 0])
        for i in range(d.CONTACT_ROWS):
            if back:
                fields[impulse_field(i) * c.WIDTH] = numbers[d.START + i]
            else:
                numbers[d.START + i] = fields[impulse_field(i) * c.WIDTH]


@compiled(cached=False, fast=True)
def update_contact_states(world: int, island: int, task: int, first: bool, whole: bool) -> bool:
    """Assume the pieces of the laws of contacts that the current solution implies; return whether it was found with them."""
    own, order, settled = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), True
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers = contact_row(world, order[k, 0])
        settled = update_point_states(numbers, first, whole) and settled
        for bound in range(0 if task in (REST, BOUNCE_FRICTION) else 3, 3):
            if numbers[d.ACTIVE + first_row(bound)] != 0.0:
                settled = update_bound_states(numbers, bound, first) and settled
    return settled


@compiled(cached=False, fast=True)
def bounds_hold(world: int, island: int, task: int, unnoticed: float) -> bool:
    """Bound friction by the normal impulses of the solution; return whether it was found with these bounds.

    Or with others that change no velocity by more than `unnoticed`, m/s.
    """
    own, order, hold = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT), True
    if task not in (REST, BOUNCE_FRICTION):
        return True
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        numbers = contact_row(world, order[k, 0])
        before = numbers[d.BOUND]
        find_bounds(linked_constraint(world, order[k, 0]), numbers)
        near = max(_NEAR * before, max(SLIPPED, unnoticed) * numbers[d.ROW_MASS + d.TANGENT])
        hold = hold and abs(numbers[d.BOUND] - before) <= near
    return hold


@compiled(cached=False, fast=True)
def fix_contacts(world: int, island: int) -> None:
    """Fix the impulses of the contacts of an island to those of the accepted solution, within their bounds."""
    own, order = integers(world, ISLAND)[island], integers(world, ISLAND_CONTACT)
    for k in range(own[d.FIRST_CONTACT], own[d.AFTER_CONTACT]):
        fix_rows(linked_constraint(world, order[k, 0]), contact_row(world, order[k, 0]))

"""Heaps that the sweeps do not bring to rest: small ones are solved directly from then on.

A sweep carries an impulse from one contact to the next, so that a load ten or a hundred times as heavy as its support, a plate
under many boxes, or a tall tower needs more sweeps than a step has. The velocities show the residual: points that press on each
other separate or approach. A body with such points in several consecutive steps is *unsolved*, and so is its heap: all bodies
that contacts hold together. A single body is not a heap.

A step that leaves a small heap far from solved is repeated, with the heap solved directly: in two steps of sweeps a tower
of ten cubes, each 1.5 times as large as the one below, leans so far that it falls.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot
from kickdrift.world.collision.body_acceleration import acceleration, weight_per_mass
from kickdrift.world.collision.broad_phase.filters_and_sensors import is_solid
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.batch_division import CROWD
from kickdrift.world.contacts.residual import FAR_RESIDUAL, NOTED_RESIDUAL, TOUCHES
from kickdrift.world.direct.direct_bodies import moves
from kickdrift.world.disjoint_sets import first_of, unite
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import (
    AWAKE,
    BODY_KIND,
    BOUNDING_RADIUS,
    DYNAMIC,
    HEAP,
    HEAP_SIZE,
    HEAP_UNSOLVED,
    IN_HEAP,
    LEFT_FOR,
    LINK_PLACE,
    RESIDUAL_SIZE,
    UNSOLVED,
    VELOCITY,
)
from kickdrift.world.settings import HAS_DIRECT, UNSOLVED_BODY, UNSOLVED_SINCE
from kickdrift.world.step.status import (
    BEGIN_AGAIN,
    HALVINGS,
    LEFT_UNSOLVED,
    NEEDS_DIRECT_SOLVER,
    OK,
    REPEATED,
    STATUS,
    WARNING,
)
from kickdrift.world.tables import (
    BATCH,
    BODY,
    CONTACT,
    GRAPH,
    MANIFOLD,
    MOTION,
    RESTED,
    SETTINGS,
    STEP_STATUS,
    floats,
    integers,
    rows,
)

# Steps after which a heap of few bodies is unsolved; number of further bodies for each further step. A direct solution of 55
# boxes takes thirty times as long as the sweeps, whose pyramid comes to rest by itself; a card house of 40 falls if it waits
# for more than 20 steps.
_PATIENCE, _MORE = 6, 4

# Of the reach of a body: if gravity and forces move it by more in a step, its heap does not wait. Sweeps let a tower of five
# cubes of 5 mm sink by a quarter of an edge in the first step and by 0.7 in six, where cubes pass each other; one of 2 cm by a
# tenth.
_FALL = 0.25

# Largest number of bodies of a heap that is solved directly, in worlds of up to CROWD free bodies: a pile of 1000 boxes falls
# apart into small heaps, which would take thirty times as long. And the count of those that are solved directly.
LARGEST, _FOUND = 64, 1 << 16

# Seconds after which a warning says that a body is left unsolved, in a heap that is too large for a direct solution. 1024 cubes
# that fall into a heap are unsolved for 5 s before they come to rest.
TOO_LONG = 6.0


@compiled
def find_heaps(t: float, h: float, world: int) -> None:
    """Mark the bodies of small heaps that the sweeps have left unsolved for long, unless the world is a crowd."""
    body, status = integers(world, BODY), integers(world, STEP_STATUS)
    any_unsolved = False
    for row in range(rows(world, BODY)):
        body[row, IN_HEAP] = 0
        unsolved = body[row, UNSOLVED] >= _PATIENCE or _falls_far(world, h, row)
        any_unsolved = any_unsolved or (unsolved and body[row, AWAKE] != 0)
    if not any_unsolved:
        return
    found, small = False, _count_free(world) <= CROWD
    if small:
        _join_heaps(world, h)
    for row in range(rows(world, BODY)):
        size, unsolved = body[body[row, HEAP], HEAP_SIZE], body[body[row, HEAP], HEAP_UNSOLVED]
        if small and _is_free(world, row) and 1 < size <= LARGEST and unsolved >= _PATIENCE + size // _MORE:
            body[row, IN_HEAP], body[row, UNSOLVED], found = 1, _FOUND, True
    _forget_impulses(world)
    if found and floats(world, SETTINGS)[0, HAS_DIRECT] == 0.0 and status[0, STATUS] == OK:
        status[0, STATUS] = NEEDS_DIRECT_SOLVER


@compiled(inline=True)
def _falls_far(world: int, h: float, row: int) -> bool:
    """Whether gravity and forces bring a dynamic body a good part of its size in a step."""
    if integers(world, BODY)[row, BODY_KIND] != DYNAMIC:
        return False
    gained, reach = acceleration(world, row), _FALL * floats(world, RESTED)[row, BOUNDING_RADIUS]
    falls: bool = h**4 * dot(gained, gained) > reach * reach
    return falls


@compiled
def _forget_impulses(world: int) -> None:
    """Let contacts of bodies that return to the sweeps begin without impulses.

    In a world that has become a crowd, sweeps throw a light body at 50 m/s from those that bore 10,000 times its weight; where
    the load is taken away, at 1 m/s from those that bore 1000 times its weight.
    """
    body, contact, manifold = integers(world, BODY), integers(world, CONTACT), floats(world, MANIFOLD)
    any_left = False
    for row in range(rows(world, BODY)):
        any_left = any_left or _goes_back(world, row)
    if not any_left:
        return
    for row in range(rows(world, CONTACT)):
        if _goes_back(world, contact[row, c.BODY_A]) or _goes_back(world, contact[row, c.BODY_B]):
            for k in range(c.NORMAL_IMPULSE, c.TWIST_IMPULSE + 1):
                manifold[row, k] = 0.0
            for k in range(3):
                manifold[row, c.ROLLING_IMPULSE + k] = 0.0
    for row in range(rows(world, BODY)):
        if _goes_back(world, row):
            body[row, UNSOLVED] = 0


@compiled(inline=True)
def _goes_back(world: int, row: int) -> bool:
    """Whether a body was solved directly until now."""
    body = integers(world, BODY)
    does: bool = body[row, UNSOLVED] >= _FOUND and body[row, IN_HEAP] == 0 and body[row, AWAKE] != 0
    return does


@compiled(inline=True)
def _is_free(world: int, row: int) -> bool:
    """Whether a body moves, and no joint holds it."""
    place = integers(world, BODY)[row, LINK_PLACE]
    return moves(world, row) and (place == 0 or place > integers(world, GRAPH)[0, j.JOINED_ROWS])


@compiled
def _count_free(world: int) -> int:
    count = 0
    for row in range(rows(world, BODY)):
        count += _is_free(world, row)
    return count


@compiled
def _join_heaps(world: int, h: float) -> None:
    """Unite the free bodies that contacts hold together."""
    body, contact = integers(world, BODY), integers(world, CONTACT)
    for row in range(rows(world, BODY)):
        body[row, HEAP], body[row, HEAP_SIZE], body[row, HEAP_UNSOLVED] = row, 0, 0
    for row in range(rows(world, CONTACT)):
        a, b = contact[row, c.BODY_A], contact[row, c.BODY_B]
        if is_solid(contact, row) and _is_free(world, a) and _is_free(world, b):
            unite(body, HEAP, a, b)
    for row in range(rows(world, BODY)):
        if _is_free(world, row):
            first = first_of(body, HEAP, row)
            body[row, HEAP] = first
            body[first, HEAP_SIZE] += 1
            unsolved = _FOUND if _falls_far(world, h, row) else body[row, UNSOLVED]
            body[first, HEAP_UNSOLVED] = max(body[first, HEAP_UNSOLVED], unsolved)


@compiled
def ask_again(t: float, h: float, world: int) -> None:
    """Request that the step is repeated, once, if the sweeps have left a small heap far from solved."""
    body, status = integers(world, BODY), integers(world, STEP_STATUS)
    if status[0, REPEATED] != 0 or rows(world, BATCH) > 0:
        return  # batches are of a crowd
    any_far = False
    for row in range(rows(world, BODY)):
        any_far = any_far or _is_far_left(world, row)
    if not any_far or _count_free(world) > CROWD:
        return
    _join_heaps(world, h)
    found = False
    for row in range(rows(world, BODY)):
        size = body[body[row, HEAP], HEAP_SIZE]
        if _is_far_left(world, row) and _is_free(world, row) and 1 < size <= LARGEST:
            body[row, UNSOLVED], found = _PATIENCE + LARGEST // _MORE, True
    if found and status[0, STATUS] == OK:
        status[0, STATUS], status[0, REPEATED] = BEGIN_AGAIN, 1


@compiled(inline=True)
def _is_far_left(world: int, row: int) -> bool:
    """Whether sweeps have left a body far from solved in this step."""
    body = integers(world, BODY)
    far: bool = body[row, RESIDUAL_SIZE] & FAR_RESIDUAL != 0 and body[row, UNSOLVED] < _FOUND
    return far


@compiled
def count_unsolved(t: float, h: float, world: int) -> None:
    """Count for how many steps bodies were left unsolved; those solved directly stay so until they touch nothing.

    Sleeping bodies keep their count, so that a heap that wakes is solved as before.
    """
    body = integers(world, BODY)
    integers(world, STEP_STATUS)[0, REPEATED] = 0
    for row in range(rows(world, BODY)):
        if body[row, BODY_KIND] == DYNAMIC and body[row, AWAKE] == 0:
            body[row, LEFT_FOR] = body[row, RESIDUAL_SIZE] = 0
            continue
        _count_left(world, row, t, h)
        residual, count = body[row, RESIDUAL_SIZE], body[row, UNSOLVED]
        if count >= _FOUND:
            body[row, UNSOLVED] = count if residual & TOUCHES else 0
        elif residual & NOTED_RESIDUAL:
            body[row, UNSOLVED] = count + 1
        else:
            body[row, UNSOLVED] = 0
        body[row, RESIDUAL_SIZE] = 0


@compiled(inline=True)
def _count_left(world: int, row: int, t: float, h: float) -> None:
    """Count how long a resting body, slower than its weight makes it in a step, is left unsolved; report it after too long.

    Only whole steps are counted: parts are shorter, and may be many.
    """
    body = integers(world, BODY)
    if integers(world, STEP_STATUS)[0, HALVINGS] != 0:
        return
    v, gained = vector_at(floats(world, MOTION), row, VELOCITY), h * weight_per_mass(world, row)
    rests = body[row, BODY_KIND] == DYNAMIC and dot(v, v) < gained * gained
    if body[row, RESIDUAL_SIZE] & NOTED_RESIDUAL == 0 or not rests:
        body[row, LEFT_FOR] = max(body[row, LEFT_FOR] - 1, 0)
        return
    body[row, LEFT_FOR] += 1
    lasted, status, settings = body[row, LEFT_FOR] * h, integers(world, STEP_STATUS), floats(world, SETTINGS)
    if lasted >= TOO_LONG and status[0, WARNING] & LEFT_UNSOLVED == 0:
        settings[0, UNSOLVED_BODY], settings[0, UNSOLVED_SINCE] = row, max(t - lasted, 0.0)
        status[0, WARNING] |= LEFT_UNSOLVED

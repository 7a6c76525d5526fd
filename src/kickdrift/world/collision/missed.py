"""Contacts that were missed: what an impact makes fast within a step may meet what the search before it did not expect.

At the end of a step it is known who was elsewhere than expected, by more than the margin of the search. Where one of them may
have met a shape of which the step had no points, the step is done again, and the search knows then how these bodies move. What
was found once stays found, so that each time more is known.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, plus, product, turned
from kickdrift.world.collision.aabb import box_around, box_in_frame, boxes_overlap, fat_bounds, reaches_under
from kickdrift.world.collision.acceleration import reach
from kickdrift.world.collision.bvh import Box, gather
from kickdrift.world.collision.dispatch import extent_of, sort_of
from kickdrift.world.collision.filters import may_touch
from kickdrift.world.collision.foresight import OFF, TURNED_FARTHER, foresee, forget, surprise
from kickdrift.world.collision.narrow_phase import smallest
from kickdrift.world.collision.search_state import TRIES
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts.layout import CONTACT_STATE, POINTS, SENSOR, SHAPE_A, SHAPE_B, TRIANGLE_INDEX
from kickdrift.world.layout import (
    AWAKE,
    BEGIN,
    BODY_KIND,
    BODY_ROW,
    DYNAMIC,
    FIRST_TREE_NODE,
    IS_SENSOR,
    LAST_TREE_NODE,
    ORIENTATION,
    PLACE_ORIENTATION,
    PLACE_POSITION,
    PLACED_ORIENTATION,
    PLACED_POSITION,
    POSITION,
    RADIUS,
)
from kickdrift.world.settings import MARGIN
from kickdrift.world.shapes.record import HALF_SPACE, SURFACE
from kickdrift.world.shapes.triangle import triangle_box
from kickdrift.world.step_status import BEGIN_AGAIN, OK, STATUS, ask_for_room
from kickdrift.world.tables import (
    BODY,
    BOUNDS,
    CONTACT,
    FORESEEN,
    GEOMETRY,
    MOVERS,
    PLACE,
    PLACED,
    PLANES,
    POSE,
    SCRATCH,
    SEARCH,
    SETTINGS,
    SHAPE,
    STATIC_TREE,
    STEP_STATUS,
    TREE,
    TRIANGLE_TREE,
    Table,
    flat,
    floats,
    integers,
    room,
    rows,
)

_MOST = 8  # times that a step is done again


@compiled
def find_missed(t: float, h: float, world: int) -> None:
    """Ask for the step to be done again if it has missed a contact."""
    search, status = integers(world, SEARCH), integers(world, STEP_STATUS)
    any_off = _find_surprised(h, world)
    if any_off and search[0, TRIES] < _MOST:
        size = rows(world, SHAPE) + rows(world, TRIANGLE_TREE) + 2
        if room(world, SCRATCH) < size:
            ask_for_room(world, SCRATCH, size)
            return
        if _misses(world):
            for body in range(rows(world, BODY)):
                if floats(world, FORESEEN)[body, OFF] > 0.0 or floats(world, FORESEEN)[body, TURNED_FARTHER] > 0.0:
                    foresee(h, world, body)
            search[0, TRIES] += 1
            if status[0, STATUS] == OK:
                status[0, STATUS] = BEGIN_AGAIN
            return
    for body in range(rows(world, BODY)):
        forget(world, body)
    search[0, TRIES] = 0


@compiled
def _find_surprised(h: float, world: int) -> bool:
    """Note how far bodies are from where they were expected; return whether any is by as much as contacts are sought."""
    body, foreseen, found = integers(world, BODY), floats(world, FORESEEN), False
    margin = floats(world, SETTINGS)[0, MARGIN]
    for row in range(rows(world, BODY)):
        foreseen[row, OFF], foreseen[row, TURNED_FARTHER] = 0.0, 0.0
        if body[row, BODY_KIND] != DYNAMIC or body[row, AWAKE] == 0:
            continue
        off, farther = surprise(h, world, row)
        # What differs by less may be its rounding, or the bend of its path.
        foreseen[row, OFF] = off if off > 0.1 * margin else 0.0
        foreseen[row, TURNED_FARTHER] = farther
        found = found or off > 0.5 * margin or farther > 0.1
    return found


@compiled
def _misses(world: int) -> bool:
    """Whether a shape that was not where it was expected has come to one with which the step had no points."""
    contact, place, margin = integers(world, CONTACT), floats(world, PLACE), floats(world, SETTINGS)[0, MARGIN]
    for row in range(rows(world, CONTACT)):
        if contact[row, POINTS] != 0 or contact[row, CONTACT_STATE] & SENSOR != 0:
            continue
        a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
        # Who has come less deep into another shape than half of its size is pushed out again.
        far = max(margin, 0.5 * smallest(place[a, RADIUS], place[b, RADIUS]))
        if _off(world, a) + _off(world, b) > far and _may_meet(world, a, contact[row, TRIANGLE_INDEX], b):
            return True
    movers, bounds = integers(world, MOVERS), floats(world, BOUNDS)
    for k in range(rows(world, MOVERS)):
        shape = movers[k, 0]
        if integers(world, SHAPE)[shape, IS_SENSOR] != 0 or _off(world, shape) <= max(
            margin, 0.5 * place[shape, RADIUS]
        ):
            continue
        box, known = _swept(world, shape), True
        for j in range(3):
            known = known and bounds[shape, j] <= box[j] and box[3 + j] <= bounds[shape, 3 + j]
        if not known and _meets_unknown(world, shape, box):
            return True
    return False


@compiled(inline=True)
def _off(world: int, shape: int) -> float:
    """Bound how far a point of a shape is from where it was expected."""
    foreseen, body = floats(world, FORESEEN), integers(world, SHAPE)[shape, BODY_ROW]
    off: float = foreseen[body, OFF]
    if foreseen[body, TURNED_FARTHER] > 0.0:
        off += foreseen[body, TURNED_FARTHER] * reach(floats(world, PLACE), shape)
    return off


@compiled
def _may_meet(world: int, a: int, part: int, b: int) -> bool:
    """Whether the boxes that two shapes have swept overlap; the first may be a plane, or a mesh of which one part counts."""
    box, sort = _swept(world, b), sort_of(world, a)
    if sort == HALF_SPACE:
        return reaches_under(world, a, box)
    if sort == SURFACE:
        own = triangle_box(flat(world, GEOMETRY), integers(world, SHAPE)[a, BEGIN], part)
        return boxes_overlap(own, box_in_frame(world, a, box))
    return boxes_overlap(_swept(world, a), box)


@compiled
def _swept(world: int, shape: int) -> Box:
    """Return the box around where a shape was at the start of the step and where it is now."""
    place, placed = floats(world, PLACE), floats(world, PLACED)
    body = integers(world, SHAPE)[shape, BODY_ROW]
    box = _moved(
        extent_of(world, shape, quaternion_at(placed, shape, PLACED_ORIENTATION)),
        vector_at(placed, shape, PLACED_POSITION),
    )
    if integers(world, BODY)[body, BODY_KIND] != DYNAMIC:
        return box
    pose = floats(world, POSE)
    q = quaternion_at(pose, body, ORIENTATION)
    at = plus(vector_at(pose, body, POSITION), turned(q, vector_at(place, shape, PLACE_POSITION)))
    own = extent_of(world, shape, product(q, quaternion_at(place, shape, PLACE_ORIENTATION)))
    return box_around(box, _moved(own, at))


@compiled(inline=True)
def _moved(box: Box, at: Vector) -> Box:
    return (at[0] + box[0], at[1] + box[1], at[2] + box[2], at[0] + box[3], at[1] + box[4], at[2] + box[5])


@compiled
def _meets_unknown(world: int, shape: int, box: Box) -> bool:
    """Whether the box that a shape has swept overlaps that of one that its fat bounds do not overlap."""
    planes, fat = integers(world, PLANES), fat_bounds(world, shape)
    for k in range(rows(world, PLANES)):
        plane = planes[k, 0]
        if may_touch(world, shape, plane) and reaches_under(world, plane, box) and not reaches_under(world, plane, fat):
            return True
    return _meets_unknown_in(world, STATIC_TREE, shape, box) or _meets_unknown_in(world, TREE, shape, box)


@compiled
def _meets_unknown_in(world: int, tree: Table, shape: int, box: Box) -> bool:
    shapes, fat, scratch = integers(world, SHAPE), fat_bounds(world, shape), flat(world, SCRATCH)
    found, parts = scratch[: rows(world, SHAPE) + 1], scratch[rows(world, SHAPE) + 1 :]
    hits, _ = gather(floats(world, tree)[: rows(world, tree)], box, found)
    for k in range(hits):
        other = int(found[k])
        if shapes[other, IS_SENSOR] != 0 or not may_touch(world, shape, other):
            continue
        if sort_of(world, other) == SURFACE:
            bounds, known = floats(world, BOUNDS), box_in_frame(world, other, fat)
            nodes = floats(world, TRIANGLE_TREE)[
                int(bounds[other, FIRST_TREE_NODE]) : int(bounds[other, LAST_TREE_NODE])
            ]
            count, _ = gather(nodes, box_in_frame(world, other, box), parts)
            for j in range(count):
                if not boxes_overlap(triangle_box(flat(world, GEOMETRY), shapes[other, BEGIN], int(parts[j])), known):
                    return True
        elif not boxes_overlap(fat, fat_bounds(world, other)) and boxes_overlap(box, _swept(world, other)):
            return True
    return False

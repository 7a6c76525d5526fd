"""Contacts that were missed: what an impact makes fast within a step may meet what the search before it did not expect.

At the end of a step it is known which bodies were elsewhere than expected, by more than the margin of the search. Where one of
them may have met a shape of which the step had no points, the step is done again, and the search knows then how these bodies
move. What was found once stays found, so that each time more is known. What is missed after the last attempt is said.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, plus, product, turned
from kickdrift.world.collision.aabb import box_around, box_in_frame, boxes_overlap, fat_bounds, reaches_under
from kickdrift.world.collision.acceleration import reach
from kickdrift.world.collision.bvh import Box, gather
from kickdrift.world.collision.dispatch import extent_of, sort_of
from kickdrift.world.collision.filters import may_touch
from kickdrift.world.collision.narrow_phase import smallest
from kickdrift.world.collision.predicted_path import POSITION_ERROR, TURN_ERROR, drop_path, note_path, prediction_error
from kickdrift.world.collision.search_state import TRIES
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    CONTACT_STATE,
    POINTS,
    SENSOR,
    SHAPE_A,
    SHAPE_B,
    TRIANGLE_INDEX,
)
from kickdrift.world.layout import (
    AWAKE,
    BEGIN,
    BODY_KIND,
    BODY_ROW,
    DYNAMIC,
    FIRST_TREE_NODE,
    IS_SENSOR,
    LAST_TREE_NODE,
    LOWER,
    ORIENTATION,
    PLACE_ORIENTATION,
    PLACE_POSITION,
    PLACED_ORIENTATION,
    PLACED_POSITION,
    POSITION,
    RADIUS,
    UPPER,
)
from kickdrift.world.settings import MARGIN, MISSED_BODY, MISSED_TIME
from kickdrift.world.shapes.record import HALF_SPACE, SURFACE
from kickdrift.world.shapes.triangle import triangle_box
from kickdrift.world.step_status import BEGIN_AGAIN, MISSES_CONTACT, OK, STATUS, WARNING, ask_for_room
from kickdrift.world.tables import (
    BODY,
    BOUNDS,
    CONTACT,
    GEOMETRY,
    MOVERS,
    PLACE,
    PLACED,
    PLANES,
    POSE,
    PREDICTED,
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
    search, status, settings = integers(world, SEARCH), integers(world, STEP_STATUS), floats(world, SETTINGS)
    if not _find_errors(h, world):
        return
    size = rows(world, SHAPE) + rows(world, TRIANGLE_TREE) + 2
    if room(world, SCRATCH) < size:
        ask_for_room(world, SCRATCH, size)
        return
    missed = _find_body(world)
    if missed < 0:
        return
    if search[0, TRIES] == _MOST:
        if status[0, WARNING] & MISSES_CONTACT == 0:
            settings[0, MISSED_BODY], settings[0, MISSED_TIME] = missed, t
            status[0, WARNING] |= MISSES_CONTACT
        return
    for body in range(rows(world, BODY)):
        if floats(world, PREDICTED)[body, POSITION_ERROR] > 0.0 or floats(world, PREDICTED)[body, TURN_ERROR] > 0.0:
            note_path(h, world, body)
    search[0, TRIES] += 1
    if status[0, STATUS] == OK:
        status[0, STATUS] = BEGIN_AGAIN


@compiled
def drop_paths(t: float, h: float, world: int) -> None:
    """Know no more of bodies than how they begin the next step, once nothing asks for this one to be done again."""
    for body in range(rows(world, BODY)):
        drop_path(world, body)
    integers(world, SEARCH)[0, TRIES] = 0


@compiled
def _find_errors(h: float, world: int) -> bool:
    """Note how far bodies are from where they were expected; return whether any is by as much as contacts are sought."""
    body, predicted, found = integers(world, BODY), floats(world, PREDICTED), False
    margin = floats(world, SETTINGS)[0, MARGIN]
    for row in range(rows(world, BODY)):
        predicted[row, POSITION_ERROR], predicted[row, TURN_ERROR] = 0.0, 0.0
        if body[row, BODY_KIND] != DYNAMIC or body[row, AWAKE] == 0:
            continue
        off, farther = prediction_error(h, world, row)
        # What differs by less may be its rounding, or the bend of its path.
        predicted[row, POSITION_ERROR] = off if off > 0.1 * margin else 0.0
        predicted[row, TURN_ERROR] = farther
        found = found or off > 0.5 * margin or farther > 0.1
    return found


@compiled
def _find_body(world: int) -> int:
    """Return a body that was not where it was expected and has come to a shape with which the step had no points, or -1."""
    contact, place, margin = integers(world, CONTACT), floats(world, PLACE), floats(world, SETTINGS)[0, MARGIN]
    for row in range(rows(world, CONTACT)):
        if contact[row, POINTS] != 0 or contact[row, CONTACT_STATE] & SENSOR != 0:
            continue
        a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
        # Who has come less deep into another shape than half of its size is pushed out again.
        far = max(margin, 0.5 * smallest(place[a, RADIUS], place[b, RADIUS]))
        of_a, of_b = _off(world, a), _off(world, b)
        if of_a + of_b > far and _may_meet(world, a, contact[row, TRIANGLE_INDEX], b):
            missed: int = contact[row, BODY_A if of_a > of_b else BODY_B]
            return missed
    movers, bounds = integers(world, MOVERS), floats(world, BOUNDS)
    for k in range(rows(world, MOVERS)):
        shape = movers[k, 0]
        if integers(world, SHAPE)[shape, IS_SENSOR] != 0 or _off(world, shape) <= max(
            margin, 0.5 * place[shape, RADIUS]
        ):
            continue
        box, known = _swept(world, shape), True
        for j in range(3):
            known = known and bounds[shape, LOWER + j] <= box[j] and box[3 + j] <= bounds[shape, UPPER + j]
        if not known and _meets_unknown(world, shape, box):
            own: int = integers(world, SHAPE)[shape, BODY_ROW]
            return own
    return -1


@compiled(inline=True)
def _off(world: int, shape: int) -> float:
    """Bound how far a point of a shape is from where it was expected."""
    predicted, body = floats(world, PREDICTED), integers(world, SHAPE)[shape, BODY_ROW]
    off: float = predicted[body, POSITION_ERROR]
    if predicted[body, TURN_ERROR] > 0.0:
        off += predicted[body, TURN_ERROR] * reach(floats(world, PLACE), shape)
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

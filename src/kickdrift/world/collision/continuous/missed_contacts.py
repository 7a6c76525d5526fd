"""Missed contacts: a body that an impact makes fast within a step may meet shapes that the search did not expect.

At the end of a step it is known which bodies left their expected paths by more than the margin of the search: at the end, at
ends of substeps, or at impacts. Where one of them may have met a shape without points of contact in the step, the step is
repeated with a search that knows the paths of these bodies. Known paths stay known, so that each attempt knows more. Where
paths have more corners than the search can represent, or an impact turned shapes aside from the points at which they were
expected to touch, the step is halved (see `kickdrift.world.step.subdivision`), until no part misses a contact. A contact missed
in the shortest parts causes a warning.
"""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.aabb import box_in_frame, boxes_overlap, fat_bounds, reaches_under
from kickdrift.world.collision.broad_phase.bvh import Box, gather
from kickdrift.world.collision.broad_phase.filters_and_sensors import may_touch
from kickdrift.world.collision.broad_phase.search_state import TRIES
from kickdrift.world.collision.continuous.stale_points import deviation, points_are_stale
from kickdrift.world.collision.continuous.swept_overlap import may_meet, swept_box, thinner
from kickdrift.world.collision.predicted_motion import (
    POSITION_ERROR,
    TURN,
    TURN_ERROR,
    drop_path,
    note_path,
    path_error,
    turn_error,
)
from kickdrift.world.collision.shape_properties import half_width, sort_of
from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    CONTACT_STATE,
    FAST,
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
    UPPER,
)
from kickdrift.world.settings import MARGIN, MISSED_BODY, MISSED_TIME
from kickdrift.world.shapes.record import SURFACE
from kickdrift.world.shapes.triangle import triangle_box
from kickdrift.world.step.status import (
    BEGIN_AGAIN,
    DO_IN_PARTS,
    HALVINGS,
    MISSES_CONTACT,
    MOST_HALVINGS,
    OK,
    STATUS,
    WARNING,
    ask_for_room,
)
from kickdrift.world.tables import (
    BODY,
    BOUNDS,
    CONTACT,
    GEOMETRY,
    MOVERS,
    PLANES,
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

_TRIES = 2  # times that a step, or a part of one, is repeated before it is halved


@compiled
def find_missed(t: float, h: float, world: int) -> None:
    """Request that the step is repeated if it has missed a contact."""
    search, status, settings = integers(world, SEARCH), integers(world, STEP_STATUS), floats(world, SETTINGS)
    off = _find_errors(world, h)
    size = rows(world, SHAPE) + rows(world, TRIANGLE_TREE) + 2
    if room(world, SCRATCH) < size:
        ask_for_room(world, SCRATCH, size)
        return
    missed, aside = _find_body(world, off)
    if missed < 0:
        return
    # A repetition keeps the points that contacts have, and with them their normals.
    if not aside and search[0, TRIES] < _TRIES and _note_paths(world, h):
        search[0, TRIES] += 1
        if status[0, STATUS] == OK:
            status[0, STATUS] = BEGIN_AGAIN
    elif status[0, HALVINGS] < MOST_HALVINGS:
        drop_paths(t, h, world)
        if status[0, STATUS] == OK:
            status[0, STATUS] = DO_IN_PARTS
    elif status[0, WARNING] & MISSES_CONTACT == 0:
        settings[0, MISSED_BODY], settings[0, MISSED_TIME] = missed, t
        status[0, WARNING] |= MISSES_CONTACT


@compiled
def _note_paths(world: int, h: float) -> bool:
    """Note the motion of bodies that left their expected paths; return whether any has moved otherwise than before."""
    predicted, news = floats(world, PREDICTED), False
    for body in range(rows(world, BODY)):
        if predicted[body, POSITION_ERROR] > 0.0 or predicted[body, TURN_ERROR] > 0.0:
            news = note_path(world, h, body) or news
    return news


@compiled
def drop_paths(t: float, h: float, world: int) -> None:
    """Forget the paths of bodies, except how they begin the next step, once this step is not to be repeated."""
    for body in range(rows(world, BODY)):
        drop_path(world, body)
    integers(world, SEARCH)[0, TRIES] = 0


@compiled
def _find_errors(world: int, h: float) -> bool:
    """Note the distances of bodies from their expected paths; return whether any exceeds the margin of the search."""
    body, predicted, found = integers(world, BODY), floats(world, PREDICTED), False
    margin = floats(world, SETTINGS)[0, MARGIN]
    for row in range(rows(world, BODY)):
        predicted[row, TURN_ERROR] = 0.0
        if body[row, BODY_KIND] != DYNAMIC or body[row, AWAKE] == 0:
            continue
        off, farther = path_error(world, row), turn_error(world, h, row)
        # Smaller differences may be rounding, or the curvature of the path.
        predicted[row, POSITION_ERROR] = off if off > 0.1 * margin else 0.0
        predicted[row, TURN_ERROR] = farther
        found = found or off > 0.5 * margin or farther > TURN
    return found


@compiled
def _find_body(world: int, off: bool) -> tuple[int, bool]:
    """Return a body that may have missed a shape, or -1; only fast contacts are examined if no body is off its expected path.

    It has come to a shape with which the step had no points of contact or, then the second result is true, beside the points
    of a fast contact or past them: these are valid only where they were expected to touch.
    """
    contact, margin = integers(world, CONTACT), floats(world, SETTINGS)[0, MARGIN]
    missed, aside = -1, False
    for row in range(rows(world, CONTACT)):
        touches, is_fast = contact[row, POINTS] != 0, contact[row, CONTACT_STATE] & FAST != 0
        if not (is_fast if touches else off) or contact[row, CONTACT_STATE] & SENSOR != 0:
            continue
        a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
        of_a, of_b = deviation(world, a), deviation(world, b)
        if touches:
            if not points_are_stale(world, row):
                continue
        # A body less deep in another shape than a quarter of the thinner one is pushed out again.
        elif missed >= 0 or of_a + of_b <= margin or of_a + of_b <= 0.5 * thinner(world, a, b):
            continue
        if may_meet(world, a, contact[row, TRIANGLE_INDEX], b):
            missed, aside = contact[row, BODY_A if of_a > of_b else BODY_B], touches
            if aside:
                break
    if missed >= 0 or not off:
        return missed, aside
    movers, bounds = integers(world, MOVERS), floats(world, BOUNDS)
    for k in range(rows(world, MOVERS)):
        shape = movers[k, 0]
        way = deviation(world, shape)
        if integers(world, SHAPE)[shape, IS_SENSOR] != 0 or way <= margin or way <= 0.5 * half_width(world, shape):
            continue
        box, known = swept_box(world, shape, 0.0), True
        for j in range(3):
            known = known and bounds[shape, LOWER + j] <= box[j] and box[3 + j] <= bounds[shape, UPPER + j]
        if not known and _meets_unknown(world, shape, box):
            own: int = integers(world, SHAPE)[shape, BODY_ROW]
            return own, False
    return -1, False


@compiled
def _meets_unknown(world: int, shape: int, box: Box) -> bool:
    """Whether the box that a shape has swept overlaps that of one that its fat bounds do not overlap."""
    planes, fat = integers(world, PLANES), fat_bounds(world, shape)
    for k in range(rows(world, PLANES)):
        plane = planes[k, 0]
        if not may_touch(world, shape, plane) or reaches_under(world, plane, fat):
            continue
        if reaches_under(world, plane, box) and may_meet(world, plane, 0, shape):
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
                own = triangle_box(flat(world, GEOMETRY), shapes[other, BEGIN], int(parts[j]))
                if not boxes_overlap(own, known) and may_meet(world, other, int(parts[j]), shape):
                    return True
        elif not boxes_overlap(fat, fat_bounds(world, other)) and may_meet(world, other, 0, shape):
            return True
    return False

"""Lists of movable shapes, of immovable ones, of planes, and of shapes whose pairs are sought again."""

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.fat_aabb import is_somewhere, may_move, settle
from kickdrift.world.collision.broad_phase.search_state import (
    AT_HOME,
    CHANGED,
    CONTACTS,
    LEFT,
    MOVERS_CHANGED,
    NEW,
    PARTS_CHANGED,
    REVIEW,
    SOUGHT_ANEW,
    STATIC_CHANGED,
    UNSEEN,
)
from kickdrift.world.collision.shape_properties import sort_of
from kickdrift.world.layout import AWAKE, BODY_ROW, SEARCH_STATE, SHAPE_KIND, UPPER
from kickdrift.world.shapes.record import HALF_SPACE, SURFACE
from kickdrift.world.step.status import ask_for_room, report_body
from kickdrift.world.tables import (
    BODY,
    BOUNDS,
    CONTACT,
    FIXTURES,
    MOVERS,
    PLANES,
    SEARCH,
    SHAPE,
    SOUGHT,
    Table,
    floats,
    integers,
    room,
    rows,
    set_rows,
)


@compiled
def update_bounds(world: int, h: float) -> bool:
    """List the shapes that leave their fat bounds in a step of h in SOUGHT; False on an error."""
    search, shapes = integers(world, SEARCH), integers(world, SHAPE)
    if search[0, CONTACTS] != rows(world, CONTACT):  # contacts were removed elsewhere
        for shape in range(rows(world, SHAPE)):
            if shapes[shape, SEARCH_STATE] == AT_HOME:
                shapes[shape, SEARCH_STATE] = SOUGHT_ANEW
        search[0, CHANGED] = UNSEEN
    if search[0, CHANGED] != 0 and not enlist(world, h):
        return False
    movers, sought, body = integers(world, MOVERS), integers(world, SOUGHT), integers(world, BODY)
    for k in range(rows(world, MOVERS)):
        shape = movers[k, 0]
        if body[shapes[shape, BODY_ROW], AWAKE] == 0 or not settle(world, shape, h):
            continue
        search[0, LEFT] += 1
        if shapes[shape, SEARCH_STATE] == AT_HOME:
            shapes[shape, SEARCH_STATE] = SOUGHT_ANEW
            count = rows(world, SOUGHT)
            sought[count, 0] = shape
            set_rows(world, SOUGHT, count + 1)
        if not is_somewhere(world, shape):
            report_body(world, shapes[shape, BODY_ROW])
            return False
    return True


@compiled
def enlist(world: int, h: float) -> bool:
    """Rebuild the lists, and give new shapes fat bounds; False on an error."""
    shapes, bounds, search = integers(world, SHAPE), floats(world, BOUNDS), integers(world, SEARCH)
    count = rows(world, SHAPE)
    for table in (MOVERS, FIXTURES, PLANES, SOUGHT):
        if room(world, table) < count:
            ask_for_room(world, table, count)
            return False
    fixtures = rows(world, FIXTURES)
    for table in (MOVERS, PLANES, SOUGHT):
        set_rows(world, table, 0)
    fixed = 0
    for shape in range(count):
        if shapes[shape, SHAPE_KIND] < 0:
            shapes[shape, SEARCH_STATE] = NEW
            continue
        sort, state = sort_of(world, shape), shapes[shape, SEARCH_STATE]
        if state == NEW and sort != HALF_SPACE:
            for k in range(6):
                bounds[shape, k] = 0.0
            bounds[shape, UPPER] = -1.0  # empty bounds
            settle(world, shape, h)
            if not is_somewhere(world, shape):
                report_body(world, shapes[shape, BODY_ROW])
                return False
        if state != AT_HOME:
            _note(world, SOUGHT, shape)
        if sort == HALF_SPACE:
            _note(world, PLANES, shape)
        elif may_move(world, shape):
            _note(world, MOVERS, shape)
        else:
            listed = integers(world, FIXTURES)
            if state == NEW or fixed >= fixtures or listed[fixed, 0] != shape:
                search[0, STATIC_CHANGED] = 1
            if state == NEW and sort == SURFACE:
                search[0, PARTS_CHANGED] = 1
            listed[fixed, 0] = shape
            fixed += 1
    if fixed != fixtures:
        search[0, STATIC_CHANGED] = 1
    set_rows(world, FIXTURES, fixed)
    search[0, MOVERS_CHANGED] = 1
    search[0, REVIEW] = 1
    search[0, CHANGED] = 0
    return True


@compiled(inline=True)
def _note(world: int, table: Table, shape: int) -> None:
    """Append a shape to a list."""
    count = rows(world, table)
    integers(world, table)[count, 0] = shape
    set_rows(world, table, count + 1)

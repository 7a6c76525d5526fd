"""Properties and functions of the kinds of shapes for compiled code: rows of `kickdrift.world.tables.SHAPE_KINDS`."""

from collections.abc import Iterable

from kickdrift.core.calls import address_of, caller
from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion
from kickdrift.world.columns import column
from kickdrift.world.layout import BEGIN, SHAPE_KIND, SIZE
from kickdrift.world.shapes import shape_kinds
from kickdrift.world.shapes.extents import Extent
from kickdrift.world.shapes.record import EXTENT, NO_CORE, Kind
from kickdrift.world.tables import GEOMETRY, SHAPE, SHAPE_KINDS, Tables, flat, integers

# Columns of SHAPE_KINDS
SORT = column(SHAPE_KINDS)
CORE = column(SHAPE_KINDS)
EXTENT_AT = column(SHAPE_KINDS)  # address of its function

_extent = caller(EXTENT)


@compiled(inline=True)
def sort_of(world: int, shape: int) -> int:
    """Return the sort of a shape: `SOLID`, `SURFACE` or `HALF_SPACE`."""
    sort: int = integers(world, SHAPE_KINDS)[integers(world, SHAPE)[shape, SHAPE_KIND], SORT]
    return sort


@compiled(inline=True)
def core_of(world: int, shape: int) -> int:
    """Return the core of a shape: `NO_CORE`, `CENTRE` or `AXIS`."""
    core: int = integers(world, SHAPE_KINDS)[integers(world, SHAPE)[shape, SHAPE_KIND], CORE]
    return core


@compiled(inline=True)
def is_round(world: int, shape: int) -> bool:
    """Whether a shape is round, so that it can roll."""
    return bool(core_of(world, shape) != NO_CORE)


@compiled(inline=True)
def extent_of(world: int, shape: int, turn: Quaternion) -> Extent:
    """Return the bounds of a shape with an orientation, relative to its origin."""
    shapes = integers(world, SHAPE)
    begin = shapes[shape, BEGIN]
    numbers = flat(world, GEOMETRY)[begin : begin + shapes[shape, SIZE]]
    box: Extent = _extent(integers(world, SHAPE_KINDS)[shapes[shape, SHAPE_KIND], EXTENT_AT], (numbers, turn))
    return box


@compiled
def half_width(world: int, shape: int) -> float:
    """Return half the smallest width of the bounds of a solid shape in its own frame, m."""
    box = extent_of(world, shape, (1.0, 0.0, 0.0, 0.0))
    return 0.5 * min(box[3] - box[0], box[4] - box[1], box[5] - box[2])


def describe_kinds(tables: Tables) -> None:
    """Write the properties of all kinds, without the addresses of functions."""
    rows = tables.resize(SHAPE_KINDS, len(shape_kinds.KINDS))
    for number, kind in shape_kinds.KINDS.items():
        rows[number, [SORT, CORE]] = kind.sort, kind.core


def extents_of(kinds: Iterable[int]) -> list[Kind]:
    """Return the records of those kinds that have finite bounds."""
    return [kind for kind in map(shape_kinds.KINDS.__getitem__, kinds) if kind.extent is not None]


def find_extents(tables: Tables, kinds: Iterable[int]) -> None:
    """Compile the functions for the bounds of kinds, unless they are compiled, and write their addresses."""
    rows = tables.array(SHAPE_KINDS)
    for kind in extents_of(kinds):
        if rows[kind.number, EXTENT_AT] == 0 and kind.extent is not None:
            rows[kind.number, EXTENT_AT] = address_of(kind.extent, EXTENT)

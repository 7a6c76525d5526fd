"""Shapes of a world: their rows in the tables, and their geometry, which equal shapes share."""

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from itertools import combinations_with_replacement
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import is_whole, real, reals
from kickdrift.core.calls import address_of
from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import choice
from kickdrift.world.collision.broad_phase.search_state import NEW, shapes_changed
from kickdrift.world.collision.narrow_phase.manifolds import COLLIDE
from kickdrift.world.collision.narrow_phase.pair_dispatch import PAIRS
from kickdrift.world.collision.shape_properties import describe_kinds, find_extents
from kickdrift.world.layout import (
    BEGIN,
    BODY_ROW,
    FRICTION,
    GONE,
    RADIUS,
    RESTITUTION,
    ROLLING,
    SHAPE_KIND,
    SURFACE_VELOCITY,
)
from kickdrift.world.shapes.record import Shape
from kickdrift.world.shapes.shape_kinds import may_touch, met_as
from kickdrift.world.tables import BOUNDS, COLLIDERS, GEOMETRY, PLACE, PLACED, SHAPE, Tables

Floats = NDArray[np.float64]

SHOWN = -2  # kind of shapes that are only drawn, which compiled code ignores
_ALL_LAYERS = (1 << 62) - 1
_FEW = 4096  # size of removed geometry up to which the rest is not compacted


@dataclass(frozen=True)
class Surface:
    """The contact properties of a shape, and the layers it collides with: options of `World.add_body` and `kickdrift.Part`.

    Attributes
    ----------
    friction : float
        Coefficient of friction; two shapes in contact use the geometric mean.
    restitution : float
        From 0 (no bounce) to 1 (elastic); two shapes in contact use the larger value.
    rolling_resistance : float
        Lever arm of the normal force against rolling, m; two shapes in contact use the larger value. Without it, balls roll
        for ever, as in rigid-body mechanics; a thousandth of the radius brings a pen full of them to rest.
    surface_velocity : (3,) sequence
        Velocity of a surface that moves like a conveyor belt, in the body's axes, m/s.
    layer : int
        From 0 to 61.
    collides_with : sequence of int, optional
        Layers that it collides with; all by default.
    sensor : bool
        Whether it reports contacts without colliding.
    """

    friction: float = 0.6
    restitution: float = 0.0
    rolling_resistance: float = 0.0
    surface_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    layer: int = 0
    collides_with: tuple[int, ...] | None = None
    sensor: bool = False

    def __post_init__(self) -> None:
        for name in ("friction", "restitution", "rolling_resistance"):
            value: Any = getattr(self, name)
            try:
                fits = 0.0 <= real(value) < np.inf
            except TypeError:
                fits = False
            if not fits:
                raise ArgumentError(f"{name}={value!r} must be a number, zero or positive and finite.")
        if self.restitution > 1.0:
            raise ArgumentError(f"restitution={self.restitution!r} would add energy at every bounce; give at most 1.")
        try:
            velocity = reals(self.surface_velocity)
        except TypeError:
            velocity = np.zeros(0)
        if velocity.shape != (3,) or not np.isfinite(velocity).all():
            raise ArgumentError(f"surface_velocity={self.surface_velocity!r} must be three finite numbers, in m/s.")
        object.__setattr__(self, "surface_velocity", tuple(velocity.tolist()))  # immutable, unlike the user's array
        layers = () if self.collides_with is None else self.collides_with
        if not isinstance(layers, Collection) or (isinstance(layers, np.ndarray) and layers.ndim == 0):
            raise ArgumentError(f"collides_with={layers!r} must be a sequence of layers, whole numbers from 0 to 61.")
        for layer in (self.layer, *layers):
            if not is_whole(layer, 0, 61):
                raise ArgumentError(f"layer={layer!r} must be a whole number from 0 to 61.")
        choice("sensor", self.sensor)


class Placed(NamedTuple):
    """A shape with its pose in a body, origin (3,) and orientation (4,), and its surface."""

    shape: Shape
    position: Floats
    orientation: Floats
    surface: Surface


@dataclass
class ShapeRows:
    """The rows of shapes in the tables of a world."""

    tables: Tables
    free: list[int] = field(default_factory=list)
    begins: dict[bytes, int] = field(default_factory=dict)
    kinds: frozenset[int] = frozenset()  # of all shapes so far, removed ones included
    shapes: dict[int, Placed] = field(default_factory=dict)
    bouncing: bool = False  # whether any shape has had a restitution

    _gone: int = 0  # size of the geometry of removed shapes, some of which others may share

    def __post_init__(self) -> None:
        self.tables.resize(COLLIDERS, COLLIDERS.width)
        describe_kinds(self.tables)
        shapes_changed(self.tables)

    def add(self, body: int, placed: Placed) -> int:
        """Add a shape of a body, and return its row."""
        row = self._take_row()
        self.write(row, body, placed)
        shapes_changed(self.tables)
        return row

    def write(self, row: int, body: int, placed: Placed) -> None:
        """Fill in the row of a shape of a body, as new to the search for pairs."""
        tables, (shape, position, orientation, surface) = self.tables, placed
        begin = self._keep(shape)
        mask = _ALL_LAYERS
        if surface.collides_with is not None:
            mask = sum(1 << layer for layer in set(surface.collides_with))
        tables.array(SHAPE)[row] = (
            shape.kind, body, begin, shape.numbers.size, 1 << surface.layer, mask, surface.sensor, NEW
        )  # fmt: skip
        place = tables.array(PLACE)[row]
        place[:3] = position
        place[3:7] = orientation
        place[FRICTION], place[RESTITUTION], place[ROLLING] = (
            surface.friction,
            surface.restitution,
            surface.rolling_resistance,
        )
        place[SURFACE_VELOCITY : SURFACE_VELOCITY + 3] = surface.surface_velocity
        place[RADIUS] = shape.reach
        self.shapes[row] = placed
        self.bouncing = self.bouncing or bool(surface.restitution > 0.0)
        self.kinds |= {shape.kind}
        tables.altered = True

    def rows_of(self, body: int) -> NDArray[np.intp]:
        """Return the rows of the shapes of a body."""
        table = self.tables.array(SHAPE)
        return np.flatnonzero((table[:, BODY_ROW] == body) & (table[:, SHAPE_KIND] != GONE))

    def surface_numbers(self, body: int, name: str) -> set[float]:
        """Return the values of a surface property that the shapes of a body have."""
        return {float(getattr(self.shapes[row].surface, name)) for row in self.rows_of(body).tolist()}

    def change_surface(self, body: int, name: str, value: float) -> None:
        """Set a surface property of all shapes of a body; ArgumentError for an invalid value, or if there are no shapes."""
        rows = self.rows_of(body).tolist()
        if not rows:
            raise ArgumentError(f"{name}={value!r} is for bodies with shapes; this one has none.")
        changed: dict[str, Any] = {name: value}
        new = {row: replace(self.shapes[row].surface, **changed) for row in rows}
        for row, surface in new.items():
            self.shapes[row] = self.shapes[row]._replace(surface=surface)
            place = self.tables.array(PLACE)[row]
            place[FRICTION], place[RESTITUTION] = surface.friction, surface.restitution
            self.bouncing = self.bouncing or bool(surface.restitution > 0.0)
        self.tables.altered = True

    def remove_of(self, body: int) -> None:
        """Remove the shapes of a body, and free their rows."""
        tables = self.tables
        table = tables.array(SHAPE)
        for row in self.rows_of(body):
            table[row] = 0
            table[row, SHAPE_KIND] = GONE
            self._gone += self.shapes.pop(int(row)).shape.numbers.size
            self.free.append(int(row))
        shapes_changed(tables)
        if self._gone > max(_FEW, tables.count(GEOMETRY) // 2):
            self._compact()

    def _keep(self, shape: Shape) -> int:
        """Return where the numbers of a shape begin in GEOMETRY, adding them unless an equal shape has."""
        key = bytes([shape.kind]) + shape.numbers.tobytes()
        if key not in self.begins:
            geometry = self.tables.array(GEOMETRY)
            begin = len(geometry)
            self.tables.resize(GEOMETRY, begin + shape.numbers.size)[begin:, 0] = shape.numbers
            self.begins[key] = begin
        return self.begins[key]

    def _compact(self) -> None:
        """Drop the numbers of removed shapes from GEOMETRY."""
        self.begins, self._gone = {}, 0
        self.tables.resize(GEOMETRY, 0)
        table = self.tables.array(SHAPE)
        for row, placed in self.shapes.items():
            if table[row, SHAPE_KIND] != SHOWN:
                table[row, BEGIN] = self._keep(placed.shape)

    def show(self, body: int, placed: Placed) -> None:
        """Add a shape of a body that is only drawn: nothing collides with it, and rays pass through it."""
        self.write_shown(self._take_row(), body, placed)
        shapes_changed(self.tables)

    def write_shown(self, row: int, body: int, placed: Placed) -> None:
        """Fill in the row of a shape that is only drawn."""
        self.tables.array(SHAPE)[row] = 0
        self.tables.array(SHAPE)[row, [SHAPE_KIND, BODY_ROW]] = SHOWN, body
        self.tables.altered = True
        self.shapes[row] = placed

    def _take_row(self) -> int:
        if self.free:
            return self.free.pop()
        row = len(self.tables.array(SHAPE))
        for table in (SHAPE, PLACE, PLACED, BOUNDS):
            self.tables.resize(table, row + 1)
        return row

    def find_functions(self) -> None:
        """Write the addresses of the functions for the kinds in use and their pairs; those of others are not compiled."""
        find_extents(self.tables, self.kinds)
        colliders = self.tables.array(COLLIDERS)
        for pair in self.pairs():
            if colliders[pair] == 0:
                colliders[pair] = address_of(PAIRS[pair], COLLIDE)

    def pairs(self) -> list[tuple[int, int]]:
        """Return the pairs of kinds in use that can touch, the lower one first."""
        met = sorted({met_as(kind) for kind in self.kinds})
        return [pair for pair in combinations_with_replacement(met, 2) if may_touch(*pair)]

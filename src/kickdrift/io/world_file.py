"""Worlds on disk: all that their next steps depend on, so that they continue with the same bits."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core import archive
from kickdrift.core.compilation import Function
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.io.shapes import Catalogue, shapes_of
from kickdrift.world.argument_checks import vector
from kickdrift.world.bodies.shape_rows import SHOWN, Placed, ShapeRows, Surface
from kickdrift.world.collision.broad_phase.filters_and_sensors import part_joined
from kickdrift.world.deformables.building import MET_AS
from kickdrift.world.deformables.layout import CLOTH_GENERATION, DIMENSION
from kickdrift.world.deformables.wind_functions import force_or_wind_of
from kickdrift.world.file_integrity import check
from kickdrift.world.joints.layout import BRAKE, GENERATION, JOINT_KIND, REMOVED_JOINT
from kickdrift.world.joints.spanning_tree import add_unjoined, arrange
from kickdrift.world.layout import BODY_KIND, BODY_ROW, GONE, LINK_PLACE, REMOVED, SEARCH_STATE, SHAPE_KIND
from kickdrift.world.layout import GENERATION as BODY_GENERATION
from kickdrift.world.snapshot import TABLES, Snapshot, kept
from kickdrift.world.tables import BODY, CLOTH, JOINT, JOINT_NUMBERS, LINK_NUMBERS, PLACE, SHAPE, Table, Tables
from kickdrift.world.world import World

_KIND, _TABLE = "kickdrift world ", "table "
# Tables that are made from the records of shapes and joints, not read from the file
MADE = ("SHAPE", "PLACE", "GEOMETRY", "ARTICULATION", "LINK", "GRAPH")
_STORED: Mapping[str, Table] = {name: table for name, table in TABLES.items() if name not in MADE}
_PART = 6  # row, shape, surface, body, whether it is only shown, state of the search


def save_world(world: World, path: str | Path) -> Path:
    """Write a world to a file, whole or not at all.

    Parameters
    ----------
    world : World
        Forces added by users are functions; they are counted but not written, since a file holds no code.
    path : path
        ``.npz`` is appended if it is missing. The folder must exist.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    FileFormatError
        If the file cannot be written there.
    """
    return archive.write(path, *contents(world))


def contents(world: World) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return header and arrays of the file of a world."""
    snapshot, catalogue = world.snapshot(), Catalogue()
    surfaces: dict[str, int] = {}
    parts, places = [], []
    for row, (shape, position, orientation, surface) in snapshot.shapes.items():
        face = surfaces.setdefault(_words(surface), len(surfaces))
        numbers = snapshot.tables["SHAPE"][row, [BODY_ROW, SHAPE_KIND, SEARCH_STATE]].tolist()
        parts.append((row, catalogue.place(shape), face, numbers[0], int(numbers[1] == SHOWN), numbers[2]))
        places.append([*position, *orientation])
    header = {
        "format": archive.WORLD,
        "time": snapshot.time,
        "n_steps": snapshot.n_steps,
        "counted": snapshot.counted,
        "sleeping": snapshot.sleeping,
        "threads": world.threads,
        "n_forces": len(snapshot.forces),
        "n_bodies_made": snapshot.n_bodies_made,
        "n_joints_made": snapshot.n_joints_made,
        "n_cloths_made": snapshot.n_cloths_made,
        "free_bodies": snapshot.free_bodies,
        "free_shapes": snapshot.free_shapes,
        "bouncing": snapshot.bouncing,
        "body_names": list(snapshot.body_names.items()),
        "joint_names": list(snapshot.joint_names.items()),
        "cloth_names": list(snapshot.cloth_names.items()),
        "shapes": catalogue.words,
        "surfaces": [json.loads(words) for words in surfaces],
    }
    arrays = {
        **{_TABLE + name: snapshot.tables[name] for name in _STORED},
        "shape numbers": catalogue.numbers,
        "parts": np.array(parts, dtype=np.int64).reshape(-1, _PART),
        "places": np.array(places, dtype=np.float64).reshape(-1, 7),
    }
    return header, arrays


def load_world(path: str | Path, forces: Sequence[Function] = ()) -> World:
    """Read a world that `World.save` wrote; it continues bit-identically to the one that was written.

    Parameters
    ----------
    path : path
    forces : sequence of callable
        The functions passed to `World.add_force` and `World.add_wind`, in the same order: a file holds no code.

    Returns
    -------
    World
        Bodies keep their rows and names; ``world.body(name)`` and ``world.bodies.handle(row)`` return handles.

    Raises
    ------
    FileFormatError
        If there is no such file, or it is not a world, or one of another version of kickdrift.
    ArgumentError
        If the number of forces differs from that of the world.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> ball = world.add_sphere(radius=0.1, mass=1.0)
    >>> path = world.save("world.npz")
    >>> kd.load_world(path).position.shape
    (2, 3)
    """

    def assemble(head: dict[str, Any], arrays: dict[str, Any]) -> tuple[Snapshot, int, bool]:
        _check(str(path), head, arrays)
        return snapshot_of(head, arrays), int(head["n_forces"]), bool(head["threads"])

    snapshot, count, threads = archive.read(path, "a kickdrift world", "World.save", assemble)
    if len(forces) != count:
        raise ArgumentError(
            f"forces has {len(forces)} functions, but the world in path={str(path)!r} had {count}; give the functions"
            " passed to add_force and add_wind, in the same order."
        )
    world = World(threads=threads)
    world.restore(snapshot.with_forces(force_or_wind_of(force) for force in forces))
    return world


def _check(path: str, head: dict[str, Any], arrays: dict[str, Any]) -> None:
    given = str(head["format"])
    if given != archive.WORLD and given.startswith(_KIND):
        raise FileFormatError(
            f"path={path!r} is {given!r}, but this version of kickdrift reads {archive.WORLD!r}; read it with the"
            " version that wrote it."
        )
    if given != archive.WORLD:
        raise KeyError("format")


def snapshot_of(head: dict[str, Any], arrays: dict[str, Any]) -> Snapshot:
    """Make a snapshot of a file; what its tables and its records both say is taken from the records.

    Raises
    ------
    FileFormatError, LookupError, TypeError, ValueError
        If it could not have been `contents` of a world.
    """
    of = _tables(arrays)
    shapes = ShapeRows(of)
    _place_shapes(shapes, head, arrays)
    check(kept(of))
    linked, brakes = of.array(LINK_NUMBERS).copy(), of.array(JOINT_NUMBERS)[:, BRAKE : BRAKE + 3].copy()
    places = of.array(BODY)[:, LINK_PLACE].copy()
    arrange(of)
    part_joined(of)
    add_unjoined(of, places)
    if len(linked) < of.count(LINK_NUMBERS):
        raise ValueError(f"table LINK_NUMBERS has {len(linked)} rows, fewer than there are links")
    of.array(LINK_NUMBERS)[:] = linked[: of.count(LINK_NUMBERS)]
    of.array(JOINT_NUMBERS)[:, BRAKE : BRAKE + 3] = brakes
    bodies, joints = of.array(BODY), of.array(JOINT)
    gone = np.flatnonzero(bodies[:, BODY_KIND] == REMOVED)
    return Snapshot(
        time=_finite(head["time"]),
        n_steps=_whole(head["n_steps"], 0),
        counted=_counted(*head["counted"]),
        sleeping=bool(head["sleeping"]),
        forces=(),
        tables=kept(of),
        free_bodies=_rows_of(head["free_bodies"], gone),
        free_shapes=tuple(shapes.free),
        n_bodies_made=_whole(head["n_bodies_made"], 1 + int(bodies[:, BODY_GENERATION].max())),
        n_joints_made=_whole(head["n_joints_made"], 1 + int(joints[:, GENERATION].max(initial=-1))),
        n_cloths_made=_whole(head["n_cloths_made"], 1 + int(of.array(CLOTH)[:, CLOTH_GENERATION].max(initial=-1))),
        kinds=tuple(sorted(shapes.kinds.union(*map(MET_AS.__getitem__, of.array(CLOTH)[:, DIMENSION].tolist())))),
        bouncing=bool(head["bouncing"]) or shapes.bouncing,
        body_names=_names(head["body_names"], np.flatnonzero(bodies[:, BODY_KIND] != REMOVED)),
        joint_names=_names(head["joint_names"], np.flatnonzero(joints[:, JOINT_KIND] != REMOVED_JOINT)),
        cloth_names=_names(head["cloth_names"], np.arange(of.count(CLOTH))),
        shapes=MappingProxyType(shapes.shapes),
        geometry=MappingProxyType(shapes.begins),
    )


def _tables(arrays: dict[str, Any]) -> Tables:
    """Take over the tables of a file as they are."""
    of = Tables()
    given = {name.removeprefix(_TABLE): rows for name, rows in arrays.items() if name.startswith(_TABLE)}
    if given.keys() != _STORED.keys():
        raise KeyError(", ".join(sorted(given.keys() ^ _STORED.keys())))
    for name, table in _STORED.items():
        wanted = np.int64 if table.whole else np.float64
        if given[name].dtype != wanted or given[name].shape[1:] != (table.width,):
            raise ValueError(f"table {name} has the shape {given[name].shape}")
        of.put(table, given[name])
    return of


def _place_shapes(rows: ShapeRows, head: dict[str, Any], arrays: dict[str, Any]) -> None:
    """Write the rows of shapes that a file has records of."""
    shapes = shapes_of(head["shapes"], arrays["shape numbers"])
    surfaces = [_surface(words) for words in head["surfaces"]]
    parts, places = arrays["parts"], arrays["places"]
    if parts.dtype != np.int64 or parts.shape[1:] != (_PART,) or places.shape != (len(parts), 7):
        raise ValueError(f"parts have the shape {parts.shape}, and places {places.shape}")
    count = len(parts) + len(head["free_shapes"])
    rows.free[:] = _rows_of(head["free_shapes"], np.setdiff1d(np.arange(count), parts[:, 0]))
    table = rows.tables.resize(SHAPE, count)
    rows.tables.resize(PLACE, count)
    table[:, SHAPE_KIND] = GONE
    for (row, of, face, body, shown, state), numbers in zip(parts.tolist(), places, strict=True):
        if not 0 <= row < count or min(of, face) < 0:
            raise IndexError(f"a part has row {row}, shape {of} and surface {face}")
        placed = Placed(
            shapes[of], vector("position", numbers[:3], 3), vector("orientation", numbers[3:], 4), surfaces[face]
        )
        (rows.write_shown if shown else rows.write)(row, body, placed)
        table[row, SEARCH_STATE] = state


def _rows_of(given: list[int], wanted: NDArray[np.intp]) -> tuple[int, ...]:
    """Return the rows that are free, in their order; they must be those that are not in use."""
    rows = tuple(_whole(row, 0) for row in given)
    if sorted(rows) != wanted.tolist():
        raise ValueError(f"the rows {list(rows)} are listed as free, but {wanted.tolist()} are")
    return rows


def _whole(value: Any, least: int) -> int:
    if type(value) is not int or not least <= value < 1 << 62:
        raise ValueError(f"{value!r} is not a whole number of at least {least}")
    return value


def _counted(t0: Any, step: Any, number: Any) -> tuple[float, float, int]:
    return _finite(t0), _finite(step), _whole(number, 0)


def _finite(value: Any) -> float:
    if not math.isfinite(number := float(value)):
        raise ValueError(f"the time is {value!r}")
    return number


def _names(pairs: list[tuple[int, str]], rows: NDArray[np.intp]) -> MappingProxyType[int, str]:
    names = {_whole(row, 0): str(name) for row, name in pairs}
    if not set(names) <= set(rows.tolist()) or len(set(names.values())) != len(pairs):
        raise ValueError("names are duplicates, or belong to rows that do not exist")
    return MappingProxyType(names)


def _words(surface: Surface) -> str:
    """Return a surface as JSON; equal ones in equal words."""
    layers = surface.collides_with
    return json.dumps(
        {
            "friction": float(surface.friction),
            "restitution": float(surface.restitution),
            "rolling_resistance": float(surface.rolling_resistance),
            "surface_velocity": [float(v) for v in surface.surface_velocity],
            "layer": int(surface.layer),
            "collides_with": None if layers is None else [int(layer) for layer in layers],
            "sensor": bool(surface.sensor),
        }
    )


def _surface(words: dict[str, Any]) -> Surface:
    layers = words["collides_with"]
    tuples = {
        "surface_velocity": tuple(words["surface_velocity"]),
        "collides_with": None if layers is None else tuple(layers),
    }
    return Surface(**{**words, **tuples})

"""Worlds on disk: all that their next steps depend on, so that they go on with the same bits."""

import json
from collections.abc import Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from kickdrift.core.compilation import Function
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.io import archive
from kickdrift.io.shapes import Catalogue, shapes_of
from kickdrift.world.shape_rows import Placed, Surface
from kickdrift.world.snapshot import TABLES, Snapshot
from kickdrift.world.world import World

_KIND, _TABLE = "kickdrift world ", "table "


def save_world(world: World, path: str | Path) -> Path:
    """Write a world to a file, whole or not at all.

    Parameters
    ----------
    world : World
        Forces that were added to it, functions of one's own, are counted and not written: a file holds no code.
    path : path
        Where; ``.npz`` is appended where it is missing. The folder must exist.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    FileFormatError
        If the file cannot be written there.
    """
    snapshot, catalogue = world.snapshot(), Catalogue()
    surfaces: dict[str, int] = {}
    parts, places = [], []
    for row, (shape, position, orientation, surface) in snapshot.shapes.items():
        parts.append((row, catalogue.place(shape), surfaces.setdefault(_words(surface), len(surfaces))))
        places.append([*position, *orientation])
    header = {
        "format": archive.WORLD,
        "time": snapshot.time,
        "n_steps": snapshot.n_steps,
        "sleeping": snapshot.sleeping,
        "threads": world.threads,
        "n_forces": len(snapshot.forces),
        "n_bodies_made": snapshot.n_bodies_made,
        "n_joints_made": snapshot.n_joints_made,
        "joints_arranged": snapshot.joints_arranged,
        "free_bodies": snapshot.free_bodies,
        "free_shapes": snapshot.free_shapes,
        "rooms": dict(snapshot.rooms),
        "kinds": snapshot.kinds,
        "bouncing": snapshot.bouncing,
        "body_names": list(snapshot.body_names.items()),
        "joint_names": list(snapshot.joint_names.items()),
        "shapes": catalogue.words,
        "surfaces": [json.loads(words) for words in surfaces],
    }
    geometry = [(key[0], begin, (len(key) - 1) // 8) for key, begin in snapshot.geometry.items()]
    arrays = {
        **{_TABLE + name: rows for name, rows in snapshot.tables.items()},
        "shape numbers": catalogue.numbers,
        "parts": np.array(parts, dtype=np.int64).reshape(-1, 3),
        "places": np.array(places, dtype=np.float64).reshape(-1, 7),
        "geometry": np.array(geometry, dtype=np.int64).reshape(-1, 3),
    }
    return archive.write(path, header, arrays)


def load_world(path: str | Path, forces: Sequence[Function] = ()) -> World:
    """Read a world that `World.save` wrote; it goes on with the bits of the one that was written.

    Parameters
    ----------
    path : path
    forces : sequence of callable
        The functions that `World.add_force` was given, in their order: a file holds no code.

    Returns
    -------
    World
        Bodies have the rows and names that they had; ``world.body(name)`` and ``world.bodies.handle(row)`` give the handle
        of one.

    Raises
    ------
    FileFormatError
        If there is no such file, it is not a world, or one of another version of kickdrift.
    ArgumentError
        If the forces are not as many as the world had.
    """

    def assemble(head: dict[str, Any], arrays: dict[str, Any]) -> tuple[Snapshot, int, bool]:
        _check(str(path), head, arrays)
        return _assemble(head, arrays), int(head["n_forces"]), bool(head["threads"])

    snapshot, count, threads = archive.read(path, "a kickdrift world", "World.save", assemble)
    if len(forces) != count:
        raise ArgumentError(
            f"forces has {len(forces)} functions, and the world in path={str(path)!r} had {count}; give those that"
            " add_force was given, in their order."
        )
    world = World(threads=threads)
    for force in forces:
        world.add_force(force)
    world.restore(snapshot.with_forces(world.forces))
    return world


def _check(path: str, head: dict[str, Any], arrays: dict[str, Any]) -> None:
    given = str(head["format"])
    if given != archive.WORLD and given.startswith(_KIND):
        raise FileFormatError(
            f"path={path!r} is {given!r}, and this version of kickdrift reads {archive.WORLD!r}; read it with the"
            " version that wrote it."
        )
    if given != archive.WORLD:
        raise KeyError("format")
    if head["digest"] != archive.digest(head, arrays):
        raise ValueError("it was changed after it was written")


def _assemble(head: dict[str, Any], arrays: dict[str, Any]) -> Snapshot:
    tables = {name.removeprefix(_TABLE): rows for name, rows in arrays.items() if name.startswith(_TABLE)}
    if tables.keys() != TABLES.keys():
        raise KeyError(", ".join(sorted(tables.keys() ^ TABLES.keys())))
    for name, table in TABLES.items():
        wanted = np.int64 if table.whole else np.float64
        if tables[name].dtype != wanted or tables[name].shape[1:] != (table.width,):
            raise ValueError(f"table {name} has the shape {tables[name].shape}")
    shapes = shapes_of(head["shapes"], arrays["shape numbers"])
    surfaces = [_surface(words) for words in head["surfaces"]]
    rows = zip(arrays["parts"].tolist(), arrays["places"], strict=True)
    numbers = tables["GEOMETRY"][:, 0]
    return Snapshot(
        time=float(head["time"]),
        n_steps=int(head["n_steps"]),
        sleeping=bool(head["sleeping"]),
        forces=(),
        tables=MappingProxyType(tables),
        rooms=MappingProxyType({name: int(head["rooms"][name]) for name in TABLES}),
        free_bodies=tuple(head["free_bodies"]),
        free_shapes=tuple(head["free_shapes"]),
        n_bodies_made=int(head["n_bodies_made"]),
        n_joints_made=int(head["n_joints_made"]),
        joints_arranged=bool(head["joints_arranged"]),
        kinds=tuple(head["kinds"]),
        bouncing=bool(head["bouncing"]),
        body_names=_names(head["body_names"]),
        joint_names=_names(head["joint_names"]),
        shapes=MappingProxyType(
            {row: Placed(shapes[of], place[:3], place[3:7], surfaces[face]) for (row, of, face), place in rows}
        ),
        geometry=MappingProxyType(
            {
                bytes([kind]) + numbers[begin : begin + size].tobytes(): begin
                for kind, begin, size in arrays["geometry"].tolist()
            }
        ),
    )


def _names(pairs: list[tuple[int, str]]) -> MappingProxyType[int, str]:
    return MappingProxyType({int(row): str(name) for row, name in pairs})


def _words(surface: Surface) -> str:
    """Say in JSON what a surface is; equal ones in equal words."""
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

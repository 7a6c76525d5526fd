"""Snapshots: a world as it is at one moment, to be gone back to as often as one likes."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from kickdrift.core.compilation import Function
from kickdrift.core.errors import ArgumentError
from kickdrift.world import settings, tables
from kickdrift.world.shape_rows import Placed
from kickdrift.world.tables import COLLIDERS, SETTINGS, SHAPE_KINDS, SWEEPS, Table

if TYPE_CHECKING:
    from kickdrift.world.world import World

# Addresses of compiled functions mean nothing in another process; a world finds its own.
_OF_THE_PROCESS = (COLLIDERS, SHAPE_KINDS, SWEEPS)
TABLES: Mapping[str, Table] = MappingProxyType(
    {name: table for name, table in vars(tables).items() if isinstance(table, Table) and table not in _OF_THE_PROCESS}
)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """All that the next steps of a world depend on. It does not change with the world that it was taken of.

    Attributes
    ----------
    time : float
        s.
    n_steps : int
        Steps done.
    sleeping : bool
        Whether what rests may sleep.
    forces : tuple of callable
        Stages of the step made of users' functions.
    tables : mapping of str to array
        Rows in use of each table of `kickdrift.world.tables`, by its name; read-only.
    rooms : mapping of str to int
        How many rows there was room for: stages make room where they find that something has changed, and not again.
    free_bodies, free_shapes : tuple of int
        Rows to be used again, the next one last.
    n_bodies_made, n_joints_made : int
        How many there have been in the world, so that the handle of one is never that of another.
    joints_arranged : bool
        Whether the tables say which joints make trees, and which close loops.
    shapes : mapping of int to Placed
        By row.
    geometry : mapping of bytes to int
        Where the numbers of a shape begin, by its kind and numbers.
    kinds : tuple of int
        Kinds of shapes that there have been.
    bouncing : bool
        Whether a shape has bounced.
    body_names, joint_names : mapping of int to str
        By row.
    """

    time: float
    n_steps: int
    sleeping: bool
    forces: tuple[Function, ...]
    tables: Mapping[str, NDArray[Any]]
    rooms: Mapping[str, int]
    free_bodies: tuple[int, ...]
    free_shapes: tuple[int, ...]
    n_bodies_made: int
    n_joints_made: int
    joints_arranged: bool
    shapes: Mapping[int, Placed]
    geometry: Mapping[bytes, int]
    kinds: tuple[int, ...]
    bouncing: bool
    body_names: Mapping[int, str]
    joint_names: Mapping[int, str]

    def with_forces(self, forces: Iterable[Function]) -> "Snapshot":
        """Return the same with other forces."""
        return replace(self, forces=tuple(forces))

    def __repr__(self) -> str:
        return f"<Snapshot at {self.time:g} s, after {self.n_steps} steps: {len(self.tables['POSE'])} rows of bodies>"


def take(world: "World") -> Snapshot:
    """Copy everything that the next steps of a world depend on."""
    copies = {name: world.tables.array(table).copy() for name, table in TABLES.items()}
    for copy in copies.values():
        copy.flags.writeable = False
    return Snapshot(
        time=world.time,
        n_steps=world.n_steps,
        sleeping=world.sleeping,
        forces=tuple(world.forces),
        tables=MappingProxyType(copies),
        rooms=MappingProxyType({name: world.tables.room(table) for name, table in TABLES.items()}),
        free_bodies=tuple(world.bodies.free),
        free_shapes=tuple(world.shape_rows.free),
        n_bodies_made=world.bodies.n_made,
        n_joints_made=world.joints.n_made,
        joints_arranged=world.joints.arranged,
        shapes=MappingProxyType(dict(world.shape_rows.shapes)),
        geometry=MappingProxyType(dict(world.shape_rows.begins)),
        kinds=tuple(sorted(world.shape_rows.kinds)),
        bouncing=world.shape_rows.bouncing,
        body_names=MappingProxyType(world.bodies.names.all()),
        joint_names=MappingProxyType(world.joints.names.all()),
    )


def restore(world: "World", snapshot: Snapshot) -> None:
    """Make a world what it was, or what another one was, when a snapshot was taken."""
    if not isinstance(snapshot, Snapshot):
        raise ArgumentError(f"snapshot={snapshot!r} is no snapshot; give what World.snapshot returned.")
    if world.recorder is not None:
        raise ArgumentError("the world is being recorded, and a recording does not go back; end it before you restore.")
    world.sleeping = snapshot.sleeping  # which wakes all; who sleeps is in the tables
    for name, table in TABLES.items():
        world.tables.put(table, snapshot.tables[name], snapshot.rooms[name])
    world.time, world.n_steps = snapshot.time, snapshot.n_steps
    world.planar = bool(world.tables.array(SETTINGS)[0, settings.PLANE_NORMAL : settings.PLANE_NORMAL + 3].any())
    world.forces, world.broken = list(snapshot.forces), []
    bodies, joints, shapes = world.bodies, world.joints, world.shape_rows
    bodies.free[:] = snapshot.free_bodies
    bodies.n_made = max(bodies.n_made, snapshot.n_bodies_made)
    joints.n_made = max(joints.n_made, snapshot.n_joints_made)
    joints.arranged = snapshot.joints_arranged
    shapes.free[:] = snapshot.free_shapes
    shapes.shapes = dict(snapshot.shapes)
    shapes.begins = dict(snapshot.geometry)
    shapes.kinds, shapes.bouncing = frozenset(snapshot.kinds), snapshot.bouncing
    bodies.names.replace(snapshot.body_names)
    joints.names.replace(snapshot.joint_names)
    world.tables.altered = True
    world.tables.version += 1

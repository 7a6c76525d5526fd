"""Snapshots: the state of a world at one time, which can be restored any number of times."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world import settings, tables
from kickdrift.world.bodies.shape_rows import Placed
from kickdrift.world.collision.broad_phase.search_state import shapes_new
from kickdrift.world.deformables.particle_tables import OF_A_STEP, keep_pairs
from kickdrift.world.force_functions import Force
from kickdrift.world.tables import JOINT, POSE, SETTINGS, STARTED_JOINTS, Table, Tables

if TYPE_CHECKING:
    from kickdrift.world.world import World

# Addresses of compiled functions are meaningless in another process; each world finds its own.
_OF_THE_PROCESS = (tables.COLLIDERS, tables.SHAPE_KINDS, tables.KERNEL_ADDRESSES)
# Tables that a step fills anew, with one row per body
_OF_BODIES = (
    tables.DELTA_POSE, tables.FORCE, tables.NOTED, tables.COLOURED, tables.STARTED_POSE, tables.STARTED_MOTION,
    tables.STARTED_ROTATION, tables.MEMBER, tables.MEMBERSHIP, tables.SWEPT,
)  # fmt: skip
# Tables that a step fills anew, or the search for pairs when it is restarted
_OF_A_STEP = (
    *_OF_BODIES, STARTED_JOINTS, tables.LANES, tables.GROUPS, tables.COLOURS, tables.SCRATCH, tables.TREE,
    tables.STATIC_TREE, tables.TRIANGLE_TREE, tables.SEARCH, tables.MOVERS, tables.FIXTURES, tables.PLANES, tables.SOUGHT,
    tables.CONTACT_ROW, tables.ISLAND, tables.ISLAND_CONTACT, tables.ISLAND_JOINT, tables.NODE, tables.NEIGHBOUR,
    tables.BLOCK, tables.ADJACENCY, tables.IMPACT, tables.BOUNCING, tables.LOST_POINT, tables.FORCE_NUMBERS,
    tables.BATCH, tables.STARTED_IMPULSE, tables.VIEW, tables.CLOTH_CONTACT,
    tables.CLOTH_CONTACT_NUMBERS, tables.CONTACT_LANES, tables.CONTACT_LANE_PARTICLES, tables.CLOTH_NEAR, *OF_A_STEP,
)  # fmt: skip
TABLES: Mapping[str, Table] = MappingProxyType(
    {
        name: table
        for name, table in vars(tables).items()
        if isinstance(table, Table) and table not in (*_OF_THE_PROCESS, *_OF_A_STEP)
    }
)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The state of a world, as returned by `World.snapshot`: everything that its next steps depend on.

    It does not change with the world, and can be copied and pickled. `World.restore` takes it; the fields that are not listed
    here are the internal tables of the world.

    Attributes
    ----------
    time : float
        Time since the start, s.
    n_steps : int
        Steps done.
    """

    time: float
    n_steps: int
    counted: tuple[
        float, float, int
    ]  # time from which equal steps are counted, their length, the number of the next one
    sleeping: bool
    forces: tuple[Force, ...]  # with the stages compiled from them
    tables: Mapping[str, NDArray[Any]]  # rows in use of each table that no step fills anew, by its name; read-only
    free_bodies: tuple[int, ...]  # rows to be reused, the next one last
    free_shapes: tuple[int, ...]
    n_bodies_made: int  # ever added, from which handles get their generations
    n_joints_made: int
    n_cloths_made: int
    shapes: Mapping[int, Placed]  # by row
    geometry: Mapping[bytes, int]  # row of GEOMETRY where the numbers of a shape begin, by its kind and numbers
    kinds: tuple[int, ...]
    bouncing: bool  # whether any shape has had a restitution
    body_names: Mapping[int, str]  # by row
    joint_names: Mapping[int, str]
    cloth_names: Mapping[int, str]

    def with_forces(self, forces: Iterable[Force]) -> "Snapshot":
        """Return a copy with other forces."""
        return replace(self, forces=tuple(forces))

    def __copy__(self) -> "Snapshot":
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> "Snapshot":
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpacked, (_pack(vars(self)),)

    def __repr__(self) -> str:
        return f"<Snapshot at {self.time:g} s, after {self.n_steps} steps: {len(self.tables['POSE'])} rows of bodies>"


def _pack(members: Mapping[str, Any]) -> dict[str, Any]:
    """Return the members of a snapshot with dictionaries in place of read-only mappings, which cannot be pickled."""
    return {name: dict(value) if isinstance(value, Mapping) else value for name, value in members.items()}


def _unpacked(members: dict[str, Any]) -> Snapshot:
    """Return the snapshot that `_pack` was applied to.

    Raises
    ------
    ArgumentError
        If it was pickled by a version of kickdrift that has other tables.
    """
    widths = {name: rows.shape[1] for name, rows in members["tables"].items()}
    if widths != {name: table.width for name, table in TABLES.items()}:
        raise ArgumentError("the snapshot was pickled by another version of kickdrift; unpickle it with that one.")
    for rows in members["tables"].values():
        rows.flags.writeable = False
    mappings = {name: MappingProxyType(value) for name, value in members.items() if isinstance(value, dict)}
    return Snapshot(**{**members, **mappings})


def kept(of: Tables) -> Mapping[str, NDArray[Any]]:
    """Return read-only copies of the tables that the next steps depend on."""
    copies = {name: of.array(table).copy() for name, table in TABLES.items()}
    for copy in copies.values():
        copy.flags.writeable = False
    return MappingProxyType(copies)


def take(world: "World") -> Snapshot:
    """Copy everything that the next steps of a world depend on; joints are arranged, so that no restoring has to do it."""
    world.joints.arrange()
    return Snapshot(
        time=world.time,
        n_steps=world.n_steps,
        counted=world.counted,
        sleeping=world.sleeping,
        forces=tuple(world.forces),
        tables=kept(world.tables),
        free_bodies=tuple(world.bodies.free),
        free_shapes=tuple(world.shape_rows.free),
        n_bodies_made=world.bodies.n_made,
        n_joints_made=world.joints.n_made,
        n_cloths_made=world.cloths.n_made,
        shapes=MappingProxyType(dict(world.shape_rows.shapes)),
        geometry=MappingProxyType(dict(world.shape_rows.begins)),
        kinds=tuple(sorted(world.shape_rows.kinds)),
        bouncing=world.shape_rows.bouncing,
        body_names=MappingProxyType(world.bodies.names.all()),
        joint_names=MappingProxyType(world.joints.names.all()),
        cloth_names=MappingProxyType(world.cloths.names.all()),
    )


def restore(world: "World", snapshot: Snapshot) -> None:
    """Bring a world into the state of a snapshot, of itself or of another world."""
    if not isinstance(snapshot, Snapshot):
        raise ArgumentError(f"snapshot={snapshot!r} is not a snapshot; give one returned by World.snapshot.")
    if world.recorder is not None:
        raise ArgumentError(
            "the world is being recorded, and a recording cannot go back in time; end it before restoring."
        )
    world.sleeping = snapshot.sleeping  # which wakes all bodies; the tables below tell which sleep
    put_back(world.tables, snapshot.tables)
    world.time, world.n_steps, world.counted = snapshot.time, snapshot.n_steps, snapshot.counted
    world.planar = bool(world.tables.array(SETTINGS)[0, settings.PLANE_NORMAL : settings.PLANE_NORMAL + 3].any())
    world.forces, world.broken = list(snapshot.forces), []
    bodies, joints, shapes = world.bodies, world.joints, world.shape_rows
    bodies.free[:] = snapshot.free_bodies
    bodies.n_made = max(bodies.n_made, snapshot.n_bodies_made)
    joints.n_made = max(joints.n_made, snapshot.n_joints_made)
    joints.arranged = True
    shapes.free[:] = snapshot.free_shapes
    shapes.shapes = dict(snapshot.shapes)
    shapes.begins = dict(snapshot.geometry)
    shapes.kinds, shapes.bouncing = frozenset(snapshot.kinds), snapshot.bouncing
    bodies.names.replace(snapshot.body_names)
    joints.names.replace(snapshot.joint_names)
    world.cloths.names.replace(snapshot.cloth_names)
    world.cloths.n_made = max(world.cloths.n_made, snapshot.n_cloths_made)
    world.cloths.restored()
    world.tables.altered = True
    world.tables.version += 1


def put_back(of: Tables, copies: Mapping[str, NDArray[Any]]) -> None:
    """Bring tables back to copies of them; those that a step fills anew are resized, trees and lists of shapes rebuilt."""
    for name, table in TABLES.items():
        if len(copies[name]) or of.count(table):
            of.put(table, copies[name])
    for table in _OF_BODIES:
        of.resize(table, of.count(POSE))
    of.resize(STARTED_JOINTS, of.count(JOINT))
    shapes_new(of)
    keep_pairs(of)

"""What a world is made of: tables of numbers, one row a body, a shape or a contact, which compiled code finds by address.

A stage of the step is a compiled function ``stage(t, h, world)``, where ``world`` is the address of a block that says of
every table where it lies, how many rows are in use and how many there is room for. Views of a table (`floats`,
`integers`) cost nothing. Tables grow between stages, never inside of one: a stage that finds one full says so (`FULL`),
leaves everything as it was, and is run again once the table has grown.
"""

import mmap
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from numba import carray
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_at, integers_at, put_word, word


class Table(NamedTuple):
    """Where a table is described in the block, the numbers in a row, and whether they are integers."""

    place: int
    width: int
    whole: bool = False


# Bodies; row 0 is the ground, which never moves. Rows of eight floats are one cache line.
POSE = Table(0, 8)  # centre of mass (3), orientation (4: w, x, y, z)
MOTION = Table(1, 8)  # velocity of the centre of mass (3), angular velocity in the world's axes (3)
DELTA_POSE = Table(2, 8)  # since the start of the step: displacement (3), rotation vector (3)
INVERSE_MASS = Table(3, 8)  # 1/mass, and the inverse inertia in the world's axes (6); zeros do not move
INERTIA = Table(4, 16)  # mass, inertia in the body's axes (6), its inverse (6), damping of velocity and of rotation (2)
LOAD = Table(5, 8)  # force (3) and torque (3) asked for during the next step
# For how long a body has rested, for how long its island has, how far it reaches, where it sleeps (7)
RESTED = Table(36, 12)
FORCE = Table(35, 8)  # force (3) and torque (3) in this substep
KICKED = Table(6, 24)  # see `kickdrift.world.flight`
NOTED = Table(19, 8)  # as MOTION was before a solution of the direct solver, to go back to
BODY = Table(7, 12, whole=True)  # see `kickdrift.world.flight`
# Shapes
# Kind (-1: removed), body, where its numbers begin in GEOMETRY, how many, layer, mask, sensor, state of its search (see
# `kickdrift.world.collision.search`)
SHAPE = Table(8, 8, whole=True)
PLACE = Table(9, 16)  # pose in the body (7), friction, restitution, rolling resistance, velocity of its surface (3)
PLACED = Table(37, 8)  # pose of a shape in the world (7) when the step began
# Corners of the fat bounds that a shape was last sought in (6), and of a mesh its nodes in TRIANGLE_TREE: the first, and the
# one after the last
BOUNDS = Table(10, 8)
GEOMETRY = Table(11, 1)  # the numbers of all shapes, one shape after the other
# Contacts: pairs of shapes whose fat bounds overlap
CONTACT = Table(12, 8, whole=True)  # shapes (2), triangle of a, bodies (2), points, what it does, group and lane
MANIFOLD = Table(13, 72)  # see `kickdrift.world.contacts.layout`
SETTINGS = Table(14, 32)  # one row: see `kickdrift.world.settings`
STEP_STATUS = Table(15, 8, whole=True)  # one row: what went wrong, which table or body
EVENTS = Table(16, 8, whole=True)  # see `kickdrift.world.events`
# Joints: see `kickdrift.world.joints.layout`
JOINT = Table(17, 16, whole=True)
JOINT_NUMBERS = Table(18, 80)
JOINT_AXES = Table(45, 16)  # six rows a joint
LANES = Table(20, 1)  # constraints in groups of lanes
GROUPS = Table(21, 24, whole=True)  # of each lane the first body (8), the second (8), the contact (8)
SCRATCH = Table(22, 1)
TREE = Table(23, 8)  # over the fat bounds of shapes that may move: see `kickdrift.world.collision.bvh`
STATIC_TREE = Table(24, 8)  # over those that may not
SHAPE_KINDS = Table(28, 4, whole=True)  # of shapes: see `kickdrift.world.collision.dispatch`
COLLIDERS = Table(25, 16, whole=True)  # address of the function for each pair of kinds of shapes
ARTICULATION = Table(26, 12, whole=True)
LINK = Table(46, 10, whole=True)  # a body of an articulation and the joint that it hangs on, parents first
LINK_NUMBERS = Table(47, 248)
CONTACT_ROW = Table(48, 288)  # of contacts that are solved directly: see `kickdrift.world.direct.layout`
GRAPH = Table(51, 4, whole=True)  # one row: see `kickdrift.world.direct.nodes`
ISLAND = Table(52, 12, whole=True)
ISLAND_CONTACT = Table(53, 1, whole=True)  # contacts of the linked colour, one island after the other
ISLAND_JOINT = Table(54, 1, whole=True)  # rows of LINK that have joints, one island after the other
NODE = Table(55, 8, whole=True)
NEIGHBOUR = Table(56, 1, whole=True)  # node
BLOCK = Table(57, 144)
ADJACENCY = Table(58, 1, whole=True)  # bits: which nodes are coupled
COLOURS = Table(30, 4, whole=True)  # contacts of a colour, its first group and the group after its last
COLOURED = Table(31, 1, whole=True)  # of each body the set of colours that its contacts have
SWEEPS = Table(34, 9, whole=True)  # one row: see `kickdrift.world.contacts.contact_solver_simd`
IMPACT = Table(59, 64)  # hits of a round of impacts: see `kickdrift.world.contacts.restitution`
BOUNCING = Table(60, 1, whole=True)  # contacts that may bounce in this step
STARTED_POSE = Table(32, 8)  # as POSE and MOTION were when the step began
STARTED_MOTION = Table(33, 8)
STARTED_JOINTS = Table(50, 80)  # as JOINT_NUMBERS were
SEARCH = Table(38, 16, whole=True)  # one row: see `kickdrift.world.collision.search`
MOVERS = Table(39, 1, whole=True)  # shapes that may move
FIXTURES = Table(44, 1, whole=True)  # shapes that may not
PLANES = Table(40, 1, whole=True)  # shapes that are planes
SOUGHT = Table(41, 1, whole=True)  # shapes whose pairs are to be found anew
TRIANGLE_TREE = Table(42, 8)  # over the triangles of each mesh, one tree after the other
EXCLUDED = Table(43, 2, whole=True)  # pairs of bodies that never touch, the lower one first; sorted
ASKED_APART = Table(49, 2, whole=True)  # those of them that users ask for; the others are joined

_COUNT = 61
_HUGE_PAGES = getattr(mmap, "MADV_HUGEPAGE", None)  # Linux
_HUGE_PAGE, _LARGE = 1 << 21, 1 << 19  # bytes: of such a page, and of tables that go there
_ADDRESS, _ROWS, _ROOM = 0, 1, 2  # the words that describe a table


@compiled(inline=True)
def rows(world: int, table: Table) -> int:
    """Rows in use."""
    count: int = word(world, 3 * table[0] + _ROWS)
    return count


@compiled(inline=True)
def room(world: int, table: Table) -> int:
    """Rows that there is room for."""
    count: int = word(world, 3 * table[0] + _ROOM)
    return count


@compiled(inline=True)
def set_rows(world: int, table: Table, count: int) -> None:
    """Say how many rows are in use, at most what there is room for."""
    put_word(world, 3 * table[0] + _ROWS, count)


@compiled(inline=True)
def floats(world: int, table: Table) -> Any:
    """Return a view of all rows that a table has room for."""
    place = 3 * table[0]
    return carray(floats_at(word(world, place + _ADDRESS)), (word(world, place + _ROOM), table[1]))


@compiled(inline=True)
def integers(world: int, table: Table) -> Any:
    """Return a view of all rows that a table of integers has room for."""
    place = 3 * table[0]
    return carray(integers_at(word(world, place + _ADDRESS)), (word(world, place + _ROOM), table[1]))


@compiled(inline=True)
def flat(world: int, table: Table) -> Any:
    """Return the numbers of a table as one row: loops over it vectorise."""
    place = 3 * table[0]
    return carray(floats_at(word(world, place + _ADDRESS)), (word(world, place + _ROOM) * table[1],))


@compiled(inline=True)
def flat_integers(world: int, table: Table) -> Any:
    """Return the integers of a table as one row."""
    place = 3 * table[0]
    return carray(integers_at(word(world, place + _ADDRESS)), (word(world, place + _ROOM) * table[1],))


_COMPANIONS = {CONTACT: (MANIFOLD,), LINK: (LINK_NUMBERS,)}  # that a table grows with
_TABLES = {table.place: table for table in list(globals().values()) if isinstance(table, Table)}


class Tables:
    """The tables of one world and the block that describes them to compiled code."""

    def __init__(self) -> None:
        self.block: NDArray[np.intp] = np.zeros(3 * _COUNT, dtype=np.intp)
        self.address = int(
            self.block.ctypes.data
        )  # what compiled code is given; the same for as long as the world lives
        self._arrays: dict[int, NDArray[Any]] = {}
        # Whether something has changed that the stages of the step or their order may depend on.
        self.altered = True
        # Grows where bodies or joints go, or tables lie elsewhere, so that handles look again where theirs is.
        self.version = 0

    def count(self, table: Table) -> int:
        """Return how many rows of a table are in use."""
        return int(self.block.item(3 * table.place + _ROWS))

    def row(self, table: Table, row: int) -> NDArray[Any]:
        """Return a row that is in use, as a live view; what `array` takes longer for."""
        found: NDArray[Any] = self._arrays[table.place][row]
        return found

    def array(self, table: Table) -> NDArray[Any]:
        """Return the rows of a table in use, as a live view; replaced where the table grows."""
        return self._room(table)[: self.block[3 * table.place + _ROWS]]

    def room(self, table: Table) -> int:
        """Return how many rows of a table there is room for."""
        return len(self._room(table))

    def resize(self, table: Table, count: int) -> NDArray[Any]:
        """Say how many rows are in use; new ones are zeros. Room grows by half of itself at least."""
        place = 3 * table.place
        before = int(self.block[place + _ROWS])
        if count > before:
            self.reserve(table, count)
            self._room(table)[before:count] = 0
        self.block[place + _ROWS] = count
        return self._room(table)[:count]

    def reserve(self, table: Table, count: int) -> None:
        """Make room for so many rows, keeping what is there."""
        place = 3 * table.place
        old = self._room(table)
        if count <= len(old):
            return
        new = _aligned(max(count, len(old) + len(old) // 2, 16), table.width, np.int64 if table.whole else np.float64)
        new[: len(old)] = old
        self._arrays[table.place] = new
        self.version += 1
        self.block[place : place + 3] = new.ctypes.data, self.block[place + _ROWS], len(new)

    def put(self, table: Table, values: NDArray[Any], room: int) -> None:
        """Let a table hold these rows, with room for so many."""
        count = len(values)
        if count == self.count(table) and room <= self.room(
            table
        ):  # as it does where a world goes back to its own past
            if count:
                self._arrays[table.place][:count] = values
            return
        self.reserve(table, room)
        self.resize(table, count)[:] = values

    def make_room(self, place: int, count: int) -> None:
        """Make room in the table at a place of the block, as a stage has asked, and in those that go with it."""
        for table in (_TABLES[place], *_COMPANIONS.get(_TABLES[place], ())):
            self.reserve(table, count)

    def _room(self, table: Table) -> NDArray[Any]:
        if table.place not in self._arrays:
            empty = np.zeros((0, table.width), dtype=np.int64 if table.whole else np.float64)
            self._arrays[table.place] = empty
        return self._arrays[table.place]


def _aligned(count: int, width: int, dtype: Any) -> NDArray[Any]:
    """Zeros that begin where a cache line does; large tables lie on huge pages, where the system has them.

    Their rows are read out of order: among 10,000 bodies, whose tables have thousands of usual pages, a step takes a tenth
    longer without.
    """
    size = count * width
    if _HUGE_PAGES is not None and 8 * size >= _LARGE:
        buffer = np.frombuffer(_huge_pages(8 * size + _HUGE_PAGE, _HUGE_PAGES), dtype=dtype)
        start = (-buffer.ctypes.data % _HUGE_PAGE) // 8
    else:
        buffer = np.zeros(size + 8, dtype=dtype)
        start = (-buffer.ctypes.data % 64) // 8
    return buffer[start : start + size].reshape(count, width)


def _huge_pages(size: int, advice: int) -> mmap.mmap:
    """Return a map of memory of so many bytes, zeros, that lives for as long as the arrays in it."""
    pages = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    with suppress(OSError):  # of a system that does not care
        pages.madvise(advice)
    return pages

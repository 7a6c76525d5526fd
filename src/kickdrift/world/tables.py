"""The data of a world: tables with one row per body, shape or contact, which compiled code finds by address.

A stage of the step is a compiled function ``stage(t, h, world)``, where ``world`` is the address of a block that holds for
every table its address, the number of rows in use and the number of rows allocated. Views of a table (`floats`, `integers`)
cost nothing. Tables grow between stages, never within one: a stage that finds one full sets the status `FULL`, and is
run again once the table has grown: what it has written until then must not change the result.
"""

import threading
from typing import Any, NamedTuple

import numpy as np
from numba import carray
from numpy.typing import NDArray

from kickdrift.core.aligned_arrays import aligned_zeros
from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_at, integers_at, put_word, word


class Table(NamedTuple):
    """The index of a table in the block, the numbers per row, and whether they are integers."""

    place: int
    width: int
    whole: bool = False


# Bodies; row 0 is the ground, which never moves. Rows of eight floats are one cache line.
# Columns are declared in `kickdrift.world.layout`, or in the module named here.
POSE = Table(0, 8)
MOTION = Table(1, 8)  # of the centre of mass
DELTA_POSE = Table(2, 8)  # since the start of the step
INVERSE_MASS = Table(3, 8)
INERTIA = Table(4, 16)
LOAD = Table(5, 8)  # forces that users apply during the next step
RESTED = Table(36, 12)
FORCE = Table(35, 12)  # in this substep
KICKED = Table(6, 24)  # data that `kickdrift.world.integration` carries from kick to drift
CLOTH_LOAD = Table(109, 67)  # of cloths on bodies
NOTED = Table(19, MOTION.width)  # MOTION before a solution of the direct solver; or while impacts are found, support
BODY = Table(7, 16, whole=True)
# Shapes
SHAPE = Table(8, 8, whole=True)
PLACE = Table(9, 16)  # in the body, and its surface
PLACED = Table(37, 8)  # in the world when the step began
BOUNDS = Table(10, 8)  # fat bounds with which a shape was last sought
GEOMETRY = Table(11, 1)  # the numbers of all shapes, one shape after the other
# Contacts: pairs of shapes whose fat bounds overlap; see `kickdrift.world.contacts.layout`
CONTACT = Table(12, 8, whole=True)
MANIFOLD = Table(13, 72)
LOST_POINT = Table(107, 16)  # in this step: see `kickdrift.world.collision.narrow_phase.impulse_matching`
SETTINGS = Table(14, 35)  # one row: see `kickdrift.world.settings`
STEP_STATUS = Table(15, 16, whole=True)  # one row: see `kickdrift.world.step.status`
EVENTS = Table(16, 8, whole=True)
# Joints: see `kickdrift.world.joints.layout`
JOINT = Table(17, 16, whole=True)
JOINT_NUMBERS = Table(18, 96)
JOINT_AXES = Table(45, 16)  # six rows a joint
LANES = Table(20, 1)  # constraints in groups of lanes, whose fields are in `kickdrift.world.contacts.layout`
GROUPS = Table(21, 24, whole=True)  # contents of these groups: see there
SCRATCH = Table(22, 1)
TREE = Table(23, 8)  # over the fat bounds of shapes that may move: see `kickdrift.world.collision.broad_phase.bvh`
STATIC_TREE = Table(24, 8)  # over those of shapes that may not
SHAPE_KINDS = Table(28, 4, whole=True)  # of shapes: see `kickdrift.world.collision.shape_properties`
COLLIDERS = Table(25, 16, whole=True)  # address of the function for each pair of kinds of shapes
# Trees of joints: see `kickdrift.world.joints.layout`
ARTICULATION = Table(26, 8, whole=True)
LINK = Table(46, 11, whole=True)  # a body of an articulation and its joint to the parent, parents first
LINK_NUMBERS = Table(47, 277)  # no step reads the data of another there
GRAPH = Table(51, 4, whole=True)  # one row
# The direct solver: see `kickdrift.world.direct.layout`
CONTACT_ROW = Table(48, 288)  # of contacts that are solved directly
ISLAND = Table(52, 13, whole=True)
ISLAND_CONTACT = Table(53, 1, whole=True)  # contacts of the linked colour, one island after the other
ISLAND_JOINT = Table(54, 1, whole=True)  # rows of LINK that have joints, one island after the other
NODE = Table(55, 8, whole=True)
NEIGHBOUR = Table(56, 1, whole=True)  # node
BLOCK = Table(57, 144)
ADJACENCY = Table(58, 1, whole=True)  # bits: which nodes are coupled
# The sweeps
COLOURS = Table(30, 4, whole=True)  # of contacts: see `kickdrift.world.contacts.layout`
COLOURED = Table(31, 1, whole=True)  # for each body the set of colours of its contacts
KERNEL_ADDRESSES = Table(34, 24, whole=True)  # one row: see `kickdrift.world.contacts.layout`
IMPACT = Table(59, 64)  # hits of a round of impacts: see `kickdrift.world.contacts.impacts.impact_rows`
BOUNCING = Table(60, 3, whole=True)  # contacts that may bounce in this step
STARTED_POSE = Table(32, POSE.width)  # POSE, MOTION and JOINT_NUMBERS at the start of the step
STARTED_MOTION = Table(33, MOTION.width)
STARTED_ROTATION = Table(27, 16)  # see `kickdrift.world.step.rollback`
STARTED_JOINTS = Table(50, JOINT_NUMBERS.width)
STARTED_IMPULSE = Table(29, 12)  # of contacts: see `kickdrift.world.contacts.batch_division`
PREDICTED = Table(61, 20)  # paths in a step: see `kickdrift.world.collision.predicted_motion`
SWEPT = Table(104, 6)  # around the paths of bodies in a step: see `kickdrift.world.collision.predicted_motion`
SEARCH = Table(38, 16, whole=True)  # one row: see `kickdrift.world.collision.broad_phase.search_state`
MOVERS = Table(39, 1, whole=True)  # shapes that may move
FIXTURES = Table(44, 1, whole=True)  # shapes that may not
PLANES = Table(40, 1, whole=True)  # shapes that are planes
SOUGHT = Table(41, 1, whole=True)  # shapes whose pairs are to be found again
TRIANGLE_TREE = Table(42, 8)  # over the triangles of each mesh, one tree after the other
EXCLUDED = Table(43, 2, whole=True)  # pairs that never touch, sorted; see `collision.broad_phase.filters_and_sensors`
ASKED_APART = Table(49, 2, whole=True)  # those of them that users have excluded; the others are joined
FORCE_NUMBERS = Table(62, 1)  # numbers captured by users' forces: see `kickdrift.world.force_functions`

# The substeps: see `kickdrift.world.batch_view`
MEMBER = Table(63, 1, whole=True)  # bodies that a substep moves, one batch after the other
BATCH = Table(64, 4, whole=True)
MEMBERSHIP = Table(65, 2, whole=True)  # of each body

# Cloths: see `kickdrift.world.deformables.layout`
CLOTH, CLOTH_NUMBERS = Table(66, 27, whole=True), Table(67, 32)
PARTICLE, PARTICLE_LANES = Table(68, 8), Table(69, 1)  # see `kickdrift.world.deformables.particle_fields`
PARTICLE_COUPLINGS = Table(72, 2, whole=True)
FACE = Table(70, 4, whole=True)  # a triangle of a cloth
FACE_NUMBERS = Table(71, 8)
COUPLING, COUPLING_NUMBERS = Table(73, 1, whole=True), Table(81, 1)  # of a particle with another one, by bending
CURVED_FACE, CURVED_FACE_NUMBERS = Table(82, 8, whole=True), Table(83, 8)  # a triangle that is curved at rest
PIN, PIN_NUMBERS = Table(74, 2, whole=True), Table(75, 4)
TETHER, TETHER_NUMBERS = Table(121, 3, whole=True), Table(122, 1)
CLOTH_CONTACT, CLOTH_CONTACT_NUMBERS = Table(76, 13, whole=True), Table(77, 26)
STARTED_PARTICLE = Table(78, PARTICLE.width)
PARTICLE_REST = Table(80, 4)
PARTICLE_SHIFT, PARTICLE_BOUNDS = Table(84, 4), Table(85, 8)
CLOTH_PAIR, CLOTH_PAIR_NUMBERS = Table(86, 8, whole=True), Table(87, 14)  # vertex and triangle, or edges
CLOTH_TREE = Table(88, 8)  # over the triangles of each cloth: see `kickdrift.world.deformables.self_collision.face_bvh`
NORMAL_TREE = Table(95, 8)  # likewise, over their normals
CLOTH_TREE_NODE, TREE_NEIGHBOUR = Table(89, 4, whole=True), Table(103, 2, whole=True)  # nodes
FACE_BOUNDS, FACE_NORMALS, FACE_STARS = Table(90, 8), Table(91, 8), Table(108, 3, whole=True)
# of each particle: see `kickdrift.world.deformables.self_collision.impact_zones`
ZONE, ZONE_NUMBERS = Table(92, 4, whole=True), Table(93, 16)
CLOTH_SEARCH = Table(94, 16)  # one row
INTERVAL_START, PARTICLE_PATH, FACE_TURN, PARTICLE_WIND = Table(96, 4), Table(97, 7), Table(98, 6), Table(102, 3)
FACE_GROUP, GROUP_REST, GROUP_STRAIN = Table(99, 32, whole=True), Table(100, 40), Table(101, 24)  # eight triangles each
TETRAHEDRON, TETRAHEDRON_NUMBERS = Table(105, 4, whole=True), Table(106, 10)  # of a soft body
STARTED_SEARCH, STARTED_PATH = Table(112, CLOTH_SEARCH.width), Table(113, PARTICLE_PATH.width)
BENDING_SUMS = Table(116, 9)  # of each chunk of particles: see `kickdrift.world.deformables.forces.bending`
# See `kickdrift.world.deformables.self_collision.parallel_search`
SEARCH_TASK, FOUND_PAIR = Table(117, 8, whole=True), Table(118, CLOTH_PAIR.width, whole=True)
FOUND_PAIR_NUMBERS, NEAR_PAIR = Table(119, CLOTH_PAIR_NUMBERS.width), Table(120, 1, whole=True)
STARTED_PAIR, STARTED_PAIR_NUMBERS = Table(114, CLOTH_PAIR.width, whole=True), Table(115, CLOTH_PAIR_NUMBERS.width)
CONTACT_LANES, CONTACT_LANE_PARTICLES = Table(110, 64), Table(111, 8, whole=True)  # eight contacts each
CLOTH_NEAR = Table(79, 1)  # shapes, and triangles of one, that are near a cloth

_LAST = max(table.place for table in list(globals().values()) if isinstance(table, Table))
VIEW = Table(_LAST + 1, 3 * (_LAST + 2), whole=True)  # the block as it is for a batch, or for a worker in a search
_COUNT = _LAST + 2
_ADDRESS, _ROWS, _ROOM = 0, 1, 2  # the words that describe a table


@compiled(inline=True)
def rows(world: int, table: Table) -> int:
    """Return the number of rows in use."""
    count: int = word(world, 3 * table[0] + _ROWS)
    return count


@compiled(inline=True)
def room(world: int, table: Table) -> int:
    """Return the number of rows that there is room for."""
    count: int = word(world, 3 * table[0] + _ROOM)
    return count


@compiled(inline=True)
def set_rows(world: int, table: Table, count: int) -> None:
    """Set the number of rows in use, at most the number allocated."""
    put_word(world, 3 * table[0] + _ROWS, count)


@compiled(inline=True)
def address(world: int, table: Table) -> int:
    """Return the address of the first row."""
    begins: int = word(world, 3 * table[0] + _ADDRESS)
    return begins


@compiled(inline=True)
def narrow(world: int, table: Table, first: int, count: int) -> None:
    """Restrict a table to `count` of its rows, from `first` on."""
    place = 3 * table[0]
    put_word(world, place + _ADDRESS, word(world, place + _ADDRESS) + 8 * table[1] * first)
    put_word(world, place + _ROWS, count)
    put_word(world, place + _ROOM, count)


@compiled(inline=True)
def replace(world: int, table: Table, by: Table, first: int, count: int) -> None:
    """Replace a table in a block by `count` rows of another one, from `first` on, none of which is in use."""
    place = 3 * table[0]
    put_word(world, place + _ADDRESS, word(world, 3 * by[0] + _ADDRESS) + 8 * by[1] * first)
    put_word(world, place + _ROWS, 0)
    put_word(world, place + _ROOM, count)


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
    """Return the numbers of a table as one array, over which loops vectorise."""
    place = 3 * table[0]
    return carray(floats_at(word(world, place + _ADDRESS)), (word(world, place + _ROOM) * table[1],))


@compiled(inline=True)
def flat_integers(world: int, table: Table) -> Any:
    """Return the integers of a table as one array."""
    place = 3 * table[0]
    return carray(integers_at(word(world, place + _ADDRESS)), (word(world, place + _ROOM) * table[1],))


# Tables that are given at least as much room as another one
_COMPANIONS: dict[Table, tuple[Table, ...]] = {CONTACT: (MANIFOLD,), LINK: (LINK_NUMBERS,)}
_COMPANIONS |= {CLOTH_CONTACT: (CLOTH_CONTACT_NUMBERS,), CLOTH_PAIR: (CLOTH_PAIR_NUMBERS, NEAR_PAIR)}
_COMPANIONS |= {CONTACT_LANES: (CONTACT_LANE_PARTICLES,), STARTED_PAIR: (STARTED_PAIR_NUMBERS,)}
_COMPANIONS |= {FOUND_PAIR: (FOUND_PAIR_NUMBERS,)}
_TABLES = {table.place: table for table in list(globals().values()) if isinstance(table, Table)}


class Tables:
    """The tables of one world and the block that describes them to compiled code."""

    def __init__(self) -> None:
        self.block: NDArray[np.intp] = np.zeros(3 * _COUNT, dtype=np.intp)
        self.address = int(self.block.ctypes.data)  # for compiled code; the same for the lifetime of the world
        self._arrays: dict[int, NDArray[Any]] = {}
        # Whether anything has changed that the stages of the step or their order may depend on.
        self.altered = True
        # Held by the thread that uses the tables: they must not move in memory during a step in another thread.
        self.lock = threading.RLock()
        # Incremented when bodies or joints are removed or tables move in memory, which invalidates the views of handles.
        self.version = 0

    def count(self, table: Table) -> int:
        """Return how many rows of a table are in use."""
        count: int = self.block.item(3 * table.place + _ROWS)
        return count

    def row(self, table: Table, row: int) -> NDArray[Any]:
        """Return a row that is in use, as a live view; faster than a row of `array`."""
        found: NDArray[Any] = self._arrays[table.place][row]
        return found

    def array(self, table: Table) -> NDArray[Any]:
        """Return the rows of a table in use, as a live view; replaced where the table grows."""
        return self._room(table)[: self.block.item(3 * table.place + _ROWS)]

    def resize(self, table: Table, count: int) -> NDArray[Any]:
        """Set the number of rows in use and return them; new ones are zeros. Room grows by half of itself at least."""
        place = 3 * table.place
        before = self.block.item(place + _ROWS)
        if count > before:
            self.reserve(table, count)
            self._room(table)[before:count] = 0
        if count != before:
            self.block[place + _ROWS] = count
        return self._room(table)[:count]

    def reserve(self, table: Table, count: int) -> None:
        """Make room for a number of rows, keeping the existing ones."""
        place = 3 * table.place
        old = self._room(table)
        if count <= len(old):
            return
        new = aligned_zeros(
            max(count, len(old) + len(old) // 2, 16), table.width, np.int64 if table.whole else np.float64
        )
        new[: len(old)] = old
        words = new.ctypes.data, self.block[place + _ROWS], len(new)
        # In one statement, which Ctrl-C does not interrupt: otherwise compiled code could get the address of freed memory.
        self._arrays[table.place], self.block[place : place + 3] = new, words
        self.version += 1
        for companion in _COMPANIONS.get(table, ()):
            self.reserve(companion, len(new))

    def put(self, table: Table, values: NDArray[Any]) -> None:
        """Replace the rows of a table."""
        self.resize(table, len(values))[:] = values

    def make_room(self, place: int, count: int) -> None:
        """Make room in the table with this place in the block, for a stage that has set `FULL`."""
        self.reserve(_TABLES[place], count)

    def _room(self, table: Table) -> NDArray[Any]:
        array = self._arrays.get(table.place)
        if array is None:
            array = np.zeros((0, table.width), dtype=np.int64 if table.whole else np.float64)
            self._arrays[table.place] = array
        return array

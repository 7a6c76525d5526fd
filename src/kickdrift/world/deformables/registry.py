"""The cloths, ropes and soft bodies of a world: their rows in its tables, and the checks of their handles."""

from __future__ import annotations

from typing import Any, TypeVar
from weakref import ReferenceType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError, unknown_name
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.building import Built
from kickdrift.world.deformables.cloth_handle import Cloth
from kickdrift.world.deformables.deformable import Deformable
from kickdrift.world.deformables.forces.bending_coupling_rows import put_couplings
from kickdrift.world.deformables.forces.highest_frequency import put_membrane_rate
from kickdrift.world.deformables.mesh import ClothMesh
from kickdrift.world.deformables.mesh_tables import mesh_in, put_mesh
from kickdrift.world.deformables.particle_tables import forget_motion, forget_pairs
from kickdrift.world.deformables.pin_rows import add_pins, remove_pins
from kickdrift.world.deformables.preparation import Preparation
from kickdrift.world.deformables.rope_handle import Rope
from kickdrift.world.deformables.row_ranges import add_range, remove_range, rows_of
from kickdrift.world.deformables.soft_body_handle import SoftBody
from kickdrift.world.deformables.splitting import Split, cut_by_plane, put_split
from kickdrift.world.deformables.substep_choice import WORDS, is_far_softer, softness
from kickdrift.world.deformables.tearing import find_tears
from kickdrift.world.names import Names
from kickdrift.world.tables import CLOTH, CLOTH_NUMBERS, FACE_NUMBERS, PARTICLE, PIN, TETRAHEDRON, Tables
from kickdrift.world.world_lock import alone, undivided

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
D = TypeVar("D", bound=Deformable)


class Cloths:
    """The rows of cloths in the tables of a world.

    Parameters
    ----------
    tables : Tables
    bodies : Bodies
        The bodies of the world, to which vertices may be pinned.
    """

    def __init__(self, tables: Tables, bodies: Bodies) -> None:
        self.tables, self._bodies = tables, bodies
        self.names = Names("cloth")
        self.world: ReferenceType[Any] | None = None
        self.n_made = 0  # never decreases, not even on restoring a snapshot: two cloths would share a handle
        self._preparation = Preparation(tables)

    @undivided
    def add(self, built: Built, kind: type[D], name: str | None, self_collision: bool) -> D:
        """Add a cloth, a rope or a soft body, free of tension, and return its handle, which is of this kind."""
        tables, name = self.tables, self.names.checked(name)
        row = add_range(tables)
        put_mesh(tables, row, built)
        own, generation = tables.array(CLOTH)[row], self.n_made
        self.n_made += 1
        own[c.PARTS], own[c.CLOTH_GENERATION], own[c.MEETS_ITSELF] = 1, generation, int(self_collision)
        if built.dimension == c.SHEET:
            put_membrane_rate(tables, row, built.mesh)
        self.names.give(row, name)
        self._couple(row)
        self._changed()
        return kind(row, generation, self)

    @undivided
    def remove(self, cloth: Deformable) -> None:
        """Remove a cloth; see `World.remove_cloth`."""
        row = self.row(cloth)
        repr(cloth)  # its name is kept for later errors
        remove_range(self.tables, row)
        names = self.names.all()
        self.names.replace({k - (k > row): name for k, name in names.items() if k != row})
        self._changed()

    @undivided
    def cut(self, cloth: Cloth, point: Floats, normal: Floats) -> int:
        """Cut a cloth; see `Cloth.cut`."""
        row = self.row(cloth)
        return self._put_split(row, cut_by_plane(self.tables, row, point, normal))

    @property
    def tearable(self) -> bool:
        """Whether a cloth can tear."""
        return bool((self.tables.array(CLOTH_NUMBERS)[:, c.TEAR_STRAIN] > 0.0).any())

    @undivided
    def tear(self) -> bool:
        """Tear the cloths that are stretched too far, and return whether there were any."""
        torn = False
        for row, own in enumerate(self.tables.array(CLOTH)[:, c.IS_ASLEEP].tolist()):
            split = find_tears(self.tables, row) if own == 0 else None
            torn = torn or split is not None
            if split is not None:
                self._put_split(row, split)
        return torn

    def _put_split(self, row: int, split: Split) -> int:
        if split.parents.size:
            put_split(self.tables, row, split)
            self._changed()
        return int(split.parents.size)

    def _changed(self) -> None:
        """Wake everything, and request that all data that depend on the vertices are prepared again."""
        self._preparation.forget()
        forget_motion(self.tables)
        self._bodies.wake()
        self.wake()
        self.tables.altered = True
        self.tables.version += 1

    def _couple(self, row: int) -> None:
        forget_pairs(self.tables)  # of which the inverse masses of pinned vertices are a part
        put_couplings(self.tables, row, self.mesh(row))
        self._preparation.forget_pins()

    def mesh(self, row: int) -> ClothMesh:
        """Return the mesh of a cloth at rest."""
        return mesh_in(self.tables, row)

    def tune(self, substep: float) -> None:
        """Prepare the tables of cloths for a substep, s."""
        self._preparation.prepare(substep)

    def restored(self) -> None:
        """Have `tune` prepare everything again, after the tables were replaced."""
        self._preparation.forget()

    def row(self, cloth: Deformable, argument: str = "cloth") -> int:
        """Return the row of an existing cloth or rope; ArgumentError if it was removed, or is not of this world."""
        if not isinstance(cloth, Deformable) or cloth.registry is not self:
            raise ArgumentError(
                f"{argument}={cloth!r} is not a cloth, rope or soft body of this world; give what World.add_cloth, add_rope or "
                "add_soft_body returned."
            )
        index = cloth.index
        if not self.knows(index, cloth.generation):
            raise ArgumentError(f"{argument}={cloth!r} was removed; use an existing cloth.")
        return index

    def index_of(self, generation: int, last: int) -> int:
        """Return the row of the cloth of a generation; `last`, the row that it had last, if it was removed."""
        if self.knows(last, generation):
            return last
        found = np.flatnonzero(self.tables.array(CLOTH)[:, c.CLOTH_GENERATION] == generation)
        return int(found[0]) if found.size else last

    def words(self, row: int) -> str:
        """Return the name of a cloth, or its row, for messages."""
        return f"{WORDS[int(self.tables.array(CLOTH)[row, c.DIMENSION])]} {(self.names.of(row) or row)!r}"

    def knows(self, index: int, generation: int) -> bool:
        """Whether a row holds the cloth of a generation."""
        cloths = self.tables.array(CLOTH)
        return 0 <= index < len(cloths) and bool(cloths[index, c.CLOTH_GENERATION] == generation)

    def handle(self, row: int) -> Deformable:
        """Return the handle of a row."""
        own = self.tables.array(CLOTH)[row]
        return _HANDLES[int(own[c.DIMENSION])](row, int(own[c.CLOTH_GENERATION]), self)

    def named(self, name: str, kind: type[D]) -> D:
        """Return the handle of the one with a name; UnknownNameError if there is none of this kind."""
        known = {named: self.handle(row) for row, named in self.names.all().items()}
        found = known.get(name)
        if not isinstance(found, kind):
            raise unknown_name("name", name, [each for each, handle in known.items() if isinstance(handle, kind)])
        return found

    def particles(self, cloth: Deformable) -> Floats:
        """Return the rows of the vertices, a live view."""
        return rows_of(self.tables, self.row(cloth), c.FIRST_PARTICLE, PARTICLE)

    def triangles(self, cloth: Deformable) -> Integers:
        """Return the vertices of the triangles, a copy."""
        return self.mesh(self.row(cloth)).triangles

    def rest_lengths(self, rope: Deformable) -> Floats:
        """Return the lengths of the segments of a rope at rest, m, a copy."""
        return rows_of(self.tables, self.row(rope), c.FIRST_FACE, FACE_NUMBERS)[:, c.REST_LENGTH].copy()

    def tetrahedra(self, body: Deformable) -> Integers:
        """Return the vertices of the tetrahedra of a soft body, a copy."""
        row = self.row(body)
        corners = rows_of(self.tables, row, c.FIRST_TETRAHEDRON, TETRAHEDRON)
        result: Integers = corners - self.tables.array(CLOTH)[row, c.FIRST_PARTICLE]
        return result

    def numbers(self, cloth: Deformable, name: str) -> Floats:
        """Return a property by its name, a copy."""
        first, size = _COLUMNS[name]
        return self.tables.array(CLOTH_NUMBERS)[self.row(cloth), first : first + size].copy()

    @alone
    def set_numbers(self, cloth: Deformable, name: str, value: ArrayLike) -> None:
        """Set a property by its name, and wake bodies and cloths."""
        first, size = _COLUMNS[name]
        self.tables.array(CLOTH_NUMBERS)[self.row(cloth), first : first + size] = value
        self.tables.altered = True  # the loop of the steps depends on whether it can tear
        if name == "friction":
            forget_pairs(self.tables)
        if name == "tether_strain":
            self._preparation.forget_pins()
        self._bodies.wake()
        self.wake()

    @undivided
    def pin(self, cloth: Deformable, vertices: ArrayLike, body: Body | None) -> None:
        """Pin vertices; see `Cloth.pin`."""
        rows, of = self._rows_of(cloth, vertices), None if body is None else self._bodies.row(body, "body")
        particles = self.tables.array(PARTICLE)
        remove_pins(self.tables, rows)
        particles[rows, c.PARTICLE_INVERSE_MASS] = 0.0
        particles[rows, c.PARTICLE_VELOCITY : c.PARTICLE_VELOCITY + 3] = 0.0
        if of is not None:
            add_pins(self.tables, rows, of)
        self._couple(self.row(cloth))
        self._bodies.wake()
        self.wake()
        self.tables.altered = True

    @undivided
    def unpin(self, cloth: Deformable, vertices: ArrayLike) -> None:
        """Release vertices; see `Cloth.unpin`."""
        self._free(self.row(cloth), self._rows_of(cloth, vertices))

    def wake(self) -> None:
        """Wake all cloths, and reset their time of rest."""
        self.tables.array(CLOTH)[:, c.IS_ASLEEP] = 0
        self.tables.array(CLOTH_NUMBERS)[:, c.REST_TIME] = 0.0

    def release(self, body: int) -> None:
        """Release particles pinned to a body that is removed, and wake cloths, which may have rested on it."""
        self.wake()
        pins = self.tables.array(PIN)
        held = pins[pins[:, c.PINNED_BODY] == body, c.PINNED_PARTICLE]
        for row, (first, last) in enumerate(
            self.tables.array(CLOTH)[:, c.FIRST_PARTICLE : c.LAST_PARTICLE + 1].tolist()
        ):
            own = held[(held >= first) & (held < last)]
            if own.size:
                self._free(row, own)

    def _free(self, row: int, particles: Integers) -> None:
        """Release particles of a cloth, given by their rows."""
        remove_pins(self.tables, particles)
        table = self.tables.array(PARTICLE)
        table[particles, c.PARTICLE_INVERSE_MASS] = 1.0 / table[particles, c.PARTICLE_MASS]
        self._couple(row)
        self._bodies.wake()
        self.wake()
        self.tables.altered = True

    def stiffness(self, cloth: Deformable) -> tuple[float, float, float]:
        """Return the stiffness in use; see `Cloth.stiffness`."""
        row = self.tables.array(CLOTH_NUMBERS)[self.row(cloth)]
        stretch, shear, bending = row[c.STRETCH : c.STRETCH + 3].tolist()
        return stretch, shear, bending

    def notes(self) -> str:
        """Return notes on cloths that are softer or less damped than their fabric, and what would help."""
        rows = enumerate(zip(self.tables.array(CLOTH)[:, c.DIMENSION], self.tables.array(CLOTH_NUMBERS), strict=True))
        return "".join(softness(self.words(row), int(dimension), numbers) for row, (dimension, numbers) in rows)

    def far_softer(self) -> dict[str, str]:
        """Return the notes on cloths that are less than half as stiff as their material, by their words."""
        kinds, numbers = self.tables.array(CLOTH)[:, c.DIMENSION].tolist(), self.tables.array(CLOTH_NUMBERS)
        rows = [row for row in range(len(kinds)) if is_far_softer(numbers[row])]
        return {self.words(row): softness(self.words(row), kinds[row], numbers[row]) for row in rows}

    def _rows_of(self, cloth: Deformable, vertices: ArrayLike) -> Integers:
        """Return the rows of vertices, without repetition; ArgumentError for invalid ones."""
        count, chosen = len(self.particles(cloth)), np.atleast_1d(np.asarray(vertices))
        if chosen.shape == (0,):
            chosen = chosen.astype(np.int64)
        if chosen.dtype.kind == "b":
            raise ArgumentError("vertices is a mask of True and False; give indices: numpy.flatnonzero(mask).")
        if chosen.dtype.kind not in "iu" or chosen.ndim != 1:
            raise ArgumentError(f"vertices={vertices!r} must be whole numbers, indices of vertices of the cloth.")
        wrong = chosen[(chosen < 0) | (chosen >= count)]
        if wrong.size:
            raise ArgumentError(f"vertex {wrong[0]} does not exist; the cloth has the vertices 0 to {count - 1}.")
        return np.unique(chosen).astype(np.int64) + int(self.tables.array(CLOTH)[self.row(cloth), c.FIRST_PARTICLE])


_COLUMNS = {
    "wind": (c.WIND, 3), "friction": (c.CLOTH_FRICTION, 1), "tear_strain": (c.TEAR_STRAIN, 1), "radius": (c.CLOTH_RADIUS, 1),
    "poisson_ratio": (c.POISSON_RATIO, 1), "tether_strain": (c.TETHER_STRAIN, 1),
}  # fmt: skip
_HANDLES: dict[int, type[Deformable]] = {c.ROPE: Rope, c.SHEET: Cloth, c.VOLUME: SoftBody}

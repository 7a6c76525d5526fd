"""Bodies: their rows in the tables of a world, and the checks of their handles."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Literal
from weakref import ReferenceType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.bodies.body_mass import check_mass
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.shape_rows import ShapeRows
from kickdrift.world.collision.broad_phase.search_state import shapes_changed
from kickdrift.world.contacts.body_mass_change import scale_impulses
from kickdrift.world.integration import follow_pose
from kickdrift.world.layout import (
    AWAKE,
    BODY_INERTIA,
    BODY_KIND,
    DAMPING,
    DYNAMIC,
    GENERATION,
    INERTIA_KIND,
    INVERSE_INERTIA,
    INVERSE_LINEAR_MASS,
    ISOTROPIC,
    KINEMATIC,
    LEFT_POSE,
    MASS,
    ORIENTATION,
    PLANAR,
    POSITION,
    REMOVED,
    STATIC,
    TIME_AT_REST,
    TUMBLES,
    TURN_DAMPING,
)
from kickdrift.world.names import Names
from kickdrift.world.settings import PLANE_NORMAL
from kickdrift.world.shapes.mass_properties import Mass, checked_inertia
from kickdrift.world.tables import (
    BODY,
    CLOTH_LOAD,
    COLOURED,
    DELTA_POSE,
    FORCE,
    INERTIA,
    INVERSE_MASS,
    KICKED,
    LOAD,
    MEMBER,
    MEMBERSHIP,
    MOTION,
    NOTED,
    POSE,
    PREDICTED,
    RESTED,
    SETTINGS,
    STARTED_MOTION,
    STARTED_POSE,
    STARTED_ROTATION,
    SWEPT,
    Table,
    Tables,
)
from kickdrift.world.world_lock import alone, undivided

Floats = NDArray[np.float64]
GROUND = 0
_TABLES: tuple[Table, ...] = (
    POSE, MOTION, DELTA_POSE, INVERSE_MASS, INERTIA, LOAD, FORCE, KICKED, NOTED, RESTED, BODY, COLOURED, STARTED_POSE,
    STARTED_MOTION, STARTED_ROTATION, MEMBER, MEMBERSHIP, PREDICTED, SWEPT,
)  # fmt: skip


class Bodies:
    """The rows of bodies in the tables of a world; row 0 is the ground.

    Parameters
    ----------
    tables : Tables
    shape_rows : ShapeRows
        The shapes of the bodies.
    mass_changed : callable
        Called after the mass or inertia of a body has changed, with its row and the ratio of new mass to old, 1 at most.
    """

    def __init__(self, tables: Tables, shape_rows: ShapeRows, mass_changed: Callable[[int, float], None]) -> None:
        self.tables = tables
        self._shape_rows = shape_rows
        self._mass_changed = mass_changed
        self.names = Names("body")
        self.world: ReferenceType[Any] | None = None
        self.free: list[int] = []
        self.n_made = 0  # never decreases, not even on restoring a snapshot: two bodies would share a handle
        self.ground = self.add(STATIC, np.zeros(3), np.array([1.0, 0, 0, 0]))

    def __len__(self) -> int:
        return int((self.tables.array(BODY)[:, BODY_KIND] != REMOVED).sum())

    def __iter__(self) -> Iterator[Body]:
        """Iterate over the handles of all bodies, the ground first."""
        return map(self.handle, np.flatnonzero(self.tables.array(BODY)[:, BODY_KIND] != REMOVED).tolist())

    def add(self, kind: int, position: Floats, orientation: Floats) -> Body:
        """Allocate a row for a body of a kind, at rest and without mass."""
        tables = self.tables
        if self.free:
            row = self.free.pop()
        else:
            row = len(tables.array(POSE))
            for table in _TABLES:
                tables.resize(table, row + 1)
        generation, self.n_made = self.n_made, self.n_made + 1
        for table in _TABLES:
            tables.array(table)[row] = 0
        tables.array(BODY)[row, [BODY_KIND, AWAKE, GENERATION]] = kind, int(kind != STATIC), generation
        tables.array(POSE)[row, POSITION : POSITION + 3] = position
        tables.array(POSE)[row, ORIENTATION : ORIENTATION + 4] = orientation
        return Body(row, generation, self)

    def remove(self, body: Body) -> None:
        """Free the row of a body."""
        row = self.row(body)
        for table in _TABLES:
            self.tables.array(table)[row] = 0
        self.tables.array(CLOTH_LOAD)[row : row + 1] = 0  # a table that is empty until there are cloths
        self.tables.array(POSE)[row] = np.nan
        self.tables.array(BODY)[row, BODY_KIND] = REMOVED
        self.names.give(row, None)
        self.free.append(row)
        self.tables.version += 1

    def row(self, body: Any, argument: str = "body") -> int:
        """Return the row of an existing body.

        Raises
        ------
        ArgumentError
            If it is not a handle, or is one of a removed body or of another world.
        """
        if isinstance(body, Body) and body.bodies is self and self.knows(body.index, body.generation):
            return body.index
        if not isinstance(body, Body):
            raise ArgumentError(
                f"{argument}={body!r} is not a body; give a handle returned by World.add_box or the like."
            )
        if body.bodies is not self:
            raise ArgumentError(
                f"{argument}={body!r} is a body of another world; give one of this world, such as world.body(name) or"
                " world.bodies.handle(row)."
            )
        raise ArgumentError(f"{argument}={body!r} was removed; use an existing body.")

    def knows(self, index: int, generation: int) -> bool:
        """Whether a row holds the body of a generation."""
        if not 0 <= index < self.tables.count(BODY):
            return False
        row = self.tables.row(BODY, index)
        return bool(row.item(GENERATION) == generation and row.item(BODY_KIND) != REMOVED)

    def moved_row(self, body: Any) -> int:
        """Return the row of a body that forces move; ArgumentError for others."""
        row = self.row(body)
        if self.tables.row(BODY, row).item(BODY_KIND) != DYNAMIC:
            raise ArgumentError(f"forces do not move body={body!r}, which is not dynamic; give a dynamic body.")
        return row

    def set_mass(self, row: int, mass: Mass, damping: Sequence[float], locked: bool = False) -> None:
        """Set mass, inertia about the centre of mass in the body's axes, and damping rates, 1/s; a locked one cannot turn."""
        tables = self.tables
        inverse = np.zeros((3, 3)) if locked else np.asarray(np.linalg.inv(mass.inertia), dtype=np.float64)
        moments = np.linalg.eigvalsh(mass.inertia)
        numbers = tables.array(INERTIA)[row]
        numbers[MASS] = mass.mass
        numbers[BODY_INERTIA : BODY_INERTIA + 6] = _six_of(mass.inertia)
        numbers[INVERSE_INERTIA : INVERSE_INERTIA + 6] = _six_of(inverse)
        numbers[[DAMPING, TURN_DAMPING]] = damping
        isotropic = locked or moments[2] - moments[0] < 1e-13 * moments[2]
        planar = tables.array(SETTINGS)[0, PLANE_NORMAL : PLANE_NORMAL + 3].any()
        numbers[INERTIA_KIND] = ISOTROPIC if isotropic else PLANAR if planar else TUMBLES
        # No orientation equals this one, so the angular momentum is recomputed before the next kick.
        tables.array(KICKED)[row, LEFT_POSE : LEFT_POSE + 4] = 0.0
        if tables.array(BODY)[row, BODY_KIND] == DYNAMIC:
            tables.array(INVERSE_MASS)[row, INVERSE_LINEAR_MASS] = 1.0 / mass.mass
            follow_pose(tables.address, row)

    def locked(self, body: Body) -> bool:
        """Whether the rotation of a body is locked: it is dynamic, and its inverse inertia is zero."""
        row = self.row(body)
        dynamic = self.tables.array(BODY)[row, BODY_KIND] == DYNAMIC
        return bool(dynamic and not self.tables.array(INERTIA)[row, INVERSE_INERTIA])

    def mass(self, body: Body) -> Mass:
        """Return mass, and inertia about the centre of mass in the body's axes; infinite for static and kinematic bodies."""
        row = self.row(body)
        if self.tables.array(BODY)[row, BODY_KIND] != DYNAMIC:
            return Mass(np.inf, np.zeros(3), np.diag(np.full(3, np.inf)))
        numbers = self.tables.array(INERTIA)[row]
        xx, yy, zz, xy, xz, yz = numbers[BODY_INERTIA : BODY_INERTIA + 6].tolist()
        return Mass(float(numbers[MASS]), np.zeros(3), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))

    @undivided
    def change_mass(
        self, body: Body, mass: float | None = None, inertia: ArrayLike | None = None, locked: bool | None = None
    ) -> None:
        """Change the mass of a body, which scales its inertia, or its inertia, or lock its rotation; velocities are kept."""
        row = self.moved_row(body)
        if mass is not None:
            check_mass(mass)
        old = self.mass(body)
        locked = self.locked(body) if locked is None else locked
        new = old.inertia * (1.0 if mass is None else mass / old.mass) if inertia is None else checked_inertia(inertia)
        numbers = self.tables.array(INERTIA)[row]
        self.set_mass(
            row, Mass(old.mass if mass is None else mass, old.centre, new), numbers[[DAMPING, TURN_DAMPING]], locked
        )
        lighter = 1.0 if mass is None else min(1.0, mass / old.mass)
        scale_impulses(
            self.tables, row, lighter
        )  # warm starting with those of the old weight would throw a lighter body
        self._mass_changed(row, lighter)
        self.wake()

    @alone
    def place(self, body: Body, columns: slice, numbers: Floats) -> None:
        """Write columns of a pose; for a static body, also have its pairs found again and wake all bodies."""
        row = self.row(body)
        if row == GROUND:
            raise ArgumentError("body is the ground of the world, which cannot move; move another body.")
        self.tables.row(POSE, row)[columns] = numbers
        if self.tables.array(BODY)[row, BODY_KIND] == STATIC:
            shapes_changed(self.tables, self._shape_rows.rows_of(row))
            self.wake()

    @alone
    def move(self, body: Body, columns: slice, numbers: Floats) -> None:
        """Write columns of the velocity and the angular velocity."""
        row = self.row(body)
        if self.tables.array(BODY)[row, BODY_KIND] == STATIC and numbers.any():
            raise ArgumentError(f"body={body!r} is static and has no velocity; add it with kinematic=True to move it.")
        if columns.start == 3 and numbers.any() and self.locked(body):
            raise ArgumentError(
                f"angular_velocity={numbers.tolist()} cannot be set for body={body!r}, whose rotation is locked;"
                " set locked_rotation = False first."
            )
        self.tables.row(MOTION, row)[columns] = numbers

    def surface(self, body: Body, name: Literal["friction", "restitution"]) -> float:
        """Return a surface property that all shapes of a body share.

        Raises
        ------
        ArgumentError
            If they differ, or there are none.
        """
        found = self._shape_rows.surface_numbers(self.row(body), name)
        if len(found) != 1:
            several = f"shapes of {name} {', '.join(map(str, sorted(found)))}; set it to give all of them one value"
            raise ArgumentError(f"body={body!r} has {several if found else f'no shapes, and so no {name}'}.")
        return found.pop()

    @undivided
    def change_surface(self, body: Body, name: Literal["friction", "restitution"], value: float) -> None:
        """Set a property of the surfaces of all shapes of a body, and wake the bodies that rest on it."""
        self._shape_rows.change_surface(self.row(body), name, value)
        self.wake()

    def words(self, row: int) -> str:
        """Return the row of a body and its name, if any, for messages."""
        name = self.names.of(row)
        return f"body {row}" if name is None else f"body {row}, {name!r},"

    def wake(self) -> None:
        """Wake all bodies and reset their times of rest, for changes that may remove their supports."""
        bodies = self.tables.array(BODY)
        sleeping = (bodies[:, BODY_KIND] >= KINEMATIC) & (bodies[:, AWAKE] == 0)
        bodies[sleeping, AWAKE] = 1
        self.tables.array(RESTED)[:, TIME_AT_REST] = 0.0

    def handle(self, row: int) -> Body:
        """Return the handle of a row."""
        return Body(row, int(self.tables.array(BODY)[row, GENERATION]), self)

    def moving(self) -> NDArray[np.intp]:
        """Rows of the bodies that forces move."""
        return np.flatnonzero(self.tables.array(BODY)[:, BODY_KIND] == DYNAMIC)


def _six_of(m: Floats) -> Floats:
    """Return the elements of a symmetric (3, 3) matrix in the order of the tables: xx, yy, zz, xy, xz, yz."""
    return np.array([m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]])

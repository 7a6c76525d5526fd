"""Bodies: rows of tables that come and go, and handles that know when theirs is gone."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.arguments import choice
from kickdrift.world.flight import (
    AWAKE,
    BODY_INERTIA,
    DAMPING,
    DYNAMIC,
    GENERATION,
    INVERSE_INERTIA,
    KIND,
    KINEMATIC,
    MASS,
    REMOVED,
    SPHERICAL,
    STATIC,
    TURN_DAMPING,
)
from kickdrift.world.settings import PLANE
from kickdrift.world.shapes.mass import Mass, rotation_matrix
from kickdrift.world.tables import (
    BODY,
    CHANGE,
    COLOURED,
    FORCE,
    INERTIA,
    KICKED,
    LOAD,
    MOTION,
    POSE,
    RESPONSE,
    RESTED,
    SETTINGS,
    STARTED_MOTION,
    STARTED_POSE,
    Table,
    Tables,
)

Floats = NDArray[np.float64]
GROUND = 0
_TABLES: tuple[Table, ...] = (
    POSE, MOTION, CHANGE, RESPONSE, INERTIA, LOAD, FORCE, KICKED, RESTED, BODY, COLOURED, STARTED_POSE, STARTED_MOTION
)  # fmt: skip


@dataclass(frozen=True)
class Body:
    """A body of a world.

    Attributes
    ----------
    index : int
        Its row in `World.position` and the other arrays.
    generation : int
        Bodies that the world had seen before it; a handle of one that was removed is known by it.
    """

    index: int
    generation: int = 0


class Bodies:
    """The rows of bodies in the tables of a world; row 0 is the ground."""

    def __init__(self, tables: Tables) -> None:
        self._tables = tables
        self.free: list[int] = []
        self.n_made = 0  # never goes back, not even to a snapshot: two bodies would share a handle
        self.ground = self.add(STATIC, np.zeros(3), np.array([1.0, 0, 0, 0]))

    def add(self, kind: int, position: Floats, orientation: Floats) -> Body:
        """Take a row for a body at rest that nothing moves."""
        tables = self._tables
        if self.free:
            row = self.free.pop()
        else:
            row = len(tables.array(POSE))
            for table in _TABLES:
                tables.resize(table, row + 1)
        generation, self.n_made = self.n_made, self.n_made + 1
        for table in _TABLES:
            tables.array(table)[row] = 0
        tables.array(BODY)[row, [KIND, AWAKE, GENERATION]] = kind, int(kind != STATIC), generation
        tables.array(POSE)[row, :3] = position
        tables.array(POSE)[row, 3:7] = orientation
        return Body(row, generation)

    def remove(self, body: Body) -> None:
        """Give the row of a body back."""
        row = self.row(body)
        if row == GROUND:
            raise ArgumentError("body is the ground of the world, which cannot be removed; remove another body.")
        for table in _TABLES:
            self._tables.array(table)[row] = 0
        self._tables.array(POSE)[row] = np.nan
        self._tables.array(BODY)[row, KIND] = REMOVED
        self.free.append(row)

    def row(self, body: Any, argument: str = "body") -> int:
        """Return the row of a body that is there.

        Raises
        ------
        ArgumentError
            If it is no handle, or one of a body that was removed or of another world.
        """
        if not isinstance(body, Body):
            raise ArgumentError(f"{argument}={body!r} is not a body; give what World.add_box and the like returned.")
        kinds = self._tables.array(BODY)
        if not 0 <= body.index < len(kinds):
            raise ArgumentError(f"{argument}={body!r} is not in this world, which has {len(kinds)} rows of bodies.")
        if kinds[body.index, GENERATION] != body.generation or kinds[body.index, KIND] == REMOVED:
            raise ArgumentError(f"{argument}={body!r} was removed, or is of another world; use one that is there.")
        return body.index

    def moved_row(self, body: Any) -> int:
        """Return the row of a body that forces move; ArgumentError for others."""
        row = self.row(body)
        if self._tables.array(BODY)[row, KIND] != DYNAMIC:
            raise ArgumentError(f"body={body!r} is moved by no force: it is the ground, static or kinematic.")
        return row

    def set_mass(self, row: int, mass: Mass, damping: Sequence[float]) -> None:
        """Give a body its mass, and its inertia about the centre of mass in the body's axes."""
        tables = self._tables
        inverse = np.asarray(np.linalg.inv(mass.inertia), dtype=np.float64)
        moments = np.linalg.eigvalsh(mass.inertia)
        numbers = tables.array(INERTIA)[row]
        numbers[MASS] = mass.mass
        numbers[BODY_INERTIA : BODY_INERTIA + 6] = _symmetric(mass.inertia)
        numbers[INVERSE_INERTIA : INVERSE_INERTIA + 6] = _symmetric(inverse)
        numbers[[DAMPING, TURN_DAMPING]] = damping
        numbers[SPHERICAL] = float(moments[2] - moments[0] < 1e-13 * moments[2])
        if tables.array(BODY)[row, KIND] == DYNAMIC:
            turn = rotation_matrix(tables.array(POSE)[row, 3:7])
            response: Floats = turn @ inverse @ turn.T
            plane = tables.array(SETTINGS)[0, PLANE : PLANE + 3]
            if plane.any():
                # About the normal of the plane alone, where nothing tumbles and the inertia stays what it is.
                response = np.outer(plane, plane) / (plane @ turn @ mass.inertia @ turn.T @ plane)
                numbers[SPHERICAL] = 1.0
            tables.array(RESPONSE)[row, 0] = 1.0 / mass.mass
            tables.array(RESPONSE)[row, 1:7] = _symmetric(response)

    def wake(self) -> None:
        """Wake all bodies, as if none had rested: what they rest on may be gone."""
        bodies = self._tables.array(BODY)
        sleeping = (bodies[:, KIND] >= KINEMATIC) & (bodies[:, AWAKE] == 0)
        bodies[sleeping, AWAKE] = 1
        self._tables.array(RESTED)[:, 0] = 0.0

    def handle(self, row: int) -> Body:
        """Return the handle of a row."""
        return Body(row, int(self._tables.array(BODY)[row, GENERATION]))

    def moving(self) -> NDArray[np.intp]:
        """Rows of the bodies that forces move."""
        return np.flatnonzero(self._tables.array(BODY)[:, KIND] == DYNAMIC)


def kind_of(static: bool, kinematic: bool) -> int:
    """Say what kind of body is wanted."""
    static, kinematic = choice("static", static), choice("kinematic", kinematic)
    if static and kinematic:
        raise ArgumentError(
            "static=True and kinematic=True exclude each other: a kinematic body has a velocity; choose one."
        )
    return STATIC if static else KINEMATIC if kinematic else DYNAMIC


def _symmetric(m: Floats) -> Floats:
    return np.array([m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]])

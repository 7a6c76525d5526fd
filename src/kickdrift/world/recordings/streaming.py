"""Rows of a recording that are streamed to disk in chunks."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.zarr_group import Array
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.world.recordings.recording_rows import RecordingRows

if TYPE_CHECKING:
    from kickdrift.world.world import World

Floats = NDArray[np.float64]


class StreamedRecordingRows(RecordingRows):
    """The rows of a recording that are written to a store; the `Recording` holds only the first and the last.

    Parameters
    ----------
    world : World
    store : ZarrStore
    """

    def __init__(self, world: "World", store: ZarrStore) -> None:
        if world.cloths.tearable:
            raise ArgumentError(
                f"a cloth can tear, and then has more vertices than save_to={str(store.path)!r} has room for; record into"
                " memory, or set its tear_strain to 0."
            )
        super().__init__(world, 1)
        self._store, self.saved_to = store, str(store.path)
        self._start: dict[str, Floats] = {}
        self._last: dict[str, Floats] = {}

    def begin(self) -> None:
        """Create the store, empty."""
        about = self.description()
        units = about.units

        def of_bodies(unit: str, last: str = "space") -> Array:
            return Array(("body", last), (self._bodies, 3 + (last == "quaternion")), units[unit])

        vectors = {
            name: Array((f"{name}_component",), (3,), units[name.replace("_", " ")])
            for name in ("momentum", "angular_momentum")
        }
        arrays = {
            "time": Array(unit=units["t"]),
            "x": of_bodies("x"),
            "v": of_bodies("v"),
            "orientation": of_bodies("orientation", "quaternion"),
            "angular_velocity": of_bodies("angular velocity"),
            "particles": Array(("particle", "space"), (self._cloths.size, 3), units["particles"]),
            **{name: Array(unit=units["energy"]) for name in ("energy", "kinetic_energy", "potential_energy")},
            **vectors,
            **{name: Array(unit=units["x"]) for name in ("overlap", "joint_gap")},
            "residual": Array(unit=units["v"]),
        }
        words = {"system": about.system, "method": about.method, "source": about.source, "status": "RUNNING"}
        self._store.create(words, arrays, {**about.coordinates, "quaternion": list("wxyz")})

    def keep(self, t: float) -> None:
        """Add a row with the state of the world, at the time t.

        Raises
        ------
        ArgumentError
            If there are more bodies or particles than at the start.
        """
        if len(self._world.position) > self._bodies or self._cloths.changed:
            raise ArgumentError(
                f"a body or a cloth was added, or a cloth cut, while rows of {self._bodies} bodies are written to"
                f" save_to={self.saved_to!r}; add it before the recording, or record into memory."
            )
        super().keep(t)
        row = self.count - self.first - 1
        self._last = {name: values[row : row + 1].copy() for name, values in self._rows.items()}
        self._start = self._start or self._last

    def drain(self) -> None:
        """Write the rows in memory once they fill a chunk.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        if self.count - self.first >= self._store.chunk:
            self._write({})

    def close(self, outcome: Outcome) -> None:
        """Write the remaining rows and the outcome.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        self._write({"status": outcome.name})

    def remembered(self) -> dict[str, Floats]:
        """Return the first row, and how many rows are in the store."""
        return {**self._start, "stored": np.array([float(self.first)])}

    def fill(self, kept: Mapping[str, Floats], remembered: Mapping[str, Floats]) -> None:
        """Begin with the rows of a checkpoint, which follow those in the store.

        Raises
        ------
        LookupError, ValueError
            If they do not fit this world.
        FileFormatError
            If the store lacks rows before them.
        """
        self.first = int(remembered["stored"][0])
        self._start = {name: remembered[name] for name in self._rows}
        self._store.go_on(self.first)
        rows = len(kept["t"])
        self._rows = {name: np.full((rows + 1, *own.shape[1:]), np.nan) for name, own in self._rows.items()}
        super().fill(kept, remembered)
        self._last = {name: values[rows - 1 : rows].copy() for name, values in kept.items()} if rows else self._start

    def ends(self) -> dict[str, Floats]:
        """Return the first and the last row, or one if they are the same."""
        if self.count == 1:
            return self._start
        return {name: np.concatenate((self._start[name], self._last[name])) for name in self._rows}

    def _write(self, attributes: Mapping[str, str]) -> None:
        """Append the rows in memory to the store, and set its attributes."""
        rows = super().kept()
        (kinetic, potential), (overlap, gap) = rows["energy"].T, rows["constraint error"].T
        values = {
            "time": rows["t"][:, 0],
            **{name: rows[name] for name in ("x", "v", "orientation", "particles", "momentum")},
            "angular_velocity": rows["angular velocity"],
            "angular_momentum": rows["angular momentum"],
            "energy": kinetic + potential,
            "kinetic_energy": kinetic,
            "potential_energy": potential,
            "overlap": overlap,
            "joint_gap": gap,
            "residual": rows["residual"][:, 0],
        }
        self._store.append(values, attributes)
        self.first = self.count

"""The rows of a recording, and the recording of a user's loop."""

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.description import Description
from kickdrift.engine.invariants import Invariants
from kickdrift.world.contact_points import contact_points, deepest_overlap
from kickdrift.world.joint_gaps import widest_gap
from kickdrift.world.recordings.appearance import DrawnCloth, appearance
from kickdrift.world.recordings.recorded_cloths import RecordedCloths
from kickdrift.world.recordings.recording import Recording

if TYPE_CHECKING:
    from kickdrift.world.world import World

Floats = NDArray[np.float64]
_NO_POINTS = np.zeros((0, 3))
_UNITS = {
    "t": "s", "x": "m", "particles": "m", "contact points": "m", "v": "m/s", "orientation": "1", "angular velocity": "rad/s",
    "energy": "J", "momentum": "kg m/s", "angular momentum": "kg m^2/s",
}  # fmt: skip
_OF_BODIES = {"x": 3, "v": 3, "orientation": 4, "angular velocity": 3}
_OF_PARTICLES = {"particles": 3}
_OF_CONTACTS = {"contact points": 3}
_OF_THE_WORLD = {"t": 1, "energy": 2, "constraint error": 2, "residual": 1, "momentum": 3, "angular momentum": 3}


class RecordingRows:
    """The rows of a recording, filled as the world runs; NaN for bodies that are not there yet.

    Parameters
    ----------
    world : World
    room : int
        Expected number of rows; there may be more.
    with_contacts : bool
        Whether to record the points of contacts.

    Attributes
    ----------
    first : int
        Number of rows that are on disk, and no longer in memory.
    count : int
        Number of all rows.
    """

    saved_to = ""

    def __init__(self, world: "World", room: int, with_contacts: bool = False) -> None:
        self._world, self._bodies, self._cloths = world, len(world.position), RecordedCloths(world.cloths)
        self._cloths.take_over()
        self.with_contacts, self._points = with_contacts, 0
        self.count = self.first = 0
        shapes: dict[str, tuple[int, ...]] = {name: (room, size) for name, size in _OF_THE_WORLD.items()}
        shapes |= {name: (room, self._bodies, size) for name, size in _OF_BODIES.items()}
        shapes |= {name: (room, self._cloths.size, size) for name, size in _OF_PARTICLES.items()}
        shapes |= {name: (room, 0, size) for name, size in _OF_CONTACTS.items()}
        self._rows: dict[str, Floats] = {name: np.full(shape, np.nan) for name, shape in shapes.items()}

    def keep(self, t: float) -> None:
        """Add a row with the state of the world, at the time t."""
        world, rows, row = self._world, self._rows, self.count - self.first
        bodies, points = len(world.position), contact_points(world.tables) if self.with_contacts else _NO_POINTS
        self._points = max(self._points, len(points))
        if row == len(rows["t"]) or bodies > self._bodies or self._points > rows["contact points"].shape[1]:
            self._grow(max(bodies, self._bodies))
        if self._cloths.changed:
            self._rearrange(self._cloths.take_over())
        rows["t"][row] = t
        rows["x"][row, :bodies], rows["v"][row, :bodies] = world.position, world.velocity
        rows["orientation"][row, :bodies] = world.orientation
        rows["angular velocity"][row, :bodies] = world.angular_velocity
        self._cloths.put(rows["particles"][row])
        rows["contact points"][row, : len(points)] = points
        energy = world.energy()
        rows["energy"][row] = energy.kinetic, energy.potential
        rows["constraint error"][row] = deepest_overlap(world.tables), widest_gap(world.tables)
        rows["residual"][row] = world.residual
        rows["momentum"][row], rows["angular momentum"][row] = world.momentum(), world.angular_momentum()
        self.count += 1

    def kept(self) -> dict[str, Floats]:
        """Return the rows in memory, for `fill`."""
        kept = {name: values[: self.count - self.first] for name, values in self._rows.items()}
        return kept | {name: kept[name][:, : self._points] for name in _OF_CONTACTS}

    def remembered(self) -> dict[str, Floats]:
        """Return the data that `fill` needs besides the rows in memory."""
        return {}

    def fill(self, kept: Mapping[str, Floats], remembered: Mapping[str, Floats]) -> None:
        """Begin with the rows of a checkpoint.

        Raises
        ------
        LookupError, ValueError
            If they do not fit this world.
        """
        if self._cloths.changed:
            self._rearrange(self._cloths.take_over())
        self._points = int(np.isfinite(kept["contact points"][:, :, 0]).sum(axis=1).max(initial=0))
        self._grow(self._bodies)
        for name, own in self._rows.items():
            values = kept[name][:, : self._points] if name in _OF_CONTACTS else kept[name]
            own[tuple(map(slice, values.shape))] = values
        self.count = self.first + len(kept["t"])

    def begin(self) -> None:
        """Prepare for the first row."""

    def drain(self) -> None:
        """Write the rows in memory to disk once they fill a chunk; here they stay in memory."""

    def close(self, outcome: Outcome) -> None:
        """Write the remaining rows and the outcome to disk; here they stay in memory."""

    def ends(self) -> dict[str, Floats]:
        """Return the rows that the `Recording` holds: here all of them."""
        return self.kept()

    def _grow(self, bodies: int) -> None:
        """Widen the rows to the bodies and points of contacts, and make room for half as many rows again if all are full."""
        before = len(self._rows["t"])
        room = before + (before // 2 + 16 if self.count - self.first == before else 0)
        points = self._rows["contact points"].shape[1]
        points = points if self._points <= points else self._points + self._points // 4
        widths = dict.fromkeys(_OF_BODIES, (bodies,)) | dict.fromkeys(_OF_CONTACTS, (points,))
        for name, old in self._rows.items():
            shape = (room, *widths.get(name, old.shape[1:-1]), old.shape[-1])
            if shape != old.shape:
                self._rows[name] = np.full(shape, np.nan)
                self._rows[name][tuple(map(slice, old.shape))] = old
        self._bodies = bodies

    def _rearrange(self, columns: NDArray[np.int64]) -> None:
        """Let the vertices of cloths take over other columns."""
        taken = columns >= 0
        for name in _OF_PARTICLES:
            old = self._rows[name]
            new = np.full((len(old), len(columns), old.shape[-1]), np.nan)
            new[:, taken] = old[:, columns[taken]]
            self._rows[name] = new

    def description(self) -> Description:
        """Return a description of the recording, for display."""
        return Description(
            system=_words(int(np.count_nonzero(appearance(self._world).kinds)) - 1, self._cloths.drawn),
            method="soft steps",
            kind=Kind.VELOCITY_DEPENDENT.name,
            order=1,
            word=str(self._world.word),
            compensated=False,
            dimensions=("body", "space"),
            coordinates={"body": list(range(self._bodies)), "space": ["x", "y", "z"]},
            units=_UNITS,
        )

    def recording(
        self, outcome: Outcome, message: str, step: float, n_steps: int, n_force_evaluations: int, seconds: float
    ) -> Recording:
        """Return the recording."""
        world, rows = self._world, self.ends()
        (kinetic, potential), (overlap, gap) = rows["energy"].T.copy(), rows["constraint error"].T.copy()
        kept = {"energy": kinetic + potential, **{name: rows[name] for name in ("momentum", "angular momentum")}}
        looks = appearance(world)._replace(cloths=tuple(self._cloths.drawn))
        return Recording(
            t=rows["t"][:, 0],
            x=rows["x"],
            v=rows["v"],
            invariants=Invariants(tuple(kept), kept.__getitem__),
            status=outcome,
            message=message,
            step=step,
            n_steps=n_steps,
            n_force_evaluations=n_force_evaluations,
            wall_time=seconds,
            about=self.description(),
            derived={
                "kinetic energy": kinetic,
                "potential energy": potential,
                "overlap": overlap,
                "joint gap": gap,
                "residual": rows["residual"][:, 0],
            },
            saved_to=self.saved_to,
            orientation=rows["orientation"],
            angular_velocity=rows["angular velocity"],
            particles=rows["particles"],
            contact_points=rows["contact points"],
            appearance=looks,
        )


def _words(bodies: int, cloths: list[DrawnCloth]) -> str:
    """Return how many bodies, cloths, ropes and soft bodies a world has, in words."""
    counts = {"body": bodies, **Counter(cloth.kind for cloth in cloths)}
    words = [f"{count} {kind if count == 1 else _plural(kind)}" for kind, count in counts.items()]
    return f"world of {', '.join(words[:-1])} and {words[-1]}" if len(words) > 1 else f"world of {words[0]}"


def _plural(word: str) -> str:
    return f"{word[:-1]}ies" if word.endswith("y") else f"{word}s"


class Recorder:
    """Records the steps of a user's loop, as the world reports them.

    Parameters
    ----------
    world : World
    save_every : int
        Steps from row to row.
    rows : RecordingRows
    """

    def __init__(self, world: "World", save_every: int, rows: RecordingRows) -> None:
        self._world, self._every, self._rows = world, save_every, rows
        self.n_steps, self._evaluations = 0, 0
        self._step, self._seconds = 0.0, 0.0
        rows.begin()
        rows.keep(world.time)

    @property
    def steps_to_row(self) -> int:
        """Number of steps until the next row is due."""
        return self._every - self.n_steps % self._every

    def note(self, count: int, step: float, time: float, seconds: float) -> None:
        """Note that `count` steps up to a time, s, were done, and the seconds that they took; add a row if one is due."""
        self.n_steps += count
        self._evaluations += count * self._world.substeps
        self._seconds += seconds
        if count:
            self._step = max(self._step, step)
            if self.n_steps % self._every == 0:
                self._rows.keep(time)
                self._rows.drain()

    def recording(self, outcome: Outcome, message: str) -> Recording:
        """Add a row for the last state, if it has none, and return the recording."""
        try:
            if self.n_steps % self._every:
                self._rows.keep(self._world.time)
            self._rows.close(outcome)
        except (ArgumentError, FileFormatError) as error:
            if outcome is Outcome.COMPLETED:
                outcome, message = Outcome.NOT_WRITTEN, f"{Outcome.NOT_WRITTEN.value} {error}"
        return self._rows.recording(outcome, message, self._step, self.n_steps, self._evaluations, self._seconds)

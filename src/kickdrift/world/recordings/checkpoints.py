"""Checkpoints of the runs of a world."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from kickdrift.core.arguments import check_checkpoint_every, choice
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.core.naming import digest
from kickdrift.engine.checkpoints import Checkpoints
from kickdrift.engine.grid import Grid, with_step
from kickdrift.engine.identity import written
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.world.recordings.recording import Recording
from kickdrift.world.recordings.recording_rows import RecordingRows

if TYPE_CHECKING:
    from kickdrift.world.world import World

_WORLD, _ROWS, _REMEMBERED = "world ", "rows ", "remembered "


class Kept(NamedTuple):
    """What is kept of a run, and where: arguments of `World.run`."""

    folder: Any = None
    every: Any = None
    keep: Any = 2
    save_to: Any = None
    contact_points: Any = False

    def check(self) -> None:
        """Refuse invalid `contact_points`.

        Raises
        ------
        ArgumentError
        """
        if choice("contact_points", self.contact_points) and self.save_to is not None:
            raise ArgumentError(
                f"contact_points=True keeps points in memory, as many as there are, and save_to={str(self.save_to)!r} has"
                " no room for them; leave one of the two out."
            )

    def keeper(self, world: "World") -> "Keeper | None":
        """Return the writer of checkpoints of a run that begins now, or None if it has none.

        Raises
        ------
        ArgumentError
            For invalid arguments.
        """
        check_checkpoint_every(self.folder, self.every)
        return None if self.folder is None else Keeper(world, self.folder, self.every, self.keep)

    def store(self, world: "World", grid: Grid) -> ZarrStore | None:
        """Return the store that rows are written to, or None if they stay in memory.

        Raises
        ------
        ArgumentError
            For a folder that cannot be used.
        """
        if self.save_to is None:
            return None
        known = *sorted(_identity_of(world).items()), f"{grid.step:.9g}", grid.every
        store = ZarrStore(self.save_to, digest(known))
        store.check(self.folder is not None)
        return store


NOT_KEPT = Kept()


class Keeper:
    """Writes the checkpoints of a run of a world, and resumes from the newest.

    Parameters
    ----------
    world : World
        In the state in which the run begins.
    folder, every, keep
        `checkpoint`, `checkpoint_every` and `checkpoint_keep` of `World.run`.
    """

    def __init__(self, world: "World", folder: Any, every: Any, keep: Any) -> None:
        self._world, self._checkpoints = world, Checkpoints(folder, every, keep, _identity_of(world))

    def close(self) -> None:
        """Release the folder to other runs."""
        self._checkpoints.close()

    def until(self, done: int, last: int) -> int:
        """Return the step after which the next checkpoint is due."""
        return self._checkpoints.until(done, last)

    def keep(self, done: int, grid: Grid, rows: RecordingRows, seconds: float) -> None:
        """Write a checkpoint after `done` steps, which took `seconds`, with the rows up to there.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        self._checkpoints.pace(done, seconds)
        header, arrays = Recording.presenters.contents(self._world)
        kept = {_WORLD + name: values for name, values in arrays.items()}
        kept |= {_ROWS + name: values for name, values in rows.kept().items()}
        kept |= {_REMEMBERED + name: values for name, values in rows.remembered().items()}
        kept["rows after"] = np.array([step_of_row(grid, row) for row in range(rows.first, rows.count)], dtype=np.int64)
        known = {"h": grid.step, "seconds": seconds, "world": header, **_arguments_of(grid, rows)}
        self._checkpoints.write(done, known, kept)

    def find(self, grid: Grid, rows: RecordingRows) -> tuple[int, Grid, float, str] | None:
        """Restore the world from the newest checkpoint, if there is one, and fill the rows.

        Returns
        -------
        done : int
            Steps done.
        grid : Grid
            With the step of the interrupted run.
        seconds : float
            Time that these steps took.
        said : str
            A note for the message of the recording.

        Raises
        ------
        ArgumentError
            If the checkpoint belongs to another run.
        FileFormatError
            If it is damaged.
        """
        found = self._checkpoints.find(grid)
        if found is None:
            return None
        header, arrays, said = found
        try:
            done, h, seconds = int(header["step"]), float(header["h"]), float(header["seconds"])
            after, kept, remembered = (
                arrays["rows after"],
                _with_prefix(arrays, _ROWS),
                _with_prefix(arrays, _REMEMBERED),
            )
            given = {name: header[name] for name in _arguments_of(grid, rows)}
            snapshot = Recording.presenters.snapshot_of(header["world"], _with_prefix(arrays, _WORLD))
        except (LookupError, TypeError, ValueError) as error:
            raise FileFormatError(
                f"checkpoint={str(self._checkpoints.folder)!r} has invalid contents ({type(error).__name__}: {error});"
                " remove it to start again."
            ) from None
        same = with_step(grid, h)
        if same is None:
            raise self._checkpoints.refuse(f"step ({h!r} there, {grid.step!r} here)")
        for name, value in _arguments_of(same, rows).items():
            if given[name] != value:
                raise self._checkpoints.refuse(name)
        # The last row of a run is not one of a longer run that continues it.
        taken = (after % (same.every or 1) == 0) | (after == same.n_steps)
        self._world.restore(snapshot.with_forces(self._world.forces))
        rows.fill({name: values[taken] for name, values in kept.items()}, remembered)
        return done, same, seconds, said


def _arguments_of(grid: Grid, rows: RecordingRows) -> dict[str, int | bool | None]:
    """Return the arguments that decide what the rows hold, by name."""
    return {"save_every": grid.every, "save_to": grid.streamed, "contact_points": rows.with_contacts}


def step_of_row(grid: Grid, row: int) -> int:
    """Return the number of steps after which a row is recorded."""
    return min(row * (grid.every or 1), grid.n_steps)


def _identity_of(world: "World") -> dict[str, str]:
    """Return digests of everything that determines the run of a world."""
    header, arrays = Recording.presenters.contents(world)
    forces = [force.function for force in world.forces]
    return {"world": digest((written(header), written(arrays))), "forces": digest(written(forces))}


def _with_prefix(arrays: dict[str, Any], kind: str) -> dict[str, Any]:
    """Return the arrays whose names begin with a prefix, without it."""
    return {name.removeprefix(kind): values for name, values in arrays.items() if name.startswith(kind)}

"""Runs of worlds that are kept as they go on, in checkpoints."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.core.naming import digest
from kickdrift.engine.checkpoints import Checkpoints
from kickdrift.engine.grid import Grid, with_step
from kickdrift.engine.identity import written
from kickdrift.world.recorder import RecordingRows
from kickdrift.world.recording import Recording

if TYPE_CHECKING:
    from kickdrift.world.world import World

_WORLD, _ROWS = "world ", "rows "


class Kept(NamedTuple):
    """How a run is to be kept: the arguments of `World.run`."""

    folder: Any = None
    every: Any = None
    keep: Any = 2

    def keeper(self, world: "World") -> "Keeper | None":
        """Make what keeps a run that begins now, if it is to be kept.

        Raises
        ------
        ArgumentError
            For arguments that cannot be.
        """
        if self.folder is not None:
            return Keeper(world, *self)
        if self.every is not None:
            raise ArgumentError(
                f"checkpoint_every={self.every!r} is given without checkpoint, a folder for them; give it."
            )
        return None


NOT_KEPT = Kept()


class Keeper:
    """Keeps a run of a world, and finds where it stands.

    Parameters
    ----------
    world : World
        Where the run begins.
    folder, every, keep
        As of `World.run`.
    """

    def __init__(self, world: "World", folder: Any, every: Any, keep: Any) -> None:
        header, arrays = Recording.presenters.contents(world)
        forces = [force.function for force in world.forces]
        identity = {"world": digest((written(header), written(arrays))), "forces": digest(written(forces))}
        self._world, self._checkpoints = world, Checkpoints(folder, every, keep, identity)

    def close(self) -> None:
        """Let other runs have the folder."""
        self._checkpoints.close()

    def until(self, done: int, last: int) -> int:
        """Return the step after which the next checkpoint is due."""
        return self._checkpoints.until(done, last)

    def keep(self, done: int, grid: Grid, rows: RecordingRows, seconds: float) -> None:
        """Write a checkpoint after so many steps, which took so long, with the rows up to there.

        Raises
        ------
        FileFormatError
            If it cannot be written.
        """
        self._checkpoints.pace(done, seconds)
        header, arrays = Recording.presenters.contents(self._world)
        kept = {_WORLD + name: values for name, values in arrays.items()}
        kept |= {_ROWS + name: values for name, values in rows.kept().items()}
        kept["rows after"] = grid.save_steps[: rows.count]
        self._checkpoints.write(done, {"h": grid.step, "seconds": seconds, "world": header}, kept)

    def find(self, grid: Grid, rows: RecordingRows) -> tuple[int, Grid, float, str] | None:
        """Bring the world to the newest checkpoint, if there is one, and fill the rows.

        Returns
        -------
        done : int
            Steps done.
        grid : Grid
            With the step of the first part.
        seconds : float
            That they took.
        said : str
            What is to be said of it.

        Raises
        ------
        ArgumentError
            If the checkpoint is one of another run.
        FileFormatError
            If it is damaged.
        """
        found = self._checkpoints.find(grid.n_steps)
        if found is None:
            return None
        header, arrays, said = found
        try:
            done, h, seconds = int(header["step"]), float(header["h"]), float(header["seconds"])
            after, kept = arrays["rows after"], _part(arrays, _ROWS)
            snapshot = Recording.presenters.snapshot_of(header["world"], _part(arrays, _WORLD))
        except (LookupError, TypeError, ValueError) as error:
            raise FileFormatError(
                f"checkpoint={str(self._checkpoints.folder)!r} does not hold what it should ({type(error).__name__}: {error});"
                " remove it to begin anew."
            ) from None
        same = with_step(grid, h)
        if same is None:
            raise self._checkpoints.refuse(f"step ({h!r} there, {grid.step!r} here)")
        wanted = same.save_steps if done == same.n_steps else same.rows_after(done)
        taken = np.isin(after, wanted)
        if not np.array_equal(after[taken], wanted):
            raise self._checkpoints.refuse("save_every")
        rows.fill({name: values[taken] for name, values in kept.items()})
        self._world.restore(snapshot.with_forces(self._world.forces))
        return done, same, seconds, said


def _part(arrays: dict[str, Any], kind: str) -> dict[str, Any]:
    return {name.removeprefix(kind): values for name, values in arrays.items() if name.startswith(kind)}

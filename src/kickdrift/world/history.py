"""How worlds are recorded, shown, kept and restored."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, cast

from kickdrift.world.keeping import Kept
from kickdrift.world.recording import Recording
from kickdrift.world.running import record, run
from kickdrift.world.snapshot import Snapshot, restore, take
from kickdrift.world.tables import Tables
from kickdrift.world.undivided import alone, undivided

if TYPE_CHECKING:
    from kickdrift.viewer.live import LivePage
    from kickdrift.world.world import World


class KeepsHistory:
    """The methods of a world that record, show, keep and restore it."""

    tables: Tables

    def run(
        self,
        duration: float,
        step: float,
        save_every: int | None = None,
        progress: bool | None = None,
        *,
        checkpoint: str | Path | None = None,
        checkpoint_every: int | None = None,
        checkpoint_keep: int | None = 2,
        save_to: str | Path | None = None,
    ) -> Recording:
        """Run for a while, and record it.

        Parameters
        ----------
        duration : float
            s.
        step : float
            The largest step allowed, s: a whole number of equal steps covers the duration.
        save_every : int, optional
            Keep every n-th step, for n = `save_every`, and the last; every step by default.
        progress : bool, optional
            Show a bar and say when something is compiled; by default on a terminal, for runs of more than two seconds.
        checkpoint : path, optional
            A folder for checkpoints, made where it is missing. The same call of a world that was built in the same way goes on
            from the newest one, with the bits of a run that was never broken; for a longer or shorter duration, too.
            Functions of `add_force` may remember nothing.
        checkpoint_every : int, optional
            Steps from one checkpoint to the next; by default they are about a minute apart. Each holds the rows so far.
        checkpoint_keep : int, optional
            How many of the last to keep, None for all.
        save_to : path, optional
            A folder, such as ``"pile.zarr"``, to which the rows go while the world runs, in place of memory, as those of
            `kickdrift.solve` do; with overlaps, gaps of joints and what the solver left unsolved.

        Returns
        -------
        Recording
            Its `status` and `message` say how the run ended. An interruption (Ctrl-C) and a body that is lost to
            infinity end it early; what was done is kept.

        Raises
        ------
        ArgumentError
            For a duration, step or save_every that cannot be, and for checkpoints of another run or version.
        FileFormatError
            If all checkpoints are damaged.
        """
        kept = Kept(checkpoint, checkpoint_every, checkpoint_keep, save_to)
        return run(self._world, duration, step, save_every, progress, kept)

    def record(self, save_every: int = 1, *, save_to: str | Path | None = None) -> AbstractContextManager[Recording]:
        """Record the steps of a loop of one's own.

        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> with world.record(save_every=2) as recording:
        ...     for _ in range(100):
        ...         world.apply_force(ball, (0, 0, 9.81))
        ...         world.step(1 / 60)
        >>> recording.x.shape
        (51, 2, 3)

        Parameters
        ----------
        save_every : int
            Keep the state at the beginning, after every n-th step, for n = `save_every`, and after the last one.
        save_to : path, optional
            A folder to which the rows go in place of memory, as those of `run`. All bodies must be there at the start.

        Returns
        -------
        context manager
            Of what becomes a `Recording`, as `run` returns, once the block has ended, be it by an error: its `status` says
            how. Its `step` is the largest one. The rows of bodies that were added on the way are NaN before.

        Raises
        ------
        ArgumentError
            For a `save_every` or a `save_to` that cannot be, and for a world that is being recorded already; in the block, for
            `restore`, and for bodies that are added where rows go to disk.
        FileFormatError
            In the block, if rows cannot be written.
        """
        return record(self._world, save_every, save_to)

    def view(self, step: float, *, port: int = 8080) -> LivePage:
        """Show the world on a page of the browser, where it plays, pauses, steps, resets, and is pulled with the mouse.

        In a script: ``world.view(1 / 60).wait()``.

        Parameters
        ----------
        step : float
            s. A thread of their own does the steps from when the page is first opened, in real time where they are fast enough.
        port : int
            Of this machine, for itself alone; 0 takes any that is free.

        Returns
        -------
        LivePage
            Its `wait` returns after Ctrl-C; `close`, and the end of a ``with`` block, end the page, as the end of Python does.

        Raises
        ------
        ArgumentError
            For a step that is not positive and finite, and for a port that is taken.
        KickdriftError
            If there is nothing to be seen.
        MissingExtraError
            If viser is not installed.
        """
        return cast("LivePage", Recording.presenters.view(self._world, step, port=port))

    @alone
    def snapshot(self) -> Snapshot:
        """Return the world as it is now, for `restore`: it does not change with the world."""
        return take(self._world)

    @undivided
    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot, as often as one likes; the steps after it give the same bits.

        Handles of bodies and joints that were there are good again, and those of later ones are not.

        Parameters
        ----------
        snapshot : Snapshot
            Of this world, or of another one, which this one then continues.

        Raises
        ------
        ArgumentError
            If it is no snapshot, and while the world is being recorded: a recording does not go back.
        """
        restore(self._world, snapshot)

    def save(self, path: str | Path) -> Path:
        """Write everything that the next steps depend on to a file for `kickdrift.load_world`; returns its path.

        Raises
        ------
        FileFormatError
            If the file cannot be written.
        """
        return Recording.presenters.save_world(self, path)

    @property
    def _world(self) -> World:
        return cast("World", self)

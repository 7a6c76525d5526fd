"""Recording, viewing, saving and restoring a world."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, cast

from kickdrift.world.recordings.checkpoints import Kept
from kickdrift.world.recordings.recorded_run import record, run
from kickdrift.world.recordings.recording import Recording
from kickdrift.world.recordings.viewer_hooks import Page
from kickdrift.world.snapshot import Snapshot, restore, take
from kickdrift.world.tables import Tables
from kickdrift.world.world_lock import alone, undivided

if TYPE_CHECKING:
    from kickdrift.world.world import World


class KeepsHistory:
    """The methods of a world that record, show, save and restore it."""

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
        contact_points: bool = False,
    ) -> Recording:
        """Run the world for a duration, and record it.

        Parameters
        ----------
        duration : float
            s.
        step : float
            The largest step allowed, s: a whole number of equal steps covers the duration.
        save_every : int, optional
            Record every n-th step, for n = `save_every`, and the last; every step by default.
        progress : bool, optional
            Whether to show a progress bar and announce compilation; by default on a terminal, for runs of more than two
            seconds.
        checkpoint : path, optional
            A folder for checkpoints, created if missing. The same call for a world that was built in the same way resumes
            from the newest one, bit-identically to an uninterrupted run; also for a longer or shorter duration. Functions of
            `add_force` must not keep state.
        checkpoint_every : int, optional
            Steps from one checkpoint to the next; by default they are about a minute apart. Each holds the rows so far.
        checkpoint_keep : int, optional
            How many of the newest to keep; None keeps all.
        save_to : path, optional
            A folder, such as ``"pile.zarr"``, to which the rows are written during the run, instead of memory, as by
            `kickdrift.solve`; with overlaps, joint gaps and residuals.
        contact_points : bool
            Whether to record the points at which bodies press on each other, too, which pages of the recording then show; not
            possible with `save_to`.

        Returns
        -------
        Recording
            Its `status` and `message` tell how the run ended. Ctrl-C and a body that is lost to infinity end it early; the
            states up to there are recorded.

        Raises
        ------
        ArgumentError
            For an invalid duration, step or save_every, and for checkpoints of another run or version.
        FileFormatError
            If all checkpoints are damaged.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> recording = world.run(duration=1.0, step=1 / 60, save_every=2)
        >>> recording.x.shape
        (31, 2, 3)
        """
        kept = Kept(checkpoint, checkpoint_every, checkpoint_keep, save_to, contact_points)
        return run(self._world, duration, step, save_every, progress, kept)

    def record(
        self, save_every: int = 1, *, save_to: str | Path | None = None, contact_points: bool = False
    ) -> AbstractContextManager[Recording]:
        """Record the steps of a loop of your own, in a ``with`` block.

        Parameters
        ----------
        save_every : int
            Record the state at the start, after every n-th step, for n = `save_every`, and after the last one.
        save_to : path, optional
            A folder to which the rows are written instead of memory, as by `run`. All bodies must exist at the start.
        contact_points : bool
            Whether to record the points at which bodies press on each other, as by `run`.

        Returns
        -------
        context manager
            Its target is a `Recording`, as `run` returns, complete once the block has ended, even by an error: its `status`
            tells how it ended, and its `step` is the largest of the steps. Rows of bodies added later are NaN until then.

        Raises
        ------
        ArgumentError
            For an invalid `save_every` or `save_to`, and for a world that is already being recorded; in the block, for
            `restore`, and for bodies that are added while rows go to disk.
        FileFormatError
            In the block, if rows cannot be written.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> with world.record(save_every=2) as recording:
        ...     for _ in range(100):
        ...         world.apply_force(ball, (0, 0, 9.81))
        ...         world.step(1 / 60)
        >>> recording.x.shape
        (51, 2, 3)
        """
        return record(self._world, save_every, Kept(save_to=save_to, contact_points=contact_points))

    def view(self, step: float, *, control: Callable[[], object] | None = None, port: int = 8080) -> Page:
        """Show the world on a page in the browser, with controls to play, pause, step and reset it and to pull bodies.

        In a script: ``world.view(1 / 60).wait()``.

        Parameters
        ----------
        step : float
            s. A background thread does the steps, once the page is first opened, in real time if they are fast enough.
        control : callable, optional
            Called without arguments before each step: a robot's controller, which applies efforts and sets drives.
        port : int
            Port on this machine, accessible only from it; 0 chooses a free one.

        Returns
        -------
        Page
            A `kickdrift.viewer.live.LivePage`: its `wait` returns after Ctrl-C; `close`, the end of a ``with`` block, and the
            end of Python close the page.

        Raises
        ------
        ArgumentError
            For a step that is not positive and finite, a control that cannot be called, and a port that is in use.
        KickdriftError
            If there is nothing to show.
        MissingExtraError
            If viser is not installed.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> with world.view(1 / 60, port=0) as page:
        ...     pass  # in a script of your own: page.wait()
        open http://127.0.0.1:...
        """
        return Recording.presenters.view(self._world, step, control=control, port=port)

    def __repr__(self) -> str:
        world = self._world
        bodies, joints = len(world.bodies.moving()), len(world.joints)
        numbers = f"{bodies} moving {'body' if bodies == 1 else 'bodies'}, {joints} joint{'s' * (joints != 1)}"
        return f"<World at t={world.time:g} s: {numbers}>"

    def _repr_html_(self) -> str:
        """Return the HTML that a notebook shows: a summary of the world, and a picture of its present state."""
        return Recording.presenters.world_html(self._world)

    @alone
    def snapshot(self) -> Snapshot:
        """Return a copy of the state of the world, for `restore`.

        Returns
        -------
        Snapshot

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> before = world.snapshot()
        >>> world.advance(1 / 60, 60)
        >>> world.restore(before)
        >>> world.time, ball.position
        (0.0, array([0., 0., 0.]))
        """
        return take(self._world)

    @undivided
    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot, any number of times; the steps after it are bit-identical.

        Handles of bodies and joints that existed then are valid again; those of later ones are not.

        Parameters
        ----------
        snapshot : Snapshot
            Of this world, or of another one, whose state this one then takes over.

        Raises
        ------
        ArgumentError
            If it is not a snapshot, and while the world is being recorded, since time cannot go back in a recording.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> before = world.snapshot()
        >>> world.advance(1 / 60, 60)
        >>> world.restore(before)
        >>> world.time
        0.0
        """
        restore(self._world, snapshot)

    def save(self, path: str | Path) -> Path:
        """Write everything that the next steps depend on to a file for `kickdrift.load_world`.

        Parameters
        ----------
        path : path
            A suffix ``.npz`` is added if it is missing.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        FileFormatError
            If the file cannot be written.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> path = world.save("world.npz")
        >>> kd.load_world(path).position.shape
        (2, 3)
        """
        return Recording.presenters.save_world(self, path)

    @property
    def _world(self) -> World:
        return cast("World", self)

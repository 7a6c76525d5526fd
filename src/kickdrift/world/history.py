"""How worlds are recorded, kept and restored."""

from pathlib import Path
from typing import TYPE_CHECKING, cast

from kickdrift.world.recording import Recording
from kickdrift.world.running import run as record
from kickdrift.world.snapshot import Snapshot, restore, take

if TYPE_CHECKING:
    from kickdrift.world.world import World


class KeepsHistory:
    """The methods of a world that record, keep and restore it."""

    def run(
        self, duration: float, step: float, save_every: int | None = None, progress: bool | None = None
    ) -> Recording:
        """Run for a while, and record it.

        Parameters
        ----------
        duration : float
            s.
        step : float
            The largest step allowed, s: a whole number of equal steps covers the duration.
        save_every : int, optional
            Keep every so manieth step, and the last; every step by default.
        progress : bool, optional
            Show a bar and say when something is compiled; by default on a terminal, for runs of more than two seconds.

        Returns
        -------
        Recording
            Its `status` and `message` say how the run ended. An interruption (Ctrl-C) and a body that is lost to
            infinity end it early; what was done is kept.

        Raises
        ------
        ArgumentError
            For a duration, step or save_every that cannot be.
        """
        return record(self._world, duration, step, save_every, progress)

    def snapshot(self) -> Snapshot:
        """Return the world as it is now, for `restore`: it does not change with the world."""
        return take(self._world)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot, as often as one likes; the steps after it give the same bits.

        Handles of bodies and joints that were there are good again, and those of later ones are not.

        Parameters
        ----------
        snapshot : Snapshot
            Of this world, or of another one, which this one then continues.
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
    def _world(self) -> "World":
        return cast("World", self)

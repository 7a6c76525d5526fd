"""Checkpoints on disk: a folder of files of plain arrays, from which a run resumes with the bits of an uninterrupted one.

A file is written under a temporary name and then renamed, and older files are removed after that: whenever the process is
killed, one of them is complete. A second one is kept in case the machine crashes and the newest is truncated.
"""

import os
import re
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, Self

from kickdrift.core import archive
from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.core.locking import FileLock, LockedError
from kickdrift.engine.grid import Grid, with_step
from kickdrift.engine.identity import version

_SECONDS = 60.0  # between checkpoints, if the number of steps is not given
_FIRST = 1000  # steps to the first one there
_NAME = re.compile(r"step-(\d{15})\.npz")


class Found(NamedTuple):
    """A checkpoint that was read: its header, its arrays, and a sentence for the message of the solution."""

    header: dict[str, Any]
    arrays: dict[str, Any]
    said: str


class Checkpoints:
    """The checkpoints of a run, locked against other runs until they are closed.

    Parameters
    ----------
    folder : path
        Created if it is missing.
    every : int, optional
        Steps from one to the next; by default as many as take a minute.
    keep : int, optional
        Number of the last ones to keep, None for all.
    identity : mapping of str to str
        Descriptions of everything that determines the run, by argument.

    Raises
    ------
    ArgumentError
        For invalid arguments, a folder that cannot be created, and one in use by another run.
    """

    def __init__(self, folder: Any, every: Any, keep: Any, identity: Mapping[str, str]) -> None:
        for name, value in (("checkpoint_every", every), ("checkpoint_keep", keep)):
            if value is not None and not is_whole(value, 1):
                raise ArgumentError(f"{name}={value!r} must be a whole number of at least 1.")
        if not isinstance(folder, str | os.PathLike) or not str(folder) or "\0" in str(folder):
            raise ArgumentError(f"checkpoint={folder!r} is not a path; give a folder, such as 'run.checkpoints'.")
        self.folder, self._every, self._keep, self._identity = Path(folder), every, keep, dict(identity)
        self._pace, self._newest = _FIRST, -1
        try:
            self.folder.mkdir(exist_ok=True)
            self._lock = FileLock(self.folder / ".lock")
            for partial in self.folder.glob(".step-*.partial.npz"):  # of a process that was killed
                partial.unlink(missing_ok=True)
        except OSError as error:
            raise ArgumentError(
                f"checkpoint={str(folder)!r} cannot be used as the folder for checkpoints: {error.strerror}; name"
                " another one, in an existing folder."
            ) from None
        except LockedError as holder:
            raise ArgumentError(
                f"checkpoint={str(folder)!r} is in use by a run of {holder}; wait until that run has ended, or name"
                " another folder."
            ) from None

    def close(self) -> None:
        """Release the folder to other runs."""
        self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def until(self, step: int, last: int) -> int:
        """Return the step after which the next checkpoint is due."""
        if self._every is None:
            return min(last, max(step + 1, max(self._newest, 0) + self._pace))
        return min(last, int((step // self._every + 1) * self._every))

    def pace(self, steps: int, seconds: float) -> None:
        """Estimate the steps between checkpoints from the time, s, that some steps took."""
        self._pace = max(1, min(10 * max(steps, _FIRST), int(steps * _SECONDS / max(seconds, 1e-9))))

    def write(self, step: int, header: Mapping[str, Any], arrays: archive.Arrays) -> None:
        """Write a checkpoint, unless the run resumed from it, and remove those beyond the number to keep.

        Raises
        ------
        FileFormatError
            If it cannot be written; those before it are unchanged.
        """
        if step == self._newest:
            return
        named = {"format": archive.CHECKPOINT, "version": version(), "identity": self._identity, "step": step}
        archive.write(self.folder / f"step-{step:015d}.npz", {**named, **header}, arrays, compressed=False)
        self._newest = step
        if self._keep is not None:
            before = [kept for kept in self._steps() if kept <= step]  # those beyond are of a run to a later end
            for older in before[self._keep :]:
                with suppress(OSError):
                    self._file(older).unlink()

    def find(self, grid: Grid | None = None) -> Found | None:
        """Read the newest intact checkpoint, up to the last step of a grid if given; None if there is none.

        Raises
        ------
        ArgumentError
            If it belongs to another run, or another version.
        FileFormatError
            If all are damaged.
        """
        damaged: list[str] = []
        steps = self._steps()
        usable = [step for step in steps if grid is None or step <= grid.n_steps]
        for step in usable or steps:
            try:
                found = archive.read(self._file(step), "a checkpoint", "kickdrift", _assemble)
            except FileFormatError as error:
                damaged.append(str(error))
                continue
            header, arrays = found
            self._check(header)
            if grid is not None and not usable:  # all are of runs to later ends
                if with_step(grid, header["h"]) is None:
                    raise self.refuse("step")
                return None
            self._newest = step
            said = f" It resumed from step {step}, stored in {str(self.folder)!r}."
            return Found(
                header, arrays, said + "".join(f" A newer checkpoint is damaged: {words}" for words in damaged)
            )
        if damaged:
            raise FileFormatError(
                f"checkpoint={str(self.folder)!r} has no intact checkpoint: {' '.join(damaged)} Remove the folder to"
                " start again."
            )
        return None

    def refuse(self, argument: str) -> ArgumentError:
        """Return the error for a folder of a run with another value of an argument."""
        return ArgumentError(
            f"checkpoint={str(self.folder)!r} belongs to another run, with another {argument}; name another folder, or"
            " remove this one to start again."
        )

    def _check(self, header: Mapping[str, Any]) -> None:
        if header["version"] != version():
            raise ArgumentError(
                f"checkpoint={str(self.folder)!r} was written by {header['version']}, and this is {version()}, which"
                " may yield other bits; resume with that version, or name another folder."
            )
        others = [name for name, words in self._identity.items() if header["identity"].get(name) != words]
        if header["identity"].keys() - self._identity.keys() or len(others) == len(self._identity):
            others = ["problem"]
        if others:
            raise self.refuse(" and ".join(others))

    def _steps(self) -> list[int]:
        """Return the steps that have checkpoints, the newest first."""
        found = (_NAME.fullmatch(path.name) for path in self.folder.iterdir())
        return sorted((int(match[1]) for match in found if match), reverse=True)

    def _file(self, step: int) -> Path:
        return self.folder / f"step-{step:015d}.npz"


def _assemble(header: dict[str, Any], arrays: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    if not str(header["format"]).startswith("kickdrift checkpoint "):
        raise KeyError("format")
    if not isinstance(header["version"], str) or not isinstance(header["identity"], dict):
        raise TypeError("version and identity")
    return header, arrays

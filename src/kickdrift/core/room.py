"""Checks of the memory available: rows that would not fit are refused before the run."""

import math
import os
from contextlib import suppress
from pathlib import Path

from kickdrift.core.errors import ArgumentError

_UNASKED = 2 << 30  # bytes that rows may take if `save_every` is not given
_PART = 0.8  # of the free memory
_LITTLE = 1 << 20  # bytes below which the free memory is not looked up: that takes a third of the time of ten steps


def check_kept(save_every: int | None, n_steps: int, row: int, remedy: str = "") -> None:
    """Refuse to keep more rows than fit into memory.

    Parameters
    ----------
    save_every : int, optional
        Steps from row to row, or None for all steps if they are not too many.
    n_steps : int
    row : int
        Bytes of a row.
    remedy : str
        What else could be given instead, for the message.

    Raises
    ------
    ArgumentError
    """
    rows = n_steps // (1 if save_every is None else save_every) + 2
    if rows * row <= _LITTLE:
        return
    most = _PART * free_bytes()
    if save_every is None:
        most = min(most, _UNASKED)
    if rows * row > most:
        kept = f"all {n_steps + 1}" if save_every in (None, 1) else f"{rows} of {n_steps + 1}"
        raise ArgumentError(
            f"save_every={save_every!r} keeps {kept} steps, {rows * row / 2**30:.3g} GiB, and there is room for"
            f" {most / 2**30:.3g} GiB; give save_every={math.ceil((n_steps + 2) * row / most) + 1} or more{remedy}."
        )


def free_bytes() -> float:
    """Return the memory that this process may still allocate, bytes; infinity if the system does not report it."""
    free = math.inf
    with suppress(OSError, ValueError, LookupError):
        lines = Path("/proc/meminfo").read_text().splitlines()
        free = 1024 * int(next(line for line in lines if line.startswith("MemAvailable:")).split()[1])
    with suppress(OSError, ValueError):  # of a container; "max" is not a number
        group = Path("/sys/fs/cgroup")
        free = min(free, int((group / "memory.max").read_text()) - int((group / "memory.current").read_text()))
    if free == math.inf and hasattr(os, "sysconf"):
        with suppress(OSError, ValueError):
            free = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return max(free, 0.0)

"""Numba's thread pool: started where it is needed, and never used in a forked process.

A fork does not copy threads. GNU's OpenMP kills a forked process that uses its pool, so that a pool of processes would wait for
ever for workers that it restarts again and again.
"""

import os

from numba.np.ufunc.parallel import _launch_threads

_launched_by: list[int] = []  # the process, once there is a pool


def launch() -> None:
    """Start the pool for code loaded from the cache on disk, which expects it to be running."""
    if not _launched_by:
        _launch_threads()
        _launched_by.append(os.getpid())


def present() -> bool:
    """Whether this process has the pool, rather than one that it was forked from."""
    return _launched_by == [os.getpid()]

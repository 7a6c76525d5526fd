"""Numba's pool of threads: started where it is needed, and not asked for in a process that was forked.

A fork takes no threads along. The pools of GNU's OpenMP end a forked process that asks for them, so that a pool of processes
waits for ever for the workers that it starts again and again.
"""

import os

from numba.np.ufunc.parallel import _launch_threads

_launched_by: list[int] = []  # the process, once there is a pool


def launch() -> None:
    """Start the pool, for code from the cache on disk, which looks for it and does not start it."""
    if not _launched_by:
        _launch_threads()
        _launched_by.append(os.getpid())


def present() -> bool:
    """Whether this process has the pool, and not one that it was forked from."""
    return _launched_by == [os.getpid()]

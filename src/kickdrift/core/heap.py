"""Memory of large temporary arrays: kept by the process, which needs as much again in the next step."""

import ctypes
import os
from functools import cache

# Of glibc's malloc.h.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
_KEPT = 64 << 20  # bytes of free memory that stay with the process
_LARGEST = 32 << 20  # bytes of an array that is taken from them; more is not allowed


@cache
def keep_freed_memory() -> None:
    """Make the C library reuse freed memory for arrays of up to 32 MB, where it has such a setting.

    glibc gives the memory of large arrays back to the system as soon as they are freed. A force that makes a few in each
    step waits for new pages of them in each step: Lennard-Jones by broadcasting on 125 atoms takes 0.8 to 1.4 ms, as in
    NumPy, instead of 0.15 to 0.18. Where the environment says what glibc is to do, that holds.
    """
    if any(name.startswith("MALLOC_") or name == "GLIBC_TUNABLES" for name in os.environ):
        return
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):  # another C library
        return
    mallopt(_MMAP_THRESHOLD, _LARGEST)
    mallopt(_TRIM_THRESHOLD, _KEPT)

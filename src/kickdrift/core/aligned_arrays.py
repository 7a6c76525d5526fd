"""Arrays whose rows begin at cache lines, on huge pages where they are large."""

import mmap
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

_HUGE_PAGES = getattr(mmap, "MADV_HUGEPAGE", None)  # Linux
_HUGE_PAGE, _LARGE = 1 << 21, 1 << 19  # size of such a page, and of the smallest array that is placed there, bytes


def aligned_zeros(count: int, width: int, dtype: Any) -> NDArray[Any]:
    """Return zeros of eight bytes, (count, width), aligned to a cache line; many of them lie on huge pages, if there are any.

    Rows of worlds are read in random order: with 10,000 bodies, which span thousands of normal pages, a step takes a tenth
    longer without them.
    """
    size = count * width
    if _HUGE_PAGES is not None and 8 * size >= _LARGE:
        buffer = np.frombuffer(_huge_pages(8 * size + _HUGE_PAGE, _HUGE_PAGES), dtype=dtype)
        start = (-buffer.ctypes.data % _HUGE_PAGE) // 8
    else:
        buffer = np.zeros(size + 8, dtype=dtype)
        start = (-buffer.ctypes.data % 64) // 8
    return buffer[start : start + size].reshape(count, width)


def _huge_pages(size: int, advice: int) -> mmap.mmap:
    """Return zeroed memory of a number of bytes, which lives for as long as the arrays in it."""
    pages = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    with suppress(OSError):  # on systems without huge pages
        pages.madvise(advice)
    return pages

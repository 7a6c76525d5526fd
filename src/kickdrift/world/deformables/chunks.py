"""Loops over rows of a cloth in chunks: one after the other, or in parallel on Numba's threads, with the same bits.

The chunks of a loop write to different rows, so that their order does not matter. Both kinds of loop call the function of a
chunk by its address: if it were compiled into each of them, its sums might be reordered differently.
"""

from numba import prange, types

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.world.contacts.layout import THREADED_LOOP
from kickdrift.world.tables import KERNEL_ADDRESSES, integers

Numbers = tuple[float, float, float, float, float]

# ``function(world, cloth, begin, end, numbers)`` does the rows from `begin` to `end` - 1 of a cloth.
CHUNK = types.none(types.intp, types.intp, types.intp, types.intp, types.UniTuple(types.float64, 5))
LOOP = types.none(types.intp, types.intp, *CHUNK.args)
_call_chunk, _call_loop = caller(CHUNK), caller(LOOP)

_FEWEST = 8  # chunks, of 1 to 4 us, from which on a parallel region, of some 3 us on two cores, pays off


@compiled(inline=True)
def for_chunks(world: int, column: int, size: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Do the rows from `first` to `last` - 1 in chunks of a size, by the function in a column of `KERNEL_ADDRESSES`."""
    kernels = integers(world, KERNEL_ADDRESSES)
    function, threaded = kernels[0, column], kernels[0, THREADED_LOOP]
    if threaded != 0 and last - first > (_FEWEST - 1) * size:
        _call_loop(threaded, (function, size, world, cloth, first, last, numbers))
    else:
        for begin in range(first, last, size):
            _call_chunk(function, (world, cloth, begin, min(begin + size, last), numbers))


@compiled(parallel=True)
def run_threaded(function: int, size: int, world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Do all chunks in parallel."""
    for k in prange((last - first + size - 1) // size):
        begin = first + k * size
        _call_chunk(function, (world, cloth, begin, min(begin + size, last), numbers))

"""Loops over the rows of a cloth in chunks: one after the other, or in parallel on Numba's threads, with the same bits.

The chunks of a loop write to different rows, so that their order does not matter. A world without threads has no addresses of
the parallel loops, which are then not compiled.
"""

from collections.abc import Callable
from typing import NamedTuple

from numba import prange, types

from kickdrift.core.calls import caller
from kickdrift.core.compilation import Function, compiled, specialise, unbound
from kickdrift.world.tables import KERNEL_ADDRESSES, integers

Numbers = tuple[float, ...]

_FEWEST = 8  # chunks, of 1 to 3 us, from which on a parallel region, of some 3 us on two cores, pays off

chunk: Callable[..., None] = unbound
call: Callable[..., None] = unbound
SIZE, COLUMN = 1, 0


class Loop(NamedTuple):
    """A loop over chunks, ``run(world, cloth, first, last, numbers)`` for the rows from `first` to `last` - 1.

    Attributes
    ----------
    run : function
        The loop, which calls `threaded` by its address where the world has threads.
    threaded : function
        The parallel loop.
    signature : numba.core.typing.templates.Signature
        Of the latter.
    column : int
        Of `KERNEL_ADDRESSES`, for its address.
    """

    run: Function
    threaded: Function
    signature: object
    column: int


def chunked(function: Function, name: str, column: int, size: int, numbers: int) -> Loop:
    """Return the loop over chunks of `size` rows that calls ``function(world, cloth, begin, end, numbers)`` for each of them.

    `numbers` is the length of the last argument, a tuple of floats.
    """
    signature = types.none(types.intp, types.intp, types.intp, types.intp, types.UniTuple(types.float64, numbers))
    bound = {"chunk": function, "SIZE": size}
    return Loop(
        compiled(specialise(_run, name, **bound, COLUMN=column, call=caller(signature))),
        compiled(parallel=True)(specialise(_run_threaded, f"{name}_threaded", **bound)),
        signature,
        column,
    )


def _run(world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Do all chunks, in parallel if there are threads and enough chunks."""
    threaded = integers(world, KERNEL_ADDRESSES)[0, COLUMN]
    if threaded != 0 and last - first > (_FEWEST - 1) * SIZE:
        call(threaded, (world, cloth, first, last, numbers))
    else:
        for begin in range(first, last, SIZE):
            chunk(world, cloth, begin, min(begin + SIZE, last), numbers)


def _run_threaded(world: int, cloth: int, first: int, last: int, numbers: Numbers) -> None:
    """Do all chunks in parallel."""
    for k in prange((last - first + SIZE - 1) // SIZE):
        begin = first + k * SIZE
        chunk(world, cloth, begin, min(begin + SIZE, last), numbers)

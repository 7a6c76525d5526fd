"""The layout of ``work``, in which flows keep numbers between calls.

For a state of n numbers::

    0        accelerations of the last kick
    n        rounding errors of the sums for x
    2 n      rounding errors of the sums for v
    3 n      rate of x if it is not v, otherwise the change of v that a flow prepares, see `change_of_v`
    4 n      coefficients of the method
    memory   of the flows of the step, see `memory`; its last n numbers are for `estimated_errors`, and before them is the
             memory of step control, see `control_memory`
    -TAIL    single numbers, below

In front of it there are machine words: the addresses of the scratch and of the functions of the system.

Beside it there is a *scratch* for matrices, which grows with the square of n and is not copied with the state: a flow
forms a matrix again wherever it needs one, or keeps it and counts at FORMED that it is another one now.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from numba import carray, types
from numpy.typing import NDArray

from kickdrift.core.calls import address_of, caller
from kickdrift.core.compilation import Function, compiled, specialise, unbound
from kickdrift.core.memory import floats_at, start_of_array, word_in
from kickdrift.core.views import part

Floats = NDArray[np.float64]

_VECTOR = types.Array(types.float64, 1, "C")
FLAT = types.none(types.float64, _VECTOR, _VECTOR, _VECTOR, _VECTOR)
"""Signature of the functions of a system: ``function(t, x, v, params, out)``."""

PARTS = (
    "acceleration",
    "velocity",
    "remainder",
    "fast",
    "jump",
    "component",
    "velocity_jacobian",
    "magnetic_field",
    "constraints",
    "constraint_jacobian",
    "constraint_differences",
    "density",
    "energy",
    "gaps",
)
"""The functions that a system may have; flows call them as ``acceleration_at(t, x, v, params, work, out)``, say."""

TAIL = 32
TROUBLE = -1  # residual of a solve that failed, zero if none
EVALUATIONS = -2  # force evaluations counted by flows whose number varies
MEMORY = -3  # where memory starts
KEPT_BY, KEPT_FOR = -4, -5  # the flow and the step of the matrix kept in memory, zero if none is kept
DRAWN = -6  # random numbers drawn so far
FORMED = -7  # number of matrices formed
KEPT_TIMES = -8  # number of solutions that began with a kept matrix
# For variable steps:
CLOCK, ROUNDED_OFF = -9, -10  # the time, and the residual of its sum
CLOCK_OF_V = -11  # the time that moves with v
DENSITY = -12  # steps in the time that the first one takes
START_DENSITY = -13  # value of the density function at the start
DENSITY_RATE = -14  # the rate of its logarithm at the end of the last step
FIRST_STEP = -15  # signed
END = -16  # the final time
REJECTED = -17  # whether the last step was rejected
LAST_ERROR = -18  # of the last step accepted, over the tolerance
BINDING = -19  # minus the energy at the start
CONTROL, OWN_PARAMS = -20, -21  # start of the memory of step control, and of the params of its function
OWN_COUNT = -22  # number of these params
DEAR = -23  # force evaluations of one evaluation of the density
DENSITY_ROUNDED_OFF = -26  # residual of the density's sum
SHADOW = -28  # start of the copy of the memory of the flows, for steps that may be rejected
TAKEN_BACK = -29  # number of steps rejected by a flow itself
DENSITY_HERE = -27  # value of the density function after the last step
SMALLEST, LARGEST = -24, -25  # of the steps taken
LOST_STEPS = -31  # number of the last steps in a row that were lost to rounding beside the time
RETRIED = -32  # whether a step that fails is tried again, shorter, by the control of errors
CHANGES = -30  # number of changes of the state or the force between steps, which invalidate forces kept by flows
FAILED_CONTROL, JAMMED, NOT_HELD, CROWDED, UNSIGNED_GAP = -1.0, -2.0, -3.0, -4.0, -5.0
CHATTERING, MISSED_SWITCH = -6.0, -7.0
LOST_TO_ROUNDING = -8.0
UNFIT_DENSITY, MISSED_DENSITY = -9.0, -10.0
"""Residuals that mean that no step size works: in general, of impacts, of densities; see `kickdrift.engine.no_step`."""
_SCRATCH = -1  # index among the words before work
_LINE = _BLOCK = 8  # numbers in a cache line, and in the block that describes the arrays of a run
_WORDS = (1 + len(PARTS) + _LINE - 1) // _LINE * _LINE  # in front of work: whole cache lines

FEW = 4  # size of a state up to which flows with constants are compiled for each size

SLOT = 0  # bound by `part_by_address`
function: Function = unbound  # bound by `part_inlined`
call = caller(FLAT)


@compiled
def _call_at(address: int, t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    call(address, (t, x, v, params, out))


def call_flat(function: Function, t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    """Call a compiled function of a system from the interpreter."""
    _call_at(address_of(function, FLAT), t, x, v, params, out)


def _scratch_at(start: int, size: int, work: Floats) -> Floats:
    address = word_in(work, _SCRATCH)
    numbers: Floats = carray(floats_at(address + 8 * start), (size,))
    return numbers


scratch_by_address = compiled(cached=False, inline=True)(_scratch_at)
"""Returns ``size`` numbers of the scratch from ``start`` on: what ``scratch`` is bound to in compiled flows."""


def scratch_interpreted(scratch: Floats) -> Function:
    """Return the same function for the interpreter."""
    return lambda start, size, work: scratch[start : start + size]


@compiled(inline=True)
def coefficients_at(n: int) -> int:
    """Return the index of the method's coefficients in work."""
    return 4 * n


@compiled(inline=True)
def change_of_v(n: int, work: Floats) -> Floats:
    """Return the part of work in which a flow may prepare the change of v, in systems where x' is v."""
    return part(work, 3 * n, n)


@compiled(inline=True)
def memory(work: Floats) -> Floats:
    """Return the part of work that is the memory of the flows of the step."""
    start = int(work[MEMORY])
    return part(work, start, work.size - TAIL - start)


@compiled(inline=True)
def estimated_errors(n: int, work: Floats) -> Floats:
    """Return the largest estimated error of any step, for each component of x."""
    return part(work, work.size - TAIL - n, n)


CONTROL_VECTORS = 8
"""Number of vectors of n numbers in the memory of step control."""


@compiled(inline=True)
def control_memory(n: int, work: Floats) -> Floats:
    """Return the part of work that is the memory of step control, `CONTROL_VECTORS` of n numbers."""
    return part(work, int(work[CONTROL]), CONTROL_VECTORS * n)


@compiled(inline=True)
def own_params(work: Floats) -> Floats:
    """Return the params of the function of step control."""
    return part(work, int(work[OWN_PARAMS]), int(work[OWN_COUNT]))


@compiled(inline=True)
def move_clock(h: float, work: Floats) -> None:
    """Advance the time, with a compensated sum."""
    increment = h - work[ROUNDED_OFF]
    total = work[CLOCK] + increment
    work[ROUNDED_OFF] = (total - work[CLOCK]) - increment
    work[CLOCK] = total


_ROUNDING = 8 * np.finfo(float).eps  # of the clock, within which the end is reached
_SPACINGS = 16 * np.finfo(float).eps  # of the clock, below which a step is lost
_TINY = 1e-60  # of the first step, the same: at t = 0 floats have no spacing


@compiled(inline=True)
def at_end(work: Floats) -> bool:
    """Whether the clock is at the end, or beyond it."""
    left = work[END] - work[CLOCK]
    return bool((left if work[FIRST_STEP] > 0.0 else -left) <= _ROUNDING * max(abs(work[END]), abs(work[CLOCK])))


@compiled(inline=True)
def is_lost(size: float, work: Floats) -> bool:
    """Whether a step is lost to rounding beside the time."""
    return bool(abs(size) < max(_SPACINGS * abs(work[CLOCK]), _TINY * abs(work[FIRST_STEP])))


def aligned(size: int) -> tuple[NDArray[np.int64], int]:
    """Return zero words that begin at a cache line, and their address: vectors that cross two lines take twice as long."""
    room = np.zeros(size + _LINE - 1, dtype=np.int64)
    address = start_of_array(room)
    start = -(address // 8) % _LINE
    return room[start : start + size], address + 8 * start


def lay_out(
    x0: Floats,
    v0: Floats,
    params: Floats,
    coefficients: Floats,
    memory_size: int,
    addresses: dict[str, int],
    scratch: Floats,
) -> tuple[int, tuple[Floats, Floats, Floats, Floats]]:
    """Create the memory of a run: x, v, params and work, each from a cache line on; and a block that describes them.

    Work has the coefficients and addresses, and zeros elsewhere.

    Returns
    -------
    block : int
        Address of the block, see `kickdrift.core.memory.arrays`; the arrays keep it alive.
    members : tuple of array
    """
    n, n_v, n_params = x0.size, v0.size, params.size
    at_v = _BLOCK + _lines(n)
    at_params = at_v + _lines(n_v)
    at_work = at_params + _lines(n_params) + _WORDS
    end = 4 * n + coefficients.size
    start = (end + _LINE - 1) // _LINE * _LINE
    size = start + memory_size + TAIL
    room, block = aligned(at_work + size)
    of_x, of_v, of_params, of_work = [block + 8 * at for at in (_BLOCK, at_v, at_params, at_work)]
    room[:_BLOCK] = of_x, n, of_v, n_v, of_params, n_params, of_work, size
    for name, address in addresses.items():
        room[at_work + _slot(name)] = address
    room[at_work + _SCRATCH] = start_of_array(scratch)
    numbers = room.view(np.float64)
    x, v = numbers[_BLOCK : _BLOCK + n], numbers[at_v : at_v + n_v]
    given, work = numbers[at_params : at_params + n_params], numbers[at_work:]
    x[:], v[:], given[:] = x0.reshape(-1), v0.reshape(-1), params
    work[4 * n : end] = coefficients
    work[MEMORY] = start
    return block, (x, v, given, work)


def _lines(size: int) -> int:
    """Return the numbers in a vector's cache lines, and at least one more: the next would else begin at its place in a page."""
    return (1 + size // _LINE) * _LINE


def _slot(name: str) -> int:
    return _SCRATCH - 1 - PARTS.index(name)


VELOCITY, COMPONENT, VELOCITY_JACOBIAN = _slot("velocity"), _slot("component"), _slot("velocity_jacobian")
CONSTRAINT_JACOBIAN = _slot("constraint_jacobian")


@compiled(inline=True)
def has_part(slot: int, work: Floats) -> bool:
    """Whether the system has the function of this slot; x' is v where it has no velocity."""
    return bool(word_in(work, slot) != 0)


def has_part_interpreted(functions: Mapping[str, Function]) -> Function:
    """Return the same function for the interpreter, where the functions are known."""
    slots = {_slot(name) for name in functions}
    return lambda slot, work: slot in slots


def _at(t: float, x: Floats, v: Floats, params: Floats, work: Floats, out: Floats) -> None:
    call(word_in(work, SLOT), (t, x, v, params, out))


def _inlined_at(t: float, x: Floats, v: Floats, params: Floats, work: Floats, out: Floats) -> None:
    function(t, x, v, params, out)


@cache
def part_by_address(name: str) -> Function:
    """Return a compiled function that calls a part of any system by its address in work."""
    return compiled(cached=False, inline=True)(specialise(_at, f"{name}_at", SLOT=_slot(name)))


def part_inlined(name: str, function: Function) -> Function:
    """Return the same function for one system, with its part inlined."""
    return compiled(cached=False, inline=True)(specialise(_inlined_at, f"{name}_at", function=function))


def part_interpreted(function: Function) -> Function:
    """Return the same function for the interpreter, where the part is known."""

    def at(t: float, x: Any, v: Any, params: Any, work: Any, out: Any) -> None:
        function(t, x, v, params, out)

    return at

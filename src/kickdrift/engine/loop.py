"""The one loop: every method on every system."""

from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.calls import call_interpreted, caller
from kickdrift.core.compilation import compiled, specialise
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.layout import (
    CLOCK,
    CLOCK_OF_V,
    DENSITY,
    EVALUATIONS,
    FIRST_STEP,
    LARGEST,
    LOST_STEPS,
    LOST_TO_ROUNDING,
    REJECTED,
    SMALLEST,
    TROUBLE,
    at_end,
    is_lost,
    move_clock,
    own_params,
)

Floats = NDArray[np.float64]
LETTER = types.none(types.float64, types.float64, types.intp)
_INTEGERS, _FLOATS, _ROWS = (
    types.Array(*kind, "C") for kind in ((types.int64, 1), (types.float64, 1), (types.float64, 2))
)
_WORD = (_INTEGERS, _INTEGERS, _FLOATS, _FLOATS, types.float64, types.float64)  # of addresses of letters
_STATE = (types.int64, _FLOATS, _FLOATS, _FLOATS)
ADVANCE = types.UniTuple(types.int64, 2)(
    *_WORD, types.int64, types.int64, *_STATE, _INTEGERS, types.int64, _ROWS, _ROWS
)
ADVANCE_ADAPTIVELY = types.int64(
    _INTEGERS, _INTEGERS, _FLOATS, _FLOATS, _FLOATS, _INTEGERS, types.int64, *_STATE,
    types.int64, _FLOATS, _INTEGERS, _FLOATS, _FLOATS, _ROWS, _ROWS
)  # fmt: skip
CHANGE = types.none(
    _INTEGERS,
    _INTEGERS,
    _FLOATS,
    _FLOATS,
    _INTEGERS,
    _FLOATS,
    _FLOATS,
    _INTEGERS,
    *_STATE,
    _FLOATS,
    _ROWS,
    _FLOATS,
    _FLOATS,
    _FLOATS,
    _ROWS,
    _ROWS,
)

_MOST_LOST = 1_000_000  # steps in a row lost to rounding, if they are more than half of all: see `advance_adaptively`

ACCEPTED, TRIALS, ROWS, WANTED = range(4)
"""Counters of adaptive steps: steps taken, steps tried, rows filled, and wanted times passed."""

call = caller(LETTER)


@compiled
def advance(
    flows: Any,
    letters: NDArray[np.int64],
    weights: Floats,
    offsets: Floats,
    t0: float,
    h: float,
    first: int,
    last: int,
    state: Any,
    x: Floats,
    v: Floats,
    work: Floats,
    save_steps: NDArray[np.int64],
    saved: int,
    xs: Floats,
    vs: Floats,
) -> tuple[int, int]:
    """Run the steps from `first` to `last`, copying the state into the rows of xs and vs after each of `save_steps`.

    Returns
    -------
    step : int
        The last step: `last`, or the one at which a flow failed.
    saved : int
        How many rows are filled.
    """
    for step in range(first, last):
        t = t0 + step * h
        for k in range(letters.size):
            call(flows[letters[k]], (t + offsets[k] * h, weights[k] * h, state))
        if work[TROUBLE] != 0.0:
            return step, saved
        if saved < save_steps.size and save_steps[saved] == step + 1:
            assign(xs[saved], x)
            assign(vs[saved], v)
            saved += 1
    return last, saved


@compiled
def advance_adaptively(
    flows: Any,
    letters: NDArray[np.int64],
    weights: Floats,
    ticks: Floats,
    ticks_of_v: Floats,
    sees_v: NDArray[np.int64],
    last: int,
    state: Any,
    x: Floats,
    v: Floats,
    work: Floats,
    stride: int,
    wanted: Floats,
    marks: NDArray[np.int64],
    ts: Floats,
    sizes: Floats,
    xs: Floats,
    vs: Floats,
) -> int:
    """Run steps, whose sizes the letters themselves choose, until `last` are taken or the end is passed.

    The state before a step, its time and its size are kept in a row for one step in `stride` (for the first alone if that is
    0), and for each step that passes one of the `wanted` times, of which the end is the last.

    Where the motion goes to infinity in a finite time, steps get shorter for ever. They are also lost to rounding beside the
    time in a close encounter, yet those are legitimate, and fewer than the steps that lead there: 3 of 26 million on an orbit
    of eccentricity 1 - 1e-8.

    Returns
    -------
    steps : int
        Number of steps taken.
    """
    sign = 1.0 if work[FIRST_STEP] > 0.0 else -1.0
    while marks[ACCEPTED] < last and not at_end(work):
        row = marks[ROWS]
        ts[row] = work[CLOCK]
        assign(xs[row], x)
        assign(vs[row], v)
        work[CLOCK_OF_V] = work[CLOCK]
        marks[TRIALS] += 1
        for k in range(letters.size):
            h = work[FIRST_STEP] / work[DENSITY]
            call(flows[letters[k]], (work[CLOCK_OF_V] if sees_v[k] else work[CLOCK], weights[k] * h, state))
            if ticks[k] != 0.0:
                move_clock(ticks[k] * h, work)
            work[CLOCK_OF_V] += ticks_of_v[k] * h
        if work[TROUBLE] != 0.0:
            break
        if work[REJECTED] != 0.0:
            continue
        size = work[CLOCK] - ts[row]
        work[LOST_STEPS] = work[LOST_STEPS] + 1.0 if is_lost(size, work) else 0.0
        if work[LOST_STEPS] > max(_MOST_LOST, 0.5 * marks[ACCEPTED]):
            work[TROUBLE] = LOST_TO_ROUNDING
            break
        kept = marks[ACCEPTED] % stride == 0 if stride > 0 else marks[ACCEPTED] == 0
        marks[ACCEPTED] += 1
        sizes[row] = size
        work[SMALLEST], work[LARGEST] = min(work[SMALLEST], abs(size)), max(work[LARGEST], abs(size))
        while marks[WANTED] < wanted.size and sign * (work[CLOCK] - wanted[marks[WANTED]]) > 0.0:
            marks[WANTED] += 1
            kept = True
        marks[ROWS] += kept
    return int(marks[ACCEPTED])


@compiled
def change(
    flows: Any,
    letters: NDArray[np.int64],
    weights: Floats,
    offsets: Floats,
    primers: NDArray[np.int64],
    times: Floats,
    sizes: Floats,
    counts: NDArray[np.int64],
    state: Any,
    x: Floats,
    v: Floats,
    work: Floats,
    params: Floats,
    numbers: Floats,
    blank: Floats,
    clocks: Floats,
    counted: Floats,
    xs: Floats,
    vs: Floats,
) -> None:
    """Advance each row of xs and vs by steps of one size from its time, with a blank work array; NaN if a flow fails.

    Each row of `numbers`, if there are any, is the params of one row, followed by those of the control of its steps, which are
    left out where there is none. `clocks` get the final times of letters that move the
    clock, and `counted` the evaluations that flows count themselves.
    """
    for row in range(times.size):
        assign(x, xs[row])
        assign(v, vs[row])
        assign(work, blank)
        if numbers.shape[0]:
            assign(params, numbers[row, : params.size])
            own = own_params(work)
            assign(own, numbers[row, params.size : params.size + own.size])
        work[CLOCK] = times[row]
        h = sizes[row]
        for k in range(primers.size):
            call(flows[primers[k]], (times[row], 0.0, state))
        for step in range(counts[row]):
            t = times[row] + step * h
            for k in range(letters.size):
                call(flows[letters[k]], (t + offsets[k] * h, weights[k] * h, state))
        if work[TROUBLE] != 0.0:
            assign(x, np.nan)
            assign(v, np.nan)
        counted[row] = work[EVALUATIONS] - blank[EVALUATIONS]
        clocks[row] = work[CLOCK]
        assign(xs[row], x)
        assign(vs[row], v)


advance_adaptively_interpreted = specialise(
    advance_adaptively.py_func,  # type: ignore[attr-defined]
    "advance_adaptively_interpreted",
    call=call_interpreted,
)
advance_interpreted = specialise(advance.py_func, "advance_interpreted", call=call_interpreted)  # type: ignore[attr-defined]
change_interpreted = specialise(change.py_func, "change_interpreted", call=call_interpreted)  # type: ignore[attr-defined]

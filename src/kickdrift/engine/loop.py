"""The one loop: every method on every system."""

from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.calls import call_interpreted, caller
from kickdrift.core.compilation import compiled, specialise
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.layout import EVALUATIONS, TROUBLE

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
CHANGE = types.int64(
    _INTEGERS, _INTEGERS, _FLOATS, _FLOATS, _INTEGERS, _FLOATS, _FLOATS, _INTEGERS, *_STATE, _FLOATS, _ROWS, _ROWS
)

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
        Where it ended: `last`, or the step that a flow could not do.
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
    blank: Floats,
    xs: Floats,
    vs: Floats,
) -> int:
    """Overwrite each row of xs and vs by what steps of one size from its time give, begun with blank work; NaN if a flow fails.

    Returns
    -------
    evaluations : int
        How many force evaluations flows have counted themselves.
    """
    evaluations = 0
    for row in range(times.size):
        assign(x, xs[row])
        assign(v, vs[row])
        assign(work, blank)
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
        evaluations += int(work[EVALUATIONS] - blank[EVALUATIONS])
        assign(xs[row], x)
        assign(vs[row], v)
    return evaluations


advance_interpreted = specialise(advance.py_func, "advance_interpreted", call=call_interpreted)  # type: ignore[attr-defined]
change_interpreted = specialise(change.py_func, "change_interpreted", call=call_interpreted)  # type: ignore[attr-defined]

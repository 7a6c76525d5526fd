"""Members of an ensemble one after the other, without the interpreter in between: steps of all kinds, on states of any size."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, load
from kickdrift.core.elementwise import assign
from kickdrift.engine.flows.layout import EVALUATIONS, TROUBLE
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Grid
from kickdrift.engine.loop import advance, call
from kickdrift.engine.processing import Processing

Floats = NDArray[np.float64]
_INTEGERS, _FLOATS = (types.Array(kind, 1, "C") for kind in (types.int64, types.float64))
_ROWS, _PLANES = (types.Array(types.float64, ndim, "C") for ndim in (2, 3))
_SIGNATURE = types.none(
    *(_INTEGERS, _INTEGERS, _FLOATS, _FLOATS, _INTEGERS, types.float64, types.float64, types.int64),
    *(types.int64, _FLOATS, _FLOATS, _FLOATS, _FLOATS, _FLOATS, _ROWS, _ROWS, _ROWS),
    *(_INTEGERS, _PLANES, _PLANES, _FLOATS, _FLOATS),
)


@compiled
def _run(
    flows: Any,
    letters: NDArray[np.int64],
    weights: Floats,
    offsets: Floats,
    primers: NDArray[np.int64],
    t0: float,
    h: float,
    n_steps: int,
    state: Any,
    x: Floats,
    v: Floats,
    params: Floats,
    work: Floats,
    blank: Floats,
    starts: Floats,
    velocities: Floats,
    numbers: Floats,
    save_steps: NDArray[np.int64],
    xs: Any,
    vs: Any,
    evaluations: Floats,
    trouble: Floats,
) -> None:
    """Run each member from its start with its params on blank work, as `kickdrift.engine.run` does one."""
    for m in range(starts.shape[0]):
        assign(x, starts[m])
        assign(v, velocities[m])
        assign(params, numbers[m])
        assign(work, blank)
        saved = 0
        if save_steps[0] == 0:
            assign(xs[m, 0], x)
            assign(vs[m, 0], v)
            saved = 1
        for k in range(primers.size):
            call(flows[primers[k]], (t0, 0.0, state))
        advance(flows, letters, weights, offsets, t0, h, 0, n_steps, state, x, v, work, save_steps, saved, xs[m], vs[m])
        evaluations[m] = work[EVALUATIONS]
        trouble[m] = work[TROUBLE]
        for i in range(x.size):
            trouble[m] += 0.0 * x[i]
        for i in range(v.size):
            trouble[m] += 0.0 * v[i]


@dataclass(frozen=True)
class Turns:
    """What members have left: rows as people see them, (M, T, *shape), force evaluations, and which reached the end."""

    x: Floats
    v: Floats
    evaluations: NDArray[np.int64]
    good: NDArray[np.bool_]


def run_in_turn(processing: Processing, grid: Grid, x: Floats, v: Floats, params: Floats) -> Turns:
    """Run members from their starts, (M, *shape), with their params, (M, p), which are the same where states are processed."""
    kernel, system, count = processing.kernel, processing.system, x.shape[0]
    starts, velocities = (x, v) if processing.frame is None else processing.frame.enter(x, v)
    starts, velocities = starts.reshape(count, -1).copy(), velocities.reshape(count, -1).copy()
    if processing.preprocessor is not None:
        times, sizes, once = np.full(count, grid.t0), np.full(count, grid.step), np.ones(count, dtype=np.int64)
        processing.preprocessor.change(times, sizes, once, starts, velocities)
    rows, program = grid.save_steps.size, kernel.program
    xs, vs = np.empty((count, rows, starts.shape[1])), np.empty((count, rows, velocities.shape[1]))
    inside, trouble = np.zeros(count), np.zeros(count)
    load(_run, _SIGNATURE)
    flows, primers, state = kernel.compiled
    word, span = (program.letters, program.weights, program.offsets, primers), (grid.t0, grid.step, grid.n_steps)
    members = kernel.state.work.copy(), starts, velocities, params
    arguments: tuple[Any, ...] = flows, *word, *span, *state, *members, grid.save_steps, xs, vs, inside, trouble
    _run(*arguments)
    flat = (count * rows, starts.shape[1]), (count * rows, velocities.shape[1])
    xs, vs = processing.seen(np.tile(grid.times, count), xs.reshape(flat[0]), vs.reshape(flat[1]))
    xs, vs = xs.reshape(count, rows, *system.x0.shape), vs.reshape(count, rows, *system.v0.shape)
    if grid.save_steps[0] == 0:
        xs[:, 0], vs[:, 0] = x, v  # which there and back is but for rounding
    outside = sum(FLOWS[name].evaluations for name in program.primers) + processing.evaluations(rows)
    evaluations = grid.n_steps * program.evaluations + outside + inside.astype(np.int64)
    return Turns(xs, vs, evaluations, trouble == 0.0)

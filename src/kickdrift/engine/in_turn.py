"""Members of an ensemble one after the other in compiled code: steps of all kinds, on states of any size."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, load
from kickdrift.core.elementwise import assign
from kickdrift.engine.dense import DenseOutput, States, states_of
from kickdrift.engine.flows.layout import EVALUATIONS, TROUBLE
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Grid
from kickdrift.engine.loop import advance, call
from kickdrift.engine.processing import Processing

Floats = NDArray[np.float64]
_INTEGERS, _FLOATS = (types.Array(kind, 1, "C") for kind in (types.int64, types.float64))
_ROWS, _PLANES = (types.Array(types.float64, ndim, "C") for ndim in (2, 3))
_SIGNATURE = types.none(
    *(_INTEGERS, _INTEGERS, _FLOATS, _FLOATS, _INTEGERS, types.float64, types.float64, types.int64, types.int64),
    *(types.int64, _FLOATS, _FLOATS, _FLOATS, _FLOATS, _ROWS, _ROWS, _ROWS, _ROWS),
    *(_INTEGERS, _PLANES, _PLANES, _FLOATS),
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
    first: int,
    last: int,
    state: Any,
    x: Floats,
    v: Floats,
    params: Floats,
    work: Floats,
    works: Floats,
    starts: Floats,
    velocities: Floats,
    numbers: Floats,
    save_steps: NDArray[np.int64],
    xs: Any,
    vs: Any,
    trouble: Floats,
) -> None:
    """Run each member from one step to another with its params and its work array, as `kickdrift.engine.run` does."""
    for m in range(starts.shape[0]):
        assign(x, starts[m])
        assign(v, velocities[m])
        assign(params, numbers[m])
        assign(work, works[m])
        saved = 0
        if first == 0:
            if save_steps.size and save_steps[0] == 0:
                assign(xs[m, 0], x)
                assign(vs[m, 0], v)
                saved = 1
            for k in range(primers.size):
                call(flows[primers[k]], (t0, 0.0, state))
        advance(
            flows, letters, weights, offsets, t0, h, first, last, state, x, v, work, save_steps, saved, xs[m], vs[m]
        )
        assign(starts[m], x)
        assign(velocities[m], v)
        assign(works[m], work)
        trouble[m] = work[TROUBLE]
        for i in range(x.size):
            trouble[m] += 0.0 * x[i]
        for i in range(v.size):
            trouble[m] += 0.0 * v[i]


class Members:
    """Members in progress, each at its own state.

    Parameters
    ----------
    processing : Processing
    grid : Grid
    x, v : (M, *shape) array
        Their starts.
    params : (M, p) array
        The same for all where states are processed.
    """

    def __init__(self, processing: Processing, grid: Grid, x: Floats, v: Floats, params: Floats) -> None:
        kernel, count = processing.kernel, x.shape[0]
        starts, velocities = (x, v) if processing.frame is None else processing.frame.enter(x, v)
        self.x, self.v = starts.reshape(count, -1).copy(), velocities.reshape(count, -1).copy()
        if processing.preprocessor is not None:
            times, sizes, once = np.full(count, grid.t0), np.full(count, grid.step), np.ones(count, dtype=np.int64)
            processing.preprocessor.change(times, sizes, once, self.x, self.v)
        self.params, self._work = params, np.tile(kernel.state.work, (count, 1))
        self._kernel, self._grid = kernel, grid
        load(_run, _SIGNATURE)

    def advance(
        self, which: Any, first: int, last: int, save_steps: NDArray[np.int64]
    ) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Run some from one step to another; return their rows after `save_steps`, (M, T, n), and which are well."""
        kernel, program, grid = self._kernel, self._kernel.program, self._grid
        own = x, v, params, work = self.x[which], self.v[which], self.params[which], self._work[which]
        rows, trouble = (len(x), save_steps.size), np.zeros(len(x))
        xs, vs = np.empty((*rows, x.shape[1])), np.empty((*rows, v.shape[1]))
        flows, primers, state = kernel.compiled
        word, span = (program.letters, program.weights, program.offsets, primers), (grid.t0, grid.step, first, last)
        members = work, x, v, np.ascontiguousarray(params)
        arguments: tuple[Any, ...] = flows, *word, *span, *state, *members, save_steps, xs, vs, trouble
        _run(*arguments)
        self.x[which], self.v[which], _, self._work[which] = own
        return xs, vs, trouble == 0.0

    @property
    def counted(self) -> NDArray[np.int64]:
        """Force evaluations that flows have counted themselves, of each member."""
        return self._work[:, EVALUATIONS].astype(np.int64)

    @property
    def primed(self) -> int:
        """Force evaluations of primers."""
        return sum(FLOWS[name].evaluations for name in self._kernel.program.primers)


@dataclass(frozen=True)
class Turns:
    """Results of the members: rows in the user's coordinates, (M, T, *shape), force evaluations, and which reached the end."""

    x: Floats
    v: Floats
    evaluations: NDArray[np.int64]
    good: NDArray[np.bool_]


def run_in_turn(
    processing: Processing, between: Callable[[], Processing], grid: Grid, x: Floats, v: Floats, params: Floats
) -> Turns:
    """Run members from their starts, (M, *shape), with their params, (M, p), which are equal if states are processed."""
    system, count, rows = processing.system, x.shape[0], grid.save_steps.size
    members = Members(processing, grid, x, v, params)
    xs, vs, good = members.advance(slice(None), 0, grid.n_steps, grid.save_steps)
    flat = (count * rows, xs.shape[2]), (count * rows, vs.shape[2])
    xs, vs = processing.seen(np.tile(grid.times, count), xs.reshape(flat[0]), vs.reshape(flat[1]))
    xs, vs = xs.reshape(count, rows, *system.x0.shape), vs.reshape(count, rows, *system.v0.shape)
    if grid.save_steps[0] == 0:
        xs[:, 0], vs[:, 0] = x, v  # exactly: transformed there and back it would differ by rounding
    once = members.primed + processing.evaluations(rows)
    evaluations = grid.n_steps * processing.kernel.program.evaluations + once + members.counted
    if grid.wanted is not None:
        steps = np.full(rows, grid.step)
        outputs = [
            DenseOutput.of_rows(grid, States(x[m], v[m]), (grid.times, xs[m], vs[m], steps), grid.t1, between)
            for m in np.flatnonzero(good)
        ]
        xs, vs = (np.full((count, grid.wanted.size, *own.shape[2:]), np.nan) for own in (xs, vs))
        if outputs:
            xs[good], vs[good], between_rows = states_wanted(grid, outputs, params[good])
            evaluations[good] += between_rows
    return Turns(xs, vs, evaluations, good)


def states_wanted(
    grid: Grid, outputs: Sequence[DenseOutput], params: Floats
) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Return the states of members at the times wanted, NaN after their ends, and the evaluations that these took."""
    assert grid.wanted is not None
    reached, times = [], []
    for output in outputs:
        low, high = sorted((grid.t0, output.end))
        whole = output.end == grid.t1  # times may be beyond it by a rounding
        reached.append(np.full(grid.wanted.size, True) if whole else (grid.wanted >= low) & (grid.wanted <= high))
        times.append(np.clip(grid.wanted[reached[-1]], low, high))
    found = states_of(outputs, times, params)
    xs, vs = (np.full((len(outputs), grid.wanted.size, *getattr(outputs[0], name).shape[1:]), np.nan) for name in "xv")
    for m, (x, v, _) in enumerate(found):
        xs[m, reached[m]], vs[m, reached[m]] = x, v
    return xs, vs, np.array([own for *_, own in found])

"""Members of an ensemble with variable steps, integrated one after the other in compiled code."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, load
from kickdrift.core.elementwise import assign
from kickdrift.engine.dense import DenseOutput, States, states_of
from kickdrift.engine.flows.layout import CLOCK, EVALUATIONS, LARGEST, SMALLEST, TROUBLE, at_end, own_params
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Course
from kickdrift.engine.loop import ACCEPTED, ROWS, TRIALS, advance_adaptively, call
from kickdrift.engine.processing import Processing
from kickdrift.engine.rows import is_beyond

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
_INTEGERS, _FLOATS = (types.Array(kind, 1, "C") for kind in (types.int64, types.float64))
_ROWS, _MARKS = (types.Array(kind, 2, "C") for kind in (types.float64, types.int64))
_PLANES = types.Array(types.float64, 3, "C")
_SIGNATURE = types.none(
    *(_INTEGERS, _INTEGERS, _FLOATS, _FLOATS, _FLOATS, _INTEGERS, _INTEGERS, types.float64, types.int64),
    *(types.int64, _FLOATS, _FLOATS, _FLOATS, _FLOATS, _FLOATS, _ROWS, _ROWS, _ROWS, _ROWS),
    *(_FLOATS, _MARKS, _ROWS, _ROWS, _PLANES, _PLANES, _ROWS),
)
_FINITE, _CLOCK, _COUNTED, _SMALLEST, _LARGEST, _FACTS = range(6)


@compiled
def _run(
    flows: Any,
    letters: Integers,
    weights: Floats,
    ticks: Floats,
    ticks_of_v: Floats,
    sees_v: Integers,
    primers: Integers,
    t0: float,
    most: int,
    state: Any,
    x: Floats,
    v: Floats,
    params: Floats,
    work: Floats,
    blank: Floats,
    starts: Floats,
    velocities: Floats,
    numbers: Floats,
    of_control: Floats,
    wanted: Floats,
    marks: Any,
    ts: Any,
    sizes: Any,
    xs: Any,
    vs: Any,
    facts: Any,
) -> None:
    """Run each member from its start on a blank work array, as `kickdrift.engine.run` does, for at most `most` steps.

    Each has params of its own, and so has the control of its steps. The row after the last one that is filled gets the state
    that is reached.
    """
    for m in range(starts.shape[0]):
        assign(x, starts[m])
        assign(v, velocities[m])
        assign(params, numbers[m])
        assign(work, blank)
        assign(own_params(work), of_control[m])
        for k in range(primers.size):
            call(flows[primers[k]], (t0, 0.0, state))
        advance_adaptively(
            flows, letters, weights, ticks, ticks_of_v, sees_v, most, state, x, v, work, 0, wanted, marks[m], ts[m],
            sizes[m], xs[m], vs[m],
        )  # fmt: skip
        assign(xs[m, marks[m, ROWS]], x)
        assign(vs[m, marks[m, ROWS]], v)
        facts[m, _FINITE] = work[TROUBLE] if at_end(work) else 1.0
        for i in range(x.size):
            facts[m, _FINITE] += 0.0 * x[i]
        for i in range(v.size):
            facts[m, _FINITE] += 0.0 * v[i]
        facts[m, _CLOCK], facts[m, _COUNTED] = work[CLOCK], work[EVALUATIONS]
        facts[m, _SMALLEST], facts[m, _LARGEST] = work[SMALLEST], work[LARGEST]


@dataclass(frozen=True)
class Courses:
    """Results of the members: states at the times wanted, (G, T, *shape), of those that are `good`, and the costs of all."""

    x: Floats
    v: Floats
    good: NDArray[np.bool_]
    n_steps: Integers
    rejected: Integers
    evaluations: Integers
    step_range: Floats


def run_courses(
    processing: Processing,
    between: Callable[[], Processing],
    grid: Course,
    x: Floats,
    v: Floats,
    params: Floats,
    of_control: Floats,
    most: int,
) -> Courses:
    """Run members from their starts, (M, *shape), to the end of a course with times that are wanted.

    Each has its `params`, (M, p), and those of the control of its steps, which go for the control of parts of steps, too.
    """
    kernel, count, rows = processing.kernel, x.shape[0], grid.marks.size + 2  # the first one and the last one, too
    starts, velocities = (np.ascontiguousarray(own.reshape(count, -1)) for own in (x, v))
    marks, facts = np.zeros((count, 4), dtype=np.int64), np.zeros((count, _FACTS))
    ts, sizes = np.empty((count, rows)), np.empty((count, rows))
    xs, vs = np.empty((count, rows, starts.shape[1])), np.empty((count, rows, velocities.shape[1]))
    load(_run, _SIGNATURE)
    flows, primers, (block, own_x, own_v, own, work) = kernel.compiled
    program = kernel.program
    word = program.letters, program.weights, program.ticks, program.ticks_of_v, program.sees_v_clock
    state = block, own_x, own_v, own, work, work.copy()
    room = starts, velocities, np.ascontiguousarray(params), of_control, grid.marks, marks, ts, sizes, xs, vs, facts
    arguments: tuple[Any, ...] = flows, *word, primers, grid.t0, most, *state, *room
    _run(*arguments)
    good = facts[:, _FINITE] == 0.0
    primed = sum(FLOWS[name].evaluations for name in program.primers)
    evaluations = marks[:, TRIALS] * program.evaluations + primed + facts[:, _COUNTED].astype(np.int64)
    xs, vs = xs.reshape(count, rows, *x.shape[1:]), vs.reshape(count, rows, *v.shape[1:])
    members, outputs = np.flatnonzero(good), []
    for m in members:
        filled = int(marks[m, ROWS])
        if not is_beyond(grid, facts[m, _CLOCK]):
            ts[m, filled], sizes[m, filled] = grid.t1, grid.step
            filled += 1
        kept = ts[m, :filled], xs[m, :filled], vs[m, :filled], sizes[m, :filled]
        outputs.append(DenseOutput.of_rows(grid, States(x[m], v[m]), kept, grid.t1, between))
    numbers_between = np.concatenate((params, of_control), axis=1)[members]
    states = _at_wanted(grid, outputs, members, evaluations, numbers_between, (x, v))
    steps = marks[:, ACCEPTED]
    return Courses(*states, good, steps, marks[:, TRIALS] - steps, evaluations, facts[:, _SMALLEST : _LARGEST + 1])


def _at_wanted(
    grid: Course,
    outputs: list[DenseOutput],
    members: NDArray[np.intp],
    evaluations: Integers,
    params: Floats,
    starts: tuple[Floats, Floats],
) -> tuple[Floats, Floats]:
    """Return the states of the members that reached the end at the times wanted, as `kickdrift.engine.report` does."""
    assert grid.wanted is not None
    xs, vs = (np.empty((len(outputs), grid.wanted.size, *own.shape[1:])) for own in starts)
    if not outputs:
        return xs, vs
    end = np.array([grid.t1])
    short = [k for k, output in enumerate(outputs) if output.t[-1] != grid.t1]
    if short:  # whose last step leads beyond the end: a part of it to there
        last = states_of([outputs[k] for k in short], [end] * len(short), params[short])
        for k, (x, v, own) in zip(short, last, strict=True):
            outputs[k] = outputs[k].followed_by(grid.t1, x[0], v[0])
            evaluations[members[k]] += own
    low, high = sorted((grid.t0, grid.t1))
    found = states_of(outputs, [np.clip(grid.wanted, low, high)] * len(outputs), params)
    for k, (x, v, own) in enumerate(found):
        xs[k], vs[k] = x, v
        evaluations[members[k]] += own
    return xs, vs

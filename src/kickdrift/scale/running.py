"""Members run on threads: many at once in lanes where their steps allow, else one after the other by `kickdrift.solve`."""

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from functools import partial

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.interruption import next_chunk
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.announcing import compiling_announced
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.lane_letters import LANES, fields_of
from kickdrift.engine.lanes import Lanes, compile_lanes
from kickdrift.engine.processing import kernel_alone
from kickdrift.engine.progress import told_of_steps
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.scale.prepared import Cohort, Prepared

Floats = NDArray[np.float64]
Task = partial[None]

_TASK = 20_000_000  # steps of members in a task of many: some 50 ms
_FIRST_CHUNK = 1_000_000  # steps of members before Ctrl-C is looked for, until it is known how long they take
_LOOK_SECONDS = 0.1  # between two looks at the progress
_VECTOR = 8  # members in a register


class Runs:
    """The runs of members, and what they have left so far.

    Attributes
    ----------
    results : Results
    """

    def __init__(self, prepared: Prepared, threads: int, progress: bool | None = None) -> None:
        if not prepared.system.native or prepared.system.unthreaded is not None:
            threads = 1  # the interpreter's lock, or threads of its own
        self._prepared, self._threads, self._progress = prepared, threads, progress
        self.results = prepared.room()
        self._stop = threading.Event()
        self._done, self._counting = 0, threading.Lock()
        self._tasks = deque(self._split())

    def go(self, tell: Callable[[int], None]) -> None:
        """Do all runs on threads, and tell how many steps of members are done now and then.

        A KeyboardInterrupt ends them; what was done is kept.
        """
        with ThreadPoolExecutor(self._threads) as pool:
            try:
                if self._tasks[0].func == self._run_alone:  # compiles what all need
                    self._watch([pool.submit(self._tasks.popleft())], tell)
                self._watch([pool.submit(self._work) for _ in range(self._threads)], tell)
            except BaseException:
                self._stop.set()
                raise
            finally:
                pool.shutdown()
                self.results.fill()

    def _work(self) -> None:
        while not self._stop.is_set():
            try:
                task = self._tasks.popleft()
            except IndexError:  # none is left
                return
            task()

    def _watch(self, futures: "list[Future[None]]", tell: Callable[[int], None]) -> None:
        waiting = set(futures)
        while waiting:
            finished, waiting = wait(waiting, _LOOK_SECONDS)
            for future in finished:
                future.result()
            tell(self._done)

    def _count(self, steps: int) -> None:
        with self._counting:
            self._done += steps

    def _split(self) -> Iterator[Task]:
        for cohort in self._prepared.cohorts:
            lanes = self._lanes(cohort.grid)
            if lanes is None:
                yield from (partial(self._run_alone, int(i), cohort) for i in cohort.indices)
                continue
            count = cohort.indices.size
            size = min(_members_of_task(cohort.length), _rounded_up(-(-count // self._threads)))
            for first in range(0, count, size):
                yield partial(self._run_in_lanes, Cohort(cohort.indices[first : first + size], cohort.grid), *lanes)

    def _lanes(self, grid: Grid | Course) -> tuple[Lanes, tuple[Floats, Floats, Floats]] | None:
        """Return what runs members in lanes, and their numbers; None where they have to run alone."""
        prepared = self._prepared
        program = kernel_alone(prepared.system, prepared.chosen.method)
        compensated = prepared.settings.compensated
        if program is None or isinstance(grid, Course) or grid.wanted is not None:
            return None
        if fields_of(prepared.system, program, compensated) is None:
            return None
        numbers = prepared.numbers()
        if numbers is None:
            return None
        with compiling_announced(self._progress):
            return compile_lanes(prepared.system, program, compensated), numbers

    def _run_in_lanes(self, cohort: Cohort, lanes: Lanes, numbers: tuple[Floats, Floats, Floats]) -> None:
        """Run members in blocks; those that do not reach the end once more alone, to find out how far they go."""
        grid, indices = cohort.grid, cohort.indices
        assert isinstance(grid, Grid)
        x, v, params = (array[indices] for array in numbers)
        rows = grid.save_steps.size
        xs, vs = np.empty((indices.size, rows, x.shape[1])), np.empty((indices.size, rows, v.shape[1]))
        blocks, step, chunk = lanes.blocks(x, v, params), 0, max(1, _FIRST_CHUNK // indices.size)
        try:
            while step < grid.n_steps and not self._stop.is_set():
                started, target = time.perf_counter(), min(step + chunk, grid.n_steps)
                blocks.advance(grid, step, target, xs, vs)
                chunk = next_chunk(target - step, time.perf_counter() - started)
                self._count((target - step) * indices.size)
                step = target
            good = blocks.good
        except Exception:  # of a function, for one of the members
            good = np.zeros(indices.size, dtype=bool)
        well, results, saved = indices[good], self.results, blocks.saved
        results.x[well, :saved] = xs[good, :saved].reshape(well.size, saved, *results.x.shape[2:])
        results.v[well, :saved] = vs[good, :saved].reshape(well.size, saved, *results.v.shape[2:])
        results.rows[well] = saved
        outcome = Outcome.COMPLETED if step == grid.n_steps else Outcome.INTERRUPTED
        message = outcome.value if outcome.success else _ended(outcome, grid, step)
        program = lanes.program
        results.step[well], results.n_steps[well] = grid.step, step
        primed = sum(FLOWS[name].evaluations for name in program.primers)
        results.evaluations[well] = step * program.evaluations + primed
        for i in well:
            results.status[i], results.messages[i] = outcome, message
        for i in indices[~good]:
            self._run_alone(int(i), cohort, step)

    def _run_alone(self, i: int, cohort: Cohort, counted: int = 0) -> None:
        """Run a member by `kickdrift.solve`, of whose steps so many are counted already."""
        if self._stop.is_set():
            return
        prepared, results, reached = self._prepared, self.results, counted

        def tell(step: int) -> None:
            nonlocal reached
            if step > reached and isinstance(cohort.grid, Grid):
                self._count(step - reached)
                reached = step
            if self._stop.is_set():
                raise KeyboardInterrupt

        members, settings = prepared.members, prepared.settings
        x0, v0, args = members.start_of(i)
        try:
            with told_of_steps(tell):
                solution = solve(
                    members.problem_of(i),
                    settings.t_span,
                    x0,
                    v0,
                    step=members.step_of(i),
                    method=prepared.chosen.method,
                    t_eval=settings.t_eval,
                    save_every=settings.save_every,
                    step_control=settings.step_control,
                    rtol=settings.rtol,
                    atol=settings.atol,
                    args=args,
                    compensated=settings.compensated,
                    compile=settings.compile and prepared.system.native,
                    check_bounds=settings.check_bounds,
                    progress=False,
                )
        except Exception as error:
            results.status[i] = Outcome.FAILED
            results.messages[i] = f"It did not begin. The error was {type(error).__name__}: {error}"
            return
        if isinstance(cohort.grid, Course):
            self._count(1)
        self._keep(i, solution, cohort.grid.t0)

    def _keep(self, i: int, solution: Solution, t0: float) -> None:
        results, t = self.results, self._prepared.t
        reached = np.ones(t.size, dtype=bool)
        if not solution.success:
            low, high = sorted((t0, float(solution.t[-1])))
            reached = (t >= low) & (t <= high)
            results.x[i] = results.v[i] = np.nan
        count = int(reached.sum())
        results.x[i, reached], results.v[i, reached] = solution.x[:count], solution.v[:count]
        results.rows[i], results.status[i] = t.size, solution.status
        results.messages[i] = solution.status.value if solution.success else solution.message
        results.step[i], results.n_steps[i] = solution.step, solution.n_steps
        results.evaluations[i] = solution.n_force_evaluations


def _members_of_task(n_steps: int) -> int:
    return _rounded_up(max(1, _TASK // n_steps), LANES)


def _rounded_up(number: int, of: int = _VECTOR) -> int:
    return -(-number // of) * of


def _ended(outcome: Outcome, grid: Grid, step: int) -> str:
    t = grid.t0 + step * grid.step
    return f"{outcome.value} It ends at t={t!r}, after {step} of {grid.n_steps} steps."

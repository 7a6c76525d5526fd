"""Members run on threads: many at once in lanes if their steps allow that, otherwise one after the other."""

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import raised_in_compiled_code
from kickdrift.core.errors import KickdriftError
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
from kickdrift.scale.moments import Moments
from kickdrift.scale.prepared import Cohort, Prepared
from kickdrift.scale.results import Results
from kickdrift.scale.turns import Numbers, numbers_in_turn, run_in_turn

Floats = NDArray[np.float64]
Task = partial[Any]

_TASK = 20_000_000  # steps of members in a task of many: some 50 ms
_FIRST_CHUNK = 1_000_000  # steps of members before Ctrl-C is looked for, until it is known how long they take
_MOST_STEPS = (
    10  # times those of the first member: one that takes more, as in a close encounter, does not keep others waiting
)
_TASK_SECONDS = 0.05  # of members one after the other, which nothing interrupts
_LOOKS_AT_ONCE = 10  # times as fast are events found of many members as of one
_LOOK_SECONDS = 0.1  # between two looks at the progress
_VECTOR = 8  # members in a register


class Runs:
    """The runs of members, and their results so far.

    Attributes
    ----------
    results : Results
    """

    def __init__(
        self, prepared: Prepared, threads: int, progress: bool | None = None, results: Results | None = None
    ) -> None:
        if not prepared.system.native or prepared.system.unthreaded is not None:
            threads = 1  # the interpreter's lock, or threads of its own
        self._prepared, self._threads, self._progress = prepared, threads, progress
        self.results = prepared.room() if results is None else results
        self._stop = threading.Event()
        self._done, self._counting = 0, threading.Lock()
        self._tasks: deque[Task] = deque()
        self._slow: list[Cohort] = []  # whose members run one after the other
        for whole in prepared.cohorts:
            cohort = Cohort(whole.indices[~self.results.done[whole.indices]], whole.grid)
            if not cohort.indices.size:
                continue
            if (lanes := self._lanes(cohort.grid)) is None:
                self._slow.append(cohort)
            else:
                size = _members_of_task(cohort.length)
                self._tasks += self._split(self._run_in_lanes, cohort, size, *lanes)

    def go(self, tell: Callable[[int], None]) -> None:
        """Do all runs on threads, and tell how many steps of members are done now and then.

        A KeyboardInterrupt ends them; finished members are kept.
        """
        with ThreadPoolExecutor(self._threads) as pool:
            try:
                for cohort in self._slow:
                    self._watch([pool.submit(self._begin, cohort)], tell)
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

    def _split(self, run: Callable[..., None], cohort: Cohort, size: int, *given: Any) -> Iterator[Task]:
        """Divide a cohort into tasks of a limited number of members, equally many for each thread."""
        tasks = -(-cohort.indices.size // (size * self._threads)) * self._threads
        size = min(size, _rounded_up(-(-cohort.indices.size // tasks)))
        for first in range(0, cohort.indices.size, size):
            yield partial(run, Cohort(cohort.indices[first : first + size], cohort.grid), *given)

    def _begin(self, cohort: Cohort) -> None:
        """Run the first member alone, which compiles all code, and divide the others into tasks by the time that it took."""
        first, alone = cohort.indices[0], 1
        seconds = self._run_alone(int(first), cohort)
        if self._prepared.events and cohort.indices.size > 1:  # looking for which has compiled functions meanwhile
            seconds, alone = self._run_alone(int(cohort.indices[1]), cohort) / _LOOKS_AT_ONCE, 2
        rest = Cohort(cohort.indices[alone:], cohort.grid)
        size = int(_TASK_SECONDS / max(seconds, 1e-6))
        if size > 1 and rest.indices.size and (numbers := numbers_in_turn(self._prepared, cohort.grid)) is not None:
            most = _MOST_STEPS * int(self.results.n_steps[first])
            if isinstance(cohort.grid, Course):
                most = min(most, cohort.grid.most)
            self._tasks += self._split(self._run_in_turn, rest, size, numbers, most)
            return
        self._tasks += [partial(self._run_alone, int(i), cohort) for i in rest.indices]

    def _run_in_turn(self, cohort: Cohort, numbers: Numbers, most: int) -> None:
        """Run members one after the other; those that do not reach the end once more alone, to find out how far they go."""
        good = np.zeros(cohort.indices.size, dtype=bool)
        with _failing_functions():
            good = run_in_turn(self._prepared, cohort, numbers, most, self.results)
        self._count(int(good.sum()) * cohort.length)
        for i in cohort.indices[~good]:
            self._run_alone(int(i), cohort)

    def _lanes(self, grid: Grid | Course) -> tuple[Lanes, Numbers] | None:
        """Return the lanes for the members, and their numbers; None if members have to run alone."""
        prepared = self._prepared
        program = kernel_alone(prepared.system, prepared.chosen.method)
        compensated = prepared.settings.compensated
        if program is None or isinstance(grid, Course) or grid.wanted is not None or prepared.events:
            return None
        if fields_of(prepared.system, program, compensated) is None:
            return None
        numbers = prepared.numbers()
        if numbers is None:
            return None
        with compiling_announced(self._progress):
            return compile_lanes(prepared.system, program, compensated), numbers

    def _run_in_lanes(self, cohort: Cohort, lanes: Lanes, numbers: Numbers) -> None:
        """Run members in blocks; those that do not reach the end once more alone, to find out how far they go."""
        grid, indices = cohort.grid, cohort.indices
        assert isinstance(grid, Grid)
        x, v, params = (array[indices] for array in numbers)
        rows, results = grid.save_steps.size, self.results
        in_place = bool(indices[-1] - indices[0] == indices.size - 1)  # neighbours, whose rows lie beside each other
        xs, vs = (
            (kept[indices[0] : indices[-1] + 1] if in_place else np.empty((indices.size, rows, *kept.shape[2:])))
            for kept in (results.x, results.v)
        )
        flat = xs.reshape(indices.size, rows, x.shape[1]), vs.reshape(indices.size, rows, v.shape[1])
        blocks, step, chunk = lanes.blocks(x, v, params), 0, max(1, _FIRST_CHUNK // indices.size)
        good = np.zeros(indices.size, dtype=bool)
        with _failing_functions():
            while step < grid.n_steps and not self._stop.is_set():
                started, target = time.perf_counter(), min(step + chunk, grid.n_steps)
                blocks.advance(grid, step, target, *flat)
                chunk = next_chunk(target - step, time.perf_counter() - started)
                self._count((target - step) * indices.size)
                step = target
            good = blocks.good
        primed = sum(FLOWS[name].evaluations for name in lanes.program.primers)
        evaluations = np.full(indices.size, step * lanes.program.evaluations + primed)
        if not in_place:
            results.x[indices[good]], results.v[indices[good]] = xs[good], vs[good]
        results.note(indices[good], grid, step, blocks.saved, evaluations[good])
        for i in indices[~good]:
            self._run_alone(int(i), cohort, step)

    def _run_alone(self, i: int, cohort: Cohort, counted: int = 0) -> float:
        """Run a member by `kickdrift.solve`, some of whose steps are counted already; return the seconds in its loop."""
        if self._stop.is_set():
            return 0.0
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
                    step_control=settings.steering.control,
                    impacts=settings.steering.impacts,
                    switches=settings.steering.switches,
                    events=settings.events or None,
                    max_steps=settings.max_steps,
                    args=args,
                    compensated=settings.compensated,
                    compile=settings.compile and prepared.system.native,
                    check_bounds=settings.check_bounds,
                    progress=False,
                )
        except KickdriftError as error:
            results.status[i] = Outcome.FAILED
            results.messages[i] = f"It did not start. The error was {type(error).__name__}: {error}"
            results.done[i] = True
            return 0.0
        if isinstance(cohort.grid, Course):
            self._count(1)
        self._keep(i, solution, cohort.grid.t0)
        return solution.wall_time

    def _keep(self, i: int, solution: Solution, t0: float) -> None:
        results, t = self.results, self._prepared.t
        reached = np.ones(t.size, dtype=bool)
        if solution.status is not Outcome.COMPLETED:
            low, high = sorted((t0, float(solution.t[-1])))
            reached = (t >= low) & (t <= high)
        if not np.array_equal(solution.t[: int(reached.sum())], t[reached]):  # a function failed between two steps
            reached[:] = False
        results.x[i] = results.v[i] = np.nan
        count = int(reached.sum())
        results.x[i, reached], results.v[i, reached] = solution.x[:count], solution.v[:count]
        results.last[i] = Moments(*((getattr(solution, name)[count:],) for name in "txv"))
        results.rows[i], results.status[i] = t.size, solution.status
        results.messages[i] = solution.message
        results.step[i], results.n_steps[i] = solution.step, solution.n_steps
        results.step_range[i], results.rejected[i] = solution.step_range, solution.n_rejected
        results.evaluations[i] = solution.n_force_evaluations
        results.zeros[i] = Moments(solution.t_events, solution.x_events, solution.v_events)
        results.done[i] = solution.status is not Outcome.INTERRUPTED


@contextmanager
def _failing_functions() -> Iterator[None]:
    """Suppress exceptions of a function for one of many members, which a run of it alone will report; others are faults."""
    try:
        yield
    except Exception as error:
        if not (isinstance(error, KickdriftError) or raised_in_compiled_code(error)):
            raise


def _members_of_task(n_steps: int) -> int:
    return _rounded_up(max(1, _TASK // n_steps), LANES)


def _rounded_up(number: int, of: int = _VECTOR) -> int:
    return -(-number // of) * of

"""A run: the loop in chunks, with progress, interruption, and an end at the last good state."""

import sys
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.interruption import next_chunk
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.events import Watch, Zero
from kickdrift.engine.flows.layout import EVALUATIONS, FAILED_CONTROL, TROUBLE, estimated_errors
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.progress import Bar
from kickdrift.engine.rows import CourseRows, GridRows, Mark, Stretch
from kickdrift.engine.stepper import State, Stepper

Floats = NDArray[np.float64]
Failure = tuple[Outcome, str]  # and what there is to say about its cause
_LEAST_SHARE = 10  # of the time of a chunk over that of the copy after it


@dataclass(frozen=True)
class Checkpoint:
    """A state to go back to: the copy, the step after which it was made, and how far the rows were by then."""

    state: State
    step: int
    mark: Mark


@dataclass(frozen=True)
class Ending:
    """How a run ended: outcome and sentence, steps, rows filled, evaluations, seconds in the loop, estimated errors.

    And the zero of an event that ended it, the smallest and the largest step, and how many steps were tried.
    """

    outcome: Outcome
    message: str
    n_steps: int
    saved: int
    evaluations: int
    wall_time: float
    estimated: Floats | None
    stop: Zero | None
    step_range: tuple[float, float]
    trials: int


class Run:
    """The steps of a run, and the rows that are kept of them.

    Attributes
    ----------
    rows : GridRows or CourseRows
        The rows, filled as the run goes.
    """

    def __init__(
        self, stepper: Stepper, grid: Grid | Course, progress: bool | None = None, watch: Watch | None = None
    ) -> None:
        self._stepper, self._state, self._progress = stepper, stepper.state, progress
        self.rows = GridRows(stepper, grid) if isinstance(grid, Grid) else CourseRows(stepper, grid)
        self._watch, self._looked = watch, Stretch(np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0)))
        self._stop: Zero | None = None
        self._checkpoint = Checkpoint(self._state.copy(), 0, Mark())
        self._spare: State | None = None

    def go(self) -> Ending:
        """Run to the end of the grid, or as far as it goes; what was done is kept in any case."""
        started, outcome, cause = time.perf_counter(), Outcome.COMPLETED, ""
        bar = Bar(self.rows.progress(0)[1], self._progress)
        try:
            failure = self._begin() or self._do_chunks(bar, started)
            if failure is not None:
                outcome, cause = failure
        except KeyboardInterrupt:
            # It may have come in the middle of a chunk, or between its end and the note of it.
            outcome = Outcome.INTERRUPTED
        finally:
            bar.close()
        self._state.restore(self._checkpoint.state)
        return self._ending(outcome, cause, time.perf_counter() - started)

    def _begin(self) -> Failure | None:
        """Keep the start, which primers do not move."""
        mark = self.rows.begin()
        self._checkpoint = Checkpoint(self._checkpoint.state, 0, mark)
        if self._stepper.program.primers:
            try:
                self._stepper.prime()
            except Exception as error:
                return _raised(error)
            self._checkpoint = Checkpoint(self._state.copy(), 0, mark)
        return None

    def _do_chunks(self, bar: Bar, started: float) -> Failure | None:
        """Do the steps, in chunks that Ctrl-C waits for, each of which ends with a checkpoint."""
        chunk, most = 1, sys.maxsize if self._watch is None else self._watch.most
        while not self.rows.ended((good := self._checkpoint).step):
            chunk_started = time.perf_counter()
            target = self.rows.target(good.step + min(chunk, most))
            reached, mark, failure = self._attempt(target)
            if failure is not None:
                stopped = self._find_last_good(target)
                if stopped is not None:
                    return stopped
                _, _, repeated = self._attempt(self._checkpoint.step + 1)
                return repeated or failure  # a function may fail once and not again
            stopped = self._look()
            if stopped is not None:
                return stopped
            now = time.perf_counter()
            # Two copies in turns: an interruption while one is written finds the other. The last is the state itself.
            copy = self._state if self.rows.ended(reached) else self._state.copy(good.state, into=self._spare)
            self._checkpoint, self._spare = Checkpoint(copy, reached, mark), good.state
            copied = time.perf_counter()
            chunk = next_chunk(reached - good.step, now - chunk_started, _LEAST_SHARE * (copied - now))
            bar.show(self.rows.progress(reached)[0], copied - started)
        return None

    def _attempt(self, target: int) -> tuple[int, Mark, Failure | None]:
        """Run from the checkpoint, and return the step reached, how far the rows are, and what went wrong, if anything did."""
        step, mark = self._checkpoint.step, self._checkpoint.mark
        try:
            if self._watch is None:
                reached, mark = self.rows.advance(step, target, mark)
            else:
                reached, mark, self._looked = self.rows.advance_watched(step, target, mark)
        except Exception as error:
            return step, mark, _raised(error)
        residual = self._state.work[TROUBLE]
        if residual == FAILED_CONTROL:
            return reached, mark, (Outcome.STEP_TOO_SMALL, "")
        if residual != 0.0:
            why = "." if np.isfinite(residual) else ": a function gave no finite number, or the iteration ran away."
            return reached, mark, (Outcome.NOT_CONVERGED, f" The residual was {residual:.3g}{why}")
        if not self._state.finite:
            return reached, mark, (Outcome.NOT_FINITE, "")
        return reached, mark, None

    def _look(self) -> Failure | None:
        """Look for events after the checkpoint; where one ends the run, make the last step before it the checkpoint."""
        if self._watch is None:
            return None
        first = self._checkpoint.step
        try:
            found = self._watch.look(*self._looked)
        except Exception as error:  # of the force, which may fail between steps and not at their ends
            return _raised(error)
        if found.stop is None and not found.failure:
            return None
        self._state.restore(self._checkpoint.state)
        _, mark, _ = self._attempt(first + found.steps)
        self._checkpoint, self._stop = Checkpoint(self._state.copy(), first + found.steps, mark), found.stop
        if found.stop is None:
            return Outcome.FAILED, found.failure
        return Outcome.STOPPED, f" There, {self._watch.events[found.stop.event].name}, is zero."

    def _find_last_good(self, bad: int) -> Failure | None:
        """Find the last good state by halves: what is not finite stays so, and every rerun gives the same bits."""
        while bad - self._checkpoint.step > 1:
            middle = (self._checkpoint.step + bad) // 2
            self._state.restore(self._checkpoint.state)
            reached, mark, failure = self._attempt(middle)
            if failure is not None:
                bad = middle
                continue
            stopped = self._look()
            if stopped is not None:
                return stopped
            self._checkpoint = Checkpoint(self._state.copy(self._checkpoint.state), reached, mark)
        self._state.restore(self._checkpoint.state)
        return None

    def _ending(self, outcome: Outcome, cause: str, wall_time: float) -> Ending:
        good, program, message = self._checkpoint, self._stepper.program, outcome.value
        saved = self.rows.keep_last(good.state, good.step, good.mark, self._stop is not None)
        if outcome is not Outcome.COMPLETED:
            t = self.rows.time(good.step) if self._stop is None else self._stop.t
            message += f" It ends at t={t!r}, after {self.rows.steps_of(good.step)}.{cause}"
        if outcome in (Outcome.NOT_FINITE, Outcome.NOT_CONVERGED):
            message += " Try a smaller step."
        evaluations = good.mark.trials * program.evaluations
        evaluations += sum(FLOWS[name].evaluations for name in program.primers) + int(self._state.work[EVALUATIONS])
        work, size = self._state.work, self._state.x.size
        estimated = estimated_errors(size, work).copy() if self._stepper.estimates else None
        return Ending(
            outcome,
            message,
            good.step,
            saved,
            evaluations,
            wall_time,
            estimated,
            self._stop,
            self.rows.step_range(self._state),
            good.mark.trials,
        )


def _raised(error: Exception) -> Failure:
    return Outcome.FAILED, f" The error was {type(error).__name__}: {error}."

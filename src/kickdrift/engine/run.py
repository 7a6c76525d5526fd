"""A run: the loop in chunks, with progress, interruption, and an end at the last good state."""

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.interruption import next_chunk
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.events import Watch, Zero
from kickdrift.engine.flows.layout import EVALUATIONS, TROUBLE, estimated_errors
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Grid
from kickdrift.engine.progress import Bar
from kickdrift.engine.stepper import State, Stepper

Floats = NDArray[np.float64]
Failure = tuple[Outcome, str]  # and what there is to say about its cause
_LEAST_SHARE = 10  # of the time of a chunk over that of the copy after it


@dataclass(frozen=True)
class Checkpoint:
    """A state to go back to: the copy, the step after which it was made, and the rows filled by then."""

    state: State
    step: int
    saved: int


@dataclass(frozen=True)
class Ending:
    """How a run ended: outcome and sentence, steps, rows filled, evaluations, seconds in the loop, estimated errors.

    And the zero of an event that ended it.
    """

    outcome: Outcome
    message: str
    n_steps: int
    saved: int
    evaluations: int
    wall_time: float
    estimated: Floats | None
    stop: Zero | None = None


class Run:
    """The steps of a grid, and the rows that are kept of them.

    Attributes
    ----------
    xs, vs : (T, n) array
        The rows, filled as the run goes; one more than the grid's if the run ends early between two of them.
    """

    def __init__(self, stepper: Stepper, grid: Grid, progress: bool | None = None, watch: Watch | None = None) -> None:
        self._stepper, self._state, self._grid, self._progress = stepper, stepper.state, grid, progress
        self._watch, self._most = watch, grid.n_steps if watch is None else watch.most
        self._stop: Zero | None = None
        rows = grid.save_steps.size + 1
        self.xs, self.vs = np.empty((rows, self._state.x.size)), np.empty((rows, self._state.v.size))
        self._checkpoint = Checkpoint(self._state.copy(), 0, 0)
        self._spare: State | None = None

    def go(self) -> Ending:
        """Run to the end of the grid, or as far as it goes; what was done is kept in any case."""
        started, outcome, cause = time.perf_counter(), Outcome.COMPLETED, ""
        bar = Bar(self._grid.n_steps, self._progress)
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
        return self._ending(outcome, cause, self._keep_last(), time.perf_counter() - started)

    def _begin(self) -> Failure | None:
        """Keep the start, which primers do not move."""
        if starts := self._grid.save_steps[0] == 0:
            self.xs[0], self.vs[0] = self._state.x, self._state.v
        self._checkpoint = Checkpoint(self._checkpoint.state, 0, int(starts))
        if self._stepper.program.primers:
            try:
                self._stepper.prime()
            except Exception as error:
                return _raised(error)
            self._checkpoint = Checkpoint(self._state.copy(), 0, int(starts))
        return None

    def _do_chunks(self, bar: Bar, started: float) -> Failure | None:
        """Do the steps, in chunks that Ctrl-C waits for, each of which ends with a checkpoint."""
        chunk, n_steps = 1, self._grid.n_steps
        while (good := self._checkpoint).step < n_steps:
            chunk_started = time.perf_counter()
            target = min(good.step + min(chunk, self._most), n_steps)
            saved, failure = self._attempt(target)
            if failure is not None:
                stopped = self._find_last_good(target)
                if stopped is not None:
                    return stopped
                _, repeated = self._attempt(self._checkpoint.step + 1)
                return repeated or failure  # a function may fail once and not again
            stopped = self._look(target)
            if stopped is not None:
                return stopped
            reached = time.perf_counter()
            # Two copies in turns: an interruption while one is written finds the other. The last is the state itself.
            copy = self._state if target == n_steps else self._state.copy(good.state, into=self._spare)
            self._checkpoint, self._spare = Checkpoint(copy, target, saved), good.state
            now = time.perf_counter()
            chunk = next_chunk(target - good.step, reached - chunk_started, _LEAST_SHARE * (now - reached))
            bar.show(target, now - started)
        return None

    def _attempt(self, target: int) -> tuple[int, Failure | None]:
        """Run from the checkpoint, and say how many rows are filled and what went wrong, if anything did."""
        step, saved = self._checkpoint.step, self._checkpoint.saved
        try:
            reached, saved = self._advance(step, target, saved)
        except Exception as error:
            return saved, _raised(error)
        if reached < target:
            residual = self._state.work[TROUBLE]
            why = "." if np.isfinite(residual) else ": a function gave no finite number, or the iteration ran away."
            return saved, (Outcome.NOT_CONVERGED, f" The residual was {residual:.3g}{why}")
        if not self._state.finite:
            return saved, (Outcome.NOT_FINITE, "")
        return saved, None

    def _advance(self, step: int, target: int, saved: int) -> tuple[int, int]:
        """Do steps and keep rows, those that events want to look at in an array of their own."""
        if self._watch is None:
            return self._stepper.advance(step, target, self._grid.save_steps, saved, self.xs, self.vs)
        every = np.arange(step + 1, target + 1)
        xs, vs = self._watch.rows(every.size, self._state.x.size, self._state.v.size)
        reached, _ = self._stepper.advance(step, target, every, 0, xs, vs)
        until = int(np.searchsorted(self._grid.save_steps, reached, side="right"))
        wanted = self._grid.save_steps[saved:until] - step - 1
        self.xs[saved:until], self.vs[saved:until] = xs[wanted], vs[wanted]
        return reached, until

    def _look(self, target: int) -> Failure | None:
        """Look for events after the checkpoint; where one ends the run, make the last step before it the checkpoint."""
        if self._watch is None:
            return None
        first = self._checkpoint.step
        try:
            found = self._watch.look(first, target - first)
        except Exception as error:  # of the force, which may fail between steps and not at their ends
            return _raised(error)
        if found.stop is None and not found.failure:
            return None
        self._state.restore(self._checkpoint.state)
        saved, _ = self._attempt(first + found.steps)
        self._checkpoint, self._stop = Checkpoint(self._state.copy(), first + found.steps, saved), found.stop
        if found.stop is None:
            return Outcome.FAILED, found.failure
        return Outcome.STOPPED, f" There, {self._watch.events[found.stop.event].name}, is zero."

    def _find_last_good(self, bad: int) -> Failure | None:
        """Find the last good state by halves: what is not finite stays so, and every rerun gives the same bits."""
        while bad - self._checkpoint.step > 1:
            middle = (self._checkpoint.step + bad) // 2
            self._state.restore(self._checkpoint.state)
            saved, failure = self._attempt(middle)
            if failure is not None:
                bad = middle
                continue
            stopped = self._look(middle)
            if stopped is not None:
                return stopped
            self._checkpoint = Checkpoint(self._state.copy(self._checkpoint.state), middle, saved)
        self._state.restore(self._checkpoint.state)
        return None

    def _keep_last(self) -> int:
        """Add the state reached as a last row, if the run ended between two rows of the grid; return how many there are."""
        save_steps, good = self._grid.save_steps, self._checkpoint
        ends_on_a_row = good.step == self._grid.n_steps or self._stop is not None
        if ends_on_a_row or (good.saved > 0 and save_steps[good.saved - 1] == good.step):
            return good.saved
        self.xs[good.saved], self.vs[good.saved] = good.state.x, good.state.v
        return good.saved + 1

    def _ending(self, outcome: Outcome, cause: str, saved: int, wall_time: float) -> Ending:
        step, grid, program, message = self._checkpoint.step, self._grid, self._stepper.program, outcome.value
        if outcome is not Outcome.COMPLETED:
            t = grid.t0 + step * grid.step if self._stop is None else self._stop.t
            message += f" It ends at t={t!r}, after {step} of {grid.n_steps} steps.{cause}"
        if outcome in (Outcome.NOT_FINITE, Outcome.NOT_CONVERGED):
            message += " Try a smaller step."
        evaluations = step * program.evaluations + sum(FLOWS[name].evaluations for name in program.primers)
        evaluations += int(self._state.work[EVALUATIONS])
        work, size = self._state.work, self._state.x.size
        estimated = estimated_errors(size, work).copy() if self._stepper.estimates else None
        return Ending(outcome, message, step, saved, evaluations, wall_time, estimated, self._stop)


def _raised(error: Exception) -> Failure:
    return Outcome.FAILED, f" The error was {type(error).__name__}: {error}."

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
class Reached:
    """A state of the loop, and the step after which it was that."""

    state: State
    step: int


@dataclass(frozen=True)
class Leg:
    """A part of a run: where it begins, None for the start, the step at which it ends, and the rows kept on the way.

    Of `xs` and `vs` there is a row more than there are `save_steps`, for a run that ends early between two of them.
    """

    begin: Reached | None
    until: int
    save_steps: NDArray[np.int64]
    xs: Floats
    vs: Floats


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
    """The steps of a leg over a grid, and the rows that are kept of them.

    Attributes
    ----------
    checkpoint : Checkpoint
        The last good state.
    """

    def __init__(self, stepper: Stepper, grid: Grid, leg: Leg, watch: Watch | None = None) -> None:
        self._stepper, self._state, self._grid, self._leg = stepper, stepper.state, grid, leg
        self._watch, self._most = watch, grid.n_steps if watch is None else watch.most
        self._stop: Zero | None = None
        if leg.begin is not None:
            self._state.restore(leg.begin.state)
        self.checkpoint = Checkpoint(self._state.copy(), 0 if leg.begin is None else leg.begin.step, 0)
        self._spare: State | None = None

    def go(self, bar: Bar, started: float) -> Ending:
        """Go to the end of the leg, or as far as it goes; what was done is kept in any case.

        The bar shows how far the run is that `started` then.
        """
        began, outcome, cause = time.perf_counter(), Outcome.COMPLETED, ""
        try:
            failure = self._begin() or self._do_chunks(bar, started)
            if failure is not None:
                outcome, cause = failure
        except KeyboardInterrupt:
            # It may have come in the middle of a chunk, or between its end and the note of it.
            outcome = Outcome.INTERRUPTED
        self._state.restore(self.checkpoint.state)
        return self._ending(outcome, cause, self._keep_last(), time.perf_counter() - began)

    def _begin(self) -> Failure | None:
        """Keep the start, which primers do not move."""
        if self._leg.begin is not None:
            return None
        if starts := bool(self._leg.save_steps.size and self._leg.save_steps[0] == 0):
            self._leg.xs[0], self._leg.vs[0] = self._state.x, self._state.v
        self.checkpoint = Checkpoint(self.checkpoint.state, 0, int(starts))
        if self._stepper.program.primers:
            try:
                self._stepper.prime()
            except Exception as error:
                return _raised(error)
            self.checkpoint = Checkpoint(self._state.copy(), 0, int(starts))
        return None

    def _do_chunks(self, bar: Bar, started: float) -> Failure | None:
        """Do the steps, in chunks that Ctrl-C waits for, each of which ends with a checkpoint."""
        chunk, until = 1, self._leg.until
        while (good := self.checkpoint).step < until:
            chunk_started = time.perf_counter()
            target = min(good.step + min(chunk, self._most), until)
            saved, failure = self._attempt(target)
            if failure is not None:
                stopped = self._find_last_good(target)
                if stopped is not None:
                    return stopped
                _, repeated = self._attempt(self.checkpoint.step + 1)
                return repeated or failure  # a function may fail once and not again
            stopped = self._look(target)
            if stopped is not None:
                return stopped
            reached = time.perf_counter()
            # Two copies in turns: an interruption while one is written finds the other. The last is the state itself.
            copy = self._state if target == until else self._state.copy(good.state, into=self._spare)
            self.checkpoint, self._spare = Checkpoint(copy, target, saved), good.state
            now = time.perf_counter()
            chunk = next_chunk(target - good.step, reached - chunk_started, _LEAST_SHARE * (now - reached))
            bar.show(target, now - started)
        return None

    def _attempt(self, target: int) -> tuple[int, Failure | None]:
        """Run from the checkpoint, and say how many rows are filled and what went wrong, if anything did."""
        step, saved = self.checkpoint.step, self.checkpoint.saved
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
            return self._stepper.advance(step, target, self._leg.save_steps, saved, self._leg.xs, self._leg.vs)
        every = np.arange(step + 1, target + 1)
        xs, vs = self._watch.rows(every.size, self._state.x.size, self._state.v.size)
        reached, _ = self._stepper.advance(step, target, every, 0, xs, vs)
        until = int(np.searchsorted(self._leg.save_steps, reached, side="right"))
        wanted = self._leg.save_steps[saved:until] - step - 1
        self._leg.xs[saved:until], self._leg.vs[saved:until] = xs[wanted], vs[wanted]
        return reached, until

    def _look(self, target: int) -> Failure | None:
        """Look for events after the checkpoint; where one ends the run, make the last step before it the checkpoint."""
        if self._watch is None:
            return None
        first = self.checkpoint.step
        try:
            found = self._watch.look(first, target - first)
        except Exception as error:  # of the force, which may fail between steps and not at their ends
            return _raised(error)
        if found.stop is None and not found.failure:
            return None
        self._state.restore(self.checkpoint.state)
        saved, _ = self._attempt(first + found.steps)
        self.checkpoint, self._stop = Checkpoint(self._state.copy(), first + found.steps, saved), found.stop
        if found.stop is None:
            return Outcome.FAILED, found.failure
        return Outcome.STOPPED, f" There, {self._watch.events[found.stop.event].name}, is zero."

    def _find_last_good(self, bad: int) -> Failure | None:
        """Find the last good state by halves: what is not finite stays so, and every rerun gives the same bits."""
        while bad - self.checkpoint.step > 1:
            middle = (self.checkpoint.step + bad) // 2
            self._state.restore(self.checkpoint.state)
            saved, failure = self._attempt(middle)
            if failure is not None:
                bad = middle
                continue
            stopped = self._look(middle)
            if stopped is not None:
                return stopped
            self.checkpoint = Checkpoint(self._state.copy(self.checkpoint.state), middle, saved)
        self._state.restore(self.checkpoint.state)
        return None

    def _keep_last(self) -> int:
        """Add the state reached as a last row, if the run ended between two rows of the grid; return how many there are."""
        save_steps, good = self._leg.save_steps, self.checkpoint
        ends_on_a_row = good.step == self._leg.until or self._stop is not None
        if ends_on_a_row or (good.saved > 0 and save_steps[good.saved - 1] == good.step):
            return good.saved
        self._leg.xs[good.saved], self._leg.vs[good.saved] = good.state.x, good.state.v
        return good.saved + 1

    def _ending(self, outcome: Outcome, cause: str, saved: int, wall_time: float) -> Ending:
        step, program = self.checkpoint.step, self._stepper.program
        message = sentence(outcome, cause, step, self._grid, None if self._stop is None else self._stop.t)
        evaluations = step * program.evaluations + sum(FLOWS[name].evaluations for name in program.primers)
        evaluations += int(self._state.work[EVALUATIONS])
        work, size = self._state.work, self._state.x.size
        estimated = estimated_errors(size, work).copy() if self._stepper.estimates else None
        return Ending(outcome, message, step, saved, evaluations, wall_time, estimated, self._stop)


def sentence(outcome: Outcome, cause: str, step: int, grid: Grid, t: float | None = None) -> str:
    """Say how a run ended, after which step, and at what time if it is not that of the step."""
    if outcome is Outcome.COMPLETED:
        return str(outcome.value)
    at = grid.t0 + step * grid.step if t is None else t
    message: str = f"{outcome.value} It ends at t={at!r}, after {step} of {grid.n_steps} steps.{cause}"
    if outcome in (Outcome.NOT_FINITE, Outcome.NOT_CONVERGED):
        message += " Try a smaller step."
    return message


def _raised(error: Exception) -> Failure:
    return Outcome.FAILED, f" The error was {type(error).__name__}: {error}."

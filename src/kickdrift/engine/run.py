"""A run: the loop in chunks, with progress, interruption, and an end at the last good state."""

import sys
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.interruption import next_chunk
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.events import Watch
from kickdrift.engine.flows.layout import EVALUATIONS, FAILED_CONTROL, TAKEN_BACK, TROUBLE, estimated_errors
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Course
from kickdrift.engine.no_step import NO_STEP
from kickdrift.engine.progress import Bar
from kickdrift.engine.rows import Mark, Rows, Stretch
from kickdrift.engine.standing import Standing
from kickdrift.engine.stepper import State, Stepper
from kickdrift.engine.streaming import StreamedRows
from kickdrift.engine.zeros import Zero

Floats = NDArray[np.float64]
Failure = tuple[Outcome, str]  # and a sentence on its cause
_NOTHING = Stretch(np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0)))
_LEAST_SHARE = 10  # of the time of a chunk over that of the copy after it


class Checkpoint(NamedTuple):
    """A state to go back to: the copy, the step after which it was made, and how far the rows were by then."""

    state: State
    step: int
    mark: Mark


class Ending(NamedTuple):
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
    rows : Rows
        The rows, filled as the run goes.
    """

    def __init__(self, stepper: Stepper, rows: Rows, watch: Watch | None = None) -> None:
        self._stepper, self._state, self.rows = stepper, stepper.state, rows
        self._watch, self._looked = watch, _NOTHING
        self._stop: Zero | None = None
        self._checkpoint = Checkpoint(self._state.copy(), 0, Mark())
        self._spare: State | None = None
        self._begun, self._seconds = False, 0.0
        self._last = rows.grid.most if isinstance(rows.grid, Course) else sys.maxsize  # step that this run may reach

    @property
    def step(self) -> int:
        """How many steps are done."""
        return self._checkpoint.step

    @property
    def ended(self) -> bool:
        """Whether the end of the grid is reached."""
        return self.rows.ended(self.step)

    def go_on(self, standing: Standing) -> None:
        """Begin where another run of the same task stands."""
        self._state.restore(standing.state)
        mark = self.rows.go_on(standing.rows, standing.step, standing.mark)
        self._checkpoint = Checkpoint(self._state.copy(), standing.step, mark)
        self._begun, self._seconds = True, standing.wall_time
        self._last += standing.step
        if self._watch is not None and standing.seen is not None:
            t = self.rows.time(standing.step)
            self._watch.go_on(standing.seen, self.rows.grid.step, t, self._state.x.copy(), self._state.v.copy())

    def repeat(self, steps: int) -> None:
        """Count these first steps, which an earlier run has done, as no steps of this one."""
        self._last += steps

    def standing(self, beyond_the_stop: bool = False) -> Standing:
        """Return the state of the run, not a copy, and whether the event that ended it, if one did, is not to end it again."""
        good, seen = self._checkpoint, None
        if self._watch is not None:
            beyond = self._stop.t if beyond_the_stop and self._stop is not None else None
            seen = self._watch.seen(self.rows.time(good.step), beyond)
        return Standing(
            self._state.at_rest(), good.step, good.mark, self.rows.kept(good.step, good.mark), self._seconds, seen
        )

    def drain(self, rows: StreamedRows) -> None:
        """Write rows to disk, once they are a whole chunk."""
        rows.drain(self._checkpoint.mark)

    def close(self, rows: StreamedRows, outcome: Outcome) -> None:
        """Write all rows to disk, and how the run ended."""
        good = self._checkpoint
        rows.close(good.step, good.mark, good.state, self._stop, outcome.name)

    def go(self, bar: Bar, started: float, until: int = sys.maxsize) -> Failure | None:
        """Run to the end of the grid or up to a step, or as far as possible, and return what ended it earlier.

        The states reached are kept in any case. The bar shows the progress of the run since `started`.
        """
        began, failure = time.perf_counter(), None
        try:
            with np.errstate(all="ignore"):  # states that are not finite are an outcome, as in compiled code
                failure = self._begin() or self._do_chunks(bar, started, until)
        except KeyboardInterrupt:
            # It may have come in the middle of a chunk, or between its end and the note of it.
            failure = Outcome.INTERRUPTED, ""
        self._state.restore(self._checkpoint.state)
        self._seconds += time.perf_counter() - began
        return failure

    def _begin(self) -> Failure | None:
        """Keep the start, which primers do not move."""
        if self._begun:
            return None
        mark = self.rows.begin()
        self._checkpoint = Checkpoint(self._checkpoint.state, 0, mark)
        if self._stepper.program.primers:
            try:
                self._stepper.prime()
            except Exception as error:
                return _raised(error)
            self._checkpoint = Checkpoint(self._state.copy(), 0, mark)
        self._begun = True
        return None

    def _do_chunks(self, bar: Bar, started: float, until: int) -> Failure | None:
        """Do the steps, in chunks that Ctrl-C waits for, each of which ends with a checkpoint."""
        chunk, most, last = 1, sys.maxsize if self._watch is None else self._watch.most, min(until, self._last)
        while (good := self._checkpoint).step < until and not self.rows.ended(good.step):
            if good.step == self._last:
                return Outcome.STEP_LIMIT, " Give a larger max_steps."
            chunk_started = time.perf_counter()
            target = self.rows.target(min(good.step + min(chunk, most), last))
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
            now = copied = time.perf_counter()
            if self.rows.ended(reached):  # the last checkpoint is the state itself
                self._checkpoint = Checkpoint(self._state, reached, mark)
            else:  # two copies in turns: an interruption while one is written finds the other
                copy = self._state.copy(good.state, into=self._spare)
                self._checkpoint, self._spare = Checkpoint(copy, reached, mark), good.state
                copied = time.perf_counter()
                chunk = next_chunk(reached - good.step, now - chunk_started, _LEAST_SHARE * (copied - now))
            bar.show(self.rows.progress(reached)[0], copied - started)
            self._seconds -= time.perf_counter() - copied  # a widget of a notebook takes 0.1 s to open
        return None

    def _attempt(self, target: int) -> tuple[int, Mark, Failure | None]:
        """Run from the checkpoint, and return the step reached, the progress of the rows, and the failure, if there was one."""
        step, mark = self._checkpoint.step, self._checkpoint.mark
        try:
            if self._watch is None:
                reached, mark = self.rows.advance(step, target, mark)
            else:
                reached, mark, self._looked = self.rows.advance_watched(step, target, mark)
        except Exception as error:
            return step, mark, _raised(error)
        residual = self._state.work[TROUBLE]
        if residual != 0.0:
            if residual in NO_STEP:
                return reached, mark, (Outcome.NO_STEP, NO_STEP[residual])
            why = (
                "."
                if np.isfinite(residual)
                else ": a function returned a value that is not finite, or the iteration diverged."
            )
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
        return Outcome.STOPPED, is_zero(self._watch.events[found.stop.event].name, found.jumps)

    def _find_last_good(self, bad: int) -> Failure | None:
        """Find the last good state by bisection: states stay not finite once they are, and every rerun gives the same bits."""
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

    def ending(self, outcome: Outcome, cause: str) -> Ending:
        """Return the outcome of the run, and keep the state reached as a row."""
        good, program, work = self._checkpoint, self._stepper.program, self._state.work
        saved = self.rows.keep_last(good.state, good.step, good.mark, self._stop is not None)
        message = outcome.value if outcome is Outcome.COMPLETED else self._ended_early(outcome, cause)
        evaluations = good.mark.trials * program.evaluations + int(work[EVALUATIONS])
        evaluations += sum([FLOWS[name].evaluations for name in program.primers])
        estimated = estimated_errors(self._state.x.size, work).copy() if self._stepper.estimates else None
        return Ending(
            outcome,
            message,
            good.step,
            saved,
            evaluations,
            self._seconds,
            estimated,
            self._stop,
            self.rows.step_range(self._state),
            good.mark.trials + int(work[TAKEN_BACK]),
        )

    def _ended_early(self, outcome: Outcome, cause: str) -> str:
        """Tell how the run ended before the end of its span, and what may help."""
        step = self._checkpoint.step
        t = self.rows.time(step) if self._stop is None else self._stop.t
        message = ended_early(outcome, t, self.rows.steps_of(step), cause)
        if outcome in (Outcome.NOT_FINITE, Outcome.NOT_CONVERGED) or cause == NO_STEP[FAILED_CONTROL]:
            equal = outcome is Outcome.NOT_CONVERGED and not isinstance(self.rows.grid, Course)
            message += f" Try a smaller step{'; where the force jumps, give switches' if equal else ''}."
        return message


def ended_early(outcome: Outcome, t: float, steps: str, cause: str = "") -> str:
    """Tell how a run ended before the end of its span."""
    return f"{outcome.value} It ends at t={t!r}, after {steps}.{cause}"


def is_zero(event: str, jumps: bool = False) -> str:
    """Tell which event ended a run."""
    return f" There, {event}, {'changes its sign in an impact' if jumps else 'is zero'}."


def _raised(error: Exception) -> Failure:
    return Outcome.FAILED, f" The error was {type(error).__name__}: {error}."

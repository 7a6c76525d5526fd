"""A run: the loop in chunks, with progress, interruption, and an end at the last good state."""

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import address_of
from kickdrift.core.heap import keep_freed_memory
from kickdrift.core.memory import state_block
from kickdrift.core.outcomes import Outcome
from kickdrift.engine import letters, loop
from kickdrift.engine.flows.layout import EVALUATIONS, FORMED, TROUBLE, estimated_errors, lay_out
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Grid
from kickdrift.engine.program import Program
from kickdrift.engine.progress import Bar
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
Failure = tuple[Outcome, str]  # and what there is to say about its cause
_LARGE = 100  # numbers of a state whose pairs fill what the C library thinks large
_CHUNK_SECONDS = 0.1  # how long Ctrl-C waits
_LEAST_SHARE = 10  # of the time of a chunk over that of the copy after it
_NEVER = np.zeros(0, dtype=np.int64)  # the steps after which rows are kept: none


@dataclass
class State:
    """Position, velocity, and what the flows keep beside them; of a copy, the scratch is empty if nothing is kept there."""

    x: Floats
    v: Floats
    work: Floats
    scratch: Floats

    def copy(self, last: "State | None" = None, into: "State | None" = None) -> "State":
        """Copy all, into another state if there is one; the scratch only if it changed since the `last` copy."""
        if into is not None:
            into.scratch = np.zeros(0)  # which may be a matrix: one less at a time
        if last is not None and last.work[FORMED] == self.work[FORMED]:
            scratch = last.scratch
        else:
            scratch = self.scratch.copy() if self.work[FORMED] else np.zeros(0)
        if into is None:
            return State(self.x.copy(), self.v.copy(), self.work.copy(), scratch)
        into.x[:], into.v[:], into.work[:], into.scratch = self.x, self.v, self.work, scratch
        return into

    def restore(self, other: "State") -> None:
        """Go back to a copy, in place."""
        if other is self:
            return
        if self.work[FORMED] != other.work[FORMED]:
            self.scratch[: other.scratch.size] = other.scratch
        self.x[:], self.v[:], self.work[:] = other.x, other.v, other.work

    @property
    def finite(self) -> bool:
        """Whether every number is."""
        return bool(np.isfinite(self.x).all() and np.isfinite(self.v).all())


@dataclass(frozen=True)
class Good:
    """A state worth keeping: the copy, the step after which it was made, and the rows filled by then."""

    state: State
    step: int
    saved: int


@dataclass(frozen=True)
class Ending:
    """How a run ended: outcome and sentence, steps, rows filled, evaluations, seconds in the loop, estimated errors."""

    outcome: Outcome
    message: str
    n_steps: int
    saved: int
    evaluations: int
    wall_time: float
    estimated: Floats | None


class Run:
    """A system, a program and a grid, made ready: everything compiled, rows allocated.

    Attributes
    ----------
    xs, vs : (T, n) array
        The rows, filled as the run goes; one more than the grid's if the run ends early between two of them.
    """

    def __init__(
        self, system: System, program: Program, grid: Grid, compensated: bool, progress: bool | None = None
    ) -> None:
        self.system, self.program, self.grid = system, program, grid
        self._progress = progress
        self.state = State(system.x0.reshape(-1).copy(), system.v0.reshape(-1).copy(), np.zeros(0), np.zeros(0))
        rows = grid.save_steps.size + 1
        self.xs, self.vs = np.empty((rows, self.state.x.size)), np.empty((rows, self.state.v.size))
        names = program.flows + program.primers
        self._make_ready(names, compensated)

    def _make_ready(self, names: tuple[str, ...], compensated: bool) -> None:
        """Build the letters, and compile or load everything that the run needs."""
        system, program, state = self.system, self.program, self.state
        functions = letters.functions_of(system, program)
        addresses = letters.addresses_of(system, functions, names) if system.native else dict.fromkeys(functions, 1)
        n = state.x.size
        memory_size = max(FLOWS[name].memory(n, program.coefficients, system.params) for name in names)
        self._estimates = any(FLOWS[name].estimates for name in names)
        memory_size += n * self._estimates
        scratch_size = max(FLOWS[name].scratch(n, program.coefficients, system.params) for name in names)
        state.scratch = np.zeros(scratch_size)
        state.work = lay_out(n, program.coefficients, memory_size, addresses, state.scratch)
        members = (state.x, state.v, system.params, state.work)
        self._blank: Floats | None = None
        self._letters = [letters.build(name, system, program, compensated, state.scratch) for name in names]
        self._advance: Any = loop.advance_interpreted
        self._flows: Any = self._letters
        self._address: Any = members
        if system.native:
            if n > _LARGE:
                keep_freed_memory()
            self._advance = loop.advance
            self._flows = np.array([address_of(letter, loop.LETTER) for letter in self._letters])
            self._block = state_block(*members)
            self._address = self._block.ctypes.data
        self._run(0, 0, 0)

    def _run(self, first: int, last: int, saved: int) -> tuple[int, int]:
        program, grid = self.program, self.grid
        word = (program.letters, program.weights, program.offsets)
        return self._advanced(word, grid.step, first, last, grid.save_steps, saved)

    def _advanced(
        self,
        word: tuple[NDArray[np.int64], Floats, Floats],
        h: float,
        first: int,
        last: int,
        save_steps: NDArray[np.int64],
        saved: int,
    ) -> tuple[int, int]:
        state = self.state
        return self._advance(  # type: ignore[no-any-return]
            self._flows,
            *word,
            self.grid.t0,
            h,
            first,
            last,
            self._address,
            state.x,
            state.v,
            state.work,
            save_steps,
            saved,
            self.xs,
            self.vs,
        )

    def change(self, steps: NDArray[np.int64], xs: Floats, vs: Floats) -> None:
        """Do a step, of the number given, from each of the rows and overwrite it; nothing is carried over."""
        program, grid, state = self.program, self.grid, self.state
        if self._blank is None:
            self._blank = state.work.copy()
        change = loop.change if self.system.native else loop.change_interpreted
        with np.errstate(all="ignore"):
            change(
                self._flows,
                program.letters,
                program.weights,
                program.offsets,
                grid.t0,
                grid.step,
                steps,
                self._address,
                state.x,
                state.v,
                state.work,
                self._blank,
                xs,
                vs,
            )

    def _prime(self) -> Failure | None:
        """Make ready what the first step finds as the step before would have left it."""
        primers = np.arange(len(self.program.flows), len(self._letters))
        nothing = np.zeros(primers.size)
        try:
            with np.errstate(all="ignore"):
                self._advanced((primers, nothing, nothing), 0.0, 0, 1, _NEVER, 0)
        except Exception as error:
            return Outcome.FAILED, f" The error was {type(error).__name__}: {error}."
        return None

    def go(self) -> Ending:
        """Run to the end of the grid, or as far as it goes; what was done is kept in any case."""
        grid, state = self.grid, self.state
        started = time.perf_counter()
        good, spare = Good(state.copy(), 0, 0), None
        outcome, cause = Outcome.COMPLETED, ""
        bar = Bar(grid.n_steps, self._progress)
        chunk = 1
        try:
            failure = self._prime()
            if grid.save_steps[0] == 0:
                self.xs[0], self.vs[0] = state.x, state.v
            if self.program.primers:
                good = Good(state.copy(), 0, 0)
            good = replace(good, saved=int(grid.save_steps[0] == 0))
            while failure is None and good.step < grid.n_steps:
                chunk_started = time.perf_counter()
                target = min(good.step + chunk, grid.n_steps)
                saved, failure = self._attempt(good, target)
                if failure is not None:
                    good = self._last_good(good, target)
                    _, repeated = self._attempt(good, good.step + 1)
                    failure = repeated or failure  # a function may fail once and not again
                    break
                reached = time.perf_counter()
                # Two copies in turns: an interruption while one is written finds the other. The last is the state itself.
                last = good.state
                copy = state if target == grid.n_steps else state.copy(last, into=spare)
                good, spare = Good(copy, target, saved), last
                now = time.perf_counter()
                wanted = max(_CHUNK_SECONDS, _LEAST_SHARE * (now - reached))
                chunk = max(1, min(10 * chunk, int(chunk * wanted / max(reached - chunk_started, 1e-9))))
                bar.show(target, now - started)
            if failure is not None:
                outcome, cause = failure
        except KeyboardInterrupt:
            # It may have come in the middle of a chunk, or between its end and the note of it.
            outcome = Outcome.INTERRUPTED
        finally:
            bar.close()
        state.restore(good.state)
        return self._ending(outcome, cause, good.step, self._keep_last(good), time.perf_counter() - started)

    def _attempt(self, good: Good, target: int) -> tuple[int, Failure | None]:
        """Run from a good state, and say how many rows are filled and what went wrong, if anything did."""
        try:
            with np.errstate(all="ignore"):  # what is not finite is an outcome, interpreted as compiled
                reached, saved = self._run(good.step, target, good.saved)
        except Exception as error:
            return good.saved, (Outcome.FAILED, f" The error was {type(error).__name__}: {error}.")
        if reached < target:
            residual = self.state.work[TROUBLE]
            why = "." if np.isfinite(residual) else ": a function gave no finite number, or the iteration ran away."
            return saved, (Outcome.NOT_CONVERGED, f" The residual was {residual:.3g}{why}")
        if not self.state.finite:
            return saved, (Outcome.NOT_FINITE, "")
        return saved, None

    def _last_good(self, good: Good, bad: int) -> Good:
        """Find the last good state by halves: what is not finite stays so, and every rerun gives the same bits."""
        while bad - good.step > 1:
            middle = (good.step + bad) // 2
            self.state.restore(good.state)
            saved, failure = self._attempt(good, middle)
            if failure is None:
                good = Good(self.state.copy(good.state), middle, saved)
            else:
                bad = middle
        self.state.restore(good.state)
        return good

    def _keep_last(self, good: Good) -> int:
        """Add the state reached as a last row, if the run ended between two rows of the grid."""
        save_steps, saved = self.grid.save_steps, good.saved
        if good.step == self.grid.n_steps or (saved > 0 and save_steps[saved - 1] == good.step):
            return saved
        self.xs[saved], self.vs[saved] = good.state.x, good.state.v
        return saved + 1

    def _ending(self, outcome: Outcome, cause: str, step: int, saved: int, wall_time: float) -> Ending:
        message = outcome.value
        if outcome is not Outcome.COMPLETED:
            t = self.grid.t0 + step * self.grid.step
            message += f" It ends at t={t!r}, after {step} of {self.grid.n_steps} steps.{cause}"
        if outcome in (Outcome.NOT_FINITE, Outcome.NOT_CONVERGED):
            message += " Try a smaller step."
        evaluations = step * self.program.evaluations + sum(FLOWS[name].evaluations for name in self.program.primers)
        evaluations += int(self.state.work[EVALUATIONS])
        estimated = estimated_errors(self.state.x.size, self.state.work).copy() if self._estimates else None
        return Ending(outcome, message, step, saved, evaluations, wall_time, estimated)

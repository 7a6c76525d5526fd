"""A run: the loop in chunks, with progress, interruption, and an end at the last good state."""

import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from kickdrift.core.memory import state_block
from kickdrift.core.outcomes import Outcome
from kickdrift.engine import letters, loop
from kickdrift.engine.flows import EVALUATIONS, TROUBLE
from kickdrift.engine.grid import Grid
from kickdrift.engine.implicit import implicit_work_size
from kickdrift.engine.program import Program
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
_CHUNK_SECONDS = 0.1  # how long Ctrl-C waits
_SHORT_RUN_SECONDS = 2.0  # runs expected to be shorter show no bar


@dataclass
class State:
    """Position, velocity, and what the flows keep beside them."""

    x: Floats
    v: Floats
    work: Floats

    def copy(self) -> "State":
        """Copy all three."""
        return State(self.x.copy(), self.v.copy(), self.work.copy())

    def restore(self, other: "State") -> None:
        """Go back to a copy, in place."""
        self.x[:], self.v[:], self.work[:] = other.x, other.v, other.work

    @property
    def finite(self) -> bool:
        """Whether every number is."""
        return bool(np.isfinite(self.x).all() and np.isfinite(self.v).all())


@dataclass(frozen=True)
class Ending:
    """How a run ended: its outcome and sentence, steps done, rows filled, evaluations, and seconds in the loop."""

    outcome: Outcome
    message: str
    n_steps: int
    saved: int
    evaluations: int
    wall_time: float


class Run:
    """A system, a program and a grid, made ready: everything compiled, rows allocated.

    Attributes
    ----------
    xs, vs : (T, n) array
        The rows, filled as the run goes; one more than the grid's if the run ends early between two of them.
    """

    def __init__(self, system: System, program: Program, grid: Grid, compensated: bool) -> None:
        self.system, self.program, self.grid = system, program, grid
        n = system.x0.size
        implicit = any(name.startswith("implicit") for name in program.flows)
        work = np.zeros(implicit_work_size(n) if implicit else 3 * n + 3)
        self.state = State(system.x0.reshape(-1).copy(), system.v0.reshape(-1).copy(), work)
        self.xs = np.empty((grid.save_steps.size, n))
        self.vs = np.empty((grid.save_steps.size, n))
        names = program.flows + ("accelerate",) * program.primed
        flows = tuple(letters.build(name, system, compensated) for name in names)
        self._flows = flows + (flows[0],) * (loop.MOST_FLOWS - len(flows))
        members = (self.state.x, self.state.v, system.params, work)
        self._block = state_block(*members)
        self._advance: Any = loop.advance if system.native else loop.advance.py_func  # type: ignore[attr-defined]
        self._address: Any = self._block.ctypes.data if system.native else members
        self._run(0, 0, 0)  # compiles, or loads from the cache

    def _run(self, first: int, last: int, saved: int) -> tuple[int, int]:
        program, grid, state = self.program, self.grid, self.state
        return self._advance(  # type: ignore[no-any-return]
            self._flows,
            program.letters,
            program.weights,
            program.offsets,
            grid.t0,
            grid.step,
            first,
            last,
            self._address,
            state.x,
            state.v,
            state.work,
            grid.save_steps,
            saved,
            self.xs,
            self.vs,
        )

    def _prime(self) -> None:
        """Evaluate the acceleration at the start, as a step of one letter of no length."""
        self._advance(
            self._flows,
            np.array([len(self.program.flows)]),
            np.zeros(1),
            np.zeros(1),
            self.grid.t0,
            self.grid.step,
            0,
            1,
            self._address,
            self.state.x,
            self.state.v,
            self.state.work,
            self.grid.save_steps[:0],
            0,
            self.xs,
            self.vs,
        )

    def go(self, progress: bool | None) -> Ending:
        """Run to the end of the grid, or as far as it goes; what was done is kept in any case."""
        grid, state = self.grid, self.state
        started = time.perf_counter()
        step = saved = 0
        outcome = Outcome.COMPLETED
        if grid.save_steps[0] == 0:
            self.xs[0], self.vs[0] = state.x, state.v
            saved = 1
        before, before_step, before_saved = state.copy(), 0, saved
        bar = _Bar(grid.n_steps, progress)
        chunk = 1
        try:
            if self.program.primed:
                self._prime()
            while step < grid.n_steps:
                before, before_step, before_saved = state.copy(), step, saved
                chunk_started = time.perf_counter()
                target = min(step + chunk, grid.n_steps)
                step, saved = self._run(step, target, saved)
                if not state.finite:
                    outcome = Outcome.NOT_FINITE
                    step, saved = self._last_finite(before, before_step, before_saved, target)
                    break
                if step < target:
                    outcome = Outcome.NOT_CONVERGED
                    break
                seconds = time.perf_counter() - chunk_started
                chunk = max(1, min(10 * chunk, int(chunk * _CHUNK_SECONDS / max(seconds, 1e-9))))
                bar.show(step, time.perf_counter() - started)
        except KeyboardInterrupt:
            outcome = Outcome.INTERRUPTED
            if not self.system.native:
                # The interpreter stops anywhere, also in the middle of a step: go back to the last whole chunk.
                state.restore(before)
                step, saved = before_step, before_saved
        finally:
            bar.close()
        wall_time = time.perf_counter() - started
        return self._ending(outcome, step, self._keep_last(step, saved), wall_time)

    def _last_finite(self, before: State, good: int, saved: int, bad: int) -> tuple[int, int]:
        """Find the last finite state by halves: what is not finite stays so, and every rerun gives the same bits."""
        while bad - good > 1:
            self.state.restore(before)
            middle = (good + bad) // 2
            reached, rows = self._run(good, middle, saved)
            if self.state.finite and reached == middle:
                before, good, saved = self.state.copy(), middle, rows
            else:
                bad = middle
        self.state.restore(before)
        return good, saved

    def _keep_last(self, step: int, saved: int) -> int:
        """Add the state reached as a last row, if the run ended between two rows of the grid."""
        save_steps = self.grid.save_steps
        if step < self.grid.n_steps and saved < save_steps.size and (saved == 0 or save_steps[saved - 1] != step):
            self.xs[saved], self.vs[saved] = self.state.x, self.state.v
            saved += 1
        return saved

    def _ending(self, outcome: Outcome, step: int, saved: int, wall_time: float) -> Ending:
        message = outcome.value
        t = self.grid.t0 + step * self.grid.step
        if outcome is Outcome.INTERRUPTED:
            message += f" It came at t={t:g}, after {step} of {self.grid.n_steps} steps."
        elif outcome is Outcome.NOT_FINITE:
            message += f" That is at t={t!r}, after step {step} of {self.grid.n_steps}; try a smaller step."
        elif outcome is Outcome.NOT_CONVERGED:
            residual = self.state.work[TROUBLE]
            message += (
                f" That is at t={t!r}, after step {step} of {self.grid.n_steps}; the residual was {residual:.3g}."
                " Try a smaller step."
            )
        evaluations = step * self.program.evaluations + int(self.program.primed) + int(self.state.work[EVALUATIONS])
        return Ending(outcome, message, step, saved, evaluations, wall_time)


class _Bar:
    """A progress bar that appears only once a run turns out to be long."""

    def __init__(self, n_steps: int, wanted: bool | None) -> None:
        self._n_steps = n_steps
        self._wanted = sys.stderr.isatty() if wanted is None else wanted
        self._always = wanted is True
        self._bar: Any = None

    def show(self, step: int, seconds: float) -> None:
        if not self._wanted:
            return
        if self._bar is None and (self._always or seconds * self._n_steps / step > _SHORT_RUN_SECONDS):
            self._bar = tqdm(total=self._n_steps, unit="step", unit_scale=True, leave=False, file=sys.stderr)
        if self._bar is not None:
            self._bar.update(step - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()

"""The states that the loop has, where they are not those that people see: of a split, turned, and corrected."""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.outcomes import Outcome
from kickdrift.engine.grid import Grid
from kickdrift.engine.program import Program, Structure, compose
from kickdrift.engine.run import Ending, Run
from kickdrift.methods import Letter, Method
from kickdrift.methods.record import Word
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


class Processing:
    """The way into the loop and out of it.

    Inside are the coordinates of the split, if the method uses one. There, a few letters have been done before the
    first step: the corrector of the method, if it has one; and of a word that begins and ends with a Kepler flow the
    first, so that the last of a step and the first of the next are one flow. They are undone on the rows, each by
    itself: the numbers do not depend on which steps are saved.

    Attributes
    ----------
    system : System
        The system with the start that the loop has.
    program : Program
        The step.
    evaluations : int
        Force evaluations on the way in and out.
    """

    def __init__(self, system: System, method: Method, grid: Grid, compensated: bool) -> None:
        programs = _programs(method, Structure.of(system))
        self.program = programs.step
        self.system, self.evaluations = system, 0
        self._outside, self._grid = system, grid
        self._frame = system.frame if self.program.split else None
        if self._frame is not None:
            x0, v0 = self._frame.enter(system.x0, system.v0)
            self.system = replace(system, x0=x0, v0=v0)
        self._undo: Run | None = None
        if programs.before is not None and programs.back is not None:
            no_rows = replace(grid, save_steps=grid.save_steps[:0])
            do = Run(self.system, programs.before, no_rows, compensated, progress=False)
            x0, v0 = self.system.x0.reshape(1, -1).copy(), self.system.v0.reshape(1, -1).copy()
            self._change(do, np.zeros(1, dtype=np.int64), x0, v0)
            self.system = replace(self.system, x0=x0.reshape(system.x0.shape), v0=v0.reshape(system.v0.shape))
            self._undo = Run(self.system, programs.back, no_rows, compensated, progress=False)

    def leave(self, run: Run, ending: Ending) -> tuple[Floats, Floats]:
        """Return the rows of a run as people see them, shape (T, *shape)."""
        xs, vs = run.xs[: ending.saved], run.vs[: ending.saved]
        if self._undo is not None:
            steps = np.append(self._grid.save_steps, ending.n_steps)[: ending.saved]
            if ending.outcome is not Outcome.COMPLETED:
                steps[-1:] = ending.n_steps
            self._change(self._undo, steps, xs, vs)
        xs = xs.reshape(ending.saved, *self._outside.x0.shape)
        vs = vs.reshape(ending.saved, *self._outside.v0.shape)
        if self._frame is not None:
            xs, vs = self._frame.leave(xs, vs)
        if ending.saved and self._grid.save_steps[0] == 0:
            xs[0], vs[0] = self._outside.x0, self._outside.v0  # which there and back is but for rounding
        return xs, vs

    def _change(self, run: Run, steps: NDArray[np.int64], xs: Floats, vs: Floats) -> None:
        run.change(steps, xs, vs)
        self.evaluations += steps.size * run.program.evaluations


@dataclass(frozen=True)
class _Programs:
    """The step of a method, and where there is a way into the loop, that and the way back."""

    step: Program
    before: Program | None = None
    back: Program | None = None


@lru_cache(maxsize=256)
def _programs(method: Method, system: Structure) -> _Programs:
    word, first = _turned(method.word)
    before = (*method.corrector, *first)
    ahead = sum((weight for letter, weight in first), Fraction(0))
    step = compose(method, system, word, clock=ahead)
    if not before:
        return _Programs(step)
    back = tuple((letter.adjoint or letter, -weight) for letter, weight in reversed(before))
    return _Programs(
        step, compose(method, system, before, repeated=False), compose(method, system, back, ahead, repeated=False)
    )


def _turned(word: Word) -> tuple[Word, Word]:
    """Return the step as it is done, and what is done once before it."""
    (first, share), (last, rest) = word[0], word[-1]
    if len(word) > 1 and first is last is Letter.KEPLER:
        return (*word[1:-1], (first, share + rest)), word[:1]
    return word, ()

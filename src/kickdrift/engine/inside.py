"""The states that the loop has, where they are not those that people see: those of a split, and corrected ones."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.grid import Grid
from kickdrift.engine.program import Program, compose
from kickdrift.engine.run import Ending, Run
from kickdrift.methods import Method
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


class Inside:
    """The way into the loop and out of it.

    Inside are the coordinates of the split, if the program uses one, and there the corrector of the method, if it has
    one, has been done. It is undone on the rows, each by itself: what is kept does not depend on what else is.

    Attributes
    ----------
    system : System
        The system with the start that the loop has.
    """

    def __init__(self, system: System, method: Method, program: Program, grid: Grid, compensated: bool) -> None:
        self._outside, self._grid = system, grid
        self._frame = system.frame if program.split else None
        self._undo: Run | None = None
        self.system = system
        if self._frame is not None:
            x0, v0 = self._frame.enter(system.x0, system.v0)
            self.system = replace(system, x0=x0, v0=v0)
        if method.corrector:
            nothing_kept = replace(grid, save_steps=grid.save_steps[:0])
            backwards = tuple((letter, -weight) for letter, weight in reversed(method.corrector))
            do, self._undo = (
                Run(self.system, compose(method, system, word), nothing_kept, compensated, progress=False)
                for word in (method.corrector, backwards)
            )
            x0, v0 = do.step_from(0, self.system.x0, self.system.v0)
            self.system = replace(self.system, x0=x0, v0=v0)

    def leave(self, run: Run, ending: Ending) -> tuple[Floats, Floats]:
        """Return the rows of a run as people see them, shape (T, *shape)."""
        shape = (ending.saved, *self._outside.x0.shape)
        xs: Any = run.xs[: ending.saved].reshape(shape)
        vs: Any = run.vs[: ending.saved].reshape(ending.saved, *self._outside.v0.shape)
        if self._undo is not None:
            steps = np.append(self._grid.save_steps, ending.n_steps)[: ending.saved]
            steps[-1:] = ending.n_steps
            for row, step in enumerate(steps):
                xs[row], vs[row] = self._undo.step_from(int(step), xs[row], vs[row])
        if self._frame is not None:
            xs, vs = self._frame.leave(xs, vs)
        if ending.saved and self._grid.save_steps[0] == 0:
            xs[0], vs[0] = self._outside.x0, self._outside.v0  # there and back is the same but for rounding
        return xs, vs

"""Processed methods: transformations between the user's states and those of the loop (splits, turned words, correctors)."""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.controller import Controller
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.program import Control, Program, Structure, compose
from kickdrift.engine.stepper import NO_NUMBERS, Stepper, compile_program
from kickdrift.engine.transformed_steps import change_in_time
from kickdrift.methods import Method
from kickdrift.methods.record import Word
from kickdrift.systems.system import Frame, System

Floats = NDArray[np.float64]


class Processing(NamedTuple):
    """A method compiled for a system: the kernel, which the loop repeats, a preprocessor and a postprocessor.

    The loop works in the coordinates of the split, if the method uses one. Before the first step the preprocessor applies the
    corrector of the method, if it has one, and the first letter of a word that begins and ends with the same flow, so that the
    last letter of a step and the first of the next are one. The postprocessor undoes this on each row by itself, so that the
    results do not depend on which steps are saved.

    Attributes
    ----------
    system : System
        The system with the user's initial state.
    frame : Frame or None
        The coordinates of the split.
    kernel : Stepper
        The step.
    preprocessor, postprocessor : Stepper or None
    """

    system: System
    frame: Frame | None
    kernel: Stepper
    preprocessor: Stepper | None
    postprocessor: Stepper | None

    @property
    def is_processed(self) -> bool:
        """Whether the states of the loop differ from the user's."""
        return self.frame is not None or self.preprocessor is not None

    def enter(self) -> None:
        """Transform the initial state of the kernel."""
        if self.preprocessor is not None:
            state, once = self.kernel.state, np.ones(1, dtype=np.int64)
            t0, step = np.array([self.kernel.t0]), np.array([self.kernel.step])
            self.preprocessor.change(t0, step, once, state.x[None], state.v[None])

    def leave(self, times: Floats, xs: Floats, vs: Floats, t0: float) -> tuple[Floats, Floats]:
        """Return the rows of a run as the user's states, (T, *shape)."""
        xs, vs = self.seen(times, xs, vs)
        if times.size and times[0] == t0:
            xs[0], vs[0] = (
                self.system.x0,
                self.system.v0,
            )  # exactly: transformed there and back it would differ by rounding
        return xs, vs

    def seen(self, times: Floats, xs: Floats, vs: Floats) -> tuple[Floats, Floats]:
        """Transform rows of the loop, after whole steps, to the user's states; they are overwritten."""
        if self.postprocessor is not None:
            sizes, once = np.full(times.size, self.kernel.step), np.ones(times.size, dtype=np.int64)
            self.postprocessor.change(times, sizes, once, xs, vs)
        xs = xs.reshape(times.size, *self.system.x0.shape)
        vs = vs.reshape(times.size, *self.system.v0.shape)
        return (xs, vs) if self.frame is None else self.frame.leave(xs, vs)

    def go_on(
        self,
        times: Floats,
        sizes: Floats,
        counts: NDArray[np.int64],
        xs: Floats,
        vs: Floats,
        numbers: Floats = NO_NUMBERS,
    ) -> tuple[Floats, Floats, NDArray[np.int64]]:
        """Advance each row, the user's states (T, *shape), by `counts` steps of `sizes` from its time.

        Rows may have their own params, `numbers` (T, p), and those of the control of steps, if there is no frame.

        Returns
        -------
        xs, vs : (T, *shape) array
            The states reached.
        evaluations : (T,) array of int
            Force evaluations.
        """
        if self.frame is not None:
            xs, vs = self.frame.enter(xs, vs)
        x, v, once = xs.reshape(times.size, -1).copy(), vs.reshape(times.size, -1).copy(), np.ones_like(counts)
        evaluations = np.zeros(times.size, dtype=np.int64)
        for stepper, at, repeats in (
            (self.preprocessor, times, once),
            (self.kernel, times, counts),
            (self.postprocessor, times + counts * sizes, once),
        ):
            if stepper is not None and stepper.program.transformed:
                evaluations += change_in_time(stepper, at, sizes, repeats, x, v, numbers)
            elif stepper is not None:
                evaluations += stepper.change(at, sizes, repeats, x, v, numbers)[0]
        xs, vs = x.reshape(xs.shape), v.reshape(vs.shape)
        return (*((xs, vs) if self.frame is None else self.frame.leave(xs, vs)), evaluations)

    def evaluations(self, rows: int) -> int:
        """Force evaluations of preprocessing, and of postprocessing a number of rows."""
        before, after = self.preprocessor, self.postprocessor
        return (before.program.evaluations if before else 0) + rows * (after.program.evaluations if after else 0)


def compile_method(
    system: System,
    method: Method,
    grid: Grid | Course,
    compensated: bool,
    turns: bool = True,
    controller: Controller | None = None,
) -> Processing:
    """Compile a method for a system, or load it from disk.

    `turns` is False if every step is needed: an additional letter in each step costs less than undoing one.
    """
    control = None if controller is None else controller.spelled
    programs = _programs(method, Structure.of(system), turns and controller is None, control)
    frame, inner = system.frame if programs.kernel.split else None, system
    if frame is not None:
        x0, v0 = frame.enter(system.x0, system.v0)
        inner = replace(system, x0=x0, v0=v0)
    kernel, before, after = compile_program(inner, programs.kernel, grid, compensated, controller), None, None
    if programs.preprocessor is not None and programs.postprocessor is not None:
        before = compile_program(inner, programs.preprocessor, grid, compensated, controller)
        after = compile_program(inner, programs.postprocessor, grid, compensated, controller)
    return Processing(system, frame, kernel, before, after)


def kernel_alone(system: System, method: Method) -> Program | None:
    """Return the step of a method on a system; None if states are transformed."""
    programs = _programs(method, Structure.of(system), True, None)
    framed = programs.kernel.split and system.frame is not None
    return None if framed or programs.preprocessor is not None else programs.kernel


@dataclass(frozen=True)
class _Programs:
    kernel: Program
    preprocessor: Program | None = None
    postprocessor: Program | None = None


@lru_cache(maxsize=256)
def _programs(method: Method, system: Structure, turns: bool, control: Control | None) -> _Programs:
    word, first = _turned(method.word) if turns else (method.word, ())
    before = (*method.corrector, *first)
    ahead = sum((weight for letter, weight in first), Fraction(0))
    kernel = compose(method, system, word, clock=ahead, control=control)
    if not before:
        return _Programs(kernel)
    back = tuple((letter.adjoint or letter, -weight) for letter, weight in reversed(before))
    return _Programs(
        kernel, compose(method, system, before, repeated=False), compose(method, system, back, ahead, repeated=False)
    )


def _turned(word: Word) -> tuple[Word, Word]:
    """Return the word that is repeated, and the part that is done once before it."""
    (first, share), (last, rest) = word[0], word[-1]
    if len(word) > 1 and first is last and first.turned:
        return (*word[1:-1], (first, share + rest)), word[:1]
    return word, ()

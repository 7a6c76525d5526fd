"""A program ready to run: its flows compiled, and bound to the state that they work on."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import all_finite
from kickdrift.core.compilation import Function, load
from kickdrift.core.heap import keep_freed_memory
from kickdrift.engine import letters, loop
from kickdrift.engine.controller import Controller
from kickdrift.engine.flows.layout import FORMED, lay_out
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.program import Program
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
_LARGE = 100  # numbers of a state whose pairs fill what the C library thinks large
_NEVER = np.zeros(0, dtype=np.int64)  # steps after which rows are kept: none
NO_NUMBERS = _NO_ROWS = np.zeros((0, 0))


def rows_of(numbers: Floats, rows: Any) -> Floats:
    """Return those of some rows, of numbers that each row has, or none has."""
    return np.ascontiguousarray(numbers[rows]) if len(numbers) else numbers


@dataclass
class State:
    """Position, velocity, and the memory of the flows; the scratch of a copy is empty if nothing is kept there.

    The parts of work that are `kept` are used by the next step, and copied.
    """

    x: Floats
    v: Floats
    work: Floats
    scratch: Floats
    kept: tuple[slice, ...] = (slice(None),)

    def copy(self, last: "State | None" = None, into: "State | None" = None) -> "State":
        """Copy the state, into another one if given; the scratch only if it changed since the `last` copy."""
        if into is not None:
            into.scratch = np.zeros(0)  # frees its memory first: it may be a large matrix
        if last is not None and last.work[FORMED] == self.work[FORMED]:
            scratch = last.scratch
        else:
            scratch = self.scratch.copy() if self.work[FORMED] else np.zeros(0)
        if into is None:
            into = State(np.empty(self.x.size), np.empty(self.v.size), np.empty(self.work.size), scratch, self.kept)
        into.scratch = scratch
        into._take(self)
        return into

    def at_rest(self) -> "State":
        """Return the state, for a run that does not go on, with the scratch only if something is kept there."""
        scratch = self.scratch if self.work[FORMED] else np.zeros(0)
        return State(self.x, self.v, self.work, scratch, self.kept)

    def restore(self, other: "State") -> None:
        """Restore a copy, in place."""
        if other is self:
            return
        if self.work[FORMED] != other.work[FORMED]:
            self.scratch[: other.scratch.size] = other.scratch
        self._take(other)

    def _take(self, other: "State") -> None:
        self.x[:], self.v[:] = other.x, other.v
        for part in self.kept:
            self.work[part] = other.work[part]

    @property
    def finite(self) -> bool:
        """Whether all positions and velocities are finite."""
        return all_finite(self.x) and all_finite(self.v)


class Loops(NamedTuple):
    """The loops, compiled or for the interpreter."""

    advance: Function
    advance_adaptively: Function
    change: Function


_COMPILED = Loops(loop.advance, loop.advance_adaptively, loop.change)
_INTERPRETED = Loops(loop.advance_interpreted, loop.advance_adaptively_interpreted, loop.change_interpreted)


@dataclass(eq=False)
class Stepper:
    """Does steps of a program on its own state.

    Attributes
    ----------
    program : Program
    t0, step : float
        Time of step 0, and the signed size of a step.
    state : State
    estimates : bool
        Whether steps estimate their errors.
    """

    program: Program
    t0: float
    step: float
    state: State
    estimates: bool
    _flows: Any  # addresses of the letters, those of the primers last; the letters themselves for the interpreter
    _members: Any  # address of the block that describes the state, or its arrays for the interpreter
    _loops: Loops
    _alive: tuple[Any, ...]  # the objects at these addresses, kept alive

    def advance(
        self, first: int, last: int, save_steps: NDArray[np.int64], saved: int, xs: Floats, vs: Floats
    ) -> tuple[int, int]:
        """Do the steps from `first` to `last`, keeping rows; see `kickdrift.engine.loop.advance`."""
        program, state = self.program, self.state
        word = self._flows, program.letters, program.weights, program.offsets
        members = self._members, state.x, state.v, state.work
        return self._loops.advance(  # type: ignore[no-any-return]
            *word, self.t0, self.step, first, last, *members, save_steps, saved, xs, vs
        )

    def advance_adaptively(
        self,
        last: int,
        stride: int,
        wanted: Floats,
        marks: NDArray[np.int64],
        ts: Floats,
        sizes: Floats,
        xs: Floats,
        vs: Floats,
    ) -> int:
        """Do variable steps; see `kickdrift.engine.loop.advance_adaptively`."""
        program, state = self.program, (self._members, self.state.x, self.state.v, self.state.work)
        word = (program.letters, program.weights, program.ticks, program.ticks_of_v, program.sees_v_clock)
        return int(
            self._loops.advance_adaptively(self._flows, *word, last, *state, stride, wanted, marks, ts, sizes, xs, vs)
        )

    def prime(self) -> None:
        """Run the primers, which prepare the memory of the flows for the first step."""
        nothing, state = np.zeros(self._primers.size), self.state
        word, members = (self._flows, self._primers, nothing, nothing), (self._members, state.x, state.v, state.work)
        self._loops.advance(*word, self.t0, 0.0, 0, 1, *members, _NEVER, 0, _NO_ROWS, _NO_ROWS)

    def change(
        self,
        times: Floats,
        sizes: Floats,
        counts: NDArray[np.int64],
        xs: Floats,
        vs: Floats,
        numbers: Floats = NO_NUMBERS,
    ) -> tuple[NDArray[np.int64], Floats]:
        """Advance each row in place by `counts` steps of `sizes` from its time, without memory of the flows.

        Rows may have their own params, `numbers` (T, p), followed by those of the control of steps.

        Returns
        -------
        evaluations : (T,) array of int
            Of the force.
        clocks : (T,) array
            The times at the ends, of letters that move the clock themselves.
        """
        program, state, blank = self.program, self.state, self.state.work.copy()
        params = self.params
        own = params.copy()
        word = (program.letters, program.weights, program.offsets, self._primers)
        members = (self._members, state.x, state.v, state.work)
        load(self._loops.change, loop.CHANGE)
        clocks, counted = np.zeros(times.size), np.zeros(times.size)
        with np.errstate(all="ignore"):
            self._loops.change(
                self._flows, *word, times, sizes, counts, *members, params, numbers, blank, clocks, counted, xs, vs
            )
        state.work[:], params[:] = blank, own
        primed = sum(FLOWS[name].evaluations for name in program.primers)
        return counted.astype(np.int64) + primed + program.evaluations * counts, clocks

    @property
    def params(self) -> Floats:
        """The params of the functions, which the flows read."""
        arrays = self._alive[-1] if self._alive else self._members
        return arrays[2]  # type: ignore[no-any-return]

    @property
    def compiled(self) -> tuple[Any, NDArray[np.int64], tuple[Any, ...]]:
        """Addresses of the letters, indices of the primers, and the state: the address of its block, x, v, params and work."""
        *_, members = self._alive
        return self._flows, self._primers, (self._members, *members)

    @property
    def _primers(self) -> NDArray[np.int64]:
        return np.arange(len(self.program.flows), len(self._flows))


class _Needs(NamedTuple):
    """Numbers of scratch and of memory of the flows, whether these estimate errors, and the parts of work to be kept."""

    scratch: int
    memory: int
    estimates: bool
    kept: tuple[slice, ...]


@lru_cache(maxsize=256)
def _needs(program: Program, n: int, compensated: bool, params: bytes) -> _Needs:
    """Return what a program needs for a state of n numbers."""
    flows, sizes = [FLOWS[name] for name in program.names], (n, program.coefficients, np.frombuffer(params).copy())
    return _Needs(
        max(flow.scratch(*sizes) for flow in flows),
        max(flow.memory(*sizes) for flow in flows),
        any(flow.estimates for flow in flows),
        _kept(program.names, n, compensated),
    )


def _kept(names: tuple[str, ...], n: int, compensated: bool) -> tuple[slice, ...]:
    """Return the parts of work that steps of these flows pass to the next step, see `layout`."""
    if not all(FLOWS[name].plain for name in names):
        return (slice(None),)
    accelerations = (slice(0, n),) if any(flow.again in names for flow in FLOWS.values()) else ()
    residuals = (slice(n, 3 * n),) if compensated else ()
    return *accelerations, *residuals, slice(4 * n, None)


def compile_program(
    system: System, program: Program, grid: Grid | Course, compensated: bool, controller: Controller | None = None
) -> Stepper:
    """Compile a program for a system, or load it from disk; the state is the initial state of the system."""
    bound = letters.bind(system, program, compensated)
    native = letters.compile_letters(bound) if system.native else None
    n, needs = bound.n, _needs(program, bound.n, compensated, bound.params)
    scratch, size = np.zeros(needs.scratch), needs.memory + n * needs.estimates
    size += 0 if controller is None else controller.memory_size(n, needs.memory)
    numbers, called = (
        (system.x0, system.v0, system.params, program.coefficients),
        {} if native is None else native.called,
    )
    block, members = lay_out(*numbers, size, called, scratch)
    x, v, _, work = members
    if controller is not None:
        controller.prepare(work, n, needs.estimates, grid.t0, grid.t1, grid.step)
    made = program, grid.t0, grid.step, State(x, v, work, scratch, needs.kept), needs.estimates
    if native is None:
        built = [letters.build(name, bound, scratch) for name in program.names]
        return Stepper(*made, built, members, _INTERPRETED, ())
    if n > _LARGE:
        keep_freed_memory()
    if controller is None or program.primers:
        load(loop.advance, loop.ADVANCE)
    if controller is not None:
        load(loop.advance_adaptively, loop.ADVANCE_ADAPTIVELY)
    return Stepper(*made, native.flows, block, _COMPILED, (native, bound, members))

"""What the engine knows of a flow."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import Function

Ahead = tuple[tuple[int, int] | None, dict[str, int]]


@dataclass(frozen=True, eq=False)
class Flow:
    """A flow, as a template and what must be known to run it.

    Attributes
    ----------
    template : callable
        ``template(t, h, x, v, params, work)``. Bound into it are ``add_to_x`` and ``add_to_v``, the functions of
        `parts`, and those of the system, as ``acceleration_at(t, x, v, params, work, out)`` and so on: called by their
        addresses, see `kickdrift.engine.flows.layout`, or compiled into it. A flow with nothing inlined is compiled
        once for all systems.
    inlined : tuple of str
        ``"acceleration"`` or ``"velocity"``, for the flows of which every nanosecond counts: compiled into it where a
        state is small, or the system comes with kickdrift.
    parts : mapping of str to callable
        Templates that it calls, by the names that they have in it, each after those that it calls itself.
    evaluations : int
        Force evaluations each time, those that it counts itself in work left out.
    counted : callable
        How many of its letters in a step together count themselves, for the coefficients, where that is known.
    moves_x, moves_v : bool
        What it moves.
    timed : bool
        Whether the clock moves with x; not where x is put right at one time.
    moves_clock : bool
        Whether it moves the clock itself, in a time of its own.
    keeps_acceleration : bool
        Whether it leaves the acceleration of the last kick in work.
    plain : bool
        Whether it leaves nothing in work but that and sums, so that a checkpoint needs no more of it.
    memory : callable
        Numbers of memory for a state of n numbers, the coefficients of the method, and the params of the system.
    scratch : callable
        In the same way, numbers of scratch.
    constants : callable or None
        From the coefficients, the params and whether x' is not v: names and values that are constants of its compilation,
        as is the size of the state for a few numbers.
    ahead : tuple of (sizes, constants)
        Of a flow with constants, what `kickdrift compile` compiles: the numbers of x and of v, None for many, and the
        constants.
    primer : str
        Name of a flow that makes the memory ready before the first step, empty for none.
    small : callable or None
        A template of the same for few numbers, whose loops are unrolled.
    sees_v_clock : bool
        Whether its time is the one that moves with v: that of a rate of x.
    merges : bool
        Whether two in a row are one of both shares; of what moves v, where the acceleration does not depend on it.
    again, evaluation : str
        Names of the flow that does the same with the acceleration that is in work, and of the one that only puts it there.
    along : str
        Name of the flow that takes its place where x' is not v.
    companion : str
        Name of a part of a system, and of the flow of it, which follows where the kicks have only the remainder.
    estimates : bool
        Whether it estimates its errors, see `layout.estimated_errors`.
    """

    template: Function
    inlined: tuple[str, ...] = ()
    parts: Mapping[str, Function] = field(default_factory=dict)
    evaluations: int = 0
    counted: Callable[[NDArray[np.float64]], int] = lambda coefficients: 0
    moves_x: bool = False
    moves_v: bool = False
    timed: bool = True
    moves_clock: bool = False
    keeps_acceleration: bool = True
    plain: bool = False
    memory: Callable[[int, NDArray[np.float64], NDArray[np.float64]], int] = lambda n, coefficients, params: 0
    scratch: Callable[[int, NDArray[np.float64], NDArray[np.float64]], int] = lambda n, coefficients, params: 0
    constants: Callable[[NDArray[np.float64], int, NDArray[np.float64], bool], dict[str, int]] | None = None
    ahead: tuple[Ahead, ...] = ()
    primer: str = ""
    small: Function | None = None
    sees_v_clock: bool = False
    merges: bool = False
    again: str = ""
    evaluation: str = ""
    along: str = ""
    companion: str = ""
    estimates: bool = False

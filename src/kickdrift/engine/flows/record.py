"""The record of a flow."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import Function

Ahead = tuple[tuple[int, int] | None, dict[str, int]]


@dataclass(frozen=True, eq=False)
class Flow:
    """A flow: a template, and the properties that the engine needs to run it.

    Attributes
    ----------
    template : callable
        ``template(t, h, x, v, params, work)``. Bound into it are ``add_to_x`` and ``add_to_v``, the functions of
        `parts`, and those of the system, as ``acceleration_at(t, x, v, params, work, out)`` and so on: called by their
        addresses, see `kickdrift.engine.flows.layout`, or compiled into it. A flow with nothing inlined is compiled
        once for all systems.
    inlined : tuple of str
        ``"acceleration"`` or ``"velocity"``, for flows in which every nanosecond counts: inlined if the state is small, or
        the system comes with kickdrift.
    parts : mapping of str to callable
        Templates that it calls, by their names in it, each after those that it calls itself.
    evaluations : int
        Force evaluations of one call, without those that it counts itself in work.
    counted : callable
        Force evaluations that its letters in a step count themselves, as a function of the coefficients, if that is fixed.
    moves_x, moves_v : bool
        Whether it changes x and v.
    timed : bool
        Whether the clock moves with x; False for projections.
    moves_clock : bool
        Whether it moves the clock itself, in transformed time.
    keeps_acceleration : bool
        Whether the acceleration of the last kick stays in work.
    plain : bool
        Whether it keeps nothing else in work but sums, so that a checkpoint needs no more of it.
    memory : callable
        Numbers of memory for a state of n numbers, the coefficients of the method, and the params of the system.
    scratch : callable
        In the same way, numbers of scratch.
    constants : callable or None
        Returns names and values of compile-time constants, from the coefficients, the params and whether x' differs from v;
        the size of a small state is one, too.
    by_params : bool
        Whether these depend on the params; otherwise they get none.
    ahead : tuple of (sizes, constants)
        The variants of a flow with constants that `kickdrift compile` compiles: sizes of x and of v, None for any, and the
        constants.
    primer : str
        Name of the flow that prepares the memory before the first step, empty for none.
    small : callable or None
        An equivalent template for small states, with unrolled loops.
    sees_v_clock : bool
        Whether it uses the clock that moves with v, as a rate of x does.
    merges : bool
        Whether two consecutive ones can be merged; for flows that change v, if the acceleration does not depend on it.
    again, evaluation : str
        Names of the flow that does the same with the acceleration in work, and of the one that only evaluates it.
    along : str
        Name of the flow that replaces it where x' differs from v.
    companion : str
        Name of a part of a system and of its flow, which follows if the kicks contain only the remainder.
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
    by_params: bool = False
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

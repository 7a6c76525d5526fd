"""Impacts and switches: surfaces from which bodies rebound, and surfaces at which the force law changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import choice
from kickdrift.core.compilation import Function, unbound
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.core.views import part
from kickdrift.engine.control_checks import check_copies
from kickdrift.engine.controller import Controller
from kickdrift.engine.flows import surfaces as layout
from kickdrift.engine.flows.sliding_mode import MOST_ROUNDS
from kickdrift.engine.grid import Course
from kickdrift.engine.impact_checks import check_friction, check_start, masses_of, numbers_of
from kickdrift.engine.problem_adapter import Adapter, bind
from kickdrift.engine.program import Spelled
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.engine.step_control import Spell
from kickdrift.engine.surface_events import Surfaces
from kickdrift.methods import Method
from kickdrift.methods.record import Word
from kickdrift.systems.problem import name_of
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]

first: Function = unbound
second: Function = unbound
COUNT = PARAMS = 0


@dataclass(frozen=True, eq=False)
class Impacts:
    """Surfaces that bodies rebound from.

    Parameters
    ----------
    gap : callable
        The distance to contact: a number, or an array of them, positive where nothing touches and negative where bodies
        overlap, with arguments named as those of forces (x, t, params). A gap that is never negative, such as abs(x), cannot
        be resolved: the run ends there.
    restitution : float or array_like
        Newton's coefficient e of each gap: the ratio of the separation speed to the approach speed, from 0 to 1.
    friction : float or array_like
        Coulomb's coefficient mu of each gap, for gaps between one body and its surroundings.
    mass : array_like, optional
        A number, or for states (N, d) one per body; by default the masses of the problem where it has any
        (`kickdrift.Newtonian`, systems under gravity), otherwise 1.
    located : bool
        Whether impacts happen at the time of contact, at which the step is cut; otherwise they happen after the step, and
        bodies are moved back onto the surface, as in games, with an error of a fraction of a step in the times of flight.

    Notes
    -----
    A body whose rebounds have become shorter than a thousandth of a step rests on the surface, or slides along it, until
    the contact force vanishes, where the step is cut. It is constrained by impulses at both ends of a step, as in RATTLE,
    to second order for any method of that order or higher, with static friction up to Coulomb's limit. Where the slip
    reverses or stops, the step is cut as well; if impacts are not located, it is not cut, and the order is one. Two zeros
    of a gap within one step are missed. Bodies touch within 1e-12 of the largest of the positions, at the start or later,
    or of 1 where all of x0 is 0: choose units in which motions are larger.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> floor = kd.Impacts(lambda x: x[1], restitution=0.9)
    >>> fall = lambda x: np.array([0.0, -9.81])
    >>> options = {"step": 0.05, "method": "velocity-verlet", "compile": False}
    >>> ball = kd.solve(fall, (0.0, 1.0), [0, 1], [1, 0], impacts=floor, **options)
    >>> bool(ball.x[:, 1].min() > -1e-12)
    True
    """

    gap: Callable[..., Any]
    restitution: ArrayLike = 1.0
    friction: ArrayLike = 0.0
    mass: ArrayLike | None = None
    located: bool = True


def cut_steps(
    impacts: Any,
    switches: Any,
    problem: Any,
    system: System,
    method: Method,
    course: Course,
    adapter: Adapter,
    place_of_sides: int,
) -> tuple[System, Controller]:
    """Prepare impacts and switches; their gaps become a part of the system.

    The sides are at `place_of_sides` in the params of the system, if that is not negative.

    Raises
    ------
    ArgumentError
        For invalid impacts, ones that are incompatible with the method or the system, and a start beyond a surface.
    """
    if impacts is not None and not isinstance(impacts, Impacts):
        impacts = Impacts(impacts)
    _check(impacts, system, method, course)
    given = [(name, f) for name, f in (("impacts", impacts and impacts.gap), ("switches", switches)) if f is not None]
    gaps = [_adapted(name, function, adapter) for name, function in given]
    sizes = {name: gap.size for (name, _), gap in zip(given, gaps, strict=True)}
    whole = gaps[0] if len(gaps) == 1 else _both(*gaps)
    state = np.array([course.t0]), system.x0[None], system.v0[None]
    start = evaluate_quantity(whole, system, *state).reshape(whole.size)
    length = float(abs(system.x0).max()) or 1.0
    of_impacts = sizes.get("impacts", 0)
    check_start(start, of_impacts, length)
    params = _laid_out(start, of_impacts, system, 0 if switches is None else MOST_ROUNDS)
    params[[layout.LENGTH, layout.START, layout.PLACE_OF_SIDES]] = length, course.t0, place_of_sides
    if impacts is not None:
        _set_impacts(params, impacts, of_impacts, problem, system)
        check_friction(_rows(params)[layout.FRICTION], whole, system, course.t0)
    own = np.zeros(0) if whole.params is None else whole.params
    what = " and ".join(f"{size} {name}" for name, size in sizes.items())
    name = "equal steps, cut at " + (what if params[layout.LOCATED] else f"none; {what} after each")
    params = np.concatenate([params, own])
    surfaces = Surfaces(whole, of_impacts, length, course.step, bool(params[layout.LOCATED])) if of_impacts else None
    controller = Controller(
        name,
        "energy and momenta as the impacts leave them",
        spelled,
        params,
        between=Controller(name, "", _between, params),
        takes_back=True,
        surfaces=surfaces,
        function=whole,
    )
    parts = {**system.parts, "gaps": whole.function}
    return replace(system, parts=parts, exact=None), controller  # the exact solution would ignore impacts


def _laid_out(start: Floats, of_impacts: int, system: System, rounds: int) -> Floats:
    """Return the params of surfaces from their gaps at the start, of which the first are those of impacts; masses are 1.

    `rounds` is how many rounds of switches are kept; see `kickdrift.engine.flows.sliding_mode`.
    """
    count, n = start.size, system.x0.size
    listed = max(min(of_impacts, 2 * n), 1)
    params = np.zeros(layout.HEAD + (layout.ROWS + 1 + rounds) * count + (layout.VECTORS + listed) * n)
    params[[layout.COUNT, layout.MOST_LISTED, layout.MOST_KEPT, layout.LOCATED]] = count, listed, rounds, 1.0
    params[layout.BODY_SIZE] = system.x0.shape[-1] if system.x0.ndim > 1 else n
    rows = _rows(params)
    rows[layout.SIDE], rows[layout.CROSSED] = 1.0, np.inf
    rows[layout.SWITCH, of_impacts:] = 1.0
    rows[layout.SIDE, of_impacts:] = np.where(start[of_impacts:] < 0.0, -1.0, 1.0)
    _inverse_masses(params, n)[:] = 1.0
    return params


def _set_impacts(params: Floats, impacts: Impacts, count: int, problem: Any, system: System) -> None:
    """Set what the user says about impacts."""
    params[layout.LOCATED] = choice("located", impacts.located)
    rows = _rows(params)
    rows[layout.RESTITUTION, :count] = numbers_of("restitution", impacts.restitution, count, 1.0)
    rows[layout.FRICTION, :count] = numbers_of("friction", impacts.friction, count, np.inf)
    _inverse_masses(params, system.x0.size)[:] = 1.0 / masses_of(impacts.mass, problem, system)


def _rows(params: Floats) -> Floats:
    """Return a view with one column per surface."""
    count = int(params[layout.COUNT])
    return params[layout.HEAD : layout.HEAD + layout.ROWS * count].reshape(layout.ROWS, count)


def _inverse_masses(params: Floats, n: int) -> Floats:
    begin = layout.HEAD + layout.ROWS * int(params[layout.COUNT])
    return params[begin : begin + n]


def spelled(spell: Spell, word: Word) -> Spelled:
    """Add the letters that cut steps to a word."""
    whole = Fraction(1)
    return [("begin-cut", whole, Fraction(0)), *spell(word), ("end-cut", whole, whole)]


def _between(spell: Spell, word: Word) -> Spelled:
    whole = Fraction(1)
    return [("begin-between", whole, Fraction(0)), *spell(word), ("end-between", whole, whole)]


def sides_at(switches: Any, problem: Any, adapter: Adapter) -> Floats:
    """Return the side of each switch on which the start is, 1 or -1; nothing for systems, which have their own params.

    Raises
    ------
    ArgumentError
        For anything but functions of the state.
    """
    if switches is None or isinstance(problem, System):
        return np.zeros(0)
    gap = _adapted("switches", switches, adapter)
    x, v, params, out = adapter.x0.reshape(-1), adapter.v0.reshape(-1), gap.params, np.zeros(gap.size)
    gap.function(adapter.t0, x.copy(), v.copy(), params, out)
    return np.where(out < 0.0, -1.0, 1.0)


def _check(impacts: Impacts | None, system: System, method: Method, course: Course) -> None:
    if impacts is not None and course.t1 < course.t0:
        raise ArgumentError(
            f"t_span=({course.t0!r}, {course.t1!r}) runs backwards, but impacts are irreversible; start at the earlier"
            " time."
        )
    if not Kind.VELOCITY_DEPENDENT.includes(system.kind) and impacts is not None:
        raise ArgumentError(
            f"impacts change velocities, but the kind of {system.name!r} is {system.kind.value}; describe it as"
            " kd.SecondOrder, kd.Newtonian or another kind with x' = v."
        )
    if impacts is not None and system.radii is not None:
        raise ArgumentError(
            f"impacts are given, but the bodies of {system.name!r} have radii, and merge on contact; leave one of them"
            " out."
        )
    check_copies("impacts and switches", system, method)


def _adapted(name: str, function: Any, adapter: Adapter) -> Quantity:
    allowed = ("t", "x", "params") if name == "impacts" else ("t", "x", "v", "params", "q", "p", "y")
    role = f"the gap of {name}" if name == "impacts" else "switches"
    shape = adapter.shape_of(function, role, allowed)
    if len(shape) > 1 or 0 in shape:
        raise ArgumentError(f"{role}, {name_of(function)}, returns an array of shape {shape}; give a number or a list.")
    alone = adapter._replace(numbers=[])
    adapted = alone.adapt(function, role, allowed, shape)
    return Quantity(adapted.function, size=int(np.prod(shape)), params=alone.args)


def _both(one: Quantity, other: Quantity) -> Quantity:
    assert one.params is not None
    assert other.params is not None
    function = bind(
        _one_after_the_other, first=one.function, second=other.function, COUNT=one.size, PARAMS=one.params.size
    )
    return Quantity(function, size=one.size + other.size, params=np.concatenate([one.params, other.params]))


def _one_after_the_other(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    first(t, x, v, part(params, 0, PARAMS), part(out, 0, COUNT))
    second(t, x, v, part(params, PARAMS, params.size - PARAMS), part(out, COUNT, out.size - COUNT))

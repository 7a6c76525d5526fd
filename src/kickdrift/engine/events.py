"""Events: where functions of the state pass through zero along a run.

After every chunk of steps its states are asked for. Where the sign of a function has changed between two of them, the step that
lies between is done again, shorter, until it ends at the zero: as exact as the method is there.
"""

import math
from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.core.kinds import Kind
from kickdrift.engine.processing import Processing
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.engine.zeros import Brackets, changes, search
from kickdrift.systems.problem import name_of
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]

_NUMBERS = 1 << 16  # of states that are kept until they are asked
_MOST_ROWS = 4096
# Of a step in which a function may pass through zero and back. One that stays near zero has 256 parts asked in each step.
_HALVINGS = 8


class Event(NamedTuple):
    """A function whose zeros are wanted: its name, and what users have set as its attributes."""

    name: str
    quantity: Quantity
    terminal: int  # at which zero the run ends, 0 for none
    direction: float
    rate_bound: float | None


class Zero(NamedTuple):
    """A zero of an event, by its number, and the state there."""

    t: float
    event: int
    x: Floats
    v: Floats


class Seen(NamedTuple):
    """What was found of events up to a step: zeros, the steps in which further ones are, and the evaluations that it took.

    No zero up to the time `beyond` ends a run: it went on from there.
    """

    zeros: tuple[Zero, ...]
    waiting: tuple[tuple[int, Brackets], ...]
    evaluations: int
    beyond: float | None = None


class Found(NamedTuple):
    """What a look at a chunk has found: after how many of its steps it ends, the zero at which it does, and what went wrong."""

    steps: int
    stop: Zero | None = None
    failure: str = ""


def events_of(events: Any, quantity: Callable[[str, Any], Quantity]) -> tuple[Event, ...]:
    """Adapt functions to the state by `quantity`, and read their attributes.

    Raises
    ------
    ArgumentError
        For what is no function of the state, and attributes that cannot be.
    """
    if events is None:
        return ()
    functions = list(events) if isinstance(events, Sequence) else [events]
    return tuple(_event(f"events[{k}]", function, quantity) for k, function in enumerate(functions))


def _event(name: str, function: Any, quantity: Callable[[str, Any], Quantity]) -> Event:
    terminal, direction = getattr(function, "terminal", False), getattr(function, "direction", 0)
    bound = getattr(function, "rate_bound", None)
    name = f"{name}, {name_of(function)}" if callable(function) else name
    if not (isinstance(terminal, bool | np.bool_ | int | np.integer) and terminal >= 0):
        raise ArgumentError(f"{name}, has terminal={terminal!r}; give True, False, or at which zero the run ends.")
    for attribute, value, wanted in (
        ("direction", direction, "1, -1 or 0"),
        ("rate_bound", bound, "a positive number"),
    ):
        is_real = isinstance(value, int | float | np.integer | np.floating) and math.isfinite(value)
        if value is not None and not (is_real and (attribute == "direction" or value > 0.0)):
            raise ArgumentError(f"{name}, has {attribute}={value!r}; give {wanted}.")
    return Event(
        name, quantity(name, function), int(terminal), float(direction), None if bound is None else float(bound)
    )


def watch_for(
    events: tuple[Event, ...], system: System, processing: Callable[[], Processing], end: float
) -> "Watch | None":
    """Make what looks for events along a run, if there are any.

    Raises
    ------
    ArgumentError
        For Langevin dynamics, whose path is not known between two steps.
    """
    if not events:
        return None
    if system.kind is Kind.LANGEVIN:
        raise ArgumentError(
            "events are given, but noise drives the path: between two steps it is not known; leave them out."
        )
    return Watch(events, system, processing(), end)


class Watch:
    """Events along a run.

    Parameters
    ----------
    events : tuple of Event
    system : System
    processing : Processing
        The method, with a state of its own.
    end : float
        Of the span: steps of varying sizes may lead beyond it.

    Attributes
    ----------
    most : int
        Steps that may be looked at at once.
    evaluations : int
        Of the force, in search of zeros.
    """

    def __init__(self, events: tuple[Event, ...], system: System, processing: Processing, end: float) -> None:
        self.events, self._system, self._processing, self._end = events, system, processing, end
        self.most = max(1, min(_MOST_ROWS, _NUMBERS // max(system.x0.size, 1)))
        self.evaluations = 0
        self._zeros: list[Zero] = []
        self._waiting: list[tuple[int, Brackets]] = []  # zeros that end nothing: sought many at once
        self._x, self._v = system.x0[None], system.v0[None]
        self._sign = 1.0  # of the steps
        self._beyond: float | None = None

    def seen(self, t: float, near: float, beyond: float | None) -> Seen:
        """Return what was found up to a time, and what is `near` to it; no zero up to `beyond`, if given, will end the run."""
        sign = self._sign
        waiting = [
            (k, brackets.part(sign * (brackets.t + 0.5 * brackets.size) < sign * t)) for k, brackets in self._joined()
        ]
        zeros = tuple(zero for zero in self._zeros if sign * zero.t <= sign * t + near)
        return Seen(zeros, tuple(waiting), self.evaluations, self._beyond if beyond is None else beyond)

    def go_on(self, seen: Seen, t: float, x: Floats, v: Floats) -> None:
        """Go on from a time, from what was found up to there, and the state of the loop then, which is overwritten."""
        self._zeros, self._waiting = list(seen.zeros), list(seen.waiting)
        self.evaluations, self._beyond, self._sign = seen.evaluations, seen.beyond, math.copysign(1.0, self._end - t)
        self._x, self._v = self._processing.seen(np.array([t]), x[None], v[None])

    def look(self, t: Floats, xs: Floats, vs: Floats) -> Found:
        """Look at the steps between times, after each of which the loop has a state."""
        xs, vs = self._processing.seen(t[1:], xs, vs)
        count, self._sign = t.size - 1, math.copysign(1.0, t[-1] - t[0])
        xs, vs = np.concatenate((self._x, xs)), np.concatenate((self._v, vs))
        values = [evaluate_quantity(event.quantity, self._system, t, xs, vs) for event in self.events]
        bad = np.flatnonzero(np.isnan(values).any(axis=0))
        steps = count if not bad.size else max(int(bad[0]) - 1, 0)
        for k, value in enumerate(values):
            ends, before = np.s_[1 : steps + 1], np.s_[:steps]
            part = np.zeros(steps)
            of = np.diff(t)[before]
            brackets = Brackets(t[before], of, xs[before], vs[before], part, part + 1.0, value[before], value[ends])
            brackets = self._bracketed(k, brackets)
            if brackets.t.size and self.events[k].terminal:
                self._zeros += self._search(k, brackets)
            elif brackets.t.size:
                self._waiting.append((k, brackets))
        stop, failure = self._stop(), ""
        if stop is not None:
            near = 1e-9 * np.diff(t, prepend=t[0] - (t[1] - t[0]))
            before_it = int(np.searchsorted(self._sign * (t + near), self._sign * stop.t, side="left")) - 1
            steps = min(steps, max(before_it, 0))
        elif bad.size:
            k = int(np.argmax(np.isnan([value[bad[0]] for value in values])))
            failure = f" {self.events[k].name}, gave no number at t={float(t[bad[0]])!r}."
        self._x, self._v = xs[steps : steps + 1], vs[steps : steps + 1]
        return Found(steps, stop, failure)

    def by_event(self, end: float) -> tuple[tuple[Zero, ...], ...]:
        """Return the zeros of each event up to the time at which a run ended, in their order.

        Ctrl-C may have come after zeros were found, and before the run had noted the steps in which they are.
        """
        sign, found = self._sign, list(self._zeros)
        for k, brackets in self._joined():
            found += self._search(k, brackets)
        found = sorted((zero for zero in found if sign * zero.t <= sign * end), key=lambda zero: sign * zero.t)
        return tuple(tuple(zero for zero in found if zero.event == k) for k in range(len(self.events)))

    def _joined(self) -> list[tuple[int, Brackets]]:
        """Return the steps with zeros that are still to be sought, those of an event together."""
        events = sorted({event for event, _ in self._waiting})
        return [(k, reduce(Brackets.joined, (own for event, own in self._waiting if event == k))) for k in events]

    def _stop(self) -> Zero | None:
        """Return the first zero that ends the run."""
        counts = [0] * len(self.events)
        for zero in sorted(self._zeros, key=lambda zero: zero.t * self._sign):
            if self._beyond is not None and self._sign * zero.t <= self._sign * self._beyond:
                continue
            counts[zero.event] += 1
            if 0 < self.events[zero.event].terminal <= counts[zero.event]:
                return zero if self._sign * zero.t <= self._sign * self._end else None
        return None

    def _ask(self, event: int, at: Brackets, share: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return when parts of steps end, and the states and values of an event there."""
        size = share * at.size
        x, v, evaluations = self._processing.go_on(at.t, size, np.ones(at.t.size, dtype=np.int64), at.x, at.v)
        self.evaluations += int(evaluations.sum())
        t = at.t + size
        values = evaluate_quantity(self.events[event].quantity, self._system, t, x, v)
        if np.isnan(values).any():
            raise KickdriftError(f"{self.events[event].name}, gave no number at t={float(t[np.isnan(values)][0])!r}")
        return t, x, v, values

    def _bracketed(self, event: int, steps: Brackets) -> Brackets:
        """Return the parts of steps with a zero in the wanted direction; steps are halved where two zeros may hide."""
        found, bound = steps.part(self._crosses(event, steps)), self.events[event].rate_bound
        if bound is None:
            return found
        left = steps.part(~changes(steps))
        for _ in range(_HALVINGS):
            way = bound * np.abs(left.size) * (left.end - left.begin)
            left = left.part((abs(left.first) + abs(left.last) <= way) & (left.first != 0.0) & (left.last != 0.0))
            if not left.t.size:
                break
            middle = 0.5 * (left.begin + left.end)
            value = self._ask(event, left, middle)[3]
            halves = left._replace(end=middle, last=value).joined(left._replace(begin=middle, first=value))
            found, left = found.joined(halves.part(self._crosses(event, halves))), halves.part(~changes(halves))
        return found

    def _crosses(self, event: int, parts: Brackets) -> NDArray[np.bool_]:
        """Say where an event changes its sign in the direction that is wanted."""
        direction = self.events[event].direction
        wanted = np.ones(parts.t.size, dtype=bool) if direction == 0.0 else (parts.first < 0.0) == (direction > 0.0)
        return np.asarray(changes(parts) & wanted)

    def _search(self, event: int, brackets: Brackets) -> list[Zero]:
        """Find the zeros of an event, and the states there."""
        tolerance = 4.0 * np.spacing(np.abs(brackets.t) + np.abs(brackets.size)) / np.abs(brackets.size)
        share = search(
            *brackets[4:], lambda which, shares: self._ask(event, brackets.part(which), shares)[3], tolerance
        )
        t, x, v, _ = self._ask(event, brackets, share)
        return [Zero(float(t[k]), event, x[k], v[k]) for k in range(t.size)]

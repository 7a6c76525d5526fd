"""Events: where functions of the state pass through zero along a run.

After every chunk of steps the functions are evaluated at its states. Where the sign of a function has changed between two
states, the step between them is repeated with smaller sizes until it ends at the zero, which is as accurate as the method.
Impacts: see `surface_events`.
"""

import math
from collections.abc import Callable
from functools import partial
from itertools import repeat
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.event_functions import Event, check_path
from kickdrift.engine.event_values import Raised, check_numbers, first_bad, values_of
from kickdrift.engine.processing import Processing
from kickdrift.engine.strikes import Strikes, strikes_at
from kickdrift.engine.surface_events import Surfaces
from kickdrift.engine.zeros import (
    Brackets,
    Found,
    Seen,
    Zero,
    changes,
    find_changes,
    joined_by_event,
    search,
    spent_from,
    tolerance_of,
    with_zeros,
)
from kickdrift.systems.system import System

Floats = NDArray[np.float64]

_NUMBERS = 1 << 16  # of states that are kept until functions are evaluated there
# fewer cost more calls, and more do not stay in the cache: 34 ns a step more for 1 << 12, 3 for 1 << 14, 5 for 1 << 16
_MOST_ROWS = 1 << 15
_NEAR = 1e-9  # of a step: a step that begins so soon before the end of a run has no zero before it


def watch_for(
    events: tuple[Event, ...],
    system: System,
    processing: Callable[[], Processing],
    end: float,
    surfaces: Surfaces | None = None,
) -> "Watch":
    """Create the `Watch` for events along a run.

    Raises
    ------
    ArgumentError
        As `check_path`.
    """
    check_path(events, system)
    return Watch(events, system, processing(), end, surfaces)


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
    surfaces : Surfaces, optional
        Of impacts.

    Attributes
    ----------
    most : int
        Steps that may be looked at at once.
    evaluations : int
        Of the force, in search of zeros.
    beyond : float or None
        Time up to which no zero ends the run.
    """

    def __init__(
        self,
        events: tuple[Event, ...],
        system: System,
        processing: Processing,
        end: float,
        surfaces: Surfaces | None = None,
    ) -> None:
        self.events, self._system, self._processing, self._end = events, system, processing, end
        self._surfaces = surfaces
        self.most = max(1, min(_MOST_ROWS, _NUMBERS // max(system.x0.size, 1)))
        self.evaluations, self._sign = 0, 1.0  # the sign of the steps
        self._zeros: list[Zero] = []
        self._jumps: list[Zero] = []  # those of them at which a function is not zero
        self._waiting: list[tuple[int, Brackets]] = []  # zeros that end nothing: sought many at once
        self._due: list[tuple[int, Brackets]] = []  # zeros that may end the run, of this look
        self._x, self._v = system.x0[None], system.v0[None]
        self._spent: list[tuple[Floats, NDArray[np.int64]]] = []  # in the last look: starts of steps, and evaluations
        self.beyond: float | None = None

    def seen(self, t: float, beyond: float | None) -> Seen:
        """Return the zeros found in the steps up to a time; no zero up to `beyond`, if given, will end the run."""
        sign = self._sign
        waiting = [
            (k, brackets.part(sign * (brackets.t + 0.5 * brackets.size) < sign * t))
            for k, brackets in joined_by_event(self._waiting)
        ]
        zeros = tuple(zero for zero in self._zeros if sign * zero.middle < sign * t)
        later = sum(zero.evaluations for zero in self._zeros) - sum(zero.evaluations for zero in zeros)  # sought again
        later += spent_from(self._spent, t, sign, at_it=True)
        return Seen(zeros, tuple(waiting), self.evaluations - later, self.beyond if beyond is None else beyond)

    def go_on(self, seen: Seen, step: float, t: float, x: Floats, v: Floats) -> None:
        """Continue from a time, with the zeros found up to there and the state of the loop then, which is overwritten.

        The direction is that of `step`: the last one may have led beyond the end.
        """
        self._zeros, self._waiting = list(seen.zeros), list(seen.waiting)
        self.evaluations, self.beyond, self._sign = seen.evaluations, seen.beyond, math.copysign(1.0, step)
        self._x, self._v = self._processing.seen(np.array([t]), x[None], v[None])

    def look(self, t: Floats, xs: Floats, vs: Floats) -> Found:
        """Look at the steps between times, after each of which the loop has a state."""
        self._spent = []
        xs, vs = self._processing.seen(t[1:], xs, vs)
        count, self._sign = t.size - 1, math.copysign(1.0, t[-1] - t[0])
        xs, vs = np.concatenate((self._x, xs)), np.concatenate((self._v, vs))
        raised: list[Raised] = [{} for _ in self.events]
        values = [self._values(k, t, xs, vs, raised[k]) for k in range(len(self.events))]
        bad, why = first_bad(self.events, t, values, raised, jumps=self._surfaces is not None)
        steps = count if bad is None else max(bad - 1, 0)
        strikes = self._strikes(t[: steps + 1], xs[: steps + 1], vs[: steps + 1], values)
        for k, value in enumerate(values):
            if self.events[k].rate_bound is None and strikes is None:
                found = np.empty(steps, dtype=np.int64)
                of = found[: find_changes(value[: steps + 1], found)]
            else:
                of = np.arange(steps)
            begin = np.zeros(of.size)
            brackets = Brackets(t[of], t[of + 1] - t[of], xs[of], vs[of], begin, begin + 1.0, value[of], value[of + 1])
            if strikes is not None:
                self._strike(k, strikes, brackets, value[strikes.steps + 1])
                brackets = brackets.part(strikes.others)
            self._note(k, self._bracketed(k, brackets))
        self._search_due()
        stop, failure = self._stop(), ""
        if stop is not None:
            steps = min(steps, int(np.searchsorted(self._sign * t, self._sign * stop.middle)) - 1)
            last, sign = float(t[steps]), self._sign
            self.evaluations -= spent_from(self._spent, last, sign, at_it=False)  # of steps that will not be
            self._spent = [(b[k], own[k]) for b, own in self._spent for k in [sign * b <= sign * last]]
        elif bad is not None:
            failure = why
        self._x, self._v = xs[steps : steps + 1], vs[steps : steps + 1]
        return Found(steps, stop, failure, any(zero is stop for zero in self._jumps))

    def _values(self, event: int, t: Floats, x: Floats, v: Floats, raised: Raised | None = None) -> Floats:
        return values_of(self.events[event].quantity, self._system, t, x, v, {} if raised is None else raised)

    def _all_values(self, event: int, t: Floats, x: Floats, v: Floats) -> Floats:
        raised: Raised = {}
        values = self._values(event, t, x, v, raised)
        check_numbers(self.events[event], t, values, raised)
        return values

    def _note(self, event: int, brackets: Brackets) -> None:
        """Keep brackets: those of zeros that may end the run until the end of the look, and the others until later."""
        if brackets.t.size:
            (self._due if self.events[event].terminal else self._waiting).append((event, brackets))

    def _search_due(self) -> None:
        """Search for zeros that may end the run, up to the first that does: the cost does not depend on chunks."""
        sign, due, self._due = self._sign, joined_by_event(self._due), []
        while due:
            starts = []
            for k, brackets in due:
                missing = self.events[k].terminal - sum(zero.event == k for zero in self._zeros)
                starts.append(np.sort(sign * brackets.t)[min(max(int(missing), 1), brackets.t.size) - 1])
            for k, brackets in due:
                self._zeros += self._search(k, brackets.part(sign * brackets.t <= min(starts)))
            stop = self._stop()
            last = math.inf if stop is None else sign * stop.t
            rest = [(k, b.part((sign * b.t > min(starts)) & (sign * b.t <= last))) for k, b in due]
            due = [(k, brackets) for k, brackets in rest if brackets.t.size]

    def _strikes(self, t: Floats, xs: Floats, vs: Floats, values: list[Floats]) -> Strikes | None:
        """Find the steps that end with impacts, if any do, and round values where something touches."""
        if self._surfaces is None:
            return None
        touched = self._surfaces.touched(self._system, t, xs, vs)
        rows, steps = np.flatnonzero(touched), np.flatnonzero(self._surfaces.struck(t, touched))
        for k, value in enumerate(values):
            value[rows] = self._surfaces.rounded(partial(self._values, k), value[rows], t[rows], xs[rows], vs[rows])
        if not steps.size:
            return None
        strikes, evaluations = strikes_at(steps, self._processing, t, xs, vs)
        self.evaluations += int(evaluations.sum())
        self._spent.append((t[steps], evaluations))
        return strikes

    def _strike(self, event: int, at: Strikes, steps: Brackets, after: Floats) -> None:
        """Note the zeros of an event in steps that end with impacts, and in these: the states are those after them."""
        assert self._surfaces is not None
        before = self._all_values(event, at.t, at.x, at.v)
        before = self._surfaces.rounded(partial(self._values, event), before, at.t, at.x, at.v)
        steps = steps.part(at.steps)._replace(last=before)
        hops = np.flatnonzero((steps.first == 0.0) & (before == 0.0))
        if hops.size:  # from an impact to the next in one step
            steps = self._from_the_middle(event, steps, hops)
        found = self._bracketed(event, steps)
        at_end = (found.last == 0.0) & (found.end == 1.0)
        self._note(event, found.part(~at_end))
        jumps = self._crosses(event, steps._replace(first=before, last=after))
        jumps &= self._surfaces.located | (after != 0.0)  # otherwise bodies return to surfaces they had passed
        for k in np.flatnonzero(jumps | np.isin(steps.t, found.t[at_end])):
            middle = float(steps.t[k] + 0.5 * steps.size[k])
            self._zeros.append(Zero(float(at.t[k]), middle, event, at.x_after[k], at.v_after[k]))
            if after[k] != 0.0:
                self._jumps.append(self._zeros[-1])

    def by_event(self, end: float) -> tuple[tuple[Zero, ...], ...]:
        """Return the zeros of each event up to the time at which a run ended, in their order.

        Ctrl-C may have come after zeros were found, and before the run had noted the steps in which they are.
        """
        sign, found = self._sign, list(self._zeros)
        for k, brackets in joined_by_event(self._waiting):
            found += self._search(k, brackets.part(sign * (brackets.t + _NEAR * brackets.size) < sign * end))
        found = sorted([zero for zero in found if sign * zero.t <= sign * end], key=attrgetter("t"), reverse=sign < 0.0)
        return tuple(tuple([zero for zero in found if zero.event == k]) for k in range(len(self.events)))

    def _stop(self) -> Zero | None:
        """Return the first zero that ends the run."""
        counts = [0] * len(self.events)
        for zero in sorted(self._zeros, key=lambda zero: zero.t * self._sign):
            if self.beyond is not None and self._sign * zero.t <= self._sign * self.beyond:
                continue
            counts[zero.event] += 1
            if 0 < self.events[zero.event].terminal <= counts[zero.event]:
                return zero if self._sign * zero.t <= self._sign * self._end else None
        return None

    def _from_the_middle(self, event: int, steps: Brackets, which: NDArray[np.intp]) -> Brackets:
        """Begin some steps in their middle."""
        assert self._surfaces is not None
        t, x, v, values, own = self._ask(event, steps.part(which), np.full(which.size, 0.5))
        self._spent.append((steps.t[which], own))
        begin, first = steps.begin.copy(), steps.first.copy()
        begin[which], first[which] = 0.5, self._surfaces.rounded(partial(self._values, event), values, t, x, v)
        return steps._replace(begin=begin, first=first)

    def _ask(self, event: int, at: Brackets, share: Floats) -> tuple[Floats, Floats, Floats, Floats, NDArray[np.int64]]:
        """Return when parts of steps end, the states and values of an event there, and the force evaluations."""
        size = share * at.size
        x, v, evaluations = self._processing.go_on(at.t, size, np.ones(at.t.size, dtype=np.int64), at.x, at.v)
        self.evaluations += int(evaluations.sum())
        t = at.t + size
        return t, x, v, self._all_values(event, t, x, v), evaluations

    def _bracketed(self, event: int, steps: Brackets) -> Brackets:
        """Return the parts of steps with a zero in the wanted direction; steps are halved where more zeros may hide."""
        bound = self.events[event].rate_bound
        if bound is None:
            return steps if (crosses := self._crosses(event, steps)).all() else steps.part(crosses)

        def value_at(which: NDArray[np.intp], left: Brackets, share: Floats) -> Floats:
            *_, values, own = self._ask(event, left, share)
            self._spent.append((left.t, own))
            return values

        parts, _ = with_zeros(steps, bound, value_at)
        return parts.part(self._crosses(event, parts))

    def _crosses(self, event: int, parts: Brackets) -> NDArray[np.bool_]:
        """Return where an event changes its sign in its direction."""
        direction = self.events[event].direction
        wanted = np.ones(parts.t.size, dtype=bool) if direction == 0.0 else (parts.first < 0.0) == (direction > 0.0)
        return np.asarray(changes(parts) & wanted)

    def _search(self, event: int, brackets: Brackets) -> list[Zero]:
        """Find the zeros of an event, and the states there."""
        if not brackets.t.size:
            return []
        taken = np.zeros(brackets.t.size, dtype=np.int64)

        def at(which: NDArray[np.intp], shares: Floats) -> Floats:
            *_, values, own = self._ask(event, brackets.part(which), shares)
            taken[which] += own
            return values

        share = search(*brackets[4:], at, tolerance_of(brackets))
        t, x, v, _, own = self._ask(event, brackets, share)
        middle = brackets.t + 0.5 * brackets.size
        return list(map(Zero, t.tolist(), middle.tolist(), repeat(event), x, v, (taken + own).tolist()))

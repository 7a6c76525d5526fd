"""Members of an ensemble one after the other with their events, found of many members at once, as `events` finds those of one.

Members run in stretches, and those that a terminal event has ended do not go on. The zeros are sought at the end: of terminal
events those in the steps up to the one with the zero that ends a member, and of others all up to that end.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import KickdriftError
from kickdrift.engine.dense import DenseOutput, States
from kickdrift.engine.event_functions import Event
from kickdrift.engine.grid import Grid
from kickdrift.engine.in_turn import Members, states_wanted
from kickdrift.engine.processing import Processing
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.engine.zeros import Brackets, find_changes, search, tolerance_of, too_fast, with_zeros

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_NUMBERS = 1 << 16  # of states that are looked at at once: 512 KB
_SHORTEST = 16  # steps of a stretch
_NEAR = 1e-8  # of a step: a zero so near to its ends may belong to another one, which a run of the member alone decides


class Found(NamedTuple):
    """Zeros of an event: the members in which they are, times and states, and the evaluations that each took."""

    member: Integers
    t: Floats
    x: Floats
    v: Floats
    evaluations: Integers

    def part(self, which: Any) -> "Found":
        """Return some of them."""
        return Found(*(array[which] for array in self))

    def of_members(self, count: int) -> list[tuple[Floats, Floats, Floats]]:
        """Return the times and states of each of a number of members."""
        ends = np.searchsorted(self.member, np.arange(1, count))
        return list(zip(*(np.split(array, ends) for array in (self.t, self.x, self.v)), strict=True))


@dataclass(frozen=True)
class Watched:
    """Results of members: rows, (M, T, *shape), NaN after their end, steps, evaluations, and which are `good`.

    And which an event has `stopped`, and the zeros of each event, in the order of members and times.
    """

    x: Floats
    v: Floats
    n_steps: Integers
    evaluations: Integers
    good: NDArray[np.bool_]
    stopped: NDArray[np.bool_]
    zeros: tuple[Found, ...]


class WatchedMembers:
    """Members with events.

    Parameters
    ----------
    made : callable
        Returns the method compiled, with a state of its own; no states are processed. And of parts of steps, `between`.
    events : sequence of Event
        Those with a bound of their rate only if none ends a run.
    numbers : sequence of (M, p) array
        The params of each event, for each member.
    grid : Grid
    x, v : (M, *shape) array
        The starts.
    params : (M, p) array
    """

    def __init__(
        self,
        made: Callable[[], Processing],
        between: Callable[[], Processing],
        events: Sequence[Event],
        numbers: Sequence[Floats],
        grid: Grid,
        x: Floats,
        v: Floats,
        params: Floats,
    ) -> None:
        self._processing, self._again, self._between = made(), made(), between
        self._events, self._numbers, self._grid, self._params = events, numbers, grid, params
        self._start = x, v
        self._sign = np.sign(grid.step)
        self._members = Members(self._processing, grid, x, v, params)
        count = len(x)
        self._good: NDArray[np.bool_] = np.ones(count, dtype=bool)
        self._ahead = self._good.copy()
        self._latest = np.full(count, np.inf)  # start of the step, times the sign, in which the zero is that ends it
        self._counts = np.zeros((len(events), count), dtype=np.int64)
        self._spent = np.zeros(count, dtype=np.int64)  # evaluations between the ends of steps
        self._brackets: list[list[tuple[Integers, Brackets]]] = [[] for _ in events]
        rows = count, grid.save_steps.size
        self._xs, self._vs = np.full((*rows, *x.shape[1:]), np.nan), np.full((*rows, *v.shape[1:]), np.nan)

    def run(self) -> Watched:
        """Run all of them."""
        step, n_steps = 0, self._grid.n_steps
        size = max(1, self._start[0][0].size + self._start[1][0].size)
        while step < n_steps and (which := np.flatnonzero(self._ahead)).size:
            last = min(step + max(_SHORTEST, _NUMBERS // (which.size * size)), n_steps)
            self._look(which, step, last)
            step = last
        return self._ended()

    def _look(self, which: NDArray[np.intp], first: int, last: int) -> None:
        """Run some members over some steps, keep their rows, and note the steps in which events have zeros."""
        grid, events = self._grid, self._events
        before = self._members.x[which], self._members.v[which]
        xs, vs, well = self._members.advance(which, first, last, np.arange(first + 1, last + 1))
        self._leave(which[~well])
        which = which[well]
        count, rows = which.size, last - first + 1
        x, v = (
            np.concatenate((start[well, None], own[well]), axis=1).reshape(count, rows, *kept.shape[2:])
            for start, own, kept in zip(before, (xs, vs), (self._xs, self._vs), strict=True)
        )
        low, high = np.searchsorted(grid.save_steps, (first + (first > 0), last + 1))
        wanted = grid.save_steps[low:high] - first
        self._xs[which, low:high], self._vs[which, low:high] = x[:, wanted], v[:, wanted]
        t = np.asarray(grid.t0 + grid.step * np.arange(first, last + 1), dtype=np.float64)
        for k in range(len(events)):
            self._find(k, which, t, x, v)

    def _find(self, event: int, which: NDArray[np.intp], t: Floats, x: Floats, v: Floats) -> None:
        """Note the steps in which an event has zeros."""
        rows, own = t.size, self._events[event]
        flat = x.reshape(-1, *x.shape[2:]), v.reshape(-1, *v.shape[2:])
        values = self._values(event, np.tile(t, which.size), *flat, which)
        bad = np.asarray(np.isnan(of_members := values.reshape(which.size, rows)).any(axis=1))
        if own.rate_bound is not None:
            bad |= too_fast(t, of_members, own.rate_bound).any(axis=1)
        self._leave(which[bad])
        room = np.empty(values.size, dtype=np.int64)
        inside = np.append(np.arange(values.size - 1) % rows != rows - 1, False) & ~np.repeat(bad, rows)

        def steps_at(of: Any) -> tuple[Integers, Brackets]:
            row, begin = of % rows, np.zeros(of.size)
            found = flat[0][of], flat[1][of], begin, begin + 1.0, values[of], values[of + 1]
            return which[of // rows], Brackets(t[row], t[row + 1] - t[row], *found)

        of = room[: find_changes(values, room)]
        of = of[inside[of]]
        if own.rate_bound is not None:
            near = np.abs(values[:-1]) + np.abs(values[1:]) <= (1.0 + 1e-9) * own.rate_bound * abs(self._grid.step)
            self._look_closer(event, *steps_at(np.union1d(of, np.flatnonzero(near & inside[:-1]))))
        if own.direction != 0.0:
            of = of[(values[of] < 0.0) == (own.direction > 0.0)]
        member, brackets = steps_at(of)
        self._brackets[event] += [(member, brackets)] if own.rate_bound is None else []
        if own.terminal:
            order = np.arange(of.size) - np.searchsorted(member, member) + self._counts[event, member]
            ends = order == own.terminal - 1
            self._latest[member[ends]] = np.minimum(self._latest[member[ends]], self._sign * brackets.t[ends])
            self._ahead[member[ends]] = False
            self._counts[event] += np.bincount(member, minlength=len(self._good))

    def _look_closer(self, event: int, member: Integers, steps: Brackets) -> None:
        """Note the parts of steps in which an event changes its sign, each with one zero."""
        direction, bound = self._events[event].direction, self._events[event].rate_bound
        assert bound is not None

        def value_at(which: NDArray[np.intp], left: Brackets, share: Floats) -> Floats:
            *_, values, spent = self._ask(event, member[which], left, share)
            np.add.at(self._spent, member[which], spent)
            return values

        parts, of = with_zeros(steps, bound, value_at)
        wanted = np.flatnonzero((direction == 0.0) | ((parts.first < 0.0) == (direction > 0.0)))
        self._brackets[event].append((member[of[wanted]], parts.part(wanted)))

    def _leave(self, which: NDArray[np.intp]) -> None:
        """Give up members, for runs of them alone."""
        self._good[which] = self._ahead[which] = False

    def _values(self, event: int, t: Floats, x: Floats, v: Floats, member: NDArray[Any]) -> Floats:
        numbers = np.ascontiguousarray(self._numbers[event][member])
        if not t.size:
            return np.zeros(0)
        return evaluate_quantity(self._events[event].quantity, self._processing.system, t, x, v, numbers)

    def _ask(
        self, event: int, member: Integers, at: Brackets, share: Floats
    ) -> tuple[Floats, Floats, Floats, Floats, Integers]:
        """Return when parts of steps end, the states and values of an event there, and the force evaluations."""
        size, once = share * at.size, np.ones(share.size, dtype=np.int64)
        params = np.ascontiguousarray(self._params[member])
        x, v, evaluations = self._again.go_on(at.t, size, once, at.x, at.v, params)
        values = self._values(event, at.t + size, x, v, member)
        if np.isnan(values).any():
            raise KickdriftError(f"{self._events[event].name}, returned NaN between two steps")
        return at.t + size, x, v, values, evaluations

    def _search(self, event: int, member: Integers, brackets: Brackets) -> Found:
        """Find the zeros of an event."""
        evaluations = np.zeros(member.size, dtype=np.int64)

        def at(which: Any, share: Floats) -> tuple[Floats, Floats, Floats, Floats]:
            t, x, v, values, took = self._ask(event, member[which], brackets.part(which), share)
            evaluations[which] += took
            return t, x, v, values

        if not member.size:
            return Found(member, brackets.t, brackets.x, brackets.v, evaluations)
        share = search(*brackets[4:], lambda which, shares: at(which, shares)[3], tolerance_of(brackets))
        t, x, v, _ = at(np.arange(member.size), share)
        return Found(member, t, x, v, evaluations)

    def _ended(self) -> Watched:
        """Find the zeros, and where members end."""
        grid, sign, count = self._grid, self._sign, len(self._good)
        joined = [
            (np.concatenate([member for member, _ in own]), Brackets.joined(*(brackets for _, brackets in own)))
            for own in self._brackets
        ]
        zeros: list[Found | None] = [None] * len(self._events)
        end, evaluations = np.full(count, sign * grid.t1), self._spent.copy()
        stopped = np.isfinite(self._latest)
        for k in [k for k, event in enumerate(self._events) if event.terminal]:
            zeros[k] = found = self._searched(k, *joined[k], self._latest)
            ends = (
                np.arange(found.member.size) - np.searchsorted(found.member, found.member)
                == self._events[k].terminal - 1
            )
            np.minimum.at(end, found.member[ends], sign * found.t[ends])
        for k, (member, brackets) in enumerate(joined):
            if zeros[k] is None:
                zeros[k] = self._searched(k, member, brackets, end)
            else:  # a step that begins with the zero that ends a member
                self._leave(member[(sign * brackets.t > self._latest[member]) & (sign * brackets.t <= end[member])])
        kept = []
        for own in zeros:
            assert own is not None
            np.add.at(evaluations, own.member, own.evaluations)
            kept.append(own.part(sign * own.t <= end[own.member]))
        steps, near = np.divmod((sign * end - grid.t0) / grid.step, 1.0)
        self._leave(np.flatnonzero(stopped & ((near < _NEAR) | (near > 1.0 - _NEAR))))
        program = self._processing.kernel.program
        n_steps = np.where(stopped, steps, grid.n_steps).astype(np.int64)
        evaluations += n_steps * program.evaluations + self._counted(n_steps, stopped) + self._members.primed
        self._xs[grid.save_steps > n_steps[:, None]] = self._vs[grid.save_steps > n_steps[:, None]] = np.nan
        x, v = self._xs, self._vs
        if grid.wanted is not None:
            x, v = self._at_wanted(kept, n_steps, np.where(stopped, sign * end, grid.t1), evaluations)
        return Watched(x, v, n_steps, evaluations, self._good, stopped, tuple(kept))

    def _counted(self, n_steps: Integers, stopped: NDArray[np.bool_]) -> Integers:
        """Return the evaluations that flows have counted up to the ends of members: those that went beyond go there again."""
        counted = self._members.counted
        again = np.flatnonzero(stopped & self._good & (counted > 0))
        if again.size:
            members = Members(self._again, self._grid, *self._start, self._params)
            for m in again:
                members.advance([m], 0, int(n_steps[m]), np.zeros(0, dtype=np.int64))
            counted[again] = members.counted[again]
        return counted

    def _searched(self, event: int, member: Integers, brackets: Brackets, until: Floats) -> Found:
        """Find the zeros of an event in the steps that begin up to some time, in the order of members."""
        which = np.flatnonzero(self._good[member] & (self._sign * brackets.t <= until[member]))
        first = self._sign * (brackets.t + brackets.begin * brackets.size)
        which = which[np.lexsort((first[which], member[which]))]
        return self._search(event, member[which], brackets.part(which))

    def _at_wanted(
        self, zeros: Sequence[Found], n_steps: Integers, end: Floats, evaluations: Integers
    ) -> tuple[Floats, Floats]:
        """Return the states at the times wanted, up to the ends of members; the evaluations are added."""
        grid, outputs, good = self._grid, [], np.flatnonzero(self._good)
        assert grid.wanted is not None
        ends = [zeros[k] for k, event in enumerate(self._events) if event.terminal]
        for m in good:
            rows = slice(int(np.searchsorted(grid.save_steps, n_steps[m], side="right")))
            kept = grid.times[rows], self._xs[m, rows], self._vs[m, rows], np.full(rows.stop, grid.step)
            output = DenseOutput.of_rows(
                grid, States(self._start[0][m], self._start[1][m]), kept, end[m], self._between
            )
            for found in ends:
                stop = np.flatnonzero((found.member == m) & (found.t == end[m]))
                if stop.size and output.t[-1] != end[m]:
                    output = output.followed_by(end[m], found.x[stop[0]], found.v[stop[0]])
            outputs.append(output)
        xs, vs = (np.full((len(self._good), grid.wanted.size, *own.shape[2:]), np.nan) for own in (self._xs, self._vs))
        if outputs:
            xs[good], vs[good], own = states_wanted(grid, outputs, self._params[good])
            evaluations[good] += own
        return xs, vs

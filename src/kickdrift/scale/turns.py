"""Members one after the other without the interpreter in between, of steps that are equal or vary."""

from collections.abc import Callable, Sequence
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.outcomes import Outcome
from kickdrift.engine import in_turn
from kickdrift.engine.courses_in_turn import run_courses
from kickdrift.engine.event_functions import Event
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.processing import Processing, compile_method
from kickdrift.engine.run import ended_early, is_zero
from kickdrift.engine.step_control import LocalError
from kickdrift.engine.watched_in_turn import WatchedMembers
from kickdrift.scale.moments import Moments
from kickdrift.scale.prepared import Cohort, Prepared
from kickdrift.scale.results import Results

Floats = NDArray[np.float64]
Numbers = tuple[Floats, Floats, Floats]


def numbers_in_turn(prepared: Prepared, grid: Grid | Course) -> Numbers | None:
    """Return x, v and params of all members, if they may run in turn: what is compiled, and knows params, is one for all."""
    if not prepared.system.native or not prepared.cut_alike():
        return None
    if any(event.rate_bound is not None for event in prepared.events) and any(
        event.terminal for event in prepared.events
    ):
        return None  # evaluations between steps, and their number, depend on the end of the run
    if isinstance(grid, Course):
        if prepared.events:
            return None
        return None if _driven(prepared, grid).is_processed else prepared.numbers()
    numbers = prepared.numbers()
    if numbers is not None and (prepared.events or not prepared.one_system()):
        return None if _processing(prepared, grid).is_processed else numbers
    return numbers


def run_in_turn(prepared: Prepared, cohort: Cohort, numbers: Numbers, most: int, results: Results) -> NDArray[np.bool_]:
    """Run members, for a limited number of steps if these vary, and return which of them reached the end."""
    grid, indices = cohort.grid, cohort.indices
    if isinstance(grid, Course):
        return _run_courses(prepared, grid, indices, numbers, most, results)
    x, v, params = _of(indices, numbers, results)
    between = cache(partial(_processing, prepared, grid, True))
    if prepared.events:
        return _watched(prepared, cohort, between, numbers_of_events(prepared, indices), (x, v, params), results)
    turns = in_turn.run_in_turn(_processing(prepared, grid), between, grid, x, v, params)
    good = turns.good
    results.x[indices[good]], results.v[indices[good]] = turns.x[good], turns.v[good]
    results.note(indices[good], grid, grid.n_steps, turns.x.shape[1], turns.evaluations[good])
    return good


def _of(indices: NDArray[np.intp], numbers: Numbers, results: Results) -> Numbers:
    """Return x and v, (M, *shape), and params of some members."""
    x, v, params = (array[indices] for array in numbers)
    return x.reshape(len(x), *results.x.shape[2:]), v.reshape(len(v), *results.v.shape[2:]), params


def _run_courses(
    prepared: Prepared, grid: Course, indices: NDArray[np.intp], numbers: Numbers, most: int, results: Results
) -> NDArray[np.bool_]:
    """Run members with variable steps, and return who reached the end."""
    between = cache(partial(_driven, prepared, grid, True))
    if prepared.settings.steering.cuts:
        of_control, _, good = prepared.cut_numbers(indices, numbers[0][indices], numbers[1][indices])
    else:
        of_control, good = _numbers_of_control(prepared, numbers[2][indices], indices), np.full(indices.size, True)
    if not good.any():
        return good
    which = indices[good]
    courses = run_courses(_driven(prepared, grid), between, grid, *_of(which, numbers, results), of_control[good], most)
    good[good] = courses.good
    which, n_steps = indices[good], courses.n_steps[courses.good]
    results.x[which], results.v[which] = courses.x, courses.v
    results.note(which, grid, n_steps, results.x.shape[1], courses.evaluations[courses.good])
    results.rejected[which] = courses.rejected[courses.good]
    results.step_range[which] = courses.step_range[courses.good]
    return good


def _watched(
    prepared: Prepared,
    cohort: Cohort,
    between: Callable[[], Processing],
    of_events: list[Floats],
    own: Numbers,
    results: Results,
) -> NDArray[np.bool_]:
    """Run members with events, and return of which all is known."""
    grid, indices = cohort.grid, cohort.indices
    assert isinstance(grid, Grid)
    made = partial(_processing, prepared, grid)
    watched = WatchedMembers(made, between, prepared.events, of_events, grid, *own).run()
    good, zeros = watched.good, [found.of_members(indices.size) for found in watched.zeros]
    results.x[indices[good]], results.v[indices[good]] = watched.x[good], watched.v[good]
    evaluations, rows = watched.evaluations, results.x.shape[1]
    results.note(indices[good], grid, grid.n_steps, rows, evaluations[good])
    results.n_steps[indices[good]] = watched.n_steps[good]
    for i in np.flatnonzero(good):
        results.zeros[indices[i]] = found = Moments(*zip(*(of_event[i] for of_event in zeros), strict=True))
        if watched.stopped[i]:
            name, last = _end(prepared.events, found)
            steps = f"{watched.n_steps[i]} of {grid.n_steps} steps"
            message = ended_early(Outcome.STOPPED, float(last.t[0][0]), steps, is_zero(name))
            results.status[indices[i]], results.messages[indices[i]] = Outcome.STOPPED, message
            results.last[indices[i]] = last
    return good


def _end(events: Sequence[Event], zeros: Moments) -> tuple[str, Moments]:
    """Return the name of the event that ended a member, the first of several, and the state there."""
    k = next(k for k, event in enumerate(events) if 0 < event.terminal <= zeros.t[k].size)
    at = slice(events[k].terminal - 1, events[k].terminal)
    return events[k].name, Moments(*((arrays[k][at],) for arrays in zeros))


def numbers_of_events(prepared: Prepared, indices: NDArray[np.intp]) -> list[Floats]:
    """Return the params of each event for some members: numbers of users, and of the functions themselves."""
    params = [event.quantity.params for event in prepared.events]
    return [prepared.with_args(prepared.system.params if own is None else own, indices) for own in params]


def _numbers_of_control(prepared: Prepared, params: Floats, indices: NDArray[np.intp]) -> Floats:
    """Return the params of step control for each member: its tolerances, or the params of its density."""
    controller = prepared.controller
    assert controller is not None
    if isinstance(prepared.settings.steering.control, LocalError):
        return np.tile(controller.params, (indices.size, 1))
    if np.array_equal(controller.params, prepared.system.params):
        return np.ascontiguousarray(params)
    return prepared.with_args(controller.params, indices)


def _processing(prepared: Prepared, grid: Grid, between: bool = False) -> Processing:
    """Compile the method; where every step is looked at, as it is spelled, but for what leads between steps."""
    turns = between or not prepared.events
    return compile_method(prepared.system, prepared.chosen.method, grid, prepared.settings.compensated, turns)


def _driven(prepared: Prepared, grid: Course, between: bool = False) -> Processing:
    """Compile the method for steps that vary, or for what leads between them."""
    controller = prepared.controller
    if between and controller is not None:
        controller = controller.between
    compensated = prepared.settings.compensated
    return compile_method(prepared.driven, prepared.chosen.method, grid, compensated, controller=controller)

"""Members one after the other without the interpreter in between, of steps that are equal or vary."""

from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine import in_turn
from kickdrift.engine.courses_in_turn import run_courses
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.processing import Processing, compile_method
from kickdrift.scale.prepared import Cohort, Prepared
from kickdrift.scale.results import Results

Floats = NDArray[np.float64]
Numbers = tuple[Floats, Floats, Floats]


def numbers_in_turn(prepared: Prepared, grid: Grid | Course) -> Numbers | None:
    """Return x, v and params of all members, if they may run in turn: what is compiled, and knows params, is one for all."""
    if not prepared.system.native or prepared.settings.steering.cuts or prepared.events:
        return None
    if isinstance(grid, Course):
        return prepared.numbers() if prepared.one_system() and not _driven(prepared, grid).is_processed else None
    numbers = prepared.numbers() if grid.wanted is None else None
    if numbers is not None and not prepared.one_system() and _processing(prepared, grid).is_processed:
        return None
    return numbers


def run_in_turn(prepared: Prepared, cohort: Cohort, numbers: Numbers, most: int, results: Results) -> NDArray[np.bool_]:
    """Run members, if their steps vary for so many at most, and return who reached the end."""
    grid, indices = cohort.grid, cohort.indices
    x, v, params = (array[indices] for array in numbers)
    x = x.reshape(indices.size, *results.x.shape[2:])
    v = v.reshape(indices.size, *results.v.shape[2:])
    if isinstance(grid, Course):
        between = cache(partial(_driven, prepared, grid, True))
        courses = run_courses(_driven(prepared, grid), between, grid, x, v, most)
        good = courses.good
        results.x[indices[good]], results.v[indices[good]] = courses.x, courses.v
        results.note(indices[good], grid, courses.n_steps[good], results.x.shape[1], courses.evaluations[good])
        results.rejected[indices[good]], results.step_range[indices[good]] = (
            courses.rejected[good],
            courses.step_range[good],
        )
        return good
    turns = in_turn.run_in_turn(_processing(prepared, grid), grid, x, v, params)
    good = turns.good
    results.x[indices[good]], results.v[indices[good]] = turns.x[good], turns.v[good]
    results.note(indices[good], grid, grid.n_steps, turns.x.shape[1], turns.evaluations[good])
    return good


def _processing(prepared: Prepared, grid: Grid) -> Processing:
    return compile_method(prepared.system, prepared.chosen.method, grid, prepared.settings.compensated)


def _driven(prepared: Prepared, grid: Course, between: bool = False) -> Processing:
    """Compile the method for steps that vary, or for what leads between them."""
    controller = prepared.controller
    if between and controller is not None:
        controller = controller.between
    compensated = prepared.settings.compensated
    return compile_method(prepared.driven, prepared.chosen.method, grid, compensated, controller=controller)

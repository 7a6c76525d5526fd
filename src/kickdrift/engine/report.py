"""From a run to its solution: what was kept, what it conserves, and how it went."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine import multipliers, quantities
from kickdrift.engine.grid import Grid
from kickdrift.engine.method_selection import Choice
from kickdrift.engine.processing import Processing
from kickdrift.engine.run import Ending, Run
from kickdrift.engine.solution import Description, Invariants, Solution
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


def report(
    system: System, chosen: Choice, grid: Grid, processing: Processing, run: Run, ending: Ending, compensated: bool
) -> Solution:
    """Return what a run has kept, as people see it."""
    t = np.append(grid.times, grid.times[-1])[: ending.saved]
    if ending.outcome is not Outcome.COMPLETED and ending.saved:
        t[-1] = grid.t0 + ending.n_steps * grid.step
    xs, vs = processing.leave(grid, run.xs, run.vs, ending)
    for kept in (t, xs, vs):
        kept.flags.writeable = False  # invariants are evaluated later, from the same numbers
    return Solution(
        t=t,
        x=xs,
        v=vs,
        invariants=Invariants(tuple(system.quantities), partial(quantities.evaluate, system, t=t, x=xs, v=vs)),
        status=ending.outcome,
        message=ending.message + quantities.energy_lost(system, t, xs, vs),
        step=grid.step,
        n_steps=ending.n_steps,
        n_force_evaluations=ending.evaluations + processing.evaluations(ending.saved),
        wall_time=ending.wall_time,
        about=_description(system, chosen, compensated),
        derived=_derived(system, t, xs, vs),
        error_estimate=None if ending.estimated is None else ending.estimated.reshape(system.x0.shape),
    )


def _derived(system: System, t: Floats, xs: Floats, vs: Floats) -> Invariants:
    constrained = system.kind is Kind.CONSTRAINED
    return Invariants(("multipliers",) * constrained, lambda name: multipliers.evaluate(system, t, xs, vs))


def _description(system: System, chosen: Choice, compensated: bool) -> Description:
    method = chosen.method
    units = dict(system.units) | {name: quantity.unit for name, quantity in system.quantities.items() if quantity.unit}
    return Description(
        system=system.name,
        method=method.name,
        kind=system.kind.name,
        order=method.order,
        word=method.spelling,
        compensated=compensated,
        dimensions=system.dimensions or tuple(f"axis_{i}" for i in range(system.x0.ndim)),
        coordinates=dict(system.coordinates),
        units=units,
        source=system.source,
        choice=chosen.reason,
    )

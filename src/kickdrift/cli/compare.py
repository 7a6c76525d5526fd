"""``kickdrift compare``: the four methods that every course begins with, side by side."""

from pathlib import Path

import numpy as np

from kickdrift import analysis
from kickdrift.cli import DONE, INTERRUPTED
from kickdrift.cli.output import prepare_folder, say, show_table
from kickdrift.cli.plan import Plan
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.solution import Solution
from kickdrift.plots import plot_energy_comparison
from kickdrift.scenes import FIRST_METHODS, first_methods_side_by_side, kept_times
from kickdrift.systems import System

_COLUMNS = (
    *("method", "energy error", "energy drift", "phase error", "force evaluations", "ns per step", "error at the end"),
    "outcome",
)


def compare(plan: Plan, folder: Path) -> int:
    """Run the methods, show the table, draw ``<system>-energy.png`` into a folder, and return the exit code.

    A method that cannot reach the end is a result like the others, not a failure; an interruption leaves the methods
    after it out.
    """
    kept_times(plan.duration, plan.step)
    prepare_folder(folder)
    say(f"{plan.in_words} by {', '.join(FIRST_METHODS)}")
    solutions: dict[str, Solution] = {}
    for solution in first_methods_side_by_side(plan.system, plan.duration, plan.step):
        solutions[solution.about.method] = solution
        if solution.status is Outcome.INTERRUPTED:
            break
    show_table(_COLUMNS, [_row(plan.system, solution) for solution in solutions.values()])
    picture = folder / f"{plan.system.name}-energy.png"
    plot_energy_comparison(solutions, picture)
    print(f"\nwritten: {picture}")
    if solution.status is Outcome.INTERRUPTED:
        say(solution.message)
        return INTERRUPTED
    return DONE


def _row(system: System, solution: Solution) -> list[str]:
    outcome = "done" if solution.success else solution.status.name.lower().replace("_", " ")
    return [
        solution.about.method,
        f"{analysis.largest_energy_error(solution):.3e}",
        f"{analysis.energy_drift(solution):+.3e}",
        _phase_error(solution),
        f"{solution.n_force_evaluations}",
        f"{solution.wall_time / max(solution.n_steps, 1) * 1e9:.4g}",
        _error_at_end(system, solution),
        outcome if solution.success else f"{outcome} at t={solution.t[-1]:g}",
    ]


def _phase_error(solution: Solution) -> str:
    """Time by which the run is ahead of the exact motion at the last time, where there is one."""
    return f"{analysis.phase_error(solution)[-1]:+.3e}" if "phase error" in solution.derived else "-"


def _error_at_end(system: System, solution: Solution) -> str:
    """Distance in position from the exact solution at the last time, where there is one."""
    if system.exact is None:
        return "-"
    exact, _ = system.exact(solution.t[-1:])
    return f"{np.linalg.norm(solution.x[-1] - exact[0]):.3e}"

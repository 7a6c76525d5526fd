"""The scenes: one function each, shared by examples, tests, benchmarks and the command line."""

from collections.abc import Iterator
from dataclasses import dataclass

from kickdrift.core.constants import JULIAN_YEAR
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.methods import Method
from kickdrift.scenes.solar_system import (
    METHOD,
    NEWTONIAN_FLOOR,
    STEP,
    YEARS,
    Distances,
    Kept,
    distances_to_jpl,
    jpl_days,
    kept_every,
    kept_times,
    planets,
)
from kickdrift.systems import System

__all__ = [
    "DEFAULTS",
    "FIRST_METHODS",
    "NEWTONIAN_FLOOR",
    "Defaults",
    "Distances",
    "Kept",
    "distances_to_jpl",
    "first_methods_side_by_side",
    "jpl_days",
    "kept_every",
    "kept_times",
    "planets",
]


@dataclass(frozen=True)
class Defaults:
    """How long and in which steps a system is run by default, in its own unit of time.

    Attributes
    ----------
    duration, step : float
        Of one run.
    method : str
        Its method.
    comparison : (float, float)
        Duration and step for the methods of `FIRST_METHODS`: steps so small that implicit Euler, under which orbits
        shrink, reaches the end before two bodies collide.
    """

    duration: float = 100.0
    step: float = 0.01
    method: str = "stormer-verlet"
    comparison: tuple[float, float] = (100.0, 0.01)


# By the name of the system; one that is missing has what `Defaults()` says.
DEFAULTS: dict[str, Defaults] = {
    "harmonic-oscillator": Defaults(comparison=(100.0, 0.05)),
    "pendulum": Defaults(comparison=(100.0, 0.05)),
    "kepler": Defaults(comparison=(50.0, 0.001)),
    "solar-system": Defaults(YEARS * JULIAN_YEAR.value, STEP, METHOD, comparison=(JULIAN_YEAR.value, 0.005)),
    "outer-solar-system": Defaults(200_000.0, 50.0, "wisdom-holman", comparison=(20_000.0, 2.0)),
    "benchmarks-game": Defaults(1000.0, 0.01, "semi-implicit-euler", comparison=(50.0, 0.002)),
}

# The four that every course begins with.
FIRST_METHODS = ("explicit-euler", "implicit-euler", "semi-implicit-euler", "stormer-verlet")


def first_methods_side_by_side(
    system: System,
    duration: float,
    step: float,
    methods: tuple[str | Method, ...] = FIRST_METHODS,
    progress: bool | None = None,
) -> Iterator[Solution]:
    """Run a system with explicit, implicit and semi-implicit Euler and Stoermer-Verlet, all with the same step.

    Parameters
    ----------
    system : System
    duration, step : float
        In the unit of time of the system.
    methods : tuple of str or Method
        Other methods to run.
    progress : bool, optional
        As in `kickdrift.solve`.

    Yields
    ------
    Solution
        As each is done.
    """
    times = kept_times(duration, step).times
    for method in methods:
        yield solve(system, (0.0, duration), step=step, method=method, t_eval=times, progress=progress)

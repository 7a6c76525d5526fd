"""The solar system for a number of years, and how far it then is from JPL's positions."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.constants import JULIAN_YEAR
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.grid import lay_grid
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.methods import Method
from kickdrift.systems import ephemeris
from kickdrift.systems import solar_system as make_solar_system

Floats = NDArray[np.float64]

YEARS = 100.0
METHOD = "blanes-moan-srkn6b"
# Every epoch of JPL's is a whole number of these. After ten years the step costs Mercury 0.12 km and the Moon 0.29 km
# (0.75 day: 10 and 32), after a hundred 1.3 and 2.7; a hundred years take 0.2 s.
STEP = 0.25
MOST_ROWS = 4000  # of a solution kept: 2 MB for eleven bodies

# What point-mass Newtonian gravity of all eleven bodies misses JPL's DE421 by, integrated without error: heliocentric,
# in km, by days after J2000. General relativity and the asteroids are what it leaves out.
NEWTONIAN_FLOOR = {
    365.25: {"Mercury": 58.0, "Venus": 99.0, "Earth": 61.0, "Mars": 40.0, "Jupiter": 0.9},
    3652.5: {"Mercury": 1820.0, "Venus": 900.0, "Earth": 612.0, "Mars": 342.0, "Jupiter": 69.0},
}


class Kept(NamedTuple):
    """Times to keep of a run, and those that were wanted but fall between two steps."""

    times: Floats
    missed: list[float]


class Distances(NamedTuple):
    """How far bodies are from JPL's positions, both taken from the Sun.

    Attributes
    ----------
    bodies : list of str
        Names, without the Sun.
    days : (E,) array
        Epochs, in days after J2000.
    km : (N, E) array
        Distances.
    """

    bodies: list[str]
    days: Floats
    km: Floats


def planets(
    years: float = YEARS,
    *,
    step: float = STEP,
    method: str | Method = METHOD,
    bodies: Sequence[str] | None = None,
    progress: bool | None = None,
) -> Solution:
    """Integrate the solar system from J2000 on, keeping at most a few thousand rows and JPL's epochs among them.

    Parameters
    ----------
    years : float
        Julian years.
    step : float
        Largest step, in days.
    method : str or Method
        Name of a method.
    bodies : sequence of str, optional
        Which bodies; all eleven by default.
    progress : bool, optional
        As in `kickdrift.solve`.
    """
    duration = years * JULIAN_YEAR.value
    times = kept_times(duration, step, also=jpl_days()).times
    system = make_solar_system(bodies)
    return solve(system, (0.0, duration), step=step, method=method, t_eval=times, progress=progress)


def jpl_days() -> Floats:
    """Return the epochs of JPL's positions, in days after J2000."""
    sky = ephemeris()
    days: Floats = sky.epochs - sky.epochs[0]
    return days


def kept_every(duration: float, step: float, save_every: int | None = None) -> int:
    """Return how many steps lie between the states to keep: as few as keep `MOST_ROWS` rows by default."""
    if save_every is not None:
        return save_every
    return -(-lay_grid((0.0, duration), step, None, MOST_ROWS, 1).n_steps // MOST_ROWS)


def kept_times(duration: float, step: float, save_every: int | None = None, also: Iterable[float] = ()) -> Kept:
    """Choose the times to keep of a run from 0: regular ones, the end, and those of `also` on the grid of steps.

    Parameters
    ----------
    duration : float
        End of the run.
    step : float
        Largest step, as in `kickdrift.solve`.
    save_every : int, optional
        Steps between regular times; as few as keep `MOST_ROWS` rows by default.
    also : iterable of float
        Other times; those outside the run are left out.

    Returns
    -------
    Kept

    Raises
    ------
    ArgumentError
        For a duration, step or `save_every` that cannot be.
    """
    whole = lay_grid((0.0, duration), step, None, MOST_ROWS, 1)
    regular = lay_grid((0.0, duration), step, None, kept_every(duration, step, save_every), 1).save_steps
    positions = np.array(list(also), dtype=np.float64) / whole.step
    nearest = np.rint(positions)
    inside = (positions > -0.5) & (nearest <= whole.n_steps)
    on_grid = abs(positions - nearest) < 1e-9 * np.maximum(1.0, nearest)
    steps = np.union1d(regular, nearest[inside & on_grid].astype(np.int64))
    times: Floats = np.asarray(steps * whole.step, dtype=np.float64)
    times[-1] = duration
    return Kept(times, (positions[inside & ~on_grid] * whole.step).tolist())


def distances_to_jpl(solution: Solution) -> Distances:
    """Measure how far the bodies are from JPL's positions, at the epochs of JPL's that the solution keeps.

    Both are taken from the Sun. Without the Moon, the Earth is measured against the barycentre of both.

    Raises
    ------
    ArgumentError
        If the Sun is not among the bodies.
    """
    sky = ephemeris()
    names = list(solution.about.coordinates["body"])
    if "Sun" not in names:
        raise ArgumentError(
            f"bodies={','.join(names)!r} leaves out the Sun, from which the distance to JPL's positions is measured;"
            " add Sun."
        )
    reference = sky.x[:, [sky.bodies.index(name) for name in names]]
    if "Earth" in names and "Moon" not in names:
        pair = [sky.bodies.index("Earth"), sky.bodies.index("Moon")]
        reference[:, names.index("Earth")] = np.average(sky.x[:, pair], axis=1, weights=sky.gm[pair])
    sun = names.index("Sun")
    days = jpl_days()
    rows = [(row, epoch) for epoch, day in enumerate(days) for row in np.flatnonzero(abs(solution.t - day) < 1e-6)]
    computed, epochs = solution.x[[row for row, _ in rows]], [epoch for _, epoch in rows]
    offset = (computed - computed[:, [sun]]) - (reference[epochs] - reference[epochs][:, [sun]])
    km = np.linalg.norm(np.delete(offset, sun, axis=1), axis=2).T * sky.au_km
    return Distances([name for name in names if name != "Sun"], days[epochs], km)

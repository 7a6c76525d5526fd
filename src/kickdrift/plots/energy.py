"""Energy errors over time: of one run, and of several methods side by side."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.analysis import energy_drift, energy_error, largest_energy_error
from kickdrift.core.colours import COLOURS
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution
from kickdrift.plots.page import INK, dress, keep, label, one_panel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]
_MINUS = "\N{MINUS SIGN}"
_BINS = 1500  # over the width of a panel, more than it has pixels on a screen


def draw_energy_error(axes: "Axes", solution: Solution) -> None:
    """Plot the signed energy error: a bounded error stays in a band, a drift leaves it."""
    units = solution.about.units
    _draw_band(axes, solution.t, energy_error(solution), COLOURS[0])
    axes.axhline(0, color=INK, linewidth=0.6)
    dress(axes, label("t", units.get("t")), _name_of_error(solution), "energy error")
    axes.margins(x=0)
    _name_power(axes, largest_energy_error(solution))
    if solution.t.size > 1:
        # The drift over the whole run, so that it compares with the largest error.
        drift = energy_drift(solution) * (solution.t[-1] - solution.t[0])
        facts = f"largest {largest_energy_error(solution):.2g}, drift {drift:+.2g} over the run".replace("-", _MINUS)
        axes.set_title(facts, loc="right", fontsize=8.5, color=INK)


def _name_power(axes: "Axes", largest: float) -> None:
    """Write the power of ten that the ticks share into the label: above the axis it would be in the title's way."""
    if not 0 < largest < math.inf or 0.01 <= largest < 1000:
        return
    power = math.floor(math.log10(largest))
    axes.yaxis.set_major_formatter(lambda y, _: f"{y / 10.0**power:.6g}".replace("-", _MINUS))
    axes.set_ylabel(f"{axes.get_ylabel()}   [$\\times\\, 10^{{{power}}}$]")


def _name_of_error(solution: Solution) -> str:
    if solution.energy[0] != 0:
        return r"$(E - E_0)\, /\, |E_0|$"
    return label("$E - E_0$", solution.about.units.get("energy"))


def _draw_band(axes: "Axes", t: Floats, error: Floats, colour: str) -> None:
    """Draw a line, or, if it has more points than can be resolved, the band between its extremes."""
    finite = np.isfinite(error)
    t, error = t[finite], error[finite]
    if t.size <= 2 * _BINS:
        axes.plot(t, error, color=colour, linewidth=1)
        return
    starts = np.linspace(0, t.size, _BINS, endpoint=False).astype(np.intp)
    low, high = np.minimum.reduceat(error, starts), np.maximum.reduceat(error, starts)
    times = np.append(t[starts[:-1]], t[-1])
    axes.fill_between(times, low, high, color=colour, linewidth=0.9, alpha=0.85)


def plot_energy_comparison(
    solutions: Mapping[str, Solution], path: str | Path | None = None, *, ax: "Axes | None" = None
) -> "Figure":
    """Plot the energy errors of several runs in one figure.

    The axis is linear around zero, up to the smallest of the runs' maximal errors, and logarithmic beyond, so that growth, loss
    and bounded oscillations are all visible.

    Parameters
    ----------
    solutions : mapping of str to Solution
        Runs by the names that the legend shows, such as the methods.
    path : path, optional
        Where to write the figure; the file extension determines the format.
    ax : matplotlib.axes.Axes, optional
        Where to draw, instead of on a figure of its own.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ArgumentError
        If there are no solutions, or ax is not an Axes.
    KickdriftError
        If a system has no energy.
    FileFormatError
        If the file cannot be written.
    MissingExtraError
        If matplotlib is not installed.

    Examples
    --------
    >>> import kickdrift as kd
    >>> orbit = kd.systems.kepler()
    >>> runs = {
    ...     name: kd.solve(orbit, (0.0, 20.0), step=0.01, method=name)
    ...     for name in ("kick-drift", "leapfrog")
    ... }
    >>> figure = kd.plots.plot_energy_comparison(runs)
    """
    if not solutions:
        raise ArgumentError("solutions is empty; give at least one, such as {'kick-drift': kd.solve(...)}.")
    solutions = {name: solution.plain for name, solution in solutions.items()}
    first = next(iter(solutions.values()))
    systems = dict.fromkeys(s.about.system for s in solutions.values())
    figure, axes = one_panel(8, 4.4, f"{', '.join(systems)}: energy error by method", ax)
    largest = [largest_energy_error(s) for s in solutions.values()]
    for i, (name, solution) in enumerate(solutions.items()):
        colour = COLOURS[i % len(COLOURS)]
        _draw_band(axes, solution.t, energy_error(solution), colour)
        axes.plot([], [], color=colour, linewidth=2, label=name)
    axes.axhline(0, color=INK, linewidth=0.6)
    dress(axes, label("t", first.about.units.get("t")), _name_of_error(first))
    axes.margins(x=0)
    smallest = min((value for value in largest if 0 < value < math.inf), default=1.0)
    axes.set_yscale("symlog", linthresh=10.0 ** np.ceil(np.log10(smallest)), linscale=0.6)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False, fontsize=9)
    return keep(figure, path)

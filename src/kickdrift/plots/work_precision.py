"""Errors over work, one line per method."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kickdrift.analysis import WorkPrecision
from kickdrift.core.colours import COLOURS
from kickdrift.plots.page import check_axes, dress, keep, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MARKERS = "osD^vP"  # one fewer than there are colours, so that pairs of both come back after 42 curves


def plot_work_precision(
    measured: WorkPrecision, path: str | Path | None = None, *, ax: "Axes | None" = None
) -> "Figure":
    """Plot errors at the end against force evaluations and against milliseconds, on logarithmic axes.

    Parameters
    ----------
    measured : WorkPrecision
    path : path, optional
        Where to write the figure; the file extension determines the format.
    ax : matplotlib.axes.Axes, optional
        Where to draw errors against force evaluations alone, instead of on a figure of its own.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ArgumentError
        If ax is not an Axes.
    FileFormatError
        If the file cannot be written.
    MissingExtraError
        If matplotlib is not installed.

    Examples
    --------
    >>> import kickdrift as kd
    >>> table = kd.analysis.work_precision(
    ...     kd.systems.kepler(), (0.0, 10.0), ["leapfrog"], [0.05, 0.02], rounds=1
    ... )
    >>> figure = kd.plots.plot_work_precision(table)
    """
    start, end = measured.t_span
    if ax is not None:
        check_axes(ax)
        _draw(ax, measured, "evaluations")
        return keep(ax.figure, path)  # type: ignore[arg-type]  # or a part of a figure
    figure = new_figure(10, 4.4, f"{measured.system}, {start:g} to {end:g}: error at the end")
    left, right = figure.subplots(1, 2, sharey=True)
    _draw(left, measured, "evaluations")
    _draw(right, measured, "milliseconds")
    left.get_legend().remove()
    right.set_ylabel("")
    return keep(figure, path)


def _draw(axes: "Axes", measured: WorkPrecision, work: str) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter

    for i, curve in enumerate(measured.curves):
        usable = np.isfinite(curve.errors) & (curve.errors > 0.0)
        style: dict[str, Any] = {
            "color": COLOURS[i % len(COLOURS)],
            "marker": _MARKERS[i % len(_MARKERS)],
            "markersize": 4,
        }
        amount = curve.evaluations if work == "evaluations" else 1e3 * curve.median
        axes.plot(amount[usable], curve.errors[usable], linewidth=1.4, label=curve.label, **style)
    dress(axes, "force evaluations" if work == "evaluations" else "milliseconds in the loop", "error")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))  # two of a decade, as there may be one alone
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False, fontsize=9)

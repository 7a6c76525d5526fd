"""Errors over work, one line per method."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kickdrift.analysis import WorkPrecision
from kickdrift.core.colours import COLOURS
from kickdrift.plots.page import dress, keep, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MARKERS = "osD^vPX"


def plot_work_precision(measured: WorkPrecision, path: str | Path | None = None) -> "Figure":
    """Plot errors at the end against force evaluations and against milliseconds, on logarithmic axes.

    Parameters
    ----------
    measured : WorkPrecision
    path : path, optional
        Where to write the figure; the file extension determines the format.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    FileFormatError
        If the file cannot be written.
    MissingExtraError
        If matplotlib is not installed.

    Examples
    --------
    >>> import kickdrift as kd
    >>> table = kd.analysis.work_precision(kd.systems.kepler(), (0.0, 10.0), ["leapfrog"], [0.05, 0.02], rounds=1)
    >>> figure = kd.plots.plot_work_precision(table)
    """
    start, end = measured.t_span
    figure = new_figure(10, 4.4, f"{measured.system}, {start:g} to {end:g}: error at the end")
    from matplotlib.ticker import LogLocator, NullFormatter  # after new_figure, which says what is missing

    left, right = figure.subplots(1, 2, sharey=True)
    for i, curve in enumerate(measured.curves):
        usable = np.isfinite(curve.errors) & (curve.errors > 0.0)
        style = {"color": COLOURS[i % len(COLOURS)], "marker": _MARKERS[i % len(_MARKERS)], "markersize": 4}
        for axes, work in ((left, curve.evaluations), (right, 1e3 * curve.median)):
            axes.plot(work[usable], curve.errors[usable], linewidth=1.4, label=curve.label, **style)
    dress(left, "force evaluations", "error")
    dress(right, "milliseconds in the loop", "")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))  # two of a decade, as there may be one alone
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
    right.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False, fontsize=9)
    return keep(figure, path)

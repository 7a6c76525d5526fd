"""Plots of stability regions."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kickdrift import methods
from kickdrift.analysis import amplification_factor, one_step_matrix, stability_limit
from kickdrift.core.colours import COLOURS
from kickdrift.methods import Letter
from kickdrift.plots.page import INK, dress, keep, one_panel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LIMITS = (0.2, 5.0)


def plot_stability_region(
    method: str | methods.Method, path: str | Path | None = None, *, ax: "Axes | None" = None
) -> "Figure":
    """Plot the stability region of a method.

    For a method with an amplification factor R(z), z = h lambda, this is the region |R(z)| <= 1 of the complex plane. For a
    word of kicks and drifts, the moduli of both eigenvalues of one step of the oscillator are plotted against h omega.

    Parameters
    ----------
    method : str or Method
        Name of a method.
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
        If ax is not an Axes.
    FileFormatError
        If the file cannot be written.
    MissingExtraError
        If matplotlib is not installed.

    Examples
    --------
    >>> import kickdrift as kd
    >>> figure = kd.plots.plot_stability_region("implicit-midpoint")
    """
    chosen = methods.get(method)
    figure, axes = one_panel(4.8, 4.8, f"{chosen.name}: region of stability", ax)
    if chosen.word[0][0] in (Letter.KICK, Letter.DRIFT):
        _draw_eigenvalues(axes, chosen)
    else:
        _draw_plane(axes, chosen)
    return keep(figure, path)


def _draw_plane(axes: "Axes", method: methods.Method) -> None:
    real, imaginary = np.linspace(-4, 4, 401), np.linspace(-4, 4, 401)
    size = np.abs(amplification_factor(method, real + 1j * imaginary[:, None]))
    stable = size <= 1 + 1e-12
    axes.contourf(real, imaginary, stable, levels=[0.5, 1.5], colors=[COLOURS[4]], alpha=0.45)
    axes.contour(real, imaginary, size, levels=[1], colors=[COLOURS[0]], linewidths=1.5)
    axes.axhline(0, color=INK, linewidth=0.6)
    axes.axvline(0, color=INK, linewidth=0.6)
    dress(axes, "Re hλ", "Im hλ", "shaded: |R(hλ)| ≤ 1")
    axes.set_aspect("equal")
    axes.annotate(
        "oscillators, λ = ±iω", (0, 3), xytext=(8, 0), textcoords="offset points", fontsize=8.5, color=INK, va="center"
    )


def _draw_eigenvalues(axes: "Axes", method: methods.Method) -> None:
    limit = stability_limit(method)
    # Close to the limit more of them: the first window of instability may be narrow.
    steps = np.union1d(np.linspace(0.01, 1.7 * limit, 400), limit + np.linspace(0, 0.02, 41))
    sizes = np.sort([np.abs(np.linalg.eigvals(one_step_matrix(method, h))) for h in steps], axis=1)
    for i in range(2):
        axes.plot(steps, sizes[:, i], color=COLOURS[i], linewidth=1.6)
    unstable = sizes[:, 1] > 1 + 1e-6
    axes.plot(steps, np.where(unstable, np.nan, sizes[:, 1]), color=INK, linewidth=1.8)
    axes.fill_between(steps, *_LIMITS, where=unstable, color=COLOURS[1], alpha=0.18, linewidth=0.6)
    axes.set_yscale("log")
    axes.set_ylim(*_LIMITS)
    axes.set_yticks(ticks := (0.2, 0.5, 1, 2, 5), [f"{tick:g}" for tick in ticks])
    axes.set_yticks([], minor=True)
    axes.margins(x=0)
    dress(axes, "hω", "moduli of both eigenvalues", f"stable up to hω = {limit:.5g}; shaded: unstable")

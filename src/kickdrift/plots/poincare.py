"""Passages through a surface, as dots in the plane of two numbers of the state."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.analysis import PoincareSection
from kickdrift.core.colours import COLOURS
from kickdrift.core.errors import ArgumentError
from kickdrift.plots.page import dress, keep, one_panel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]


def plot_poincare_sections(
    sections: PoincareSection | Sequence[PoincareSection],
    path: str | Path | None = None,
    *,
    axes: tuple[str, str] | None = None,
    ax: "Axes | None" = None,
) -> "Figure":
    """Plot the crossings of a surface, with one colour per section.

    Parameters
    ----------
    sections : PoincareSection or sequence of PoincareSection
        Of one system, from several starts.
    path : path, optional
        Where to write the figure; the file extension determines the format.
    axes : (str, str), optional
        Two components of the state, such as ``("x[1]", "v[1]")``. By default the position that varies most between
        crossings, and its velocity.
    ax : matplotlib.axes.Axes, optional
        Where to draw, instead of on a figure of its own.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ArgumentError
        For no sections, axes that the state does not have, or an ax that is not an Axes.
    FileFormatError
        If the file cannot be written.
    MissingExtraError
        If matplotlib is not installed.

    Examples
    --------
    >>> import kickdrift as kd
    >>> options = {"step": 0.05, "compile": False, "events": lambda x: x[0]}
    >>> sol = kd.solve(lambda x: -x, (0.0, 20.0), [1.0, 0.0], [0.0, 0.5], **options)
    >>> figure = kd.plots.plot_poincare_sections(kd.analysis.poincare_section(sol))
    """
    many = [sections] if isinstance(sections, PoincareSection) else list(sections)
    if not many:
        raise ArgumentError("sections is empty; give at least one.")
    numbers = [_numbers(section) for section in many]
    chosen = _widest(numbers) if axes is None else tuple(axes)
    for name in chosen:
        if name not in numbers[0]:
            raise ArgumentError(f"axes={axes!r} has {name!r}, but the state has {', '.join(numbers[0])}.")
    title = f"{many[0].system}: {sum(section.t.size for section in many)} crossings"
    figure, panel = one_panel(5.6, 5.2, title, ax)
    for i, own in enumerate(numbers):
        panel.plot(
            own[chosen[0]], own[chosen[1]], ".", color=COLOURS[i % len(COLOURS)], markersize=2.5, markeredgewidth=0
        )
    dress(panel, *chosen)
    return keep(figure, path)


def _numbers(section: PoincareSection) -> dict[str, Floats]:
    found = {}
    for name, half in (("x", section.x), ("v", section.v)):
        for place in np.ndindex(half.shape[1:]):
            found[f"{name}[{', '.join(map(str, place))}]" if place else name] = half[:, *place]
    return found


def _widest(numbers: Sequence[dict[str, Floats]]) -> tuple[str, str]:
    spreads = {
        name: np.ptp(np.concatenate([own[name] for own in numbers])) if any(own[name].size for own in numbers) else 0.0
        for name in numbers[0]
    }
    positions = [name for name in spreads if name.startswith("x")]
    widest = max(positions, key=lambda name: float(spreads[name]))
    partner = "v" + widest[1:]
    return widest, partner if partner in spreads else next(name for name in spreads if name != widest)

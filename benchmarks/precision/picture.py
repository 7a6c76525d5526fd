"""One picture for each case: error over seconds and over evaluations. The colour says whose it is."""

import io
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.precision.case import Case
from benchmarks.precision.labels import Label, place
from kickdrift.analysis.work_curve import Curve
from kickdrift.plots.page import FAINT, dress, new_figure

# Okabe, Ito, Color Universal Design (2008).
COLOURS = {
    "heyoka": "#D55E00",
    "diffrax": "#009E73",
    "SciPy": "#555555",
    "REBOUND": "#B8860B",
    "pyhamsys": "#CC79A7",
    "symplecta": "#7B4FA3",
    "desolver": "#A0522D",
}
_BLUES = ("#6CB4E4", "#2C8FD0", "#0072B2", "#004E7C", "#00263D")
_MARKERS = "osD^vPX"
_LARGEST, _LEAST = 1.0, 1e-16  # errors worth showing
_DPI, _COLOURS_OF_A_PICTURE = 140, 255  # small enough for a repository


def draw(case: Case, kickdrift: list[Curve], peers: list[Curve], path: Path) -> None:
    """Draw a case into a file."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    path.parent.mkdir(parents=True, exist_ok=True)
    what = case.kind.value
    figure = new_figure(11.5, 5.4, f"{what[0].upper()}{what[1:]}: {case.title}")
    FigureCanvasAgg(figure)  # measures the labels
    left, right = figure.subplots(1, 2, sharey=True)
    labels = {axes: _lines(axes, kickdrift, peers, axes is left) for axes in (left, right)}
    dress(left, "seconds in the loop", case.what, "kickdrift in blue")
    dress(right, "evaluations", "")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(x=0.22)
        axes.tick_params(which="minor", length=2, color=FAINT, labelsize=8)
    errors = np.concatenate([label.y for label in labels[left]])
    left.set_ylim(errors.min() / 5, min(3 * _LARGEST, 5 * errors.max()))
    figure.draw_without_rendering()
    for axes, of in labels.items():
        place(axes, of)
    _write(figure, path)


def _lines(axes: Any, kickdrift: list[Curve], peers: list[Curve], of_time: bool) -> list[Label]:
    """Draw all curves as far as they are worth showing, ours last and above the others."""
    labels = []
    for i, curve in enumerate([*peers, *kickdrift]):
        work = curve.median if of_time else curve.evaluations
        usable = np.isfinite(work) & (curve.errors < _LARGEST)
        if not usable.any():
            continue
        library, method = curve.label.split(maxsplit=1)
        mine = i - len(peers)
        colour = _BLUES[mine] if mine >= 0 else COLOURS[library]
        x, y = work[usable], np.maximum(curve.errors[usable], _LEAST)
        axes.plot(
            x,
            y,
            color=colour,
            linewidth=2.2 if mine >= 0 else 1.2,
            marker=_MARKERS[(mine if mine >= 0 else i) % len(_MARKERS)],
            markersize=5 if mine >= 0 else 4,
            markerfacecolor=colour if mine >= 0 else "white",
            zorder=3 if mine >= 0 else 2,
        )
        labels.append(Label(method if mine >= 0 else curve.label, colour, mine >= 0, x, y))
    return labels


def _write(figure: Any, path: Path) -> None:
    from PIL import Image

    pixels = io.BytesIO()
    figure.savefig(pixels, dpi=_DPI, format="png")
    Image.open(pixels).convert("RGB").quantize(_COLOURS_OF_A_PICTURE).save(path, optimize=True)

"""Curves over time beside a scene, with a line that follows the time line of the page."""

import json
from html import escape
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_WIDTH, _HEIGHT = 260, 90  # pixels
_MOST_POINTS = 500  # of a curve

# The client of viser says the time in what is read out of its slider; it has no other way to ask.
_FOLLOW = """
<style>
  @media (max-width: 640px), (max-height: 460px) { #kickdrift-panel > :not(:first-child) { display: none !important } }
</style>
<script>(() => {
  const about = %s, now = document.getElementById("kickdrift-now"), text = document.getElementById("kickdrift-time");
  let shown = NaN;
  setInterval(() => {
    const slider = document.querySelector("[role=slider]");
    const part = slider ? Math.min(1, slider.getAttribute("aria-valuenow") / about.seconds || 0) : 0;
    if (part === shown) return;
    shown = part;
    now.setAttribute("transform", `translate(${part * about.width} 0)`);
    text.textContent = `t = ${(about.first + part * (about.last - about.first)).toPrecision(4)} ${about.unit}`;
  }, 50);
})();</script>"""


class Curve(NamedTuple):
    """A quantity at times kept, its name, and its colour as in HTML."""

    name: str
    values: Floats
    colour: str


def panel(title: str, t: Floats, curves: list[Curve], curve_unit: str, seconds: float, time_unit: str) -> str:
    """Return the part of a page that draws curves and says the time, as HTML.

    Parameters
    ----------
    title : str
    t : (T,) array
        Times kept.
    curves : list of Curve
        If there are none, the page shows the time alone.
    curve_unit : str
        Empty for ratios.
    seconds : float
        At which the page shows the last of the times, as the first of them at 0.
    time_unit : str
        Of the times.
    """
    rows = np.unique(np.linspace(0, t.size - 1, _MOST_POINTS).astype(np.intp))
    across = _WIDTH * np.abs(t[rows] - t[0]) / (abs(t[-1] - t[0]) or 1.0)
    values = np.array([curve.values[rows] for curve in curves]).reshape(len(curves), rows.size)
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    down = _HEIGHT * (high - values) / ((high - low) or 1.0)
    lines, legend = "", ""
    for curve, height in zip(curves, down, strict=True):
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, height, strict=True) if np.isfinite(y))
        lines += f'<polyline points="{points}" fill="none" stroke="{curve.colour}" stroke-width="1.5"/>'
        legend += f' <span style="color:{curve.colour}">&#9644;</span> {escape(curve.name)}'
    scale = f"<div>{low:.4g} to {high:.4g} {escape(curve_unit)}</div>" if curves else ""
    size = f'width="{_WIDTH}" height="{_HEIGHT if curves else 0}"'
    about = {"seconds": seconds, "width": _WIDTH, "first": float(t[0]), "last": float(t[-1]), "unit": time_unit}
    return (
        '<div id="kickdrift-panel"'
        ' style="position:fixed;left:12px;bottom:52px;padding:8px 10px;background:rgba(255,255,255,.85);color:#222;'
        'font:11px sans-serif;pointer-events:none;border-radius:4px">'
        f'<div><h1 style="display:inline;font:inherit">{escape(title)}</h1>, <span id="kickdrift-time"></span></div>'
        f'<svg {size} style="overflow:visible;margin:6px 0;display:block">{lines}'
        f'<path id="kickdrift-now" d="M0 0V{_HEIGHT}" stroke="#222"/></svg>'
        f"<div>{legend}</div>{scale}</div>" + _FOLLOW % json.dumps(about).replace("<", "\\u003c")
    )

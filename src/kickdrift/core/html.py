"""Facts as a table of HTML, for notebooks; all text is escaped."""

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape

Point = tuple[float, float]


def facts(title: str, rows: Iterable[tuple[str, object]], picture: bytes = b"", drawing: str = "") -> str:
    """Return a table of names and values under a title, with a PNG or an SVG below it where there is one.

    Parameters
    ----------
    title : str
    rows : iterable of (str, object)
        Names, and what `str` makes of values.
    picture : bytes
        The content of a PNG file.
    drawing : str
        The element of an SVG, as `path` and `dots` return.
    """
    cells = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{escape(str(value))}</td></tr>'
        for name, value in rows
    )
    drawn = f'<img alt="" src="data:image/png;base64,{b64encode(picture).decode()}">' if picture else ""
    return f"<div><b>{escape(title)}</b><table>{cells}</table>{drawn}{drawing}</div>"


def path(points: Sequence[Point], label: str) -> str:
    """Return an SVG of the lines from point to point; `label` describes it."""
    corners = " ".join(f"{x:.4f},{y:.4f}" for x, y in points)
    style = 'fill="none" stroke="currentColor" stroke-width="1.5" vector-effect="non-scaling-stroke"'
    return _svg(points, f'<polyline points="{corners}" {style}/>', label)


def dots(points: Sequence[Point], label: str) -> str:
    """Return an SVG of dots at points; `label` describes it."""
    size = max(max(map(abs, point)) for point in points) / 40 or 1.0
    circles = "".join(f'<circle cx="{x:.6g}" cy="{y:.6g}" r="{size:.4g}" fill="currentColor"/>' for x, y in points)
    return _svg(points, circles, label)


def _svg(points: Sequence[Point], content: str, label: str) -> str:
    """Return an SVG around points, with y upwards and equal scales."""
    low, high = (tuple(map(choose, zip(*points, strict=True))) for choose in (min, max))
    size = 1.1 * max(high[0] - low[0], high[1] - low[1]) or 1.0
    left, top = ((low[0] + high[0]) - size) / 2, (-(low[1] + high[1]) - size) / 2
    view = f"{left:.6g} {top:.6g} {size:.6g} {size:.6g}"
    return (
        f'<figure style="margin:0"><svg aria-hidden="true" width="160" height="160" viewBox="{view}">'
        f'<g transform="scale(1,-1)">{content}</g></svg><figcaption>{escape(label)}</figcaption></figure>'
    )

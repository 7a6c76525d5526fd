"""Labels beside the lines that they name, where they cover least."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.precision.laws import Floats

_GAP = 7.0  # points between a line and its label
_MARGIN, _NEAR = 2.0, 8.0  # pixels around a label that are to be free, and that other lines should keep out of
_PARTS = 25  # into which a line is cut, to see what a label covers


@dataclass(frozen=True)
class Label:
    """A label and the line that it names, in the coordinates of the picture's axes."""

    text: str
    colour: str
    strong: bool
    x: Floats
    y: Floats


def place(axes: Any, labels: list[Label]) -> None:
    """Write each label beside an end of its line, or one of its points, where it covers the least."""
    from matplotlib.patheffects import withStroke

    renderer, scale = axes.figure.canvas.get_renderer(), axes.figure.dpi / 72
    lines = [_cut(axes.transData.transform(np.column_stack([label.x, label.y]))) for label in labels]
    frame = axes.get_window_extent(renderer)
    taken: list[Floats] = []
    for i in sorted(range(len(labels)), key=lambda i: not labels[i].strong):
        label = labels[i]
        text = axes.text(
            0,
            0,
            label.text,
            color=label.colour,
            fontsize=8.5,
            fontweight="bold" if label.strong else "normal",
            transform=axes.transAxes,
            zorder=4,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )
        extent = text.get_window_extent(renderer)
        size = np.array([extent.width, extent.height])
        points = axes.transData.transform(np.column_stack([label.x, label.y]))
        boxes = list(_candidates(points, size, _GAP * scale))
        costs = [_cost(box, rank, i, taken, lines, frame) for rank, box in enumerate(boxes)]
        chosen = boxes[int(np.argmin(costs))]
        taken.append(chosen)
        text.set_position(axes.transAxes.inverted().transform(chosen[0]))


def _cut(points: Floats) -> Floats:
    """Make many points of a few."""
    if len(points) == 1:
        return points
    at = np.linspace(0, len(points) - 1, _PARTS * (len(points) - 1))
    return np.column_stack([np.interp(at, np.arange(len(points)), column) for column in points.T])


def _candidates(points: Floats, size: Floats, gap: float) -> Any:
    """Yield boxes, lower left and upper right, the most natural places first: beside the end, the start, the points."""
    width, height = size
    order = [len(points) - 1, 0, *range(len(points) - 2, 0, -1)]
    for far in (1.0, 2.0):
        right, left, above, below = far * gap, -far * gap - width, far * gap, -far * gap - height
        sides = ((right, -height / 2), (left, -height / 2), (-width / 2, below), (-width / 2, above))
        corners = tuple((x, y) for x in (right, left) for y in (below / 2 - height / 2, above / 2))
        for i in order:
            for offset in sides + corners:
                lower = points[i] + offset
                yield np.array([lower, lower + size])


def _cost(box: Floats, rank: int, own: int, taken: list[Floats], lines: list[Floats], frame: Any) -> float:
    low, high = box[0] - _MARGIN, box[1] + _MARGIN
    covered = sum(_within(line, low, high) for line in lines)
    near = sum(_within(line, low - _NEAR, high + _NEAR) for i, line in enumerate(lines) if i != own)
    overlaps = sum(bool((np.minimum(high, other[1]) > np.maximum(low, other[0])).all()) for other in taken)
    outside = low[0] < frame.x0 or low[1] < frame.y0 or high[0] > frame.x1 or high[1] > frame.y1
    return float(3.0 * covered + near + 200.0 * overlaps + 500.0 * outside + 0.5 * rank)


def _within(line: Floats, low: Floats, high: Floats) -> int:
    return int(((line > low) & (line < high)).all(axis=1).sum())

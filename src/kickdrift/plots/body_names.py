"""Names of bodies beside their dots, where they cover neither each other nor a dot."""

from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.plots.page import INK
from kickdrift.plots.trajectory import Bodies

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.text import Annotation
    from matplotlib.transforms import Bbox

Floats = NDArray[np.float64]
_DOT = 5.0  # points across; dots that are nearer than that have one name
_TURNS = np.radians([0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180])  # from the direction outwards
_DISTANCES = (7.0, 14.0)  # points from a dot to its name


def write_names(axes: "Axes", bodies: Bodies) -> None:
    """Write a name beside each dot, outwards if there is room, into a panel whose place on the page is final."""
    from matplotlib.transforms import Bbox

    axes.apply_aspect()
    pixels = axes.figure.dpi / 72  # in a point
    dots = axes.transData.transform(bodies.paths[-1])
    half = 0.5 * _DOT * pixels
    taken = [Bbox([dot - half, dot + half]) for dot in dots]
    middle = int(np.argmin(bodies.radius))
    nearest = dots[np.argsort(np.linalg.norm(dots - dots[middle], axis=1))[1]]
    for group in _groups(dots, _DOT * pixels):
        # The name of the one in the middle is on the far side of its nearest.
        outward = dots[middle] - nearest if middle in group else dots[group].mean(axis=0) - dots[middle]
        name = _written(axes, ", ".join(bodies.names[i] for i in group), bodies.paths[-1][group].mean(axis=0))
        angle = np.arctan2(outward[1], outward[0])
        places = [(distance, angle + turn) for distance, turn in product(_DISTANCES, _TURNS)]
        covered = [_covered(_moved(name, *place), taken, axes.bbox) for place in places]
        taken.append(_moved(name, *places[int(np.argmin(covered))]))


def _written(axes: "Axes", text: str, place: Floats) -> "Annotation":
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=2.5, foreground="white")]
    at = (float(place[0]), float(place[1]))
    name = axes.annotate(text, at, (0.0, 0.0), textcoords="offset points", fontsize=8.5, color=INK, path_effects=halo)
    name.set_in_layout(False)  # or the panel would move away from where it was when the name was placed
    return name


def _moved(name: "Annotation", distance: float, angle: float) -> "Bbox":
    """Move a name to a distance from its dot, in a direction; return what it covers."""
    x, y = np.cos(angle), np.sin(angle)
    name.set(
        position=(distance * x, distance * y),
        ha="left" if x > 0.4 else "right" if x < -0.4 else "center",
        va="bottom" if y > 0.4 else "top" if y < -0.4 else "center",
    )
    return name.get_window_extent()


def _covered(written: "Bbox", taken: "list[Bbox]", frame: "Bbox") -> float:
    """Return the area of a name that is over others or outside the frame, in square pixels."""
    from matplotlib.transforms import Bbox

    both = [Bbox.intersection(written, other) for other in (*taken, frame)]
    *over, inside = (0.0 if box is None else box.width * box.height for box in both)
    return round(sum(over) + written.width * written.height - inside, 6)


def _groups(dots: Floats, distance: float) -> list[list[int]]:
    """Group dots that are nearer to the first of a group than a distance."""
    groups: list[list[int]] = []
    for i, dot in enumerate(dots):
        near = next((g for g in groups if np.linalg.norm(dots[g[0]] - dot) < distance), None)
        if near is None:
            groups.append([i])
        else:
            near.append(i)
    return groups

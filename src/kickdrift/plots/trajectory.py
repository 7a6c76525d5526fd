"""Trajectories: a coordinate over time, an orbit in the plane, or many bodies seen from the z axis."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.colours import COLOURS
from kickdrift.engine.solution import Solution
from kickdrift.plots.page import FAINT, INK, dress, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]
_MOST_POINTS = 50_000  # of all bodies together; more change nothing that can be seen
_SMOOTH_TURN = 0.2  # radians between two points that the eye takes for a curve
_LOST_TURN = 2.0  # radians between two states that do not say any more which way the body went
_LOST_CHORD = 0.84  # of the length of an arc that turns by so much; any that turns more than once has a third at most
_MOST_NAMES = 30
_MOST_COORDINATES = len(COLOURS)


@dataclass(frozen=True)
class Bodies:
    """Paths of some bodies in the plane.

    Attributes
    ----------
    names : tuple of str
        One for each body; empty for bodies without.
    t : (T,) array
        Times.
    paths, velocities : (T, N, 2) array
        Where they were, and how they moved.
    radius : (N,) array
        Largest distance from the centre of all.
    """

    names: tuple[str, ...]
    t: Floats
    paths: Floats
    velocities: Floats
    radius: Floats

    def take(self, which: NDArray[np.intp]) -> "Bodies":
        """Return some of them."""
        names = tuple(self.names[i] for i in which) if self.names else ()
        return Bodies(names, self.t, self.paths[:, which], self.velocities[:, which], self.radius[which])


def panels(solution: Solution, *, split: bool = True) -> list[Bodies | None]:
    """Return what to draw: a panel of bodies, two of them where some orbits are tiny, or None for a graph over time."""
    shape = solution.x.shape[1:]
    if not shape or shape[-1] not in (2, 3) or len(shape) > 2:
        return [None]
    n_bodies = solution.x[0].size // shape[-1]
    stride = -(-solution.t.size * n_bodies // _MOST_POINTS)
    rows = np.append(np.arange(0, solution.t.size - 1, stride), solution.t.size - 1)
    paths = solution.x[rows].reshape(rows.size, n_bodies, -1)[:, :, :2]
    if solution.about.v_is_velocity:
        velocities = solution.v[rows].reshape(rows.size, n_bodies, -1)[:, :, :2]
    elif rows.size > 1:
        velocities = np.gradient(paths, solution.t[rows], axis=0)
    else:
        velocities = np.zeros_like(paths)
    # The median of the bodies, so that a few far ones on part of an orbit do not move it.
    centre = np.median(paths.mean(axis=0), axis=0)
    radius = np.linalg.norm(paths - centre, axis=2).max(axis=0)
    names = solution.about.coordinates.get("body", ())
    names = tuple(names) if 1 < len(names) <= _MOST_NAMES else ()
    everyone = Bodies(names, solution.t[rows], paths, velocities, radius)
    inner = _inner(radius) if everyone.names and split else None
    if inner is None:
        return [everyone]
    outer = np.setdiff1d(np.arange(radius.size), inner)
    return [everyone.take(inner), everyone.take(np.concatenate([[np.argmin(radius)], outer]))]


def _inner(radius: Floats) -> NDArray[np.intp] | None:
    """Bodies to draw by themselves: those below the widest gap, if they would be lost beside the others."""
    order = np.argsort(radius)
    sizes = np.maximum(radius[order], 1e-300)
    # The innermost body may be the one that all others go round; a panel of it alone shows nothing.
    ratios = sizes[2:] / sizes[1:-1]
    if ratios.size == 0 or sizes[-1] < 12 * sizes[1] or ratios.max() < 2:
        return None
    return order[: int(np.argmax(ratios)) + 2]


def draw_phase_portrait(axes: "Axes", solution: Solution) -> None:
    """Draw the velocity, or the momentum, of a state of one number over its position."""
    stride = -(-solution.t.size // _MOST_POINTS)
    x, v = (values.reshape(-1)[::stride] for values in (solution.x, solution.v))
    axes.plot(x, v, color=COLOURS[0], linewidth=0.9)
    axes.plot(x[:1], v[:1], "o", color=COLOURS[0], markersize=4)
    of_x, of_v = ("x", "v") if solution.about.v_is_velocity else ("q", "p")
    units = solution.about.units
    dress(axes, label(of_x, units.get("x")), label(of_v, units.get("v")), "phase portrait")


def draw_coordinates(axes: "Axes", solution: Solution) -> None:
    """Draw positions over time, a line for each number of the state."""
    units = solution.about.units
    values = solution.x.reshape(solution.t.size, -1)
    stride = -(-values.shape[0] // _MOST_POINTS)
    many = values.shape[1] > _MOST_COORDINATES
    for i in range(values.shape[1]):
        place = ", ".join(str(k) for k in np.unravel_index(i, solution.x.shape[1:]))
        axes.plot(
            solution.t[::stride],
            values[::stride, i],
            color=COLOURS[0 if many else i],
            alpha=0.3 if many else 0.9,
            linewidth=0.9,
            label=f"x[{place}]",
        )
    dress(axes, label("t", units.get("t")), label("x", units.get("x")), "trajectory")
    axes.margins(x=0)
    if values.shape[1] > 1 and not many:
        axes.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False, fontsize=8)


def draw_bodies(axes: "Axes", bodies: Bodies, solution: Solution, title: str) -> None:
    """Draw orbits to scale, with a dot where each body ends."""
    unit = solution.about.units.get("x")
    space = solution.about.coordinates.get("space", ("x", "y"))
    crowd, colours = bodies.radius.size > _MOST_NAMES, _colours(bodies)
    faint = 0.25 * (_MOST_NAMES / bodies.radius.size) ** 0.5  # so that the dots are seen on the orbits of thousands
    for i in range(bodies.radius.size):
        curve = _curve(bodies.t, bodies.paths[:, i], bodies.velocities[:, i])
        x, y = (bodies.paths[:, i] if curve is None else curve).T
        colour = colours[i]
        dots = {"linestyle": "", "marker": ".", "markersize": 1}
        style: dict[str, Any] = {"linewidth": 0.8} if curve is not None else dots
        axes.plot(x, y, color=colour, alpha=faint if crowd else 0.75, **style)
        if not crowd:
            axes.plot(x[-1], y[-1], "o", color=colour, markersize=5, markeredgecolor="white")
    if crowd:
        axes.plot(*bodies.paths[-1].T, "o", color=INK, markersize=1.5, markeredgewidth=0, zorder=3)
    if bodies.radius.size == 1:
        axes.plot(*bodies.paths[0, 0], "o", markerfacecolor="white", markeredgecolor=COLOURS[0], markersize=5)
    dress(axes, label(space[0], unit), label(space[1], unit), title)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.14 if bodies.names else 0.08)


def _colours(bodies: Bodies) -> list[str]:
    """Choose a colour for each body; black for one in the middle of the others."""
    if bodies.radius.size > _MOST_NAMES:
        return [COLOURS[0]] * bodies.radius.size
    colours = [COLOURS[i % (len(COLOURS) - 1)] for i in range(bodies.radius.size)]
    middle = int(np.argmin(bodies.radius))
    if bodies.radius[middle] < 0.1 * bodies.radius.max():
        colours = [*colours[:middle], INK, *colours[middle:-1]]
    return colours


def _curve(t: Floats, path: Floats, velocity: Floats) -> Floats | None:
    """Fill a path up by cubic Hermite interpolation where it turns between its points; None where it is lost."""
    ahead, behind = velocity[1:], velocity[:-1]
    crosses = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
    turns = np.abs(np.arctan2(crosses, (ahead * behind).sum(axis=1)))
    turn = float(np.median(turns)) if turns.size else 0.0
    arcs = np.abs(np.diff(t)) * (np.linalg.norm(behind, axis=1) + np.linalg.norm(ahead, axis=1)) / 2
    chords = np.linalg.norm(np.diff(path, axis=0), axis=1)
    moves = arcs > 0
    if turn > _LOST_TURN or (moves.any() and np.median(chords[moves] / arcs[moves]) < _LOST_CHORD):
        return None
    pieces = max(1, int(np.ceil(turn / _SMOOTH_TURN)))
    s = (np.arange(pieces) / pieces)[:, None]
    h, start, end = np.diff(t)[:, None, None], path[:-1, None], path[1:, None]
    slopes = (1 - s) * h * behind[:, None] - s * h * ahead[:, None]
    inside = (1 - s) * start + s * end + s * (1 - s) * ((1 - 2 * s) * (start - end) + slopes)
    return np.concatenate([inside.reshape(-1, 2), path[-1:]])


def mark_inner(axes: "Axes", inner: "Axes") -> None:
    """Draw the frame of the panel of the inner bodies into that of the outer ones."""
    from matplotlib.patches import Rectangle

    (x0, x1), (y0, y1) = inner.get_xlim(), inner.get_ylim()
    axes.add_patch(Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, edgecolor=FAINT, linewidth=0.8, linestyle=":"))


def title_of(position: int, of: Sequence[Bodies | None]) -> str:
    """Name a panel of bodies."""
    return ("inner bodies", "outer bodies")[position] if len(of) == 2 else "trajectory"

"""The plot of a recording: the last state, the paths of its bodies, and the energy."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.colours import COLOURS, SUM, colour_of
from kickdrift.plots.page import INK, check_axes, dress, keep, new_figure
from kickdrift.plots.painter import Painter
from kickdrift.plots.scenery import Pose
from kickdrift.world.recordings.recording import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]
_PIXELS = 1_000_000  # about as many as the file has for the scene
_HEIGHT, _WIDTH = 4.6, 9.2  # of the scene, inches
_WIDE = 1.8  # width over height, from which on the energy stands below the scene
_MOST_TRAILS = 40
_SHORTEST_TRAIL = 0.03  # of the width of the picture
_MOST_POINTS = 1000  # of a trail


def plot_recording(recording: Recording, path: str | Path | None = None, *, ax: "Axes | None" = None) -> "Figure":
    """Plot the last state of a recording with the paths of its bodies, and the kinetic and potential energy.

    Motion in a vertical plane along x is seen from the side; other scenes are seen from above the front left, with shadows.

    Parameters
    ----------
    recording : Recording
    path : path, optional
        Where to write the figure; the file extension determines the format.
    ax : matplotlib.axes.Axes, optional
        Where to draw the state and the paths alone, instead of on a figure of its own.

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
    """
    if ax is not None:
        check_axes(ax)
        _draw_scene(ax, Painter(recording, _PIXELS), recording)
        return keep(ax.figure, path)  # type: ignore[arg-type]  # or a part of a figure
    about = recording.about
    simulated = recording.t[-1] - recording.t[0]
    title = f"{about.system}: {simulated:.4g} s in {recording.n_steps} steps of {1e3 * recording.step:.4g} ms"
    new_figure(1.0, 1.0, "")  # says so where matplotlib is missing, before the work
    painter = Painter(recording, _PIXELS)
    aspect = painter.width / painter.height
    if aspect < _WIDE:
        figure = new_figure(_HEIGHT * aspect + 4.4, _HEIGHT, title)
        scene, energy = figure.subplots(1, 2, width_ratios=[_HEIGHT * aspect, 4.2])
    else:
        figure = new_figure(_WIDTH, _WIDTH / aspect + 3.2, title)
        scene, energy = figure.subplots(2, 1, height_ratios=[_WIDTH / aspect, 2.4])
    _draw_scene(scene, painter, recording)
    _draw_energy(energy, recording)
    return keep(figure, path)


def _draw_scene(axes: "Axes", painter: Painter, recording: Recording) -> None:
    axes.imshow(
        painter.paint(Pose(recording.x[-1], recording.orientation[-1], recording.particles[-1])),
        interpolation="antialiased",
    )
    axes.set_axis_off()
    axes.set_title(f"t = {recording.t[-1]:.4g} s", loc="left", fontsize=10, color=INK)
    _draw_trails(axes, painter, recording)


def _draw_trails(axes: "Axes", painter: Painter, recording: Recording) -> None:
    """Draw where the bodies that went farthest came from, fainter the longer ago, behind what hides it."""
    from matplotlib.collections import LineCollection

    rows = np.unique(np.linspace(0, recording.t.size - 1, _MOST_POINTS).astype(np.intp))
    moving = recording.moving
    pixels = painter.camera.project(recording.x[rows][:, moving], painter.width, painter.height)
    seen = pixels[..., :2].copy()
    seen[_hidden(painter, recording.x[rows][:, moving], pixels)] = np.nan
    lengths = np.linalg.norm(np.diff(pixels[..., :2], axis=0), axis=2).sum(axis=0)
    longest = [i for i in np.argsort(-lengths)[:_MOST_TRAILS] if lengths[i] > _SHORTEST_TRAIL * painter.width]
    for i in longest:
        segments = np.stack((seen[:-1, i], seen[1:, i]), axis=1)
        fading = np.linspace(0.25, 0.9, len(segments))
        colour = colour_of(int(moving[i])) * 0.85
        colours = [(*colour, alpha) for alpha in fading]
        axes.add_collection(LineCollection(list(segments), colors=colours, linewidths=1.1))
    axes.set_xlim(-0.5, painter.width - 0.5)
    axes.set_ylim(painter.height - 0.5, -0.5)


def _hidden(painter: Painter, points: Floats, pixels: Floats) -> NDArray[np.bool_]:
    """Return which points lie behind what is seen, or out of the picture."""
    camera, distance = painter.camera, painter.distance
    samples = len(distance) // painter.height
    size = np.array([painter.width, painter.height])
    inside = ((pixels[..., :2] >= 0) & (pixels[..., :2] < size)).all(axis=-1)
    columns, rows = (np.where(inside, samples * pixels[..., k], 0).astype(np.intp) for k in (0, 1))
    far = np.linalg.norm(points - camera.eye, axis=-1) if camera.perspective else pixels[..., 2]
    hidden: NDArray[np.bool_] = ~inside | (far > distance[rows, columns])
    return hidden


def _draw_energy(axes: "Axes", recording: Recording) -> None:
    """Draw the kinetic energy, the potential one in gravity from its lowest value on, and their sum."""
    potential = recording.derived["potential energy"]
    potential = potential - potential.min()
    kinetic = recording.derived["kinetic energy"]
    total = kinetic + potential
    unit, size = _unit_of(float(total.max()))
    # The sum is wider and below, to be seen also where it is all potential energy.
    for name, values, colour, width in (
        ("kinetic", kinetic, COLOURS[1], 1.3),
        ("potential", potential, COLOURS[0], 1.3),
        ("sum", total, SUM, 4.0),
    ):
        axes.plot(recording.t, values / size, color=colour, linewidth=width, label=name, zorder=3.0 - 0.1 * width)
    dress(axes, "t (s)", f"energy ({unit}),\npotential from its minimum")
    axes.margins(x=0)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, fontsize=8.5, borderaxespad=0.2)


def _unit_of(energy: float) -> tuple[str, float]:
    """Choose the largest unit that an energy has one of; return its name and its size in J."""
    units = {"nJ": 1e-9, "µJ": 1e-6, "mJ": 1e-3, "J": 1.0, "kJ": 1e3, "MJ": 1e6, "GJ": 1e9}
    fitting = [unit for unit, size in units.items() if energy >= size]
    unit = fitting[-1] if fitting else "J"
    return unit, units[unit]

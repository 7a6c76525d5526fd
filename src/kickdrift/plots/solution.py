"""The picture of a solution: trajectory and energy error."""

from pathlib import Path
from typing import TYPE_CHECKING

from kickdrift.engine.solution import Solution, sizes_of_steps
from kickdrift.plots import trajectory
from kickdrift.plots.body_names import write_names
from kickdrift.plots.energy import draw_energy_error
from kickdrift.plots.page import check_axes, keep, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def plot_solution(solution: Solution, path: str | Path | None = None, *, ax: "Axes | None" = None) -> "Figure":
    """Plot the trajectory and, for a system with an energy, the energy error.

    A state of one number is plotted over time, and as a phase portrait; one of two or three as an orbit in the plane;
    bodies, of shape (N, 2) or (N, 3), as orbits seen along the z axis, where named bodies whose orbits would be too small
    have a panel of their own. Other states are plotted component by component over time.

    Parameters
    ----------
    solution : Solution
        At least one time.
    path : path, optional
        Where to write the figure; the file extension determines the format.
    ax : matplotlib.axes.Axes, optional
        Where to draw the trajectory alone, instead of on a figure of its own.

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
    >>> sol = kd.solve(kd.systems.kepler(), (0.0, 20.0), step=0.01, method="leapfrog")
    >>> figure = kd.plots.plot_solution(sol, "orbit.png")
    >>> len(figure.axes)
    2
    """
    solution = solution.plain
    if ax is not None:
        check_axes(ax)
        (bodies,) = trajectory.panels(solution, split=False)
        _draw_trajectory(ax, bodies, solution, "trajectory")
        ax.figure.canvas.figure.draw_without_rendering()  # places of names depend on the layout
        _write_names(ax, bodies)
        return keep(ax.figure, path)  # type: ignore[arg-type]  # or a part of a figure
    about, parts = solution.about, trajectory.panels(solution)
    has_energy, has_phases = "energy" in solution.invariants, solution.x[0].size == solution.v[0].size == 1
    columns = len(parts) + has_phases + has_energy
    unit = f" {about.units['t']}" if about.units.get("t") else ""
    title = f"{about.system} by {about.method}: {solution.n_steps} steps of {sizes_of_steps(solution)}{unit}"
    figure = new_figure(4.6 * columns, 4.4, title)
    grid = figure.subplots(1, columns, squeeze=False)[0]
    for i, bodies in enumerate(parts):
        _draw_trajectory(grid[i], bodies, solution, trajectory.title_of(i, parts))
    if has_phases:
        trajectory.draw_phase_portrait(grid[1], solution)
    if has_energy:
        draw_energy_error(grid[-1], solution)
    figure.draw_without_rendering()  # which places the panels
    for panel, bodies in zip(grid, parts, strict=False):
        _write_names(panel, bodies)
    if len(parts) == 2:
        trajectory.mark_inner(grid[1], grid[0])
    return keep(figure, path)


def _draw_trajectory(ax: "Axes", bodies: trajectory.Bodies | None, solution: Solution, title: str) -> None:
    if bodies is None:
        trajectory.draw_coordinates(ax, solution)
    else:
        trajectory.draw_bodies(ax, bodies, solution, title)


def _write_names(ax: "Axes", bodies: trajectory.Bodies | None) -> None:
    if bodies is not None and bodies.names:
        write_names(ax, bodies)

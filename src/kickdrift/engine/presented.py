"""What solutions look like: plots, pages, files and tables, which higher layers make."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar


@dataclass(frozen=True)
class Presenters:
    """Functions of higher layers for solutions: the package passes them down when it is imported."""

    plot: Callable[..., Any]
    to_html: Callable[..., Path]
    save: Callable[..., Path]
    to_pandas: Callable[..., Any]
    to_xarray: Callable[..., Any]
    report: Callable[..., str]
    keep: Callable[..., None]
    show: Callable[..., Any]
    html: Callable[..., str]


class Presented:
    """The methods of a solution that higher layers do."""

    presenters: ClassVar[Presenters]

    def report(self) -> str:
        """Return a report on the run, as text with one fact per line.

        Returns
        -------
        str

        Examples
        --------
        >>> import kickdrift as kd
        >>> sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)
        >>> print(sol.report())  # doctest: +ELLIPSIS
        system                  kepler
        method                  semi-implicit-euler, order 1: K D
        ...
        """
        return self.presenters.report(self)

    def plot(self, path: str | Path | None = None, *, ax: Any = None) -> Any:
        """Plot trajectory and energy error; return the matplotlib figure, and write it to `path` if given.

        A recording is plotted as its last state with the paths of the bodies, and the energies over time.

        Parameters
        ----------
        path : path, optional
            Where to write the figure; the file extension determines the format.
        ax : matplotlib.axes.Axes, optional
            Where to draw the trajectory, or the scene, alone, instead of on a figure of its own.

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
        >>> from tempfile import mkdtemp
        >>> import kickdrift as kd
        >>> sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)
        >>> figure = sol.plot(mkdtemp() + "/orbit.png")
        """
        return self.presenters.plot(self, path, ax=ax)

    def to_html(self, path: str | Path) -> Path:
        """Write a page that plays in the browser, without a server.

        The mouse rotates and zooms the scene: the bodies of a recording, or those of a solution on their orbits.

        Parameters
        ----------
        path : path
            Its name ends in ``.html``.

        Returns
        -------
        Path
            Of the page.

        Raises
        ------
        ArgumentError
            If the states are not positions in the plane or in space.
        KickdriftError
            If there is nothing to show, or the states are on disk.
        FileFormatError
            For another name, and if the file cannot be written.
        MissingExtraError
            If viser is not installed.

        Examples
        --------
        >>> from tempfile import mkdtemp
        >>> import kickdrift as kd
        >>> sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)
        >>> sol.to_html(mkdtemp() + "/orbit.html").name
        'orbit.html'
        """
        return self.presenters.to_html(self, path)

    def show(self, height: int = 480) -> Any:
        """Return the page of `to_html` as a value that a notebook shows in its cell, without a server.

        Parameters
        ----------
        height : int
            Of the frame, in pixels.

        Returns
        -------
        object
            Its HTML is shown where it is the last value of a cell.

        Raises
        ------
        ArgumentError
            For a height that is not a number of pixels.
        KickdriftError
            As for `to_html`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)
        >>> frame = sol.show()  # at the end of a cell
        """
        return self.presenters.show(self, height)

    def save(self, path: str | Path) -> Path:
        """Write everything to one ``.npz`` file of plain arrays, for `kickdrift.load`.

        Parameters
        ----------
        path : path
            A suffix ``.npz`` is added if it is missing.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        FileFormatError
            If the file cannot be written.

        Examples
        --------
        >>> from tempfile import mkdtemp
        >>> import kickdrift as kd
        >>> sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)
        >>> path = sol.save(mkdtemp() + "/orbit.npz")
        >>> bool((kd.load(path).x == sol.x).all())
        True
        """
        return self.presenters.save(self, path)

    def to_pandas(self) -> Any:
        """Return the states as a table.

        Returns
        -------
        pandas.DataFrame
            One row per time; the columns are named ``x[0]``, ``x[Jupiter, y]``, ``energy``.

        Raises
        ------
        KickdriftError
            If the states are on disk; `to_xarray` reads them.
        MissingExtraError
            If pandas is not installed.

        Examples
        --------
        >>> import kickdrift as kd
        >>> sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)
        >>> list(sol.to_pandas().columns)
        ['x[x]', 'x[y]', 'v[x]', 'v[y]', 'energy', 'angular momentum']
        """
        return self.presenters.to_pandas(self)

    def to_xarray(self) -> Any:
        """Return the states as labelled arrays.

        Returns
        -------
        xarray.Dataset
            With named dimensions and units.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.

        Examples
        --------
        >>> import kickdrift as kd
        >>> sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)
        >>> sol.to_xarray().x.dims
        ('time', 'space')
        """
        return self.presenters.to_xarray(self)

    def _repr_html_(self) -> str:
        """Return the HTML that a notebook shows: the report, and a small picture."""
        return self.presenters.html(self)

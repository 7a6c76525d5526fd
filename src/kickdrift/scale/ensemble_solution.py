"""The result of an ensemble: the states of all members, and how each of them ended."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.description import Description
from kickdrift.engine.invariants import Invariants
from kickdrift.engine.motion import Motion
from kickdrift.engine.solution import Solution

Floats = NDArray[np.float64]
EVENTS = "t_events", "x_events", "v_events"
LAST = "t_last", "x_last", "v_last"


@dataclass(frozen=True)
class EnsemblePresenters:
    """Functions of higher layers for ensemble solutions: the package passes them down when it is imported."""

    save: Callable[..., Path]
    keep: Callable[..., None]
    to_pandas: Callable[..., Any]
    to_xarray: Callable[..., Any]
    report: Callable[..., str]


@dataclass(frozen=True, eq=False)
class EnsembleSolution(Motion):
    """States of M members at the times kept, and how each of them ended; ``solution[i]`` is the `Solution` of one.

    Attributes
    ----------
    t : (T,) array
        Times kept.
    x, v : (M, T, *shape) array
        Positions and velocities, NaN after the last good row of a failed member, and after a terminal event. For rows on disk
        they, and the invariants, are arrays on disk: ``x[3]`` reads a member, ``x[:]`` all.
    invariants : mapping of str to array
        Conserved quantities at those times, (M, T) or (M, T, size), each evaluated on first access.
    status : tuple of Outcome
        How each member ended.
    messages : tuple of str
        The same as sentences, with time and step for those that did not reach the end.
    step : (M,) array
        The step used.
    step_range : (M, 2) array
        The sizes of the smallest and of the largest step.
    n_steps, n_rejected, n_force_evaluations : (M,) array of int
        Steps done, steps rejected, and evaluations of the acceleration.
    wall_time : float
        Total seconds for all members, compilation not counted.
    about : Description
        Names and labels of the run, such as ``about.method`` and ``about.units``.
    parameters : mapping of str to array
        Parameters that distinguish the members, (M,) or (M, p): swept parameters, steps, seeds.
    saved_to : str
        Folder with the rows, if they are not in memory.
    t_events, x_events, v_events : tuple of tuple of array
        Of each member, for each event, the times of its zeros, (K,), and the states there, (K, *shape); empty without events.
    t_last, x_last, v_last : tuple of array
        Of each member that ended early, between the times kept, the time and the state at its end, (1,) and (1, *shape); of
        others (0,) and (0, *shape).
    last_invariants : mapping of str to tuple of array
        Conserved quantities of each member there.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> orbit = kd.systems.kepler()
    >>> runs = kd.solve_ensemble(
    ...     orbit, (0.0, 1.0), x0=orbit.x0 + np.zeros((16, 2)), step=0.01
    ... )
    >>> runs.x.shape, runs[3].n_steps
    ((16, 101, 2), 100)
    """

    t: Floats
    x: Floats
    v: Floats
    invariants: Mapping[str, Floats]
    status: tuple[Outcome, ...]
    messages: tuple[str, ...]
    step: Floats
    step_range: Floats
    n_steps: NDArray[np.int64]
    n_rejected: NDArray[np.int64]
    n_force_evaluations: NDArray[np.int64]
    wall_time: float
    about: Description
    parameters: Mapping[str, NDArray[Any]]
    saved_to: str = ""
    t_events: tuple[tuple[Floats, ...], ...] = ()
    x_events: tuple[tuple[Floats, ...], ...] = ()
    v_events: tuple[tuple[Floats, ...], ...] = ()
    t_last: tuple[Floats, ...] = ()
    x_last: tuple[Floats, ...] = ()
    v_last: tuple[Floats, ...] = ()
    last_invariants: Mapping[str, Any] = field(default_factory=dict)

    presenters: ClassVar[EnsemblePresenters]

    @property
    def success(self) -> NDArray[np.bool_]:
        """Which members reached the end of t_span or a terminal event, shape (M,)."""
        return np.array([status.success for status in self.status])

    def __len__(self) -> int:
        return len(self.status)

    def __iter__(self) -> Iterator[Solution]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, i: int) -> Solution:
        """Return the solution of a member: the rows that it reached, and its end.

        Raises
        ------
        ArgumentError
            For a slice, or anything else that is no whole number.
        IndexError
            If there is no such member.
        """
        if not is_whole(i, -sys.maxsize):
            raise ArgumentError(
                f"{i!r} is not a member; give the number of one. The states of several are in x[first:last]."
            )
        if not -len(self) <= i < len(self):
            raise IndexError(f"there is no member {i}: they are 0 to {len(self) - 1}.")
        i = range(len(self))[i]
        x = np.asarray(self.x[i])
        reached = ~np.isnan(x.reshape(self.t.size, -1)).all(axis=1)
        last, last_x, last_v = (getattr(self, name)[i] for name in LAST)

        def joined(rows: Any, at_end: Floats) -> Floats:
            return np.concatenate((np.asarray(rows)[reached], at_end))

        return Solution(
            t=joined(self.t, last),
            x=joined(x, last_x),
            v=joined(self.v[i], last_v),
            invariants=Invariants(
                tuple(self.invariants), lambda name: joined(self.invariants[name][i], self.last_invariants[name][i])
            ),
            status=self.status[i],
            message=self.messages[i],
            step=float(self.step[i]),
            step_range=(float(self.step_range[i, 0]), float(self.step_range[i, 1])),
            n_steps=int(self.n_steps[i]),
            n_rejected=int(self.n_rejected[i]),
            n_force_evaluations=int(self.n_force_evaluations[i]),
            wall_time=self.wall_time / len(self),
            about=self.about,
            **({name: getattr(self, name)[i] for name in EVENTS} if self.t_events else {}),
        )

    def report(self) -> str:
        """Return a report on the members, as text with one fact per line.

        Returns
        -------
        str

        Examples
        --------
        >>> import numpy as np, kickdrift as kd
        >>> orbit = kd.systems.kepler()
        >>> runs = kd.solve_ensemble(
        ...     orbit, (0.0, 1.0), x0=orbit.x0 + np.zeros((16, 2)), step=0.01
        ... )
        >>> print(runs.report())  # doctest: +ELLIPSIS
        system                  kepler
        members                 16
        ...
        """
        return self.presenters.report(self)

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

        Examples
        --------
        >>> from tempfile import mkdtemp
        >>> import numpy as np, kickdrift as kd
        >>> orbit = kd.systems.kepler()
        >>> runs = kd.solve_ensemble(
        ...     orbit, (0.0, 1.0), x0=orbit.x0 + np.zeros((16, 2)), step=0.01
        ... )
        >>> path = runs.save(mkdtemp() + "/orbits.npz")
        >>> bool((kd.load(path).x == runs.x).all())
        True
        """
        return self.presenters.save(self, path)

    def to_pandas(self) -> Any:
        """Return a `pandas.DataFrame`, one row per member and time: ``frame.loc[3]`` are the rows of a member.

        What was swept is in the first columns; the others are named ``x[0]``, ``x[Jupiter, y]``, ``energy``, as those of one
        `Solution`. After the end of a member that ended early its rows are NaN.

        Raises
        ------
        KickdriftError
            If what was swept has the name of another column.
        MissingExtraError
            If pandas is not installed.

        Examples
        --------
        >>> import kickdrift as kd
        >>> sweep = {"eccentricity": [0.0, 0.3, 0.6]}
        >>> runs = kd.solve_ensemble(kd.systems.kepler, (0.0, 1.0), args=sweep, step=0.01)
        >>> runs.to_pandas().groupby("eccentricity")["energy"].count()[0.3]
        np.int64(101)
        """
        return self.presenters.to_pandas(self)

    def to_xarray(self) -> Any:
        """Return the states as labelled arrays.

        Returns
        -------
        xarray.Dataset
            With named dimensions, ``member`` the first, and units.

        Raises
        ------
        KickdriftError
            If what was swept has the name of an array.
        MissingExtraError
            If xarray is not installed.

        Examples
        --------
        >>> import numpy as np, kickdrift as kd
        >>> orbit = kd.systems.kepler()
        >>> runs = kd.solve_ensemble(
        ...     orbit, (0.0, 1.0), x0=orbit.x0 + np.zeros((16, 2)), step=0.01
        ... )
        >>> runs.to_xarray().x.dims
        ('member', 'time', 'space')
        """
        return self.presenters.to_xarray(self)

    def __repr__(self) -> str:
        return (
            f"<{len(self)} solutions of {self.about.system} by {self.about.method}: {self.t.size} times from"
            f" {self.t[0]:g} to {self.t[-1]:g}, {int(self.success.sum())} completed>"
        )

"""What is compared: a problem, who solves it, and what a run costs and gives."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.precision.laws import AnyLaw, Floats, lawless
from kickdrift.core.kinds import Kind


@dataclass(frozen=True)
class Run:
    """One run.

    Attributes
    ----------
    seconds : float
        In the loop; import, compilation and set-up are not counted.
    states : (T, n) array
        What was kept, x and v side by side: the end alone, or states on the way, too. Not finite if the run failed.
    evaluations : float
        Of the force or the rates; nan where a library does not count them.
    """

    seconds: float
    states: Floats
    evaluations: float = np.nan


Solver = Callable[[float, bool], Run]  # of a number of steps or a tolerance, and whether to keep states on the way


@dataclass(frozen=True)
class Contestant:
    """A method of a library.

    Attributes
    ----------
    label : str
        Library and method.
    make : callable
        Makes a solver for a case; raises `Missing` without the library.
    cost : float or None
        Evaluations that a step takes; None for a method that takes a tolerance.
    limit : float
        The most evaluations, or the least tolerance, that it is given.
    count : int
        How many runs, from the least work to the most.
    """

    label: str
    make: "Callable[[Case], Solver]"
    cost: float | None = None
    limit: float | None = None
    count: int = 4


@dataclass(frozen=True, eq=False)
class Case:
    """A problem of a kind, and who solves it.

    Attributes
    ----------
    name, title : str
        Of the picture and its file.
    kind : Kind
        Which kind of problem it stands for.
    span : float
        How long it runs, from 0.
    x0, v0 : tuple of float
        Start; several bodies one after the other.
    problem : Any
        The same as `kickdrift.solve` takes it.
    methods : tuple of str
        Those of kickdrift.
    law : callable
        The law for the peers and the reference.
    peers : tuple of Contestant
        The others.
    energy : callable, optional
        ``energy(x, v)`` of arrays (n, T): the error is then the largest relative error of the energy over the run. It
        is otherwise the largest of all numbers of the state at the end.
    average : (callable, float), optional
        ``f(x, v)`` of arrays (n, T) and its exact average: the error is then that of the average over the run.
    evaluations : (float, float)
        The least and the most that a run gets.
    tolerances : (float, float)
        The largest and the least.
    near : float
        The error at which the table compares.
    masses : tuple of float
        Of bodies that attract each other, times G; without them, one body moves around a mass of 1 at the origin.
    end : tuple of float
        The exact end, where it is known.
    """

    name: str
    title: str
    kind: Kind
    span: float
    x0: tuple[float, ...]
    v0: tuple[float, ...]
    problem: Any
    methods: tuple[str, ...]
    law: AnyLaw = lawless
    peers: tuple[Contestant, ...] = ()
    energy: Callable[[Floats, Floats], Floats] | None = None
    average: tuple[Callable[[Floats, Floats], Floats], float] | None = None
    evaluations: tuple[float, float] = (2e3, 2e5)
    tolerances: tuple[float, float] = (1e-4, 1e-13)
    near: float = 1e-8
    masses: tuple[float, ...] = ()
    end: tuple[float, ...] = ()

    @property
    def start(self) -> Floats:
        """All numbers of the state."""
        return np.array(self.x0 + self.v0)

    @property
    def what(self) -> str:
        """What the error is, in words."""
        if self.average is not None:
            return "error of the average"
        return "largest relative error of the energy" if self.energy else "error of the state at the end"

    @property
    def needs_reference(self) -> bool:
        """Whether the end has to be known."""
        return self.energy is None and self.average is None

    def error_of(self, run: Run, reference: Floats | None) -> float:
        """Say the error of a run; infinite for one that failed."""
        if not np.isfinite(run.states).all():
            return np.inf
        n = len(self.x0)
        x, v = run.states[:, :n].T, run.states[:, n:].T
        if self.energy is not None:
            energies = self.energy(x, v)
            first = self.energy(np.array(self.x0), np.array(self.v0))
            return float(np.abs(energies / first - 1).max())
        if self.average is not None:
            function, exact = self.average
            return float(abs(function(x, v).mean() - exact))
        return float(np.abs(run.states[-1] - reference).max())

"""kickdrift: mechanics in time, structure first.

``kickdrift.solve`` integrates accelerations, Hamiltonians and other equations of motion; ``kickdrift.systems`` and
``kickdrift.methods`` are the catalogues, ``kickdrift.analysis`` judges runs, ``kickdrift.plots`` draws them,
``kickdrift.load`` reads a saved solution.
"""

from kickdrift import analysis, methods, plots, systems
from kickdrift.core.errors import ArgumentError, InterpretedWarning, KickdriftError, MethodMismatchError
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.solution import Presenters, Solution
from kickdrift.engine.solve import solve
from kickdrift.io import load, save, to_xarray
from kickdrift.io.report import report
from kickdrift.systems import (
    ChargedParticle,
    Constrained,
    Damped,
    FirstOrder,
    Hamiltonian,
    Langevin,
    Newtonian,
    Partitioned,
    SecondOrder,
    Separable,
    System,
)

__all__ = [
    "ArgumentError",
    "ChargedParticle",
    "Constrained",
    "Damped",
    "FirstOrder",
    "Hamiltonian",
    "InterpretedWarning",
    "KickdriftError",
    "Langevin",
    "MethodMismatchError",
    "Newtonian",
    "Outcome",
    "Partitioned",
    "SecondOrder",
    "Separable",
    "Solution",
    "System",
    "analysis",
    "load",
    "methods",
    "plots",
    "solve",
    "systems",
]

__version__ = "0.1.0"

# A solution saves, draws and reports itself with what lives on the floors above the engine.
Solution.presenters = Presenters(plot=plots.plot_solution, save=save, to_xarray=to_xarray, report=report)

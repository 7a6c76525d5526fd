"""Assessing runs and methods: energy, phase, order, stability, symplecticity, orbits, chaos."""

from kickdrift.analysis.advice import Advice
from kickdrift.analysis.energy import energy_drift, energy_error, largest_energy_error, modified_energy
from kickdrift.analysis.lyapunov import LyapunovExponents, lyapunov_exponent
from kickdrift.analysis.mergers import Merger, mergers
from kickdrift.analysis.modified import modified_hamiltonian, modified_order
from kickdrift.analysis.modified_formula import modified_formula
from kickdrift.analysis.orbits import OrbitalElements, orbital_elements
from kickdrift.analysis.order import ObservedOrder, observed_order
from kickdrift.analysis.phase import largest_phase_error, phase_drift, phase_error
from kickdrift.analysis.poincare import PoincareSection, poincare_section
from kickdrift.analysis.stability import amplification_factor, one_step_matrix, stability_limit
from kickdrift.analysis.symplecticity import symplecticity_defect
from kickdrift.analysis.tangent import tangent_map
from kickdrift.analysis.work_precision import WorkPrecision, work_precision

__all__ = [
    "Advice",
    "LyapunovExponents",
    "Merger",
    "ObservedOrder",
    "OrbitalElements",
    "PoincareSection",
    "WorkPrecision",
    "amplification_factor",
    "energy_drift",
    "energy_error",
    "largest_energy_error",
    "largest_phase_error",
    "lyapunov_exponent",
    "mergers",
    "modified_energy",
    "modified_formula",
    "modified_hamiltonian",
    "modified_order",
    "observed_order",
    "one_step_matrix",
    "orbital_elements",
    "phase_drift",
    "phase_error",
    "poincare_section",
    "stability_limit",
    "symplecticity_defect",
    "tangent_map",
    "work_precision",
]


def __dir__() -> list[str]:
    return __all__

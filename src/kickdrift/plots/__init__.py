"""Pictures by matplotlib, which is imported when the first one is drawn."""

from kickdrift.plots.energy import plot_energy_comparison
from kickdrift.plots.poincare import plot_poincare_sections
from kickdrift.plots.solution import plot_solution
from kickdrift.plots.stability import plot_stability_region
from kickdrift.plots.work_precision import plot_work_precision

__all__ = [
    "plot_energy_comparison",
    "plot_poincare_sections",
    "plot_solution",
    "plot_stability_region",
    "plot_work_precision",
]


def __dir__() -> list[str]:
    return __all__

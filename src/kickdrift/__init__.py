"""kickdrift: structure-preserving integration for mechanics.

``kickdrift.solve`` integrates accelerations, Hamiltonians and other equations of motion; ``kickdrift.systems`` and
``kickdrift.methods`` are the catalogues, ``kickdrift.analysis`` assesses runs, ``kickdrift.plots`` draws them,
``kickdrift.load`` reads a saved solution. ``kickdrift.World`` is for bodies that touch or are connected by joints: with shapes
(``Box``, ``Capsule``, ``Cone``, ``Cylinder``, ``Hull``, ``Sphere``, and ``Part`` for compounds), and limits, motors and drives
of joints (``Axis``, ``Motor``, ``Drive``).
"""

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from kickdrift import analysis, methods, plots, systems
from kickdrift.analysis.advice import advise
from kickdrift.core.errors import (
    ArgumentError,
    FileFormatError,
    InterpretedWarning,
    KickdriftError,
    LostBodyError,
    MethodMismatchError,
    MissingExtraError,
    UnknownNameError,
    UnsolvedWarning,
)
from kickdrift.core.outcomes import Outcome
from kickdrift.core.version import VERSION
from kickdrift.engine.impacts import Impacts
from kickdrift.engine.presented import Presenters
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.engine.sphere_gaps import sphere_gaps
from kickdrift.engine.step_control import (
    HairerSoderlind,
    HuangLeimkuhler,
    LocalError,
    LogarithmicHamiltonian,
    TimeTransformed,
)
from kickdrift.io import load, save, to_pandas, to_xarray
from kickdrift.io.pandas import ensemble_to_pandas
from kickdrift.io.report import report
from kickdrift.io.xarray import ensemble_to_xarray, recording_to_xarray
from kickdrift.scale.ensemble_solution import EnsemblePresenters, EnsembleSolution
from kickdrift.systems import (
    ChargedParticle,
    Constrained,
    Damped,
    FirstOrder,
    Hamiltonian,
    Langevin,
    Multirate,
    Newtonian,
    Oscillatory,
    Partitioned,
    SecondOrder,
    Separable,
    System,
)
from kickdrift.systems.spline import spline
from kickdrift.world.recordings.recording import Recording
from kickdrift.world.recordings.viewer_hooks import WorldPresenters

if TYPE_CHECKING:
    from kickdrift.io.meshes import load_mesh
    from kickdrift.io.robot_file import load_robot
    from kickdrift.io.world_file import load_world
    from kickdrift.scale.ensemble import solve_ensemble
    from kickdrift.systems.symbolic import from_lagrangian, from_sympy
    from kickdrift.world.bodies.part import Part
    from kickdrift.world.deformables.gusts import gusts
    from kickdrift.world.joints.limits_motors_options import Axis, Drive, Motor
    from kickdrift.world.shapes.box import Box
    from kickdrift.world.shapes.capsule import Capsule
    from kickdrift.world.shapes.cone import Cone
    from kickdrift.world.shapes.cylinder import Cylinder
    from kickdrift.world.shapes.hull import Hull
    from kickdrift.world.shapes.sphere import Sphere
    from kickdrift.world.world import World

__all__ = [
    "ArgumentError",
    "Axis",
    "Box",
    "Capsule",
    "ChargedParticle",
    "Cone",
    "Constrained",
    "Cylinder",
    "Damped",
    "Drive",
    "EnsembleSolution",
    "FileFormatError",
    "FirstOrder",
    "HairerSoderlind",
    "Hamiltonian",
    "HuangLeimkuhler",
    "Hull",
    "Impacts",
    "InterpretedWarning",
    "KickdriftError",
    "Langevin",
    "LocalError",
    "LogarithmicHamiltonian",
    "LostBodyError",
    "MethodMismatchError",
    "MissingExtraError",
    "Motor",
    "Multirate",
    "Newtonian",
    "Oscillatory",
    "Outcome",
    "Part",
    "Partitioned",
    "Recording",
    "SecondOrder",
    "Separable",
    "Solution",
    "Sphere",
    "System",
    "TimeTransformed",
    "UnknownNameError",
    "UnsolvedWarning",
    "World",
    "advise",
    "analysis",
    "from_lagrangian",
    "from_sympy",
    "gusts",
    "load",
    "load_mesh",
    "load_robot",
    "load_world",
    "methods",
    "plots",
    "solve",
    "solve_ensemble",
    "sphere_gaps",
    "spline",
    "systems",
]

__version__ = VERSION


def _later(module: str, name: str) -> Callable[..., Any]:
    """Stand for a function of a module that is imported when it is first called: worlds take a moment to import."""

    def call(*arguments: Any, **options: Any) -> Any:
        return getattr(import_module(module), name)(*arguments, **options)

    return call


_LATER = {
    **dict.fromkeys(("from_lagrangian", "from_sympy"), "kickdrift.systems.symbolic"),
    "World": "kickdrift.world.world",
    "gusts": "kickdrift.world.deformables.gusts",
    "Part": "kickdrift.world.bodies.part",
    **dict.fromkeys(("Axis", "Drive", "Motor"), "kickdrift.world.joints.limits_motors_options"),
    **{
        name: f"kickdrift.world.shapes.{name.lower()}"
        for name in ("Box", "Capsule", "Cone", "Cylinder", "Hull", "Sphere")
    },
    "solve_ensemble": "kickdrift.scale.ensemble",
    "load_mesh": "kickdrift.io.meshes",
    "load_robot": "kickdrift.io.robot_file",
    "load_world": "kickdrift.io.world_file",
}


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'kickdrift' has no attribute {name!r}")
    return getattr(import_module(_LATER[name]), name)


def __dir__() -> list[str]:
    return __all__


# Solutions and worlds save, draw and report themselves with what lives in the layers above them.
Solution.presenters = Presenters(
    plot=plots.plot_solution,
    to_html=_later("kickdrift.viewer.solution", "solution_to_html"),
    save=save,
    to_pandas=to_pandas,
    to_xarray=to_xarray,
    report=report,
    keep=_later("kickdrift.io.stored", "keep"),
    show=_later("kickdrift.viewer.embedded", "show"),
    html=_later("kickdrift.io.notebook", "solution_html"),
)
EnsembleSolution.presenters = EnsemblePresenters(
    save=_later("kickdrift.io.ensemble_file", "save"),
    keep=_later("kickdrift.io.stored", "keep"),
    to_pandas=ensemble_to_pandas,
    to_xarray=ensemble_to_xarray,
    report=_later("kickdrift.io.ensemble_report", "report"),
)
analysis.WorkPrecision.presenter = plots.plot_work_precision
analysis.PoincareSection.presenter = plots.plot_poincare_sections
Recording.presenters = WorldPresenters(
    plot=_later("kickdrift.plots.world", "plot_recording"),
    to_html=_later("kickdrift.viewer.recording", "recording_to_html"),
    save=_later("kickdrift.io.recording_file", "save_recording"),
    to_pandas=to_pandas,
    to_xarray=recording_to_xarray,
    report=_later("kickdrift.io.recording_report", "report"),
    keep=_later("kickdrift.io.stored", "keep"),
    show=_later("kickdrift.viewer.embedded", "show"),
    html=_later("kickdrift.io.notebook", "solution_html"),
    world_html=_later("kickdrift.io.notebook", "world_html"),
    animate=_later("kickdrift.plots.animation", "animate_recording"),
    save_meshes=_later("kickdrift.io.meshes", "save_meshes"),
    view=_later("kickdrift.viewer.live", "view_world"),
    save_world=_later("kickdrift.io.world_file", "save_world"),
    contents=_later("kickdrift.io.world_file", "contents"),
    snapshot_of=_later("kickdrift.io.world_file", "snapshot_of"),
)

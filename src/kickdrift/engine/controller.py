"""A step control prepared for a system and a method: its checked function, and its numbers in work."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.control_checks import binding_energy, check_density, check_merging, check_method
from kickdrift.engine.densities import by_acceleration, by_distance
from kickdrift.engine.flows import layout
from kickdrift.engine.flows.error_control import PARAMS
from kickdrift.engine.program import Spelled
from kickdrift.engine.step_control import (
    HairerSoderlind,
    HuangLeimkuhler,
    LocalError,
    LogarithmicHamiltonian,
    StepControl,
    TimeTransformed,
)
from kickdrift.engine.surface_events import Surfaces
from kickdrift.engine.user_functions import argument_names
from kickdrift.methods import Method
from kickdrift.systems.problem import name_of
from kickdrift.systems.system import Quantity, System

Floats = NDArray[np.float64]
Adapt = Callable[[str, Any], Quantity]

_NAMES = {"distance": by_distance, "acceleration": by_acceleration}


@dataclass(frozen=True, eq=False)
class Controller:
    """The control that chooses the steps of a run.

    Attributes
    ----------
    name, conserves : str
        For display.
    spelled : callable
        Turns a word into one with variable steps, see `kickdrift.engine.program.compose`.
    params : array
        The params of its function.
    dear : int
        Force evaluations in one of the density.
    tolerances : array
        Absolute ones, for x and then for v; empty if errors do not matter.
    between : Controller or None
        The controller of parts of steps, for states between them.
    takes_back : bool
        Whether steps can be rejected.
    reversible : bool
        Whether the same steps lead back.
    surfaces : Surfaces or None
        Surfaces of impacts, for events.
    function : Quantity or None
        The function that it evaluates, if that is a user's.
    """

    name: str
    conserves: str
    spelled: Callable[..., Spelled]
    params: Floats
    dear: int = 0
    tolerances: Floats = field(default_factory=lambda: np.zeros(0))
    between: Controller | None = None
    takes_back: bool = False
    reversible: bool = False
    surfaces: Surfaces | None = None
    function: Quantity | None = None

    def memory_size(self, n: int, of_flows: int) -> int:
        """Return the size of the controller's part of the work array, beside that of the flows."""
        return layout.CONTROL_VECTORS * n + self.params.size + of_flows * self.takes_back

    def prepare(self, work: Floats, n: int, estimates: bool, t0: float, t1: float, step: float) -> None:
        """Initialise the part of the work array that the letters of the control use."""
        own = work.size - layout.TAIL - n * estimates - self.params.size
        work[layout.CLOCK], work[layout.END], work[layout.FIRST_STEP] = t0, t1, step
        work[layout.DENSITY] = work[layout.START_DENSITY] = 1.0
        work[layout.OWN_PARAMS], work[layout.OWN_COUNT] = own, self.params.size
        work[layout.CONTROL] = own - layout.CONTROL_VECTORS * n
        room = work[layout.CONTROL] - work[layout.MEMORY]
        work[layout.SHADOW] = work[layout.MEMORY] + (room // 2 if self.takes_back else room)
        work[layout.DEAR] = self.dear
        work[layout.SMALLEST] = math.inf
        work[own : own + self.params.size] = self.params
        layout.control_memory(n, work)[6 * n : 6 * n + self.tolerances.size] = self.tolerances


def turn_back(work: Floats, end: float) -> None:
    """Let the steps go back to a time, from the density that they have reached."""
    work[layout.FIRST_STEP], work[layout.END] = -work[layout.FIRST_STEP], end
    work[layout.SMALLEST], work[layout.LARGEST] = math.inf, 0.0
    work[layout.EVALUATIONS] = work[layout.TAKEN_BACK] = work[layout.LOST_STEPS] = 0.0
    work[layout.KEPT_BY] = 0.0  # a matrix for steps forwards


def control_of(wanted: Any, step: float | None, rtol: float | None, atol: ArrayLike | None) -> StepControl | None:
    """Return the step control that the arguments ask for, None for equal steps.

    Raises
    ------
    ArgumentError
        For an invalid control, if two are given, or if a required step is missing.
    """
    by_error = rtol is not None or atol is not None
    if by_error and wanted is not None:
        raise ArgumentError(
            f"step_control={wanted!r} and rtol={rtol!r}, atol={atol!r} are given, but each chooses the steps; give one."
        )
    if by_error:
        return LocalError(1e-3 if rtol is None else rtol, 1e-6 if atol is None else atol)
    if step is None and not isinstance(wanted, LocalError):
        raise ArgumentError(
            "step is missing; give the step size, or the tolerances rtol= and atol=, with which steps are chosen for you."
        )
    if isinstance(wanted, str) or (callable(wanted) and not isinstance(wanted, type)):
        return HairerSoderlind(wanted)
    if wanted is not None and not isinstance(wanted, StepControl):
        raise ArgumentError(
            f"step_control={wanted!r} is not a step control; give a density (a function, 'distance', 'acceleration' or"
            " 'own'), kd.HairerSoderlind(...), kd.HuangLeimkuhler(...), kd.LogarithmicHamiltonian(),"
            " kd.TimeTransformed(...) or kd.LocalError(rtol, atol)."
        )
    return wanted


def controlled(
    wanted: StepControl, system: System, method: Method, t0: float, adapt: Adapt, first_is_given: bool
) -> tuple[System, Controller]:
    """Prepare a step control for a system; its function becomes a part of the system.

    Raises
    ------
    ArgumentError
        For a control that does not suit the method or the system, and for an invalid density.
    """
    check_method(wanted, system, method)
    if isinstance(wanted, LocalError):
        return system, _by_error(wanted, system, method, first_is_given)
    if isinstance(wanted, LogarithmicHamiltonian):
        energy = binding_energy(system, t0)
        parts = {**system.parts, "energy": energy.function}
        name, params = "logarithmic Hamiltonian", _params(energy, system)
        return replace(system, parts=parts), _in_its_own_time(
            Controller(name, wanted.conserves, wanted.spelled, params, reversible=True)
        )
    check_merging(wanted.density, system)
    density, named, sees_v, dear = _density(wanted.density, system, adapt)
    check_density(density, named, system, t0)
    spelled: Callable[..., Spelled] = wanted.spelled
    if sees_v:
        if not isinstance(wanted, HairerSoderlind):
            raise ArgumentError(
                f"density={named} depends on v, which kd.{type(wanted).__name__} does not allow; use kd.HairerSoderlind, or a"
                " density that depends on x alone."
            )
        spelled = _seeing_v
    name = f"{_SCHEMES[type(wanted)]}, density by {named}"
    parts = {**system.parts, "density": density.function}
    numbers = _params(density, system)
    controller = Controller(name, wanted.conserves, spelled, numbers, dear, reversible=True, function=density)
    if isinstance(wanted, TimeTransformed):
        controller = _in_its_own_time(controller)
    return replace(system, parts=parts), controller


def _in_its_own_time(controller: Controller) -> Controller:
    """Return a controller that controls parts of steps, too."""
    return replace(controller, between=controller)


_SCHEMES = {
    HairerSoderlind: "Hairer-Soederlind",
    HuangLeimkuhler: "Huang-Leimkuhler",
    TimeTransformed: "time-transformed leapfrog",
}


def _seeing_v(*arguments: Any) -> Spelled:
    return [
        (f"{name}-of-v" if name.endswith("-density") else name, weight, clock)
        for name, weight, clock in HairerSoderlind.spelled(*arguments)
    ]


def _params(quantity: Quantity, system: System) -> Floats:
    return system.params if quantity.params is None else quantity.params


def _by_error(wanted: LocalError, system: System, method: Method, first_is_given: bool) -> Controller:
    try:
        relative, absolute = float(reals(wanted.rtol)), reals(wanted.atol)
        of_x = np.broadcast_to(absolute, system.x0.shape).reshape(-1)
    except (TypeError, ValueError) as error:
        raise ArgumentError(
            f"rtol={wanted.rtol!r}, atol={wanted.atol!r}: {error}; give a number for rtol, and for atol a number or"
            " one per component of the state."
        ) from None
    if not (100 * np.finfo(float).eps <= relative < 1.0 or (relative == 0.0 and (of_x > 0.0).all())):
        raise ArgumentError(f"rtol={wanted.rtol!r} must be at least 2.3e-14 and below 1, or 0 with a positive atol.")
    if not ((of_x >= 0.0) & np.isfinite(of_x)).all():
        raise ArgumentError(f"atol={wanted.atol!r} must be finite and not negative.")
    tableau = None if method.tableau is None else method.tableau()
    embedded = tableau is not None and tableau.error_weights is not None
    order = tableau.error_order if tableau is not None and embedded else method.order
    params = np.array([relative, float(order), float(first_is_given), 0.0, 0.0])
    assert params.size == PARAMS
    tolerances = np.concatenate([of_x, of_x if system.v0.size else np.zeros(0)])
    how = "by its own estimate" if embedded else "by step doubling"
    name = f"local error, rtol={relative:g}, atol={_spelled(absolute)}, {how}"
    spelled = wanted.spelled_embedded if embedded else wanted.spelled
    return Controller(
        name, wanted.conserves, spelled, params, tolerances=np.maximum(tolerances, 1e-300), takes_back=True
    )


def _spelled(absolute: Floats) -> str:
    return f"{float(absolute):g}" if absolute.size == 1 else f"{absolute.min():g} to {absolute.max():g}"


def _density(wanted: Any, system: System, adapt: Adapt) -> tuple[Quantity, str, bool, int]:
    """Return a density, its name, whether it depends on v, and the number of forces that it evaluates."""
    own = system.density
    if wanted is None:
        wanted = "acceleration" if own is None else "own"
    if wanted == "own" and own is not None:
        return Quantity(own), "the system's own", False, 0
    if isinstance(wanted, str):
        if wanted not in _NAMES:
            why = f"{system.name!r} has no density of its own; " if wanted == "own" else ""
            raise ArgumentError(f"density={wanted!r}: {why}give 'distance', 'acceleration' or a function of the state.")
        if wanted == "acceleration" and not system.v0.size:
            raise ArgumentError(
                "density='acceleration': first-order equations have no acceleration; give a function of y."
            )
        return _NAMES[wanted](system), wanted, False, int(wanted == "acceleration")
    allowed = ("t", "x", "v", "params", "q", "p") if system.v0.size else ("t", "y", "x", "params")
    given = argument_names(wanted, "density", allowed)
    return adapt("density", wanted), name_of(wanted), bool({"v", "p"} & set(given)), 0

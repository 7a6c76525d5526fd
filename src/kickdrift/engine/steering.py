"""The choice of step sizes: equal steps, a step control, or steps cut by impacts and switches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.engine.controller import Controller, control_of, controlled
from kickdrift.engine.grid import Course, Grid, lay_course, lay_grid
from kickdrift.engine.impacts import Impacts, cut_steps, sides_at
from kickdrift.engine.problem_adapter import Adapter, describe
from kickdrift.engine.start import Start
from kickdrift.engine.step_control import StepControl
from kickdrift.methods import Method
from kickdrift.systems.system import System


@dataclass(frozen=True)
class Steering:
    """The arguments of `kickdrift.solve` that determine step sizes.

    Attributes
    ----------
    control : StepControl or None
    impacts : Impacts, callable or None
    switches : callable or None
    """

    control: StepControl | None = None
    impacts: Impacts | Callable[..., Any] | None = None
    switches: Callable[..., Any] | None = None

    @property
    def cuts(self) -> bool:
        """Whether equal steps are cut."""
        return self.impacts is not None or self.switches is not None

    @property
    def varies(self) -> bool:
        """Whether the sizes of steps vary."""
        return self.control is not None or self.cuts

    @property
    def defaults(self) -> dict[str, Any]:
        """Defaults for `kickdrift.engine.method_selection.choose` if no method is named."""
        return {} if self.control is None else {"default": self.control.method, "order_beside": self.control.order}

    def lay(
        self,
        t_span: Sequence[float],
        step: float | None,
        t_eval: ArrayLike | None,
        save_every: int | None,
        state_size: int,
        streamed: bool = False,
        max_steps: int | None = None,
    ) -> Grid | Course:
        """Lay out the steps of the span.

        Raises
        ------
        ArgumentError
            As `kickdrift.engine.grid.lay_grid`.
        """
        if not self.varies:
            return lay_grid(t_span, step, t_eval, save_every, state_size, streamed, max_steps)
        return lay_course(t_span, step, t_eval, save_every, self.cuts, streamed, max_steps)

    def describe(self, problem: Any, start: Start, adapter: Adapter) -> System:
        """Describe the problem as a system, with the sides of switches appended to its params.

        Raises
        ------
        ArgumentError
            As `kickdrift.engine.problem_adapter.describe`.
        """
        params = adapter.users_args
        if self.switches is not None:
            params = np.append(params, sides_at(self.switches, problem, adapter))
        return describe(problem, adapter.t0, start, params, adapter.compile_, adapter.check_bounds)

    def ready(
        self, problem: Any, system: System, method: Method, grid: Grid | Course, adapter: Adapter, step: float | None
    ) -> tuple[System, Controller | None]:
        """Prepare the control of steps, or impacts and switches; their functions become parts of the system.

        Raises
        ------
        ArgumentError
            For a control that is incompatible with the method or the system.
        """
        if self.control is not None:
            return controlled(self.control, system, method, grid.t0, adapter.number, step is not None)
        if not isinstance(grid, Course):
            return system, None
        place = -1 if self.switches is None or isinstance(problem, System) else adapter.users_args.size
        return cut_steps(self.impacts, self.switches, problem, system, method, grid, adapter, place)


def steering_of(
    step_control: Any, step: float | None, rtol: float | None, atol: ArrayLike | None, impacts: Any, switches: Any
) -> Steering:
    """Return the choice of step sizes that the arguments ask for.

    Raises
    ------
    ArgumentError
        For an invalid control, and if two are given.
    """
    steering = Steering(control_of(step_control, step, rtol, atol), impacts, switches)
    if steering.control is not None and steering.cuts:
        given = f"rtol={rtol!r}, atol={atol!r}" if step_control is None else f"step_control={step_control!r}"
        cuts, there = (
            ("switches", "switch, and solve on from there")
            if impacts is None
            else ("impacts", "surface, and solve on with the velocity after the impact")
        )
        raise ArgumentError(
            f"{given} and {cuts} are given, but each chooses the steps; leave one out, or end each run by a terminal event"
            f" at the {there}."
        )
    return steering

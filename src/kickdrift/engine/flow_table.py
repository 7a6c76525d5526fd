"""The table of flows: what the engine knows of each. A new flow is its function and a line here."""

from collections.abc import Callable
from dataclasses import dataclass

from kickdrift.core.compilation import Function
from kickdrift.engine import flows, implicit


@dataclass(frozen=True)
class Flow:
    """A flow, as a template and what must be known to run it.

    Attributes
    ----------
    template : callable
        ``template(t, h, x, v, params, work)``, see `kickdrift.engine.flows`.
    evaluations : int
        Force evaluations each time, those that it counts itself in work left out.
    moves_clock : bool
        Whether the flow moves positions, and with them the clock.
    parts : tuple of callable
        Templates that it calls by their names, each after those that it calls itself.
    work_size : callable
        Numbers of work for a state of n numbers.
    """

    template: Function
    evaluations: int = 0
    moves_clock: bool = False
    parts: tuple[Function, ...] = ()
    work_size: Callable[[int], int] = flows.work_size

    @property
    def forceless(self) -> bool:
        """Whether it is the same flow for every acceleration."""
        return not self.evaluations and not self.parts


_STAGE = (implicit.stage_residual, implicit.form_matrix, implicit.solve_stage)

FLOWS = {
    "kick": Flow(flows.kick, evaluations=1),
    "rekick": Flow(flows.rekick),
    "accelerate": Flow(flows.accelerate, evaluations=1),
    "drift": Flow(flows.drift, moves_clock=True),
    "explicit-euler": Flow(flows.explicit_euler, evaluations=1, moves_clock=True),
    "implicit-euler": Flow(implicit.implicit_euler, moves_clock=True, parts=_STAGE, work_size=implicit.work_size),
    "implicit-midpoint": Flow(implicit.implicit_midpoint, moves_clock=True, parts=_STAGE, work_size=implicit.work_size),
}

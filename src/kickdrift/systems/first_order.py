"""y' = f(t, y), by a Python function."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from kickdrift.core.compilation import unbound
from kickdrift.core.kinds import Kind
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.system import System

component: Function = unbound


@dataclass(frozen=True)
class FirstOrder(Problem):
    """y' = f(t, y) by a Python function.

    `solve` takes the initial y as x0, without v0; a solution has the states as ``y``, too.

    Parameters
    ----------
    rates : callable
        f, a function of any of ``y``, ``t``, ``params``, and ``out`` (written in place instead of returned). With an
        argument ``i`` it returns the rate of y[i] alone: the semi-implicit sweeps need one component at a time, and
        otherwise cost one evaluation of all of f per component.
    energy, invariants
        Conserved quantities, functions of ``y`` and ``t``.

    Examples
    --------
    Van der Pol's oscillator:

    >>> import kickdrift as kd
    >>> def van_der_pol(i, y):
    ...     return y[1] if i == 0 else (1 - y[0] ** 2) * y[1] - y[0]
    >>> sol = kd.solve(
    ...     kd.FirstOrder(van_der_pol), (0.0, 20.0), x0=[2.0, 0.0], step=0.01, compile=False
    ... )
    >>> sol.y.shape
    (2001, 2)
    """

    has_velocity: ClassVar[bool] = False

    rates: Function
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system."""
        adapted = adapter.adapt(self.rates, "rates", ("t", "y", "x", "params", "out", "i"))
        rates, parts = adapted.function, {}
        if "i" in adapted.names:
            parts["component"] = rates
            rates = adapter.bind(_all_components, component=rates)
        return System(
            name=name_of(self.rates),
            acceleration=rates,
            velocity=rates,
            x0=adapter.x0,
            v0=adapter.v0,
            params=adapter.args,
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.FIRST_ORDER,
            parts=parts,
            native=adapted.native,
        )


def _all_components(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    # A component's function gets its index in the place of v, which first-order equations do not have.
    index = out[:1].copy()
    for i in range(x.size):
        index[0] = i
        component(t, x, index, params, out)

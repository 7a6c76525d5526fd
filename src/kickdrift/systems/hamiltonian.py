"""Hamiltonians and other partitioned equations, by Python functions."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kickdrift.core.compilation import unbound
from kickdrift.core.elementwise import multiply
from kickdrift.core.kinds import Kind
from kickdrift.systems.problem import Adapter, Floats, Function, Problem, name_of
from kickdrift.systems.system import System

gradient: Function = unbound


@dataclass(frozen=True)
class Separable(Problem):
    """H = T(p) + V(q) with any T, by Python functions.

    The functions may have the arguments ``q`` or ``p``, ``t``, ``params``, and ``out`` (written in place instead of
    returning). In `solve`, x0 is q and v0 is p; a solution has them as ``q`` and ``p``, too. Both parts may depend on
    time.

    Parameters
    ----------
    kinetic_gradient : callable
        dT/dp, of p.
    potential_gradient : callable
        dV/dq, of q.
    energy : callable, optional
        H, of q and p.
    invariants : mapping of str to callable, optional
        Other conserved numbers by name.

    Examples
    --------
    A relativistic oscillator, with the speed of light and the mass 1:

    >>> import numpy as np, kickdrift as kd
    >>> system = kd.Separable(
    ...     kinetic_gradient=lambda p: p / np.sqrt(1 + p * p),
    ...     potential_gradient=lambda q: q,
    ...     energy=lambda q, p: np.sqrt(1 + p * p) + 0.5 * q * q,
    ... )
    >>> sol = kd.solve(
    ...     system, (0.0, 10.0), 3.0, 0.0, method="blanes-moan-s6", step=0.1, compile=False
    ... )
    >>> bool(abs(sol.energy - sol.energy[0]).max() < 1e-5)
    True
    """

    kinetic_gradient: Function
    potential_gradient: Function
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system."""
        velocity = adapter.adapt(self.kinetic_gradient, "kinetic_gradient", ("t", "p", "v", "params", "out"))
        slope = adapter.adapt(self.potential_gradient, "potential_gradient", ("t", "q", "x", "params", "out"))
        return System(
            name=name_of(self.potential_gradient),
            acceleration=adapter.bind(_minus_gradient, gradient=slope.function),
            velocity=velocity.function,
            x0=adapter.x0,
            v0=adapter.v0,
            params=adapter.args,
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.SEPARABLE,
            native=velocity.native and slope.native,
        )


@dataclass(frozen=True)
class Hamiltonian(Problem):
    """H(q, p), separable or not, by Python functions.

    The functions may have the arguments ``q``, ``p``, ``t``, ``params``, and ``out`` (written in place instead of
    returning). In `solve`, x0 is q and v0 is p; a solution has them as ``q`` and ``p``, too.

    Parameters
    ----------
    dHdq, dHdp : callable
        The gradients of H.
    energy : callable, optional
        H itself.
    invariants : mapping of str to callable, optional
        Other conserved numbers by name.

    Examples
    --------
    Tao's example, whose kinetic energy depends on the position:

    >>> import kickdrift as kd
    >>> system = kd.Hamiltonian(
    ...     dHdq=lambda q, p: q * (1 + p * p),
    ...     dHdp=lambda q, p: p * (1 + q * q),
    ...     energy=lambda q, p: 0.5 * (1 + q * q) * (1 + p * p),
    ... )
    >>> options = {"method": "semi-implicit-euler", "step": 0.01, "compile": False}
    >>> sol = kd.solve(system, (0.0, 10.0), x0=0.5, v0=0.0, **options)
    >>> sol.about.method, bool(abs(sol.energy - sol.energy[0]).max() < 0.01)
    ('implicit-kick-drift', True)
    """

    dHdq: Function  # noqa: N815 - the derivative's own name
    dHdp: Function  # noqa: N815
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system."""
        names = ("t", "q", "x", "p", "v", "params", "out")
        slope = adapter.adapt(self.dHdq, "dHdq", names)
        velocity = adapter.adapt(self.dHdp, "dHdp", names)
        return System(
            name=name_of(self.dHdq),
            acceleration=adapter.bind(_minus_gradient, gradient=slope.function),
            velocity=velocity.function,
            x0=adapter.x0,
            v0=adapter.v0,
            params=adapter.args,
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.SEPARABLE if "v" not in slope.names and "x" not in velocity.names else Kind.HAMILTONIAN,
            native=slope.native and velocity.native,
        )


@dataclass(frozen=True)
class Partitioned(Problem):
    """x' = f(t, x, v), v' = g(t, x, v) by Python functions, canonical or not.

    Parameters
    ----------
    x_rate, v_rate : callable
        f and g, functions of any of ``t``, ``x``, ``v``, ``params``, and ``out`` (written in place instead of returned).
    energy, invariants
        Conserved quantities, as for `SecondOrder`.

    Examples
    --------
    The Lotka-Volterra equations, with prey x and predators v:

    >>> import numpy as np, kickdrift as kd
    >>> fish = kd.Partitioned(
    ...     lambda x, v: x * (1 - v),
    ...     lambda x, v: v * (x - 1),
    ...     invariants={"constant of motion": lambda x, v: x - np.log(x) + v - np.log(v)},
    ... )
    >>> sol = kd.solve(
    ...     fish, (0.0, 50.0), 0.5, 1.0, method="implicit-verlet", step=0.1, compile=False
    ... )
    >>> constant = sol.invariants["constant of motion"]
    >>> bool(abs(constant - constant[0]).max() < 0.01)
    True
    """

    x_rate: Function
    v_rate: Function
    energy: Function | None = None
    invariants: Mapping[str, Function] = field(default_factory=dict)

    def system(self, adapter: Adapter) -> System:
        """Make the system."""
        velocity, acceleration = adapter.adapt(self.x_rate, "x_rate"), adapter.adapt(self.v_rate, "v_rate")
        separable = "x" not in velocity.names and "v" not in acceleration.names
        return System(
            name=name_of(self.v_rate),
            acceleration=acceleration.function,
            velocity=velocity.function,
            x0=adapter.x0,
            v0=adapter.v0,
            params=adapter.args,
            quantities=adapter.quantities(self.energy, self.invariants),
            kind=Kind.SEPARABLE if separable else Kind.PARTITIONED,
            native=acceleration.native and velocity.native,
        )


def _minus_gradient(t: float, x: Floats, v: Floats, params: Floats, out: Floats) -> None:
    gradient(t, x, v, params, out)
    multiply(out, -1.0)

"""Laws as kickdrift takes them: each in the description that says most about its structure."""

import math
from typing import Any

import kickdrift as kd
from benchmarks.precision.laws import AnyLaw, compiled


def newtonian(law: AnyLaw) -> kd.SecondOrder:
    """Describe accelerations of x."""
    force = compiled(law(math).force)

    def acceleration(x: Any, out: Any) -> None:
        force(0.0, x, x, out)

    return kd.SecondOrder(acceleration)


def velocity_dependent(law: AnyLaw) -> kd.SecondOrder:
    """Describe accelerations of x and v."""
    force = compiled(law(math).force)

    def acceleration(x: Any, v: Any, out: Any) -> None:
        force(0.0, x, v, out)

    return kd.SecondOrder(acceleration)


def separable(law: AnyLaw) -> kd.Separable:
    """Describe H = T(p) + V(q)."""
    velocity, force = compiled(law(math).velocity), compiled(law(math).force)

    def kinetic_gradient(p: Any, out: Any) -> None:
        velocity(0.0, p, p, out)

    def potential_gradient(q: Any, out: Any) -> None:
        force(0.0, q, q, out)
        out *= -1.0

    return kd.Separable(kinetic_gradient, potential_gradient)


def hamiltonian(law: AnyLaw) -> kd.Hamiltonian:
    """Describe H(q, p)."""
    velocity, force = compiled(law(math).velocity), compiled(law(math).force)

    def dHdq(q: Any, p: Any, out: Any) -> None:  # noqa: N802 - the derivative's own name
        force(0.0, q, p, out)
        out *= -1.0

    def dHdp(q: Any, p: Any, out: Any) -> None:  # noqa: N802
        velocity(0.0, q, p, out)

    return kd.Hamiltonian(dHdq, dHdp)


def partitioned(law: AnyLaw) -> kd.Partitioned:
    """Describe x' and v'."""
    velocity, force = compiled(law(math).velocity), compiled(law(math).force)

    def x_rate(x: Any, v: Any, out: Any) -> None:
        velocity(0.0, x, v, out)

    def v_rate(x: Any, v: Any, out: Any) -> None:
        force(0.0, x, v, out)

    return kd.Partitioned(x_rate, v_rate)


def first_order(law: AnyLaw) -> kd.FirstOrder:
    """Describe y'."""
    velocity = compiled(law(math).velocity)

    def rates(y: Any, out: Any) -> None:
        velocity(0.0, y, y, out)

    return kd.FirstOrder(rates)

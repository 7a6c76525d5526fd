"""Checks that step controls suit methods and systems."""

import math
from functools import partial

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.engine.quantities import evaluate_quantity
from kickdrift.engine.step_control import (
    HuangLeimkuhler,
    LocalError,
    LogarithmicHamiltonian,
    StepControl,
    TimeTransformed,
)
from kickdrift.methods import Method, preferred
from kickdrift.methods.record import D, K
from kickdrift.systems.system import Quantity, System


def check_method(wanted: StepControl, system: System, method: Method) -> None:
    """Refuse a control that does not suit a method or a system.

    Raises
    ------
    ArgumentError
    """
    name = f"kd.{type(wanted).__name__}"
    check_noise(name, system)
    check_corrector(name, method)
    if isinstance(wanted, LocalError):
        return
    if not method.symmetric:
        raise ArgumentError(
            f"step_control={name} keeps steps reversible, but method={method.name!r} is not symmetric; use"
            f" {preferred(system.kind, 2).name!r}, another symmetric method, or kd.LocalError(rtol, atol)."
        )
    if isinstance(wanted, HuangLeimkuhler | TimeTransformed) and (method.order != 2 or method.tableau is not None):
        raise ArgumentError(
            f"step_control={name} is for splittings of order 2, and method={method.name!r} is not one; use"
            " 'velocity-verlet', or kd.HairerSoderlind."
        )
    if isinstance(wanted, HuangLeimkuhler) and not {letter.plain for letter in method.letters} <= {K, D}:
        raise ArgumentError(
            f"step_control={name} divides a step at its midpoint, and method={method.name!r} has flows other than"
            " kicks and drifts; use kd.HairerSoderlind."
        )
    if isinstance(wanted, LogarithmicHamiltonian | TimeTransformed):
        plain = {letter.plain for letter in method.letters}
        if not (plain <= {K, D} and method.kind.includes(Kind.SEPARABLE)):
            raise ArgumentError(
                f"step_control={name} changes kicks and drifts so that only splittings for T(p) + V(q) keep their"
                f" order, and method={method.name!r} is not one; use 'velocity-verlet', 'blanes-moan-s6' or"
                " 'kahan-li-8'."
            )
        if not Kind.NEWTONIAN.includes(system.kind):
            raise ArgumentError(
                f"step_control={name} is for {Kind.NEWTONIAN.value}, but the kind of {system.name!r} is"
                f" {system.kind.value}; use kd.HairerSoderlind."
            )


def check_copies(name: str, system: System, method: Method) -> None:
    """Refuse methods whose flows would not see that the velocities jump.

    Raises
    ------
    ArgumentError
    """
    check_noise(name, system)
    check_corrector(name, method)
    if any(letter.share.startswith("doubled") for letter in method.letters):
        raise ArgumentError(
            f"{name} and method={method.name!r}: velocities jump, but this method keeps a second copy of the state;"
            " use another one, such as 'gauss-4'."
        )


def check_noise(name: str, system: System) -> None:
    """Refuse noise, whose path is for steps of one size.

    Raises
    ------
    ArgumentError
    """
    if system.kind is Kind.LANGEVIN:
        raise ArgumentError(f"{name} and noise: a stochastic path needs equal steps; leave one of them out.")


def check_corrector(name: str, method: Method) -> None:
    """Refuse correctors, which are for steps of one size.

    Raises
    ------
    ArgumentError
    """
    if method.corrector:
        raise ArgumentError(
            f"{name} and method={method.name!r}: its corrector needs equal steps; use the method without it."
        )


def check_merging(density: object, system: System) -> None:
    """Refuse a density by distances for bodies that merge, as they have none then.

    Raises
    ------
    ArgumentError
    """
    if system.radii is not None and isinstance(density, str):
        raise ArgumentError(
            f"step_control={density!r} has no value where bodies of {system.name!r} have merged; leave it out, since"
            " the method resolves encounters itself, or give rtol and atol."
        )


def check_density(density: Quantity, named: str, system: System, t0: float) -> None:
    """Refuse a density that is invalid at the start, or that changes with the velocities reversed.

    Raises
    ------
    ArgumentError
    """
    at = partial(evaluate_quantity, density, system, np.array([t0]), system.x0[None])
    here, turned = float(at(system.v0[None])[0]), float(at(-system.v0[None])[0])
    if not 0.0 < here < math.inf:
        raise ArgumentError(
            f"density by {named} is {here!r} at the start; it must be positive and finite: the number of steps per"
            " unit of time."
        )
    if abs(here - turned) > 1e-9 * here:
        raise ArgumentError(
            f"density by {named} is {here!r} at the start, and {turned!r} with the velocities reversed; it must"
            " be the same, or the steps are not reversible."
        )


def binding_energy(system: System, t0: float) -> Quantity:
    """Return the energy of a system, which must be T(v) + U(x) with U < 0 as far as the start shows.

    Raises
    ------
    ArgumentError
    """
    if "energy" not in system.quantities:
        raise ArgumentError(
            f"step_control=kd.LogarithmicHamiltonian() needs the energy, which {system.name!r} does not define; pass"
            " energy=... to its description, or use kd.TimeTransformed('distance')."
        )
    energy = system.quantities["energy"]
    x, v, rest = system.x0, system.v0, np.zeros_like(system.v0)
    aside = x * 1.01 + 0.001 * np.abs(x).max(initial=1e-3)
    states = np.array([x, x, aside, aside]), np.array([rest, v, rest, v])
    potential, whole, other, other_whole = evaluate_quantity(energy, system, np.full(4, t0), *states)
    if not -math.inf < potential < 0.0:
        raise ArgumentError(
            "step_control=kd.LogarithmicHamiltonian() needs a negative potential energy, as of gravity; at the start"
            f" that of {system.name!r} is {float(potential)!r}. Use kd.HairerSoderlind() or kd.TimeTransformed()."
        )
    if abs((whole - potential) - (other_whole - other)) > 1e-9 * (abs(whole) + abs(potential) + abs(other)):
        raise ArgumentError(
            f"step_control=kd.LogarithmicHamiltonian() needs an energy T(v) + U(x), but that of {system.name!r} has a"
            " kinetic energy that depends on x; use kd.HairerSoderlind()."
        )
    return energy

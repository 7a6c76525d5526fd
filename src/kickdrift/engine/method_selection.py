"""Whether a method fits a system, and which one does."""

from typing import Any

import numpy as np

from kickdrift import methods
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.core.kinds import Kind
from kickdrift.methods import Method
from kickdrift.systems.system import System

AUTO = "auto"


DEFAULT = "semi-implicit-euler"


def choose(method: str | Method | None, order: int | None, system: System) -> Method:
    """Find the method to run a system by: by name, or for ``"auto"`` by the kind of the system and the order wanted.

    None is the semi-implicit Euler method, or ``"auto"`` where that does not apply or an order is wanted. For
    Hamiltonians that are not separable it is what goes under the name there.

    Raises
    ------
    MethodMismatchError
        If the method would lose its order on the system, or needs a flow that the system does not have, or if there is
        none of the order wanted.
    """
    if method is None:
        method = DEFAULT if order is None and methods.get(DEFAULT).kind.includes(system.kind) else AUTO
    if method == AUTO:
        return methods.preferred(system.kind, order)
    named = methods.get(method)
    if system.kind is Kind.HAMILTONIAN and named.counterpart:
        return methods.get(named.counterpart)
    if named.kind.includes(system.kind):
        return named
    try:
        best = methods.preferred(system.kind, named.order)
    except MethodMismatchError:
        best = methods.preferred(system.kind)
    description = f", or describe it as {_DESCRIPTIONS[named.kind]}" if named.kind in _DESCRIPTIONS else ""
    raise MethodMismatchError(
        f"method={named.name!r} is for {named.kind.value}, but {system.name!r} has {system.kind.value}: there it would"
        f" lose its order, or has no flow for a part of it; use {best.name!r} (order {best.order}){description}."
    )


_DESCRIPTIONS = {
    Kind.DAMPED: "kd.Damped",
    Kind.CHARGED: "kd.ChargedParticle",
    Kind.CONSTRAINED: "kd.Constrained",
    Kind.LANGEVIN: "kd.Langevin",
    Kind.NEARLY_KEPLERIAN: "kd.systems.planetary, or kd.systems.solar_system(splitting='jacobi')",
}


def check_wanted(method: Any, order: Any) -> None:
    """Refuse a method that there is not, and an order that is none or not for this method.

    Raises
    ------
    ArgumentError
    """
    if not (method is None or (isinstance(method, str) and method == AUTO)):
        methods.get(method)
        if order is not None:
            raise ArgumentError(f"order={order!r} is for method='auto'; {method!r} has its own. Leave one of them out.")
    elif order is not None and (isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 1):
        raise ArgumentError(f"order={order!r} must be a positive whole number.")


def check_direction(method: Method, step: float) -> None:
    """Refuse noise that would run backwards.

    Raises
    ------
    ArgumentError
        If a letter with noise has a share of the step that is negative.
    """
    for letter, weight in method.word:
        if letter.noisy and float(weight) * step < 0:
            raise ArgumentError(
                f"method={method.name!r} has {letter.symbol!r} for {float(weight) * step!r}, backwards in time, where"
                " noise has no meaning; give a t_span that runs forwards, and a word without negative shares of it."
            )

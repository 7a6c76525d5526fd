"""Selection of a method for a system, and checks that a given one suits it."""

from typing import Any, NamedTuple

from kickdrift import methods
from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.core.kinds import Kind
from kickdrift.engine.pericentres import fastest_pericentre
from kickdrift.engine.stiffness import Stiffness, may_be_stiff, stiffness
from kickdrift.methods import Letter, Method
from kickdrift.systems.system import System

AUTO = "auto"


DEFAULT = "semi-implicit-euler"

MERGING = "close-encounters"


class Choice(NamedTuple):
    """A method, with the reason for the choice of ``"auto"``; none if it was named, by its name or an alias."""

    method: Method
    reason: str = ""
    alias: str = ""

    @property
    def name(self) -> str:
        """The name by which it was requested, otherwise its own."""
        return self.alias or self.method.name


def choose(
    method: str | Method | None,
    order: int | None,
    system: System,
    t0: float,
    step: float,
    span: float,
    default: str = DEFAULT,
    order_beside: int | None = None,
) -> Choice:
    """Find the method to run a system by: by name, or for ``"auto"`` by its kind, the order wanted, and its stiffness.

    None is the `default`, or ``"auto"`` where that does not apply or an order is wanted, and where it would see fast
    oscillations as a force; then of the order `order_beside` if none is wanted. For Hamiltonians that are not separable it is
    what goes under the name there.

    Raises
    ------
    ArgumentError
        For bodies that merge backwards in time.
    MethodMismatchError
        If the method would lose its order on the system, or needs a flow that the system does not have, or if there is
        none of the order wanted.
    """
    if system.radii is not None:
        if step < 0.0:
            raise ArgumentError(
                f"t_span runs backwards from t={t0!r}, but the bodies of {system.name!r} have radii, and mergers"
                " cannot be reversed; leave the radii out."
            )
        return _of_bodies_that_merge(method, system)
    if method is None:
        applies = default != AUTO and methods.get(default).kind.includes(system.kind)
        if applies and order is None and system.kind is not Kind.OSCILLATORY:
            method = default
        else:
            method, order = AUTO, order_beside if order is None else order
    if isinstance(method, str) and method == AUTO:
        return _choose_by_itself(order, system, t0, step, span)
    named = methods.get(method)
    if system.kind is Kind.HAMILTONIAN and named.counterpart:
        return Choice(methods.get(named.counterpart))
    if named.kind.includes(system.kind):
        return Choice(named, alias=method if isinstance(method, str) else "")
    raise _mismatch(named, system)


def _of_bodies_that_merge(method: str | Method | None, system: System) -> Choice:
    if method is None or method == AUTO:
        return Choice(methods.get(MERGING), "bodies have radii, and merge on contact")
    named = methods.get(method)
    if Letter.ENCOUNTERS not in named.letters:
        raise MethodMismatchError(
            f"method={named.name!r} does not detect contact, but the bodies of {system.name!r} have radii, and merge"
            f" on contact; use {MERGING!r}, or leave the radii out."
        )
    return Choice(named, alias=method if isinstance(method, str) else "")


def _choose_by_itself(order: int | None, system: System, t0: float, step: float, span: float) -> Choice:
    found = stiffness(system, t0, step, span) if may_be_stiff(system.kind) else Stiffness.NONE
    if found is Stiffness.DECAY and (stable := methods.preferred_for_stiff(order, abs(span / step))) is not None:
        return Choice(stable, f"stiff, with decay much faster than a step; L-stable, {_aim(order)}")
    if found is Stiffness.OSCILLATION and order is None:
        return Choice(
            methods.preferred_for_fast_oscillations(system.kind),
            "stiff, with oscillations much faster than a step, which it neither damps nor amplifies",
        )
    if system.kind is Kind.NEARLY_KEPLERIAN and order is None:
        turn = abs(step) * fastest_pericentre(system)
        return Choice(
            methods.preferred_for_nearly_keplerian(turn),
            f"the fastest for most tolerances, where a step spans {turn:.2g} radians of the fastest pericentre passage",
        )
    return Choice(methods.preferred(system.kind, order), f"{_aim(order)}, for {system.kind.value}")


def _aim(order: int | None) -> str:
    return "the fastest for most tolerances" if order is None else f"the best of order {order} or higher"


def _mismatch(named: Method, system: System) -> MethodMismatchError:
    try:
        best = methods.preferred(system.kind, named.order)
    except MethodMismatchError:
        best = methods.preferred(system.kind)
    description = f", or describe it as {_DESCRIPTIONS[named.kind]}" if named.kind in _DESCRIPTIONS else ""
    return MethodMismatchError(
        f"method={named.name!r} is for {named.kind.value}, but {system.name!r} has {system.kind.value}, on which it loses its"
        f" order or does not apply; use {best.name!r} (order {best.order}){description}."
    )


_DESCRIPTIONS = {
    Kind.DAMPED: "kd.Damped",
    Kind.CHARGED: "kd.ChargedParticle",
    Kind.CONSTRAINED: "kd.Constrained",
    Kind.LANGEVIN: "kd.Langevin",
    Kind.MULTIRATE: "kd.Multirate",
    Kind.OSCILLATORY: "kd.Oscillatory",
    Kind.NEARLY_KEPLERIAN: "kd.systems.planetary, or kd.systems.solar_system(splitting='jacobi')",
}


def check_wanted(method: Any, order: Any) -> None:
    """Refuse an unknown method, and an order that is not one, or that this method cannot have.

    Raises
    ------
    ArgumentError
    """
    if not (method is None or (isinstance(method, str) and method == AUTO)):
        methods.get(method)
        if order is not None:
            raise ArgumentError(
                f"order={order!r} is for method='auto'; {method!r} has its own order. Leave one of them out."
            )
    elif order is not None and not is_whole(order, 1):
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
                " noise is not defined; give a t_span that runs forwards, and a word without negative weights for it."
            )

"""Whether ``method="auto"`` takes the best method of each order, at equal evaluations of the force."""

import numpy as np

import kickdrift as kd
from benchmarks.precision import ours
from benchmarks.precision.case import Case
from benchmarks.precision.cases import every_case
from benchmarks.precision.laws import Floats
from benchmarks.table import Row, at_least, measured, skipped
from kickdrift.core.kinds import Kind
from kickdrift.methods import Method

TITLE = 'What "auto" takes: error of the best other method of the order, at equal evaluations'
# As what the cases are taken; the planets as bodies that attract each other, without the Kepler problems.
_KINDS = {
    "newtonian": Kind.NEWTONIAN,
    "kepler": Kind.NEWTONIAN,
    "nearly-keplerian": Kind.NEWTONIAN,
    "separable": Kind.SEPARABLE,
}
_ORDERS = (2, 4, 6, 8, 10)
_BUDGETS = 13
_LARGEST, _LEAST = 1e-2, 1e-12  # errors between which methods are compared; above is chaos, below is rounding


def compare() -> list[Row]:
    """Compare the choices with the rest of the catalogue, for the kinds that have many methods."""
    wanted = [(case, _KINDS[case.name]) for case in every_case() if case.name in _KINDS]
    return [_compare(case, kind, order) for case, kind in wanted for order in _ORDERS]


def rivals(kind: Kind, order: int) -> list[Method]:
    """Find the words of kicks and drifts that have an order on a kind."""
    return [
        method
        for method in kd.methods.catalogue().values()
        if method.order == order and method.kind.includes(kind) and Kind.SEPARABLE.includes(method.kind)
    ]


def best_other(chosen: Floats, others: dict[str, Floats]) -> tuple[str, Floats]:
    """Find the other method with the least errors, as a geometric mean, and its errors over those of the chosen one.

    None where there is no other, or the errors are too large or too small to be compared.
    """
    ratios = {}
    for name, errors in others.items():
        larger, smaller = np.maximum(errors, chosen), np.minimum(errors, chosen)
        usable = (larger < _LARGEST) & (smaller > _LEAST)
        if usable.any():
            ratios[name] = errors[usable] / chosen[usable]
    if not ratios:
        return "", np.zeros(0)
    name = min(ratios, key=lambda other: float(np.log(ratios[other]).mean()))
    return name, ratios[name]


def _compare(case: Case, kind: Kind, order: int) -> Row:
    reference = ours.reference(case) if case.needs_reference else None
    budgets = np.geomspace(*case.evaluations, _BUDGETS)
    chosen = kd.methods.preferred(kind, order)
    others = {method.name: _errors(case, method, budgets, reference) for method in rivals(kind, order)}
    name, ratios = best_other(others.pop(chosen.name), others)
    if not name:
        return skipped(f"{case.title}, order {order}: {chosen.name}", "nothing to compare with")
    what = f"{case.title}, order {order}: {name} / {chosen.name}"
    return measured(what, ratios, at_least(1), f"at {ratios.size} of {budgets.size} budgets")


def _errors(case: Case, method: Method, budgets: Floats, reference: Floats | None) -> Floats:
    contestant = ours.contestant(case, method.name)
    solver = contestant.make(case)
    steps = [max(2, round(budget / (contestant.cost or 1))) for budget in budgets]
    return np.array([case.error_of(solver(n, True), reference) for n in steps])

"""Measuring in turns, so that what else the machine does falls on all contestants alike."""

import gc
from collections.abc import Callable, Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

Costs = dict[str, NDArray[np.float64]]  # by contestant, one number a round


def in_turns(contestants: Mapping[str, Callable[[], float]], rounds: int) -> Costs:
    """Let the contestants measure themselves in turns.

    Parameters
    ----------
    contestants : mapping of str to callable
        Each does its work once and returns its cost, such as nanoseconds per step.
    rounds : int
        How often each comes. Every other round goes backwards, so that a machine that slows down steadily favours none;
        one round before the first is thrown away, because it compiles and fills caches. The garbage of a contestant is
        collected before the next one begins, and not while one measures, as in `timeit`: a collection takes 5 ms with all
        peers loaded, and falls on whoever allocates the thousandth object.
    """
    costs: dict[str, list[float]] = {name: [] for name in contestants}
    for measure in contestants.values():
        measure()
    for round_ in range(rounds):
        names = list(contestants)
        for name in names if round_ % 2 == 0 else reversed(names):
            costs[name].append(_without_collections(contestants[name]))
    return {name: np.array(values) for name, values in costs.items()}


def _without_collections(measure: Callable[[], float]) -> float:
    gc.collect()
    gc.disable()
    try:
        return measure()
    finally:
        gc.enable()


def ratio(costs: Costs, one: str, other: str) -> NDArray[np.float64]:
    """Cost of `one` over that of `other`, round by round."""
    return costs[one] / costs[other]


def cheapest(costs: Costs, names: Iterable[str]) -> str:
    """Find the contestant with the lowest median cost."""
    return min(names, key=lambda name: float(np.median(costs[name])))


def nanoseconds(costs: Costs, *names: str) -> str:
    """Say the median costs of this run, as information."""
    return ", ".join(f"{name} {np.median(costs[name]):.3g} ns" for name in names)

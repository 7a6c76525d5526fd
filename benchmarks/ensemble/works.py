"""Runs with what they took and how large their errors are, and rows that compare the cheapest ones to an error."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from benchmarks.table import Bound, Row, measured, skipped

_REPEATS = 3


@dataclass(frozen=True)
class Work:
    """What a run took, in microseconds a member, and its errors by name, of the worst member."""

    who: str
    cost: float
    errors: dict[str, float]


def seconds(run: Callable[[], object], repeats: int = _REPEATS) -> float:
    """Time of a run, the best of some."""
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        run()
        times.append(time.perf_counter() - started)
    return min(times)


def row(what: str, of: str, error: float, theirs: Iterable[Work], ours: Iterable[Work], bound: Bound | None) -> Row:
    """Compare the cheapest run of each that has an error of no more than so much."""
    cheapest = [min((w for w in runs if w.errors[of] <= error), key=_cost, default=None) for runs in (theirs, ours)]
    note = "; ".join(
        f"{name} {run.who}, {run.cost:.3g} us" if run else f"{name} does not get there"
        for name, run in zip(("heyoka", "kickdrift"), cheapest, strict=True)
    )
    one, other = cheapest
    what = f"{what}, {of} within {error:.0e}: heyoka / kickdrift"
    return skipped(what, note) if one is None or other is None else measured(what, [one.cost / other.cost], bound, note)


def _cost(work: Work) -> float:
    return work.cost

"""A step of each kind against the same algorithm written by hand, as a compiled loop with the same tolerance.

The loops by hand know the size of the state, call the acceleration where they want it, and have the compensated sums
that kickdrift has. Before anything is timed, both have to arrive in the same place.
"""

from benchmarks.steps import bounds, chains, constrained, explicit, implicit, large, massless
from benchmarks.steps.pair import Pair
from benchmarks.table import Row, at_most, measured
from benchmarks.turns import in_turns, nanoseconds, ratio

WANTED = at_most(2)


def pairs() -> list[Pair]:
    """Everything that is compared."""
    return [pair for part in (implicit, explicit, constrained, chains, large, massless) for pair in part.pairs()]


def compare(rounds: int) -> list[Row]:
    """Time of a step over that of the loop by hand, and what the check of indices costs."""
    return [*(_row(pair, rounds) for pair in pairs()), *bounds.rows(rounds)]


def _row(pair: Pair, rounds: int) -> Row:
    pair.check()
    costs = in_turns({"kickdrift": pair.ours_per_step, "by hand": pair.by_hand_per_step}, rounds)
    note = f"{nanoseconds(costs, 'kickdrift', 'by hand')}"
    return measured(pair.what, ratio(costs, "kickdrift", "by hand"), WANTED, note)

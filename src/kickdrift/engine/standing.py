"""The state of a run, from which it can continue."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from kickdrift.engine.rows import Mark
from kickdrift.engine.stepper import State
from kickdrift.engine.zeros import Seen


@dataclass(frozen=True, eq=False)
class Standing:
    """Where a run stands.

    Attributes
    ----------
    state : State
        Of the loop.
    step : int
        After which it is that.
    mark : Mark
        How far the rows are.
    rows : mapping of str to array
        The rows, see `kickdrift.engine.rows`.
    wall_time : float
        Seconds in the loop.
    seen : Seen or None
        What was found of events.
    """

    state: State
    step: int
    mark: Mark
    rows: Mapping[str, NDArray[Any]]
    wall_time: float
    seen: Seen | None

"""The progress of a run, from which it can continue."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from numpy.typing import NDArray

from kickdrift.engine.rows import Mark
from kickdrift.engine.stepper import State
from kickdrift.engine.zeros import Seen


class Standing(NamedTuple):
    """The progress of a run.

    Attributes
    ----------
    state : State
        State of the loop.
    step : int
        The step after which it is reached.
    mark : Mark
        Progress of the rows.
    rows : mapping of str to array
        The rows, see `kickdrift.engine.rows`.
    wall_time : float
        Seconds in the loop.
    seen : Seen or None
        Zeros of events found so far.
    """

    state: State
    step: int
    mark: Mark
    rows: Mapping[str, NDArray[Any]]
    wall_time: float
    seen: Seen | None

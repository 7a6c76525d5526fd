"""From a word to what the loop runs: the same flows, with the clock worked out and no force evaluated twice."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from kickdrift.engine.flow_table import FLOWS
from kickdrift.methods import Letter, Method
from kickdrift.systems.system import System


@dataclass(frozen=True)
class Program:
    """A step as arrays.

    Attributes
    ----------
    flows : tuple of str
        Names of the flows that the step uses, see `kickdrift.engine.flow_table`.
    letters : (L,) array of int
        The step: indices into `flows`.
    weights : (L,) array
        Share of the step of each letter.
    offsets : (L,) array
        Clock of each letter, in steps from the start of the step.
    evaluations : int
        Force evaluations of a step, those inside implicit flows not counted.
    primed : bool
        Whether the acceleration at the start is evaluated once, before the first step.
    """

    flows: tuple[str, ...]
    letters: NDArray[np.int64]
    weights: NDArray[np.float64]
    offsets: NDArray[np.float64]
    evaluations: int
    primed: bool


def compose(method: Method, system: System) -> Program:
    """Work out the step of a method on a system.

    A kick at the start of a step sees the position and the time that the kick at the end of the step before has seen.
    Where the acceleration does not depend on the velocity it is not evaluated again. That saves the evaluation but not
    the kick itself, so that the numbers do not depend on which steps are saved.
    """
    names = [letter.value for letter, _ in method.word]
    primed = not system.velocity_dependent and len(names) > 1 and names[0] == names[-1] == Letter.KICK.value
    if primed:
        names[0] = "rekick"
    clock, offsets = Fraction(0), []
    for letter, weight in method.word:
        offsets.append(float(clock))
        # The clock moves with the drift: a kick sees the time of the positions that it sees.
        clock += weight * FLOWS[letter.value].moves_clock
    flows = tuple(dict.fromkeys(names))
    return Program(
        flows=flows,
        letters=np.array([flows.index(name) for name in names]),
        weights=np.array([float(weight) for _, weight in method.word]),
        offsets=np.array(offsets),
        evaluations=sum(FLOWS[name].evaluations for name in names),
        primed=primed,
    )

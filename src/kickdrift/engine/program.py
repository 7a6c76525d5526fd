"""Programs: words as the loop runs them, with the times of all letters, and no force evaluated twice."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.kinds import Kind
from kickdrift.engine.flows.table import FLOWS
from kickdrift.methods import Letter, Method
from kickdrift.methods.record import Word
from kickdrift.systems.system import System


@dataclass(frozen=True, eq=False)
class Program:
    """A step as arrays.

    Attributes
    ----------
    flows : tuple of str
        Names of the flows that the step uses, see `kickdrift.engine.flows.table`.
    letters : (L,) array of int
        The step: indices into `flows`.
    weights : (L,) array
        Fraction of the step of each letter.
    offsets : (L,) array
        Time of each letter, in steps from the start of the step.
    evaluations : int
        Force evaluations of a step, without those inside implicit flows.
    primers : tuple of str
        Names of the flows that run once before the first step, without moving the state.
    split : bool
        Whether the kicks contain only the remainder of the acceleration.
    coefficients : (C,) array
        Coefficients of the method that the flows need.
    ticks, ticks_of_v : (L,) array
        Advance of the clock by each letter, and of the clock that moves with v, in steps.
    sees_v_clock : (L,) array of int
        Whether a letter uses the latter.
    """

    flows: tuple[str, ...]
    letters: NDArray[np.int64]
    weights: NDArray[np.float64]
    offsets: NDArray[np.float64]
    evaluations: int
    primers: tuple[str, ...]
    split: bool
    coefficients: NDArray[np.float64]
    ticks: NDArray[np.float64]
    ticks_of_v: NDArray[np.float64]
    sees_v_clock: NDArray[np.int64]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all flows, those of the primers last."""
        return self.flows + self.primers

    @cached_property
    def alone(self) -> frozenset[str]:
        """Names of the flows whose acceleration no other letter uses again."""
        again = {name: FLOWS[name].again for name in self.flows if not self.split}
        return frozenset(name for name, other in again.items() if other and other not in self.flows)

    @cached_property
    def by_params(self) -> bool:
        """Whether sizes and constants of flows depend on the params of the system."""
        return any(FLOWS[name].by_params for name in self.names)

    @property
    def transformed(self) -> bool:
        """Whether letters move the clock themselves, in a time of their own."""
        return any(FLOWS[name].moves_clock for name in self.flows)


Spelled = list[tuple[str, Fraction, Fraction]]
"""Flow, fraction of the step and time of each letter."""

Control = Callable[[Callable[[Word], Spelled], Word], Spelled]
"""Adds the letters of step control: given a function that spells words, and the word."""


class Structure(NamedTuple):
    """Properties of a system on which a program depends: its kind, whether x' differs from v, and the names of its parts."""

    kind: Kind
    has_velocity: bool
    parts: frozenset[str]

    @classmethod
    def of(cls, system: System) -> "Structure":
        """Return the structure of a system."""
        return cls(system.kind, system.velocity is not None, frozenset(system.parts))


def compose(
    method: Method,
    system: Structure,
    word: Word | None = None,
    clock: Fraction = Fraction(0),
    repeated: bool = True,
    control: Control | None = None,
) -> Program:
    """Compose the program of a method on a system, or of another word of its letters.

    Such a word may begin at another time, `clock`, of the step, and may be done once instead of `repeated`. A `control` adds
    the letters of variable steps.

    The flow of a letter depends on the kind of problem: an adjoint kick is a kick if the acceleration does not depend on the
    velocity, and the drift of a first-order system is the sweep over its components.

    The clock moves with the drift: a kick is evaluated at the time of its positions. In the same way the rate of x is evaluated
    at the time of the velocities, by a clock that moves with the kicks. (For a Hamiltonian T(p, t) + V(q, t) these are two more
    pairs of conjugate variables, and the split parts stay exactly solvable.)

    A kick at the same position and time as the kick before it, possibly at the end of the step before, does not evaluate the
    acceleration again. That saves the evaluation but not the kick itself, so that the results do not depend on which steps are
    saved.
    """
    word = method.word if word is None else word
    if control is None:
        spelled = _spell(method, system, word, clock)
    else:
        spelled = control(lambda part: _spell(method, system, part, clock), word)
    names = [name for name, _, _ in spelled]
    primed = False
    if not _kicks_see_velocity(method, system):
        names, primed = _reuse_accelerations(names, repeated)
    flows = tuple(dict.fromkeys(names))
    primers = tuple(dict.fromkeys(FLOWS[name].primer for name in flows if FLOWS[name].primer))
    if primed:
        primers = (*dict.fromkeys(FLOWS[name].evaluation for name in flows if FLOWS[name].evaluation), *primers)
    return Program(
        flows=flows,
        letters=np.array([flows.index(name) for name in names]),
        weights=(weights := np.array([float(weight) for _, weight, _ in spelled])),
        offsets=np.array([float(offset) for _, _, offset in spelled]),
        evaluations=sum(FLOWS[name].evaluations for name in names),
        primers=primers,
        split=_split(method, system),
        coefficients=method.coefficients,
        ticks=weights * [FLOWS[name].moves_x and FLOWS[name].timed for name in names],
        ticks_of_v=weights * [FLOWS[name].moves_v and FLOWS[name].timed for name in names],
        sees_v_clock=np.array([FLOWS[name].sees_v_clock for name in names], dtype=np.int64),
    )


def evaluations_of(method: Method) -> int:
    """Force evaluations of a step of an explicit method, on the simplest problem of its kind."""
    if method.tableau is not None:
        return method.tableau().stages
    kind = Kind.NEWTONIAN if method.kind.includes(Kind.NEWTONIAN) else method.kind
    program = compose(method, Structure(kind, False, frozenset({"remainder"})))
    return program.evaluations + sum(FLOWS[name].counted(program.coefficients) for name in program.flows)


def _spell(method: Method, system: Structure, word: Word, x_clock: Fraction) -> Spelled:
    """Return flow, fraction and time of each letter; equal neighbours are merged."""
    v_clock = Fraction(0)
    spelled: Spelled = []
    for letter, weight in word:
        name = _flow_of(letter, system, method)
        if name is None:
            continue
        flow = FLOWS[name]
        clock = v_clock if flow.sees_v_clock else x_clock
        merging = flow.merges and not (flow.moves_v and _kicks_see_velocity(method, system))
        if spelled and spelled[-1][0] == name and merging:
            spelled[-1] = name, spelled[-1][1] + weight, spelled[-1][2]
        else:
            spelled.append((name, weight, clock))
            if flow.companion in system.parts and _split(method, system):
                spelled.append((flow.companion, weight, clock))
        x_clock += weight * (flow.moves_x and flow.timed)
        v_clock += weight * (flow.moves_v and flow.timed)
    return spelled


def _flow_of(letter: Letter, system: Structure, method: Method) -> str | None:
    if system.kind is Kind.FIRST_ORDER:
        return letter.sweep
    plain = {
        "kick": not _kicks_see_velocity(method, system),
        "drift": not system.has_velocity or Kind.SEPARABLE.includes(system.kind),
    }
    name = letter.plain.value if plain.get(letter.share) else letter.value
    return FLOWS[name].along or name if system.has_velocity else name


def _split(method: Method, system: Structure) -> bool:
    """Whether the kicks contain only the remainder of the acceleration, because another flow of the word contains the rest."""
    shares = {letter.share for letter in method.letters}
    return "remainder" in system.parts and "kick" in shares and not shares <= {"kick", "drift"}


def _kicks_see_velocity(method: Method, system: Structure) -> bool:
    if _split(method, system) or system.kind in (Kind.CONSTRAINED, Kind.LANGEVIN):
        return False
    return not Kind.SEPARABLE.includes(system.kind)


def _reuse_accelerations(names: list[str], repeated: bool) -> tuple[list[str], bool]:
    """Replace kicks whose acceleration is known by ones that do not evaluate it; also return whether the first is one."""

    def walk(known: bool) -> tuple[list[str], bool]:
        replaced = []
        for name in names:
            flow = FLOWS[name]
            replaced.append(flow.again if flow.again and known else name)
            known = bool(flow.again) or (known and not flow.moves_x and flow.keeps_acceleration)
        return replaced, known

    once, known = walk(False)
    if not (known and repeated):
        return once, False
    again, _ = walk(True)
    return again, again != once

"""The step of a world as a word over stages, with what this world has a use for."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import address_of
from kickdrift.core.compilation import Function
from kickdrift.world.collision.broad_phase import find_pairs
from kickdrift.world.contacts.advance import find_impacts
from kickdrift.world.contacts.impact import bounce, find_bouncing
from kickdrift.world.contacts.looking import place_shapes
from kickdrift.world.contacts.prepare import colour, prepare
from kickdrift.world.contacts.solve import THREADED, measure, relax, solve, store, warm_start
from kickdrift.world.contacts.update import find_points
from kickdrift.world.events import note_touching
from kickdrift.world.flight import begin, drift, finish, flatten, kick
from kickdrift.world.forces import begin_forces
from kickdrift.world.islands import sleep, wake
from kickdrift.world.joints.registry import Joints
from kickdrift.world.step import STAGE

Stages = tuple[Function, ...]


class Uses(NamedTuple):
    """What a world needs besides contacts; stages that it does not need are not compiled."""

    forces: Stages
    bounces: bool
    is_fast: bool
    sleeps: bool
    planar: bool
    threads: bool


class Word(NamedTuple):
    """Stages of a step: before, in each of, and after the substeps."""

    before: Stages
    substep: Stages
    after: Stages

    def __str__(self) -> str:
        before, substep, after = (" ".join(stage.__name__.replace("_", "-") for stage in part) for part in self)
        return f"{before} ({substep})* {after}"


def word(uses: Uses, joints: Joints) -> Word:
    """Spell the step, to be read from top to bottom."""
    before = (
        begin,
        place_shapes,
        find_pairs,
        find_points,
        *when(uses.is_fast, find_impacts),
        *when(uses.sleeps, wake),
        *joints.before(),
        colour,
        prepare,
        *when(uses.bounces or uses.is_fast, find_bouncing),
    )
    substep = (
        begin_forces,
        *uses.forces,
        kick,
        *when(uses.bounces or uses.is_fast, bounce),
        *joints.forgetting(),
        warm_start,
        *joints.warm_starting(),
        solve,
        *joints.solving(),
        *when(uses.planar, flatten),
        drift,
        relax,
        *joints.relaxing(),
    )
    after = (
        finish,
        measure,
        store,
        note_touching,
        *when(uses.sleeps, sleep),
        *joints.after(),
    )
    if uses.threads:
        substep = tuple(THREADED.get(stage, stage) for stage in substep)
    return Word(before, substep, after)


def when(wanted: bool, stage: Function) -> Stages:
    """One stage or none."""
    return (stage,) if wanted else ()


class Program(NamedTuple):
    """A word as the loop runs it: addresses of its stages, the time that each covers, and when in the step it begins."""

    addresses: NDArray[np.intp]
    lengths: NDArray[np.float64]
    offsets: NDArray[np.float64]


def compose(spelt: Word, step: float, substeps: int) -> Program:
    """Compile the stages of a word and lay them out, its substeps one after the other."""
    before, substep, after = spelt
    h = step / substeps
    addresses = [address_of(stage, STAGE) for stage in (*before, *substep * substeps, *after)]
    lengths = [step] * len(before) + [h] * len(substep) * substeps + [step] * len(after)
    offsets = [0.0] * len(before) + [k * h for k in range(substeps) for _ in substep] + [step] * len(after)
    return Program(np.array(addresses, dtype=np.intp), np.array(lengths), np.array(offsets))

"""Compilation of the functions of a step, in parallel, before the first step and where a step needs others."""

from collections.abc import Iterable

from kickdrift.core.parallel_compile import Job, compile_together, missing
from kickdrift.engine.announcing import compiling_announced
from kickdrift.world.collision.narrow_phase.manifolds import COLLIDE
from kickdrift.world.collision.narrow_phase.pair_dispatch import PAIRS
from kickdrift.world.collision.shape_properties import extents_of
from kickdrift.world.shapes.record import EXTENT, RAY
from kickdrift.world.shapes.shape_kinds import KINDS, RAYS
from kickdrift.world.step.kernels import kernels_of
from kickdrift.world.step.stage_loop import STAGE
from kickdrift.world.step.stage_order import Uses, Word, word


def compile_step(spelt: Word, kinds: Iterable[int], pairs: Iterable[tuple[int, int]]) -> None:
    """Compile the stages of a step and the functions for kinds of shapes and their pairs, unless they are on disk."""
    jobs = missing(_jobs(spelt, kinds, pairs))
    if jobs:
        with compiling_announced(None, f"{len(jobs)} function{'s' * (len(jobs) != 1)} of the step"):
            compile_together(jobs)


def all_jobs() -> list[Job]:
    """Return everything that any world may have to compile, except for users' forces."""
    nothing = dict.fromkeys(Uses._fields[2:], False)
    everything = dict.fromkeys(nothing, True)
    words = (
        word(Uses((), (), **nothing | {"many": True})),  # in batches, which most other features rule out
        word(Uses((), (), **everything | {"threads": False, "many": False})),
        word(Uses((), (), **everything)),
    )
    rays = [(ray, RAY) for ray in RAYS.values()]
    return [*(job for spelt in words for job in _jobs(spelt, KINDS, PAIRS)), *rays]


def _jobs(spelt: Word, kinds: Iterable[int], pairs: Iterable[tuple[int, int]]) -> list[Job]:
    stages = [(stage, STAGE) for part in spelt for stage in part]
    kernels = [(kernel.function, kernel.signature) for kernel in kernels_of(spelt)]
    extents = [(kind.extent, EXTENT) for kind in extents_of(kinds) if kind.extent is not None]
    return [*stages, *kernels, *extents, *((PAIRS[pair], COLLIDE) for pair in pairs)]

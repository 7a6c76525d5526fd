"""The step of a world as a word over stages, of which each world has only those that it needs."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import address_of
from kickdrift.core.compilation import Function
from kickdrift.world.collision.broad_phase.pair_update import find_pairs
from kickdrift.world.collision.contact_recycling import find_points
from kickdrift.world.collision.continuous.missed_contacts import drop_paths, find_missed
from kickdrift.world.collision.continuous.rotation_limit import divide_fast_rotation
from kickdrift.world.collision.continuous.time_of_impact import find_impacts
from kickdrift.world.collision.narrow_phase.impulse_matching import pass_on_impulses
from kickdrift.world.collision.narrow_phase.manifolds import place_shapes
from kickdrift.world.collision.predicted_motion import begin_paths, follow_paths
from kickdrift.world.contact_events import note_touching
from kickdrift.world.contacts.arm_refresh import refresh_hit
from kickdrift.world.contacts.batch_division import find_batches
from kickdrift.world.contacts.graph_colouring import colour
from kickdrift.world.contacts.impacts.restitution import bounce, find_bouncing
from kickdrift.world.contacts.prepare import prepare
from kickdrift.world.contacts.residual import measure_residual
from kickdrift.world.contacts.sequential_impulses import THREADED, relax, solve, store, warm_start
from kickdrift.world.deformables.body_contacts.particle_contacts import find_cloth_contacts
from kickdrift.world.deformables.body_contacts.predicted_loads import predict_later_loads, predict_loads
from kickdrift.world.deformables.cloth_rollback import begin_cloths
from kickdrift.world.deformables.cloth_step import move_cloths
from kickdrift.world.deformables.forces.aerodynamics import calm
from kickdrift.world.deformables.sleeping import rest_cloths, wake_cloths
from kickdrift.world.direct.block_gauss_seidel import relax_in_turn, solve_in_turn
from kickdrift.world.direct.direct_bodies import find_nodes
from kickdrift.world.direct.energy_loss import note_losses
from kickdrift.world.direct.half_kicks import complete_half_kicks, mark_half_kicks
from kickdrift.world.direct.island_restitution import bounce_islands
from kickdrift.world.direct.island_solver import measure_islands, solve_islands
from kickdrift.world.direct.islands import find_islands
from kickdrift.world.direct.jammed_islands import note_jammed
from kickdrift.world.direct.unconverged_heaps import ask_again, count_unsolved, find_heaps
from kickdrift.world.direct.velocity_projection import relax_islands
from kickdrift.world.force_functions import begin_forces, begin_later_forces
from kickdrift.world.integration import complete_free_kicks, drift, finish, flatten, kick
from kickdrift.world.joints.begin_joints import begin_joints, wake_joints
from kickdrift.world.joints.breaking import finish_joints
from kickdrift.world.joints.joint_warm_start import warm_start_joints
from kickdrift.world.joints.kinematics import follow_joints, measure_joints
from kickdrift.world.sleeping import sleep, wake_moved, wake_touched
from kickdrift.world.step.lost_bodies import find_lost
from kickdrift.world.step.rollback import begin
from kickdrift.world.step.stage_loop import STAGE

Stages = tuple[Function, ...]

# Stages of substeps that can be run on a single batch, since they only access its bodies and contacts.
_BY_BATCH = frozenset((begin_forces, kick, warm_start, solve, flatten, drift, relax))


class Uses(NamedTuple):
    """Features that a world uses besides contacts; stages that it does not need are not compiled.

    `forces` are the stages of users' forces, `is_fast` asks for continuous collision, `direct` for the direct solver of heaps,
    `sequential` for nets of joints that are solved one after the other; `many` says that there are bodies enough for batches.
    """

    forces: Stages
    winds: Stages
    bounces: bool
    is_fast: bool
    direct: bool
    joints: bool
    sequential: bool
    sleeps: bool
    planar: bool
    threads: bool
    many: bool
    cloths: bool

    @property
    def islands(self) -> bool:
        """Whether islands are solved directly."""
        return self.joints or self.direct

    @property
    def impacts(self) -> bool:
        """Whether bodies may hit each other within a step."""
        return self.bounces or self.is_fast


class Word(NamedTuple):
    """Stages of a step: before, in each of, and after the substeps."""

    before: Stages
    substep: Stages
    after: Stages

    def __str__(self) -> str:
        before, substep, after = (" ".join(stage.__name__.replace("_", "-") for stage in part) for part in self)
        return f"{before} ({substep})* {after}"


def word(uses: Uses) -> Word:
    """Return the word of a step, in the order in which its stages run."""
    substep = _substep(uses)
    if uses.threads:
        substep = tuple(THREADED.get(stage, stage) for stage in substep)
    batches = uses.many and _BY_BATCH.issuperset(substep)
    return Word(_before(uses, batches), substep, _after(uses))


def _before(uses: Uses, batches: bool) -> Stages:
    """Return the stages that find contacts, and prepare contacts and joints for the substeps."""
    return (
        *when(uses.sleeps, wake_moved),
        begin,
        *when(uses.sleeps, wake_touched),
        *when(uses.cloths, begin_cloths),
        place_shapes,
        *_forces(uses),  # for the velocities that bodies will have, by which the search enlarges bounds
        find_pairs,
        find_points,
        *when(uses.is_fast, find_impacts),
        *when(not uses.planar, divide_fast_rotation),
        pass_on_impulses,
        *when(uses.sleeps, wake_touched),
        *when(uses.sleeps and uses.cloths, wake_cloths),
        *when(uses.joints, wake_joints, measure_joints, begin_joints),
        find_heaps,
        *when(uses.islands, find_nodes),
        *when(batches, find_batches),
        colour,
        prepare,
        *when(uses.islands, find_islands),
        *when(uses.impacts, find_bouncing, begin_paths),
    )


def _substep(uses: Uses) -> Stages:
    """Return the stages that move all bodies on by a substep."""
    return (
        *when(uses.islands and uses.impacts, bounce_islands),
        *_forces(uses),
        *when(uses.joints, mark_half_kicks),
        kick,
        *when(uses.impacts, bounce, refresh_hit),
        warm_start,
        *when(uses.joints, warm_start_joints),
        solve,
        *when(uses.sequential, solve_in_turn),
        *when(uses.islands, solve_islands),
        *when(uses.planar, flatten),
        drift,
        *when(
            bool(uses.forces),
            begin_later_forces,
            *when(uses.cloths, predict_later_loads),
            *uses.forces,
            complete_free_kicks,
        ),
        *when(uses.joints, complete_half_kicks),
        *when(uses.planar and (uses.joints or bool(uses.forces)), flatten),
        relax,
        *when(uses.joints, follow_joints),
        *when(uses.sequential, relax_in_turn),
        *when(uses.islands, relax_islands),
        *when(uses.impacts, follow_paths),
        *when(uses.cloths, calm, *uses.winds, find_cloth_contacts, move_cloths),
    )


def _after(uses: Uses) -> Stages:
    """Return the stages that look for what the substeps have missed or left unsolved, and end the step."""
    return (
        *when(uses.impacts, find_missed),
        *when(not uses.planar, divide_fast_rotation),
        measure_residual,
        ask_again,
        *when(uses.impacts, drop_paths),
        find_lost,
        store,
        finish,
        *when(uses.islands, measure_islands),
        *when(uses.joints, note_losses, note_jammed),
        count_unsolved,
        note_touching,
        *when(uses.sleeps, sleep),
        *when(uses.sleeps and uses.cloths, rest_cloths),
        *when(uses.joints, finish_joints),
    )


def _forces(uses: Uses) -> Stages:
    return begin_forces, *when(uses.cloths, predict_loads), *uses.forces


def when(wanted: bool, *stages: Function) -> Stages:
    """Return stages, or none."""
    return stages if wanted else ()


class Program(NamedTuple):
    """A word as the loop runs it: addresses of its stages, the time that each covers, and when in the step it begins, s.

    Stages with indices from `begin` to `end` - 1, from `prepare` to `store`, are run on one batch after the other.
    """

    addresses: NDArray[np.intp]
    lengths: NDArray[np.float64]
    offsets: NDArray[np.float64]
    begin: int
    end: int


def addresses(spelt: Word, substeps: int) -> NDArray[np.intp]:
    """Compile the stages of a word, and return their addresses, with those of the substeps repeated."""
    before, substep, after = spelt
    at = {stage: address_of(stage, STAGE) for part in spelt for stage in part}
    return np.array([at[stage] for stage in (*before, *substep * substeps, *after)], dtype=np.intp)


def compose(spelt: Word, at: NDArray[np.intp], step: float, substeps: int, part: int = 0) -> Program:
    """Return the program of a word with the times of its stages, for a step in s, or for a part of that length of a step.

    Of a part the number is given, and the addresses are those of the whole step, which may have more substeps.
    """
    before, substep, after = spelt
    begin, h = part * step, step / substeps
    ends = [0.0] * len(substep)  # 1.0 where a stage covers the end of the substep
    if begin_later_forces in substep:
        first, last = substep.index(begin_later_forces), substep.index(complete_free_kicks)
        ends[first:last] = [1.0] * (last - first)
    lengths = [step] * len(before) + [h] * len(substep) * substeps + [step] * len(after)
    offsets = [0.0] * len(before) + [(k + end) * h for k in range(substeps) for end in ends] + [step] * len(after)
    at = np.concatenate((at[: len(before) + substeps * len(substep)], at[len(at) - len(after) :]))
    return Program(
        at,
        np.array(lengths),
        np.array(offsets) + begin,
        before.index(prepare),
        len(at) - len(after) + after.index(store) + 1,
    )

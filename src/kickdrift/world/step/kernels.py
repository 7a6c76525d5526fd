"""Functions that stages call by their addresses, and which of them a step needs."""

from typing import Any, NamedTuple

from kickdrift.core.compilation import Function
from kickdrift.world.contacts import contact_solver_simd
from kickdrift.world.contacts.layout import (
    AIM_JOINTS,
    CONTACT_CHUNK,
    COUPLING_CHUNK,
    DRIFT_CHUNK,
    KICK_CHUNK,
    MEMBRANE_CHUNK,
    PAIR_CHUNK,
    REPAIR_POSES,
    SOLVE_EQUATIONS,
    TETHER_CHUNK,
    THREADED_LOOP,
    THREADED_SEARCH,
    TURNING_CHUNK,
)
from kickdrift.world.contacts.sequential_impulses import THREADED, solve
from kickdrift.world.deformables.body_contacts.contact_solver import resolve_rows
from kickdrift.world.deformables.chunks import CHUNK, LOOP, run_threaded
from kickdrift.world.deformables.cloth_step import move_cloths
from kickdrift.world.deformables.forces.bending import couple_some, turn_some
from kickdrift.world.deformables.forces.membrane import add_some_groups
from kickdrift.world.deformables.particle_fields import drift_some, kick_some
from kickdrift.world.deformables.self_collision.near_pairs import lay_some
from kickdrift.world.deformables.self_collision.parallel_search import SIGNATURE as SEARCH
from kickdrift.world.deformables.self_collision.parallel_search import search_threaded
from kickdrift.world.deformables.tethers import hold_some
from kickdrift.world.direct.active_set import solve_island
from kickdrift.world.direct.island_calls import AIM, REPAIR, SOLVE
from kickdrift.world.direct.island_right_hand_sides import aim_joints
from kickdrift.world.direct.island_solver import solve_islands
from kickdrift.world.direct.position_correction import correct_poses
from kickdrift.world.joints.begin_joints import begin_joints
from kickdrift.world.step.stage_order import Word


class Kernel(NamedTuple):
    """A function with its signature, and the column of the table `KERNEL_ADDRESSES` that holds its address."""

    column: int
    function: Function
    signature: Any


_CLOTHS = tuple(
    Kernel(column, function, CHUNK)
    for column, function in (
        (MEMBRANE_CHUNK, add_some_groups),
        (COUPLING_CHUNK, couple_some),
        (TURNING_CHUNK, turn_some),
        (KICK_CHUNK, kick_some),
        (CONTACT_CHUNK, resolve_rows),
        (DRIFT_CHUNK, drift_some),
        (PAIR_CHUNK, lay_some),
        (TETHER_CHUNK, hold_some),
    )
)
_THREADS = Kernel(THREADED_LOOP, run_threaded, LOOP), Kernel(THREADED_SEARCH, search_threaded, SEARCH)
_CONTACTS = tuple(
    Kernel(column, function, contact_solver_simd.KERNEL) for column, function in contact_solver_simd.KERNELS.items()
)
_ISLANDS = (Kernel(SOLVE_EQUATIONS, solve_island, SOLVE),)
_JOINTS = (Kernel(AIM_JOINTS, aim_joints, AIM), Kernel(REPAIR_POSES, correct_poses, REPAIR))


def kernels_of(spelt: Word) -> tuple[Kernel, ...]:
    """Return the functions that the stages of a step call by their addresses."""
    islands = _ISLANDS if solve_islands in spelt.substep else ()
    joints = _JOINTS if begin_joints in spelt.before else ()
    cloths = _CLOTHS if move_cloths in spelt.substep else ()
    threads = _THREADS if cloths and THREADED[solve] in spelt.substep else ()
    return (*_CONTACTS, *islands, *joints, *cloths, *threads)

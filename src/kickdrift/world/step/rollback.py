"""Rollback of a step to the state at its beginning, to the last bit."""

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import is_scaled, unit
from kickdrift.world.collision.broad_phase.search_state import shapes_changed
from kickdrift.world.columns import column, quaternion_at
from kickdrift.world.contacts.batch_division import roll_back_impulses
from kickdrift.world.contacts.layout import BOUNCED, CONTACT_STATE
from kickdrift.world.deformables.cloth_rollback import roll_back_cloths
from kickdrift.world.integration import follow_pose
from kickdrift.world.layout import (
    AWAKE,
    BODY_KIND,
    DYNAMIC,
    INERTIA_KIND,
    INVERSE_INERTIA_IN_WORLD,
    ISOTROPIC,
    KICK,
    LEFT_POSE,
    LEFT_TURN,
    LOWER,
    ORIENTATION,
    RESIDUAL_SIZE,
    SPIN,
    TUMBLES,
    UPPER,
    WHOLE_KICK,
)
from kickdrift.world.settings import RESIDUAL
from kickdrift.world.step.status import STARTED_WARNING, WARNING
from kickdrift.world.tables import (
    BATCH,
    BODY,
    BOUNDS,
    CONTACT,
    DELTA_POSE,
    INERTIA,
    INVERSE_MASS,
    JOINT_NUMBERS,
    KICKED,
    MEMBER,
    MOTION,
    POSE,
    SETTINGS,
    STARTED_JOINTS,
    STARTED_MOTION,
    STARTED_POSE,
    STARTED_ROTATION,
    STEP_STATUS,
    Tables,
    floats,
    integers,
    rows,
    set_rows,
)

# Columns of STARTED_ROTATION: those of other tables as they were when the step began
STARTED_SPIN = column(STARTED_ROTATION, 3, "kg m^2/s")
STARTED_LEFT_TURN = column(STARTED_ROTATION, 3, "rad/s")
STARTED_LEFT_POSE = column(STARTED_ROTATION, 4)
STARTED_INERTIA = column(STARTED_ROTATION, 6, "1/(kg m^2)")


@compiled
def begin(t: float, h: float, world: int) -> None:
    """Reset the displacements of the step, and save the state that a rollback restores.

    Inertias are updated to orientations that the user has set, since contacts and joints need them before the kick.
    """
    delta_pose, pose, motion = floats(world, DELTA_POSE), floats(world, POSE), floats(world, MOTION)
    kicked = floats(world, KICKED)
    old_pose, old_motion = floats(world, STARTED_POSE), floats(world, STARTED_MOTION)
    member, kind = integers(world, MEMBER), integers(world, BODY)
    inertia, status = floats(world, INERTIA), integers(world, STEP_STATUS)
    set_rows(world, BATCH, 0)
    status[0, STARTED_WARNING] = status[0, WARNING]
    floats(world, SETTINGS)[0, RESIDUAL] = 0.0
    for body in range(rows(world, DELTA_POSE)):
        member[body, 0] = body
        turn = quaternion_at(pose, body, ORIENTATION)
        if is_scaled(turn):  # users have written into it; the drift would normalise it too late, and only if it moves
            turn = unit(turn)
            for k in range(4):
                pose[body, ORIENTATION + k] = turn[k]
        if kind[body, BODY_KIND] == DYNAMIC and kind[body, AWAKE] != 0 and inertia[body, INERTIA_KIND] != ISOTROPIC:
            follow_pose(world, body)
        if kind[body, BODY_KIND] == DYNAMIC and inertia[body, INERTIA_KIND] == TUMBLES:
            _keep_rotation(world, body)
        kicked[body, KICK] = WHOLE_KICK
        for k in range(8):
            delta_pose[body, k] = 0.0
            old_pose[body, k] = pose[body, k]
            old_motion[body, k] = motion[body, k]
    joints, old_joints = floats(world, JOINT_NUMBERS), floats(world, STARTED_JOINTS)
    for joint in range(rows(world, STARTED_JOINTS)):
        for k in range(JOINT_NUMBERS.width):
            old_joints[joint, k] = joints[joint, k]


@compiled(inline=True)
def _keep_rotation(world: int, body: int) -> None:
    """Keep the data of a body that a drift changes besides its pose and motion."""
    kept, kicked, inverse_mass = floats(world, STARTED_ROTATION), floats(world, KICKED), floats(world, INVERSE_MASS)
    for k in range(3):
        kept[body, STARTED_SPIN + k] = kicked[body, SPIN + k]
        kept[body, STARTED_LEFT_TURN + k] = kicked[body, LEFT_TURN + k]
    for k in range(4):
        kept[body, STARTED_LEFT_POSE + k] = kicked[body, LEFT_POSE + k]
    for k in range(6):
        kept[body, STARTED_INERTIA + k] = inverse_mass[body, INVERSE_INERTIA_IN_WORLD + k]


def roll_back(tables: Tables) -> None:
    """Restore a world to the beginning of the step; pairs of shapes without finite bounds are sought again."""
    tables.array(POSE)[:] = tables.array(STARTED_POSE)
    tables.array(MOTION)[:] = tables.array(STARTED_MOTION)
    _roll_back_rotations(tables)
    tables.array(JOINT_NUMBERS)[:] = tables.array(STARTED_JOINTS)
    roll_back_impulses(tables)
    tables.row(STEP_STATUS, 0)[WARNING] = tables.row(STEP_STATUS, 0)[STARTED_WARNING]
    roll_back_cloths(tables)
    tables.array(BODY)[:, RESIDUAL_SIZE] = 0  # measured in this attempt
    tables.array(CONTACT)[:, CONTACT_STATE] &= ~BOUNCED
    nowhere = ~np.isfinite(tables.array(BOUNDS)[:, LOWER : UPPER + 3]).all(axis=1)
    if nowhere.any():
        shapes_changed(tables, np.flatnonzero(nowhere))


def _roll_back_rotations(tables: Tables) -> None:
    """Restore the data of bodies that a drift changes besides their poses and motions, to the last bit."""
    tumbles = (tables.array(BODY)[:, BODY_KIND] == DYNAMIC) & (tables.array(INERTIA)[:, INERTIA_KIND] == TUMBLES)
    kept, kicked, inverse_mass = (tables.array(table) for table in (STARTED_ROTATION, KICKED, INVERSE_MASS))
    for table, first, size, started in (
        (kicked, SPIN, 3, STARTED_SPIN),
        (kicked, LEFT_TURN, 3, STARTED_LEFT_TURN),
        (kicked, LEFT_POSE, 4, STARTED_LEFT_POSE),
        (inverse_mass, INVERSE_INERTIA_IN_WORLD, 6, STARTED_INERTIA),
    ):
        table[tumbles, first : first + size] = kept[tumbles, started : started + size]

"""Rollback of a step to the state at its beginning, to the last bit; and identification of a body lost to infinity."""

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import LostBodyError
from kickdrift.core.vectors import is_scaled, unit
from kickdrift.world.cloth.motion import roll_back_cloths
from kickdrift.world.collision.search_state import shapes_changed
from kickdrift.world.columns import column, quaternion_at
from kickdrift.world.contacts.batching import roll_back_impulses
from kickdrift.world.contacts.layout import BOUNCED, CONTACT_STATE
from kickdrift.world.integration import follow_pose
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    AWAKE,
    BODY_KIND,
    BOUNDING_RADIUS,
    DYNAMIC,
    INERTIA_KIND,
    INVERSE_INERTIA,
    INVERSE_INERTIA_IN_WORLD,
    ISOTROPIC,
    KICK,
    KINEMATIC,
    LEFT_POSE,
    LEFT_TURN,
    LOWER,
    MASS,
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
    LOAD,
    MEMBER,
    MOTION,
    POSE,
    RESTED,
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

_FAR = 1e100  # m or m/s: counts as infinite


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
    """Keep the data of a body that a drift leaves besides its pose and motion."""
    kept, kicked, inverse_mass = floats(world, STARTED_ROTATION), floats(world, KICKED), floats(world, INVERSE_MASS)
    for k in range(3):
        kept[body, STARTED_SPIN + k] = kicked[body, SPIN + k]
        kept[body, STARTED_LEFT_TURN + k] = kicked[body, LEFT_TURN + k]
    for k in range(4):
        kept[body, STARTED_LEFT_POSE + k] = kicked[body, LEFT_POSE + k]
    for k in range(6):
        kept[body, STARTED_INERTIA + k] = inverse_mass[body, INVERSE_INERTIA_IN_WORLD + k]


def find_lost_body(tables: Tables, step: float, found: int) -> int:
    """Return the row of the body that was lost.

    Bodies connected by joints are lost together: it is one whose pose was not finite before, or else the fastest one, or the
    one with the largest forces.

    Parameters
    ----------
    tables : Tables
        Of the world, after the step.
    step : float
        s.
    found : int
        Row of a body whose pose or velocity is not finite.
    """
    now = np.hstack((tables.array(POSE)[:, :7], tables.array(MOTION)[:, :6]))
    moves = tables.array(BODY)[:, BODY_KIND] >= KINEMATIC
    lost = moves & ~(np.abs(now) < _FAR).all(axis=1)
    motion, load = tables.array(STARTED_MOTION), tables.array(LOAD)
    inertia, reach = tables.array(INERTIA), tables.array(RESTED)[:, BOUNDING_RADIUS]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        per_force = np.where(inertia[:, MASS] > 0.0, 1.0 / inertia[:, MASS], 0.0)
        per_torque = inertia[:, INVERSE_INERTIA : INVERSE_INERTIA + 3].max(axis=1)
        pushes = (
            np.abs(motion[:, :3]).max(axis=1),
            np.abs(motion[:, ANGULAR_VELOCITY : ANGULAR_VELOCITY + 3]).max(axis=1) * reach,
            np.abs(load[:, :3]).max(axis=1) * per_force * step,
            np.abs(load[:, 3:6]).max(axis=1) * per_torque * step * reach,
        )
        speeds = np.max(pushes, axis=0) + 0.0 * tables.array(STARTED_POSE)[:, :7].sum(axis=1)
    speeds = np.where(np.isfinite(speeds), speeds, np.inf)
    of = moves & (lost | (speeds > _FAR))
    return int(np.argmax(np.where(of, speeds, -1.0))) if of.any() else found


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
    """Restore the data of bodies that a drift leaves besides their poses and motions, to the last bit."""
    tumbles = (tables.array(BODY)[:, BODY_KIND] == DYNAMIC) & (tables.array(INERTIA)[:, INERTIA_KIND] == TUMBLES)
    kept, kicked, inverse_mass = (tables.array(table) for table in (STARTED_ROTATION, KICKED, INVERSE_MASS))
    for table, first, size, started in (
        (kicked, SPIN, 3, STARTED_SPIN),
        (kicked, LEFT_TURN, 3, STARTED_LEFT_TURN),
        (kicked, LEFT_POSE, 4, STARTED_LEFT_POSE),
        (inverse_mass, INVERSE_INERTIA_IN_WORLD, 6, STARTED_INERTIA),
    ):
        table[tumbles, first : first + size] = kept[tumbles, started : started + size]


def lost_body_error(tables: Tables, body: int, words: str, step: int) -> LostBodyError:
    """Return the error that names the lost body and the step; the world is at the beginning of the step."""
    pose, motion = tables.array(POSE)[body, :7], tables.array(MOTION)[body, :6]
    if np.isfinite(pose).all() and np.isfinite(motion).all() and pose[3:].any():
        why = "Its forces or velocities are too large for the step: use a smaller one."
    else:
        why = (
            "Its pose or velocity was set to a value that is not finite, or its orientation to zero: set valid values."
        )
    return LostBodyError(
        f"{words} was lost to infinity in step {step}; all bodies are where they were before it. {why}"
    )


def lost_cloth_error(words: str, step: int) -> LostBodyError:
    """Return the error that names the lost cloth and the step; the world is at the beginning of the step."""
    return LostBodyError(
        f"{words} was lost to infinity in step {step}; all bodies and cloths are where they were before it. Its"
        " positions or velocities were set to values that are not finite, its triangles have no area, or it was"
        " stretched too fast for the step: use a smaller one."
    )

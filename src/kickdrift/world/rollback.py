"""Rollback: which body a world has lost to infinity, and back to where the step began."""

import numpy as np

from kickdrift.core.errors import LostBodyError
from kickdrift.world.cloth.motion import roll_back_cloths
from kickdrift.world.collision.search_state import shapes_changed
from kickdrift.world.contacts.layout import BOUNCED, CONTACT_STATE
from kickdrift.world.layout import BODY_KIND, INVERSE_INERTIA, KINEMATIC, LOWER, MASS, UPPER
from kickdrift.world.sleeping import REACH
from kickdrift.world.tables import (
    BODY,
    BOUNDS,
    CONTACT,
    INERTIA,
    INVERSE_MASS,
    JOINT_NUMBERS,
    KICKED,
    LINK_NUMBERS,
    LOAD,
    MOTION,
    POSE,
    RESTED,
    STARTED_JOINTS,
    STARTED_MOTION,
    STARTED_POSE,
    Tables,
)

_FAR = 1e100  # m or m/s: as good as infinite


def find_lost_body(tables: Tables, step: float, found: int) -> int:
    """Return which body was lost.

    Where joints hold bodies together all are lost at once: it is one that was nowhere before, or else the one that was
    the fastest, or pushed the most.

    Parameters
    ----------
    tables : Tables
        Of the world, as the step has left them.
    step : float
        s.
    found : int
        Row of a body that is nowhere.
    """
    now = np.hstack((tables.array(POSE)[:, :7], tables.array(MOTION)[:, :6]))
    moves = tables.array(BODY)[:, BODY_KIND] >= KINEMATIC
    lost = moves & ~(np.abs(now) < _FAR).all(axis=1)
    motion, load = tables.array(STARTED_MOTION), tables.array(LOAD)
    inertia, reach = tables.array(INERTIA), tables.array(RESTED)[:, REACH]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        per_force = np.where(inertia[:, MASS] > 0.0, 1.0 / inertia[:, MASS], 0.0)
        per_torque = inertia[:, INVERSE_INERTIA : INVERSE_INERTIA + 3].max(axis=1)
        pushes = (
            np.abs(motion[:, :3]).max(axis=1),
            np.abs(motion[:, 3:6]).max(axis=1) * reach,
            np.abs(load[:, :3]).max(axis=1) * per_force * step,
            np.abs(load[:, 3:6]).max(axis=1) * per_torque * step * reach,
        )
        speeds = np.max(pushes, axis=0) + 0.0 * tables.array(STARTED_POSE)[:, :7].sum(axis=1)
    speeds = np.where(np.isfinite(speeds), speeds, np.inf)
    of = moves & (lost | (speeds > _FAR))
    return int(np.argmax(np.where(of, speeds, -1.0))) if of.any() else found


def roll_back(tables: Tables) -> None:
    """Bring a world back to where the step began; shapes that were nowhere are sought again."""
    tables.array(POSE)[:] = tables.array(STARTED_POSE)
    tables.array(MOTION)[:] = tables.array(STARTED_MOTION)
    tables.array(KICKED)[:] = (
        0.0  # which orientations the drift left is forgotten, so that all of a body is found again
    )
    # Those of unequal moments are found again by the kick.
    unknown = ~np.isfinite(tables.array(INVERSE_MASS)[:, :7]).all(axis=1)
    tables.array(INVERSE_MASS)[unknown, 1:7] = tables.array(INERTIA)[unknown, INVERSE_INERTIA : INVERSE_INERTIA + 6]
    tables.array(JOINT_NUMBERS)[:] = tables.array(STARTED_JOINTS)
    roll_back_cloths(tables)
    tables.array(LINK_NUMBERS)[:] = 0.0
    tables.array(CONTACT)[:, CONTACT_STATE] &= ~BOUNCED
    nowhere = ~np.isfinite(tables.array(BOUNDS)[:, LOWER : UPPER + 3]).all(axis=1)
    if nowhere.any():
        shapes_changed(tables, np.flatnonzero(nowhere))


def lost_body_error(tables: Tables, body: int, words: str, step: int) -> LostBodyError:
    """Return in words which body was lost, and when; the world is back where the step began."""
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
    """Return in words which cloth was lost, and when; the world is back where the step began."""
    return LostBodyError(
        f"{words} was lost to infinity in step {step}; all bodies and cloths are where they were before it. Its"
        " positions or velocities were set to values that are not finite, its triangles have no area, or it was"
        " stretched too fast for the step: use a smaller one."
    )

"""Bodies and cloths that are lost to infinity: the stage that notices it, which body it was, and the errors that report it."""

import math

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import LostBodyError
from kickdrift.world.deformables.layout import FIRST_PARTICLE, LAST_PARTICLE, PARTICLE_VELOCITY
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    BODY_KIND,
    BOUNDING_RADIUS,
    INVERSE_INERTIA,
    KINEMATIC,
    MASS,
    REMOVED,
)
from kickdrift.world.step.status import report_body
from kickdrift.world.tables import (
    BODY,
    CLOTH,
    INERTIA,
    LOAD,
    MEMBER,
    MOTION,
    PARTICLE,
    POSE,
    RESTED,
    STARTED_MOTION,
    STARTED_PARTICLE,
    STARTED_POSE,
    Tables,
    floats,
    integers,
    rows,
)

_FAR = 1e100  # m or m/s: counts as infinite


@compiled
def find_lost(t: float, h: float, world: int) -> None:
    """Check that the poses and velocities of a batch are finite, before impulses are stored."""
    pose, motion = floats(world, POSE), floats(world, MOTION)
    kind, member = integers(world, BODY), integers(world, MEMBER)
    for place in range(rows(world, MEMBER)):
        body = member[place, 0]
        total = abs(pose[body, 6])
        for k in range(6):
            total += abs(pose[body, k]) + abs(motion[body, k])
        if not total < math.inf and kind[body, BODY_KIND] != REMOVED:
            report_body(world, body)
            return


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
        causes = (  # speeds at the start, and those that forces and torques add
            np.abs(motion[:, :3]).max(axis=1),
            np.abs(motion[:, ANGULAR_VELOCITY : ANGULAR_VELOCITY + 3]).max(axis=1) * reach,
            np.abs(load[:, :3]).max(axis=1) * per_force * step,
            np.abs(load[:, 3:6]).max(axis=1) * per_torque * step * reach,
        )
        speeds = np.max(causes, axis=0) + 0.0 * tables.array(STARTED_POSE)[:, :7].sum(axis=1)
    speeds = np.where(np.isfinite(speeds), speeds, np.inf)
    of = moves & (lost | (speeds > _FAR))
    return int(np.argmax(np.where(of, speeds, -1.0))) if of.any() else found


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


def find_lost_vertex(tables: Tables, cloth: int) -> int:
    """Return the number of a vertex of a cloth that was lost, after the step: the one that was fastest before it."""
    own = tables.array(CLOTH)[cloth]
    rows = slice(own[FIRST_PARTICLE], own[LAST_PARTICLE])
    lost = ~(np.abs(tables.array(PARTICLE)[rows]) < _FAR).all(axis=1)
    before = tables.array(STARTED_PARTICLE)[rows]
    speeds = np.abs(before[:, PARTICLE_VELOCITY : PARTICLE_VELOCITY + 3]).max(axis=1) + 0.0 * before[:, :3].sum(axis=1)
    return int(np.argmax(np.where(lost, np.nan_to_num(speeds, nan=np.inf, posinf=np.inf), -1.0)))


def lost_cloth_error(words: str, vertex: int, step: int) -> LostBodyError:
    """Return the error that names the lost cloth, a vertex and the step; the world is at the beginning of the step."""
    return LostBodyError(
        f"vertex {vertex} of {words} was lost to infinity in step {step}; all bodies and cloths are where they were before it."
        " Positions or velocities were set to values that are not finite, a wind or a force returned such values, triangles"
        " there have no area, or it was stretched too fast for the step: use a smaller one."
    )

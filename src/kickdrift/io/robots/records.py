"""Joints of a file as joints here: one for all that follow each other at a body, where there is one."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.io.robots.parsing import Model
from kickdrift.world.joints.ball import Ball
from kickdrift.world.joints.hinge import Hinge
from kickdrift.world.joints.limits_motors_options import LOCKED, Axis, Drive
from kickdrift.world.joints.record import Record
from kickdrift.world.joints.six_dof import SixDof
from kickdrift.world.joints.slider import Slider
from kickdrift.world.joints.universal import Universal

Floats = NDArray[np.float64]
Found = tuple[Record, dict[int, int]]

_PARALLEL = 1e-6  # sine or cosine that counts as zero; files are written with six digits


def record_of(model: Model, rows: list[int], axes: dict[int, Axis], notes: list[str]) -> Found | None:
    """Make one joint of some that follow each other between two bodies.

    Parameters
    ----------
    model : Model
    rows : list of int
        MuJoCo's joints, in their order.
    axes : dict of int to Axis
        What happens along or about those that have one axis.
    notes : list of str

    Returns
    -------
    Record
    dict of int to int
        Which axis of it each of the joints is, -1 for balls; None instead of both where no joint here is all of them.
    """
    m, kinds = model.compiled, model.mujoco.mjtJoint
    types = [int(m.jnt_type[row]) for row in rows]
    if types == [kinds.mjJNT_BALL]:
        return _ball(model, rows[0], notes), {rows[0]: -1}
    rotors = m.dof_armature[m.jnt_dofadr[rows]].tolist()
    if len(rows) > 1 and types[-1] == kinds.mjJNT_SLIDE and rotors[-1]:
        return None  # the mass that it is must move along this slide only
    if kinds.mjJNT_BALL in types or any(rotors[:-1]):
        return None  # a rotor belongs to what its own joint moves
    turning = [row for row, kind in zip(rows, types, strict=True) if kind == kinds.mjJNT_HINGE]
    sliding = [row for row in rows if row not in turning]
    ways = {row: model.direction(model.data.xaxis[row]) for row in rows}
    points = {row: model.point(model.data.xanchor[row]) for row in rows}
    if len(rows) == 1:
        row, axis = rows[0], axes[rows[0]]
        kind = Hinge if turning else Slider
        record = kind(points[row], ways[row], limits=axis.limits, drive=axis.drive, friction=axis.friction)
        return record, {row: 5 if turning else 2}
    if len(turning) == 2 and not sliding:
        first, second = turning
        if abs(ways[first] @ ways[second]) > _PARALLEL or not np.allclose(points[first], points[second], 0.0, 1e-9):
            return None
        return Universal(points[first], ways[first], ways[second], axes[first], axes[second]), {first: 3, second: 4}
    return None if len(turning) > 1 else _of_six(turning, sliding, ways, points, axes)


def _of_six(
    turning: list[int], sliding: list[int], ways: dict[int, Floats], points: dict[int, Floats], axes: dict[int, Axis]
) -> Found | None:
    """Make one joint of some slides, and of a hinge that turns what has slid."""
    frame = [ways[row] for row in sliding]
    for row in turning:
        along = [k for k, way in enumerate(frame) if way @ ways[row] > 1.0 - _PARALLEL]
        if not along:
            frame.append(ways[row])
        if sliding[-1] > row and not (len(sliding) == 1 and along):
            return None
    across = np.array([[a @ b for a in frame] for b in frame]) - np.eye(len(frame))
    if len(frame) > 3 or np.abs(across).max() > _PARALLEL:
        return None
    if len(frame) == 2:
        frame.append(np.cross(frame[0], frame[1]))
    if len(frame) == 1:
        side = np.cross(frame[0], np.eye(3)[np.abs(frame[0]).argmin()])
        frame.append(side / np.linalg.norm(side))
        frame.append(np.cross(frame[0], frame[1]))
    if np.linalg.det(frame) < 0.0:
        frame[0], frame[1] = frame[1], frame[0]
    place = {row: int(np.argmax([way @ ways[row] for way in frame])) for row in (*sliding, *turning)}
    linear, angular = [LOCKED] * 3, [LOCKED] * 3
    for row in sliding:
        linear[place[row]] = axes[row]
    for row in turning:
        angular[place[row]] = axes[row]
    anchor = points[(turning or sliding)[0]]
    record = SixDof(anchor, frame[0], frame[1], (linear[0], linear[1], linear[2]), (angular[0], angular[1], angular[2]))
    return record, {row: place[row] + 3 * (row in turning) for row in (*sliding, *turning)}


def _ball(model: Model, row: int, notes: list[str]) -> Record:
    m, name = model.compiled, model.name("joint", row)
    at, dof = int(m.jnt_qposadr[row]), int(m.jnt_dofadr[row])
    if m.jnt_limited[row]:
        notes.append(f"the limit of ball {name!r} is left out: it limits the total rotation angle, not swing or twist")
    stiffness, damping = float(m.jnt_stiffness[row]), float(m.dof_damping[dof])
    if stiffness > 0.0 and not np.allclose(m.qpos_spring[at : at + 4], m.qpos0[at : at + 4], 0.0, 1e-12):
        raise ArgumentError(f"springref of ball {name!r} is not its reference orientation; leave it out.")
    drive = Drive(stiffness=stiffness, damping=damping) if stiffness > 0.0 or damping > 0.0 else None
    friction = float(m.dof_frictionloss[dof])
    return Ball(model.point(model.data.xanchor[row]), drive=drive, friction=friction)

"""Joints of bodies to their parents."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.io.robots.bodies import Piece
from kickdrift.io.robots.laws import Actuator, axis_of
from kickdrift.io.robots.parsing import Model
from kickdrift.world.joints.axis import LOCKED, Axis, Drive
from kickdrift.world.joints.ball import Ball
from kickdrift.world.joints.hinge import Hinge
from kickdrift.world.joints.record import Record
from kickdrift.world.joints.six_dof import SixDof
from kickdrift.world.joints.slider import Slider
from kickdrift.world.joints.universal import Universal

Floats = NDArray[np.float64]

_PARALLEL = 1e-6  # sine or cosine that counts as zero; files are written with six digits


class Link(NamedTuple):
    """A joint that is to be.

    Attributes
    ----------
    body_a, body_b : int
        MuJoCo's bodies.
    record : Record
    names : dict of str to int
        The file's joints that it stands for, and the axis that each of them is.
    """

    body_a: int
    body_b: int
    record: Record
    names: dict[str, int]


def link_of(model: Model, piece: Piece, actuators: dict[str, Actuator], notes: list[str]) -> Link | None:
    """Say how a body hangs at its parent, or None for one that floats.

    Raises
    ------
    ArgumentError
        For several joints between two bodies that no joint here is.
    """
    m, kinds = model.compiled, model.mujoco.mjtJoint
    head = piece.members[0]
    rows = list(range(m.body_jntadr[head], m.body_jntadr[head] + m.body_jntnum[head]))
    types = [int(m.jnt_type[row]) for row in rows]
    if not rows:
        return None
    if types == [kinds.mjJNT_FREE]:
        _float(model, piece, rows[0], notes)
        return None
    turning = [row for row, kind in zip(rows, types, strict=True) if kind == kinds.mjJNT_HINGE]
    sliding = [row for row, kind in zip(rows, types, strict=True) if kind == kinds.mjJNT_SLIDE]
    if types == [kinds.mjJNT_BALL]:
        record, names = _ball(model, rows[0], notes), {model.name("joint", rows[0]): -1}
    elif len(turning) + len(sliding) == len(rows):
        record, names = _of_axes(model, head, turning, sliding, actuators, notes)
    else:
        raise _refused(model, head, "a ball and others")
    record.placement()  # refuses what no joint is, before anything is added
    return Link(int(m.body_parentid[head]), head, record, names)


def _refused(model: Model, head: int, what: str) -> ArgumentError:
    return ArgumentError(
        f"body {model.name('body', head)!r} hangs at its parent by {what}; a joint here has a ball, slides at right angles"
        " with one hinge, or two hinges at right angles through one point: put a light body between the joints."
    )


def _of_axes(
    model: Model, head: int, turning: list[int], sliding: list[int], actuators: dict[str, Actuator], notes: list[str]
) -> tuple[Record, dict[str, int]]:
    """Make one joint of the slides and hinges between two bodies."""
    rows = sorted(turning + sliding)
    axes = {row: axis_of(model, row, actuators, notes) for row in rows}
    names = {row: model.name("joint", row) for row in rows}
    ways = {row: model.direction(model.data.xaxis[row]) for row in rows}
    points = {row: model.point(model.data.xanchor[row]) for row in rows}
    if len(rows) == 1:
        row, axis = rows[0], axes[rows[0]]
        kind = Hinge if turning else Slider
        record = kind(points[row], ways[row], limits=axis.limits, drive=axis.drive, friction=axis.friction)
        return record, {names[row]: 5 if turning else 2}
    if len(turning) == 2 and not sliding:
        first, second = turning
        if abs(ways[first] @ ways[second]) > _PARALLEL or not np.allclose(points[first], points[second], 0.0, 1e-9):
            raise _refused(model, head, "two hinges that are not at right angles, or not through one point")
        cross = Universal(points[first], ways[first], ways[second], axes[first], axes[second])
        return cross, {names[first]: 3, names[second]: 4}
    if len(turning) > 1:
        raise _refused(model, head, f"{len(turning)} hinges and {len(sliding)} slides")
    return _of_six(model, head, turning, sliding, ways, points, axes, names)


def _of_six(
    model: Model, head: int, turning: list[int], sliding: list[int],
    ways: dict[int, Floats], points: dict[int, Floats], axes: dict[int, Axis], names: dict[int, str],
) -> tuple[Record, dict[str, int]]:  # fmt: skip
    """Make one joint of some slides, and of a hinge that turns what has slid."""
    frame = [ways[row] for row in sliding]
    for row in turning:
        along = [k for k, way in enumerate(frame) if way @ ways[row] > 1.0 - _PARALLEL]
        if not along:
            frame.append(ways[row])
        if sliding[-1] > row and not (len(sliding) == 1 and along):
            raise _refused(model, head, "a hinge that turns the slides")
    across = np.array([[a @ b for a in frame] for b in frame]) - np.eye(len(frame))
    if len(frame) > 3 or np.abs(across).max() > _PARALLEL:
        raise _refused(model, head, "axes that are not at right angles")
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
    return record, {names[row]: place[row] + 3 * (row in turning) for row in (*sliding, *turning)}


def _ball(model: Model, row: int, notes: list[str]) -> Record:
    m, name = model.compiled, model.name("joint", row)
    at, dof = int(m.jnt_qposadr[row]), int(m.jnt_dofadr[row])
    if m.jnt_limited[row]:
        notes.append(f"the limit of ball {name!r} is left out: it is one of the whole angle, not of swing or twist")
    stiffness, damping = float(m.jnt_stiffness[row]), float(m.dof_damping[dof])
    if stiffness > 0.0 and not np.allclose(m.qpos_spring[at : at + 4], m.qpos0[at : at + 4], 0.0, 1e-12):
        raise ArgumentError(f"springref of ball {name!r} is not its reference orientation; leave it out.")
    drive = Drive(stiffness=stiffness, damping=damping) if stiffness > 0.0 or damping > 0.0 else None
    friction = float(m.dof_frictionloss[dof])
    return Ball(model.point(model.data.xanchor[row]), drive=drive, friction=friction)


def _float(model: Model, piece: Piece, row: int, notes: list[str]) -> None:
    """Take over the damping of what floats, as far as it is one here."""
    m, name, dof = model.compiled, model.name("joint", row), int(model.compiled.jnt_dofadr[row])
    damping = float(m.dof_damping[dof])
    if damping > 0.0 and piece.mass is not None:
        piece.damping = damping / piece.mass.mass
        notes.append(f"damping of free joint {name!r} slows the body's centre of mass here, and not its turning")
    if m.dof_frictionloss[dof] > 0.0 or m.jnt_stiffness[row] > 0.0:
        notes.append(f"friction and stiffness of free joint {name!r} are left out")

"""Views of a joint and its bodies in the tables, which its handle keeps as long as they are valid."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.joints.forward_kinematics import signs
from kickdrift.world.joints.layout import ARM_A, ARM_B, AXES, BODY_A, BODY_B, LOCKED, PRINCIPAL
from kickdrift.world.layout import AWAKE, BODY_KIND, DYNAMIC, STATIC, TIME_AT_REST
from kickdrift.world.tables import BODY, JOINT, JOINT_NUMBERS, LOAD, MOTION, RESTED, Tables

Floats = NDArray[np.float64]


class EndViews(NamedTuple):
    """Views of a body of a joint in the tables."""

    arm: Floats  # from its centre of mass to where the joint acts, (3,)
    motion: Floats | None  # (6,), or None for a static body
    load: Floats | None  # (6,), or None for a body that is not dynamic
    body: NDArray[np.int64]
    rested: Floats


class JointViews(NamedTuple):
    """Views of a joint and its bodies, valid for one version of the tables."""

    version: int
    principal: int
    locked: int
    side: float  # -1.0 if a is measured relative to b
    signs: list[float]
    numbers: Floats
    axes: list[Floats]  # six of (3,)
    ends: tuple[EndViews, EndViews]  # a and b


def look_up(tables: Tables, row: int) -> JointViews:
    """Return the views of the joint of a row."""
    joint, numbers = tables.row(JOINT, row), tables.row(JOINT_NUMBERS, row)
    axes = [numbers[AXES + 3 * k : AXES + 3 * k + 3] for k in range(6)]
    ends = []
    for column, arm in ((BODY_A, ARM_A), (BODY_B, ARM_B)):
        place = joint.item(column)
        body = tables.row(BODY, place)
        kind = body.item(BODY_KIND)
        motion = None if kind == STATIC else tables.row(MOTION, place)[:6]
        load = tables.row(LOAD, place)[:6] if kind == DYNAMIC else None
        ends.append(EndViews(numbers[arm : arm + 3], motion, load, body, tables.row(RESTED, place)))
    return JointViews(
        tables.version, joint.item(PRINCIPAL), joint.item(LOCKED), 1.0 if ends[1].load is not None else -1.0,
        signs(tables, row).tolist(), numbers, axes, (ends[0], ends[1]),
    )  # fmt: skip


def wake_bodies(tables: Tables, row: int) -> None:
    """Wake the bodies of the joint of a row, and reset their times of rest."""
    for body in tables.row(JOINT, row)[[BODY_A, BODY_B]].tolist():
        if tables.row(BODY, body).item(BODY_KIND) == DYNAMIC:
            tables.row(BODY, body)[AWAKE], tables.row(RESTED, body)[TIME_AT_REST] = 1, 0.0

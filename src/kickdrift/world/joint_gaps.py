"""Gaps at joints."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import turned
from kickdrift.world.joints import layout as joints
from kickdrift.world.layout import ORIENTATION, POSITION
from kickdrift.world.tables import JOINT, JOINT_NUMBERS, POSE, Tables

Floats = NDArray[np.float64]


def widest_gap(tables: Tables) -> float:
    """Measure the largest error of the distance that a joint prescribes for its points, zero or its length, m."""
    rows, numbers, pose = tables.array(JOINT), tables.array(JOINT_NUMBERS), tables.array(POSE)
    on_line = (rows[:, joints.LINEAR] == joints.LINE) & (rows[:, joints.LOCKED] & 0b100 != 0)
    held = (rows[:, joints.JOINT_KIND] != joints.REMOVED_JOINT) & (on_line | (rows[:, joints.LINEAR] == joints.POINT))
    rows, numbers, lengths = rows[held], numbers[held], np.where(on_line, numbers[:, joints.LENGTH], 0.0)[held]
    ends = []
    for column, anchor in ((joints.BODY_A, joints.ANCHOR_A), (joints.BODY_B, joints.ANCHOR_B)):
        bodies = pose[rows[:, column]]
        at, turn = bodies[:, POSITION : POSITION + 3], bodies[:, ORIENTATION : ORIENTATION + 4]
        ends.append(at + turned(turn, numbers[:, anchor : anchor + 3]))
    return float(np.abs(np.linalg.norm(ends[1] - ends[0], axis=1) - lengths).max(initial=0.0))

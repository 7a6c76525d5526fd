"""Constraint errors: penetration of contacts, and gaps of joints."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import product, turned
from kickdrift.world.contacts import layout as contacts
from kickdrift.world.joints import layout as joints
from kickdrift.world.layout import BODY_ROW, ORIENTATION, PLACE_ORIENTATION, PLACE_POSITION, POSITION
from kickdrift.world.tables import CONTACT, JOINT, JOINT_NUMBERS, MANIFOLD, PLACE, POSE, SHAPE, Tables

Floats = NDArray[np.float64]


def deepest_overlap(tables: Tables) -> float:
    """Measure the largest penetration of any contact, m; 0.0 if there is none."""
    rows, manifolds = tables.array(CONTACT), tables.array(MANIFOLD)
    solid = (rows[:, contacts.CONTACT_STATE] & contacts.SENSOR) == 0
    rows, manifolds = rows[solid], manifolds[solid]
    at_a, turn_a = _place(tables, rows[:, contacts.SHAPE_A])
    at_b, turn_b = _place(tables, rows[:, contacts.SHAPE_B])
    normal = turned(turn_a, manifolds[:, contacts.NORMAL : contacts.NORMAL + 3])
    deepest = 0.0
    for k in range(4):
        there = rows[:, contacts.POINTS] > k
        if not there.any():
            break
        point = manifolds[there, contacts.POINT + contacts.POINT_SIZE * k :]
        on_a = at_a[there] + turned(turn_a[there], point[:, contacts.ON_A : contacts.ON_A + 3])
        on_b = at_b[there] + turned(turn_b[there], point[:, contacts.ON_B : contacts.ON_B + 3])
        gaps = np.sum(normal[there] * (on_b - on_a), axis=1)
        deepest = max(deepest, float(-gaps.min(initial=0.0)))
    return deepest


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


def _place(tables: Tables, shapes: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return the poses of shapes in the world: origins, (N, 3), m, and orientations, (N, 4)."""
    body = tables.array(POSE)[tables.array(SHAPE)[shapes, BODY_ROW]]
    place = tables.array(PLACE)[shapes]
    at, turn = body[:, POSITION : POSITION + 3], body[:, ORIENTATION : ORIENTATION + 4]
    offset, own = place[:, PLACE_POSITION : PLACE_POSITION + 3], place[:, PLACE_ORIENTATION : PLACE_ORIENTATION + 4]
    return at + turned(turn, offset), product(turn, own)

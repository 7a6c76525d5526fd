"""Updating joints when the mass of one of their bodies is changed."""

import numpy as np

from kickdrift.world.joints.effective_mass import effective_mass
from kickdrift.world.joints.layout import (
    BODY_A,
    BODY_B,
    DRIVEN_MASS,
    JOINT_IMPULSE,
    JOINT_KIND,
    PULL,
    REMOVED_JOINT,
    SOLVED,
)
from kickdrift.world.tables import JOINT, JOINT_AXES, JOINT_NUMBERS, Tables


def follow_mass(tables: Tables, body: int, lighter: float) -> None:
    """Scale the warm starting impulses of the joints of a body, and recompute the effective masses of their drives."""
    joints, laws = tables.array(JOINT), tables.array(JOINT_AXES)
    held = (joints[:, JOINT_KIND] != REMOVED_JOINT) & ((joints[:, BODY_A] == body) | (joints[:, BODY_B] == body))
    for row in np.flatnonzero(held).tolist():
        numbers = tables.array(JOINT_NUMBERS)[row]
        for first, size in ((JOINT_IMPULSE, 6), (SOLVED, 6), (PULL, 3)):
            numbers[first : first + size] *= lighter
        for k in range(6):
            if laws[6 * row + k, DRIVEN_MASS] > 0.0:
                laws[6 * row + k, DRIVEN_MASS] = effective_mass(tables, row, k)

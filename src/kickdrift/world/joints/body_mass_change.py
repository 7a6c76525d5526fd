"""Updating joints when the mass of one of their bodies is changed."""

import numpy as np

from kickdrift.world.joints import layout as j
from kickdrift.world.joints.drive_effective_mass import effective_mass
from kickdrift.world.tables import JOINT, JOINT_AXES, JOINT_NUMBERS, Tables


def follow_mass(tables: Tables, body: int, lighter: float) -> None:
    """Scale the warm starting impulses of the joints of a body, and recompute the effective masses of their drives."""
    joints, laws = tables.array(JOINT), tables.array(JOINT_AXES)
    held = (joints[:, j.JOINT_KIND] != j.REMOVED_JOINT) & (
        (joints[:, j.BODY_A] == body) | (joints[:, j.BODY_B] == body)
    )
    for row in np.flatnonzero(held).tolist():
        numbers = tables.array(JOINT_NUMBERS)[row]
        for first, size in ((j.JOINT_IMPULSE, 6), (j.SOLVED, 6), (j.PULL, 3)):
            numbers[first : first + size] *= lighter
        for k in range(6):
            if laws[6 * row + k, j.DRIVEN_MASS] > 0.0:
                laws[6 * row + k, j.DRIVEN_MASS] = effective_mass(tables, row, k)

"""Inertia as rows of tables hold it: six numbers xx, yy, zz, xy, xz, yz."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.integration import INVERSE_INERTIA
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, ORIENTATION
from kickdrift.world.shapes.mass import rotation_matrix
from kickdrift.world.tables import INERTIA, INVERSE_MASS, POSE, Tables

Floats = NDArray[np.float64]


def symmetric(m: Floats) -> Floats:
    """Return the six numbers of a symmetric (3, 3) matrix."""
    return np.array([m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]])


def turn_inertia(tables: Tables, body: int) -> None:
    """Turn the inverse inertia of a body that was turned, which drives and contacts ask for before the next kick."""
    xx, yy, zz, xy, xz, yz = tables.array(INERTIA)[body, INVERSE_INERTIA : INVERSE_INERTIA + 6]
    turn = rotation_matrix(tables.array(POSE)[body, ORIENTATION : ORIENTATION + 4])
    inverse = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
    columns = slice(INVERSE_INERTIA_IN_WORLD, INVERSE_INERTIA_IN_WORLD + 6)
    tables.array(INVERSE_MASS)[body, columns] = symmetric(inverse)

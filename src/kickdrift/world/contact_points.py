"""The points at which bodies press on each other."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import plus, times, turned
from kickdrift.world.collision.shape_poses import shape_pose
from kickdrift.world.columns import vector_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.tables import CONTACT, MANIFOLD, Tables, floats, integers, rows

Floats = NDArray[np.float64]
_MOST = 4  # of a contact


def contact_points(tables: Tables) -> Floats:
    """Return the points that carry an impulse, at the present poses, (P, 3), m: the middle of those of both shapes."""
    points = np.empty((_MOST * tables.count(CONTACT), 3))
    return points[: _put_points(tables.address, points)]


@compiled
def _put_points(world: int, points: Floats) -> int:
    """Write the points, and return their number."""
    contact, manifold, count = integers(world, CONTACT), floats(world, MANIFOLD), 0
    for row in range(rows(world, CONTACT)):
        if contact[row, c.CONTACT_STATE] & c.SENSOR:
            continue
        at_a, turn_a = shape_pose(world, contact[row, c.SHAPE_A])
        at_b, turn_b = shape_pose(world, contact[row, c.SHAPE_B])
        for k in range(contact[row, c.POINTS]):
            if manifold[row, c.NORMAL_IMPULSE + k] > 0.0:
                p = c.POINT + c.POINT_SIZE * k
                on_a = plus(at_a, turned(turn_a, vector_at(manifold, row, p + c.ON_A)))
                on_b = plus(at_b, turned(turn_b, vector_at(manifold, row, p + c.ON_B)))
                points[count] = times(0.5, plus(on_a, on_b))
                count += 1
    return count

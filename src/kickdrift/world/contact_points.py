"""The points of contacts in the world: where bodies press on each other, and how deeply shapes overlap."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import product, turned
from kickdrift.world.contacts import layout as c
from kickdrift.world.layout import BODY_ROW, ORIENTATION, PLACE_ORIENTATION, PLACE_POSITION, POSITION
from kickdrift.world.tables import CONTACT, MANIFOLD, PLACE, POSE, SHAPE, Tables

Floats = NDArray[np.float64]
_MOST = 4  # of a contact


class _Points(NamedTuple):
    """Points of contacts, at most one of each: on both shapes, (N, 3), m; normals; impulses, N s."""

    on_a: Floats
    on_b: Floats
    normal: Floats
    impulse: Floats


def contact_points(tables: Tables) -> Floats:
    """Return the points that carry an impulse, at the present poses, (P, 3), m: the middle of those of both shapes."""
    pressing = [0.5 * (points.on_a + points.on_b)[points.impulse > 0.0] for points in _points(tables)]
    return np.concatenate([np.zeros((0, 3)), *pressing])


def deepest_overlap(tables: Tables) -> float:
    """Measure the largest penetration of any contact, m; 0.0 if there is none."""
    depths = [np.sum(points.normal * (points.on_a - points.on_b), axis=1).max() for points in _points(tables)]
    return float(max(0.0, *depths)) if depths else 0.0


def _points(tables: Tables) -> Iterator[_Points]:
    """Return the first points of all contacts without sensors, then the second ones, and so on."""
    rows, manifolds = tables.array(CONTACT), tables.array(MANIFOLD)
    solid = (rows[:, c.CONTACT_STATE] & c.SENSOR) == 0
    rows, manifolds = rows[solid], manifolds[solid]
    at_a, turn_a = _place(tables, rows[:, c.SHAPE_A])
    at_b, turn_b = _place(tables, rows[:, c.SHAPE_B])
    normal = turned(turn_a, manifolds[:, c.NORMAL : c.NORMAL + 3])
    for k in range(_MOST):
        there = rows[:, c.POINTS] > k
        if not there.any():
            return
        point = manifolds[there, c.POINT + c.POINT_SIZE * k :]
        yield _Points(
            at_a[there] + turned(turn_a[there], point[:, c.ON_A : c.ON_A + 3]),
            at_b[there] + turned(turn_b[there], point[:, c.ON_B : c.ON_B + 3]),
            normal[there],
            manifolds[there, c.NORMAL_IMPULSE + k],
        )


def _place(tables: Tables, shapes: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return the poses of shapes in the world: origins, (N, 3), m, and orientations, (N, 4)."""
    body = tables.array(POSE)[tables.array(SHAPE)[shapes, BODY_ROW]]
    place = tables.array(PLACE)[shapes]
    at, turn = body[:, POSITION : POSITION + 3], body[:, ORIENTATION : ORIENTATION + 4]
    offset, own = place[:, PLACE_POSITION : PLACE_POSITION + 3], place[:, PLACE_ORIENTATION : PLACE_ORIENTATION + 4]
    return at + turned(turn, offset), product(turn, own)

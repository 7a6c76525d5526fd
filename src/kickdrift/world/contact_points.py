"""Contacts in the world: where bodies press on each other, with which force, and how deeply shapes overlap."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.rotations import product, turned
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.contacts import layout as c
from kickdrift.world.layout import BEGIN, BODY_ROW, ORIENTATION, PLACE_ORIENTATION, PLACE_POSITION, POSITION, SHAPE_KIND
from kickdrift.world.settings import LAST_SUBSTEP
from kickdrift.world.shapes.record import CENTRE
from kickdrift.world.shapes.shape_kinds import KINDS
from kickdrift.world.tables import CONTACT, GEOMETRY, MANIFOLD, PLACE, POSE, SETTINGS, SHAPE, Tables

Floats = NDArray[np.float64]
_MOST = 4  # of a contact


class Contact(NamedTuple):
    """Two bodies that press on each other; each pair of shapes of compound bodies has its own contact.

    Attributes
    ----------
    body_a, body_b : Body
    points : (K, 3) array
        Where they press on each other, up to four points, at the present poses, m.
    normal : (3,) array
        Unit normal, from the first body to the second.
    force : (3,) array
        On the second body, friction included, in the last substep, N; the opposite acts on the first. Impulses of bounces are
        not included.
    """

    body_a: Body
    body_b: Body
    points: Floats
    normal: Floats
    force: Floats


class _Points(NamedTuple):
    """N points, at most one of each contact, in the world."""

    row: NDArray[np.intp]  # of the contact in CONTACT
    on_a: Floats  # (N, 3), on the first shape, m
    on_b: Floats
    normal: Floats
    impulse: Floats  # N s


def contact_points(tables: Tables) -> Floats:
    """Return the points that carry an impulse, at the present poses, (P, 3), m: the middle of those of both shapes."""
    pressing = [0.5 * (points.on_a + points.on_b)[points.impulse > 0.0] for points in _points(tables)]
    return np.concatenate([np.zeros((0, 3)), *pressing])


def contacts(tables: Tables, bodies: Bodies) -> list[Contact]:
    """Return the contacts whose points carry impulses, in the order in which they were found."""
    rows, manifolds, settings = tables.array(CONTACT), tables.array(MANIFOLD), tables.array(SETTINGS)[0]
    found: dict[int, list[tuple[Floats, Floats, float]]] = {}
    for one in _points(tables):
        for k in np.flatnonzero(one.impulse > 0.0):
            point = 0.5 * (one.on_a[k] + one.on_b[k])
            found.setdefault(int(one.row[k]), []).append((point, one.normal[k], float(one.impulse[k])))
    made = []
    for row, points in sorted(found.items()):
        normal, pressed = points[0][1], sum(impulse for _, _, impulse in points)
        impulse = pressed * normal + manifolds[row, c.FRICTION_IMPULSE : c.FRICTION_IMPULSE + 3]
        body_a, body_b = (bodies.handle(int(rows[row, body])) for body in (c.BODY_A, c.BODY_B))
        force = impulse / settings[LAST_SUBSTEP]
        made.append(Contact(body_a, body_b, np.array([point for point, _, _ in points]), normal, force))
    return made


def deepest_overlap(tables: Tables) -> float:
    """Measure the largest penetration of any contact, m; 0.0 if there is none."""
    depths = [np.sum(points.normal * (points.on_a - points.on_b), axis=1).max() for points in _points(tables)]
    return float(max(0.0, *depths)) if depths else 0.0


def _points(tables: Tables) -> Iterator[_Points]:
    """Return the first points of all contacts without sensors, then the second ones, and so on."""
    rows, manifolds = tables.array(CONTACT), tables.array(MANIFOLD)
    solid = np.flatnonzero((rows[:, c.CONTACT_STATE] & c.SENSOR) == 0)
    rows, manifolds = rows[solid], manifolds[solid]
    touches = (rows[:, c.CONTACT_STATE] & c.TOUCHING) != 0  # those of a body that was removed do not
    at_a, turn_a = _place(tables, rows[:, c.SHAPE_A])
    at_b, turn_b = _place(tables, rows[:, c.SHAPE_B])
    then_a = manifolds[:, c.NORMAL : c.NORMAL + 3]  # the normal as it turns with each shape
    then_b = turned(manifolds[:, c.FOUND_POSE + 3 : c.FOUND_POSE + 7] * (1, -1, -1, -1), then_a)
    radius_a, radius_b = _radius(tables, rows[:, c.SHAPE_A]), _radius(tables, rows[:, c.SHAPE_B])
    for k in range(_MOST):
        there = rows[:, c.POINTS] > k
        if not there.any():
            return
        point = manifolds[there, c.POINT + c.POINT_SIZE * k :]
        r_a, r_b, n_a, n_b = radius_a[there], radius_b[there], then_a[there], then_b[there]
        core_a = at_a[there] + turned(turn_a[there], point[:, c.ON_A : c.ON_A + 3] - r_a * n_a)
        core_b = at_b[there] + turned(turn_b[there], point[:, c.ON_B : c.ON_B + 3] + r_b * n_b)
        normal = _normal(core_b - core_a, r_a, r_b, turned(turn_a[there], n_a), turned(turn_b[there], n_b))
        on_a, on_b = core_a + r_a * normal, core_b - r_b * normal
        apart = np.sum(normal * (on_b - on_a), axis=1, keepdims=True) * normal
        on_a = np.where((r_a == 0.0) & (r_b > 0.0), on_b - apart, on_a)  # the point moves with the shape that rolls
        on_b = np.where((r_a > 0.0) & (r_b == 0.0), on_a + apart, on_b)
        yield _Points(solid[there], on_a, on_b, normal, manifolds[there, c.NORMAL_IMPULSE + k] * touches[there])


def _normal(line: Floats, radius_a: Floats, radius_b: Floats, with_a: Floats, with_b: Floats) -> Floats:
    """Return present normals, (N, 3): they turn with the shape that does not roll; between two cores they are the line."""
    length = np.linalg.norm(line, axis=1, keepdims=True)
    rolls_a, both = (radius_a > 0.0) & (radius_b == 0.0), (radius_a > 0.0) & (radius_b > 0.0)
    normal = np.where(rolls_a, with_b, with_a)
    return np.where(both & (length > 1e-9 * (radius_a + radius_b)), line / np.maximum(length, 1e-300), normal)


def _radius(tables: Tables, shapes: NDArray[np.int64]) -> Floats:
    """Return the radii of shapes about a core that is a point or a segment, (N, 1), m; 0.0 for others."""
    rows, numbers = tables.array(SHAPE)[shapes], tables.array(GEOMETRY).ravel()
    rolls = np.isin(rows[:, SHAPE_KIND], [number for number, kind in KINDS.items() if kind.core == CENTRE])
    radius = np.zeros((len(shapes), 1))
    radius[rolls, 0] = numbers[rows[rolls, BEGIN]]
    return radius


def _place(tables: Tables, shapes: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return the poses of shapes in the world: origins, (N, 3), m, and orientations, (N, 4)."""
    body = tables.array(POSE)[tables.array(SHAPE)[shapes, BODY_ROW]]
    place = tables.array(PLACE)[shapes]
    at, turn = body[:, POSITION : POSITION + 3], body[:, ORIENTATION : ORIENTATION + 4]
    offset, own = place[:, PLACE_POSITION : PLACE_POSITION + 3], place[:, PLACE_ORIENTATION : PLACE_ORIENTATION + 4]
    return at + turned(turn, offset), product(turn, own)

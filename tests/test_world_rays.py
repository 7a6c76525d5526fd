"""Rays against exact hits, against bisection through distance functions, and against MuJoCo."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kickdrift.world.shapes.kind_numbers import BOX, CAPSULE, CONE, CYLINDER, HULL, PLANE, SPHERE, TRIANGLE
from kickdrift.world.shapes.polyhedron import polyhedron_numbers
from kickdrift.world.shapes.shape_kinds import RAYS

INFINITY = float("inf")
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
BOX_LOOPS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
SIZES = {SPHERE: 1, CAPSULE: 2, BOX: 3, HULL: 3, CYLINDER: 2, CONE: 2}


def cast(kind, numbers, origin, direction, limit=1e9):
    distance, *normal = RAYS[kind](
        np.asarray(numbers, float), tuple(map(float, origin)), tuple(map(float, direction)), float(limit)
    )
    return distance, np.array(normal)


def shape(kind, sizes):
    if kind in (CYLINDER, CONE):
        return np.array([sizes[0], sizes[0] if kind == CYLINDER else 0.0, sizes[1]])
    return polyhedron_numbers(CORNERS * sizes, BOX_LOOPS) if kind == HULL else np.asarray(sizes)


def depth(kind, sizes, points):
    """Distance from points to the surface, negative inside: a lower bound of it outside."""
    if kind == SPHERE:
        return np.linalg.norm(points, axis=-1) - sizes[0]
    if kind == CAPSULE:
        z = np.clip(points[..., 2], -sizes[1], sizes[1])
        return np.linalg.norm(points - z[..., None] * (0.0, 0.0, 1.0), axis=-1) - sizes[0]
    if kind in (CYLINDER, CONE):
        (radius, half), out = sizes, np.linalg.norm(points[..., :2], axis=-1)
        side = out - radius
        if kind == CONE:
            side = (2.0 * half * side + radius * (points[..., 2] + half)) / np.hypot(2.0 * half, radius)
        return np.maximum(side, np.abs(points[..., 2]) - half)
    return (np.abs(points) - sizes).max(axis=-1)


def marched(kind, sizes, origin, direction, reach):
    """First change of sign along a ray, by sampling and bisection; None where the samples show none."""
    t = np.linspace(0.0, reach, 4001)
    inside = depth(kind, sizes, origin + t[:, None] * direction) < 0.0
    changes = np.flatnonzero(inside[1:] != inside[:-1])
    if not changes.size:
        return None
    low, high = t[changes[0]], t[changes[0] + 1]
    before = inside[changes[0]]
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (depth(kind, sizes, origin + middle * direction) < 0.0) == before:
            low = middle
        else:
            high = middle
    return low


vectors = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-2)
scales = st.floats(-3.0, 3.0).map(lambda x: 10.0**x)


@pytest.mark.parametrize("kind", SIZES)
@settings(max_examples=80, deadline=None)
@given(data=st.data())
def test_rays_meet_the_first_surface(kind, data):
    scale = data.draw(scales)
    sizes = scale * np.array(data.draw(st.tuples(*[st.floats(0.1, 1.0)] * SIZES[kind])))
    origin = scale * data.draw(st.sampled_from([0.1, 1.0, 3.0])) * np.array(data.draw(vectors))
    aim = scale * np.array(data.draw(st.tuples(*[st.floats(-0.9, 0.9)] * 3))) - origin
    if np.linalg.norm(aim) < 0.01 * scale or abs(depth(kind, sizes, origin)) < 1e-3 * scale:
        return
    direction = aim / np.linalg.norm(aim)
    expected = marched(kind, sizes, origin, direction, 20.0 * scale)
    distance, normal = cast(kind, shape(kind, sizes), origin, direction)
    if expected is None:
        # the ray misses, or cuts off less than the samples see
        middle = origin + distance * direction if distance < INFINITY else origin
        assert distance == INFINITY or depth(kind, sizes, middle + 1e-3 * scale * direction) > -1e-2 * scale
        return
    assert abs(distance - expected) < 1e-7 * scale
    assert abs(np.linalg.norm(normal) - 1.0) < 1e-9
    hit = origin + distance * direction
    assert abs(depth(kind, sizes, hit)) < 1e-9 * scale
    assert depth(kind, sizes, hit + 1e-4 * scale * normal) > 0.0  # the normal points out
    inside = depth(kind, sizes, origin) < 0.0
    assert (normal @ direction > 0.0) == inside
    assert cast(kind, shape(kind, sizes), origin, direction, distance * (1 + 1e-9))[0] == distance
    assert cast(kind, shape(kind, sizes), origin, direction, distance * (1 - 1e-9))[0] == INFINITY


EXACT = [
    (PLANE, [], (1.0, 2.0, 3.0), (0.0, 0.0, -1.0), 3.0, (0.0, 0.0, 1.0)),
    (PLANE, [], (1.0, 2.0, 3.0), (0.6, 0.0, -0.8), 3.75, (0.0, 0.0, 1.0)),
    (PLANE, [], (1.0, 2.0, 3.0), (0.0, 0.0, 1.0), INFINITY, (0.0, 0.0, 0.0)),
    (PLANE, [], (1.0, 2.0, 3.0), (1.0, 0.0, 0.0), INFINITY, (0.0, 0.0, 0.0)),
    (PLANE, [], (1.0, 2.0, -3.0), (0.0, 0.0, 1.0), 3.0, (0.0, 0.0, 1.0)),  # from inside
    (PLANE, [], (1.0, 2.0, -3.0), (0.0, 0.0, -1.0), INFINITY, (0.0, 0.0, 0.0)),
    (PLANE, [], (1.0, 2.0, 0.0), (0.0, 0.0, -1.0), 0.0, (0.0, 0.0, 1.0)),
    (SPHERE, [1.0], (3.0, 0.0, 0.0), (-1.0, 0.0, 0.0), 2.0, (1.0, 0.0, 0.0)),
    (SPHERE, [1.0], (3.0, 0.0, 0.0), (1.0, 0.0, 0.0), INFINITY, (0.0, 0.0, 0.0)),
    (SPHERE, [1.0], (3.0, 1.0 + 1e-9, 0.0), (-1.0, 0.0, 0.0), INFINITY, (0.0, 0.0, 0.0)),
    (SPHERE, [1.0], (0.5, 0.0, 0.0), (1.0, 0.0, 0.0), 0.5, (1.0, 0.0, 0.0)),  # from inside
    (SPHERE, [1.0], (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), 0.0, (1.0, 0.0, 0.0)),  # on it, into it
    (SPHERE, [1.0], (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), INFINITY, (0.0, 0.0, 0.0)),  # on it, away from it
    (CAPSULE, [1.0, 2.0], (0.0, 0.0, 9.0), (0.0, 0.0, -1.0), 6.0, (0.0, 0.0, 1.0)),
    (CAPSULE, [1.0, 2.0], (5.0, 0.0, 1.0), (-1.0, 0.0, 0.0), 4.0, (1.0, 0.0, 0.0)),
    (CAPSULE, [1.0, 2.0], (5.0, 0.0, 2.5), (-1.0, 0.0, 0.0), 5.0 - np.sqrt(0.75), (np.sqrt(0.75), 0.0, 0.5)),
    (CAPSULE, [1.0, 2.0], (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 3.0, (0.0, 0.0, 1.0)),
    (CAPSULE, [1.0, 2.0], (0.5, 0.0, 0.0), (1.0, 0.0, 0.0), 0.5, (1.0, 0.0, 0.0)),
    (CAPSULE, [1.0, 2.0], (2.0, 0.0, 0.0), (0.0, 0.0, 1.0), INFINITY, (0.0, 0.0, 0.0)),
    (BOX, [1.0, 2.0, 3.0], (5.0, 1.0, 1.0), (-1.0, 0.0, 0.0), 4.0, (1.0, 0.0, 0.0)),
    (BOX, [1.0, 2.0, 3.0], (5.0, 2.5, 1.0), (-1.0, 0.0, 0.0), INFINITY, (0.0, 0.0, 0.0)),
    (BOX, [1.0, 2.0, 3.0], (0.0, 0.0, 0.0), (0.0, -1.0, 0.0), 2.0, (0.0, -1.0, 0.0)),
    (BOX, [1.0, 2.0, 3.0], (0.0, 0.0, 9.0), (0.0, 0.0, -1.0), 6.0, (0.0, 0.0, 1.0)),
    (TRIANGLE, [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1], (0.2, 0.2, 5.0), (0.0, 0.0, -1.0), 5.0, (0.0, 0.0, 1.0)),
    (TRIANGLE, [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1], (0.2, 0.2, -5.0), (0.0, 0.0, 1.0), 5.0, (0.0, 0.0, 1.0)),
    (TRIANGLE, [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1], (0.6, 0.6, 5.0), (0.0, 0.0, -1.0), INFINITY, (0.0, 0.0, 0.0)),
    (TRIANGLE, [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1], (-1.0, 0.2, 0.0), (1.0, 0.0, 0.0), INFINITY, (0.0, 0.0, 0.0)),
    (TRIANGLE, [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1], (0.2, 0.2, 5.0), (0.0, 0.0, 1.0), INFINITY, (0.0, 0.0, 0.0)),
]


@pytest.mark.parametrize(("kind", "numbers", "origin", "direction", "distance", "normal"), EXACT)
def test_exact_hits(kind, numbers, origin, direction, distance, normal):
    found, at = cast(kind, numbers, origin, direction)
    assert found == pytest.approx(distance, rel=1e-15)
    assert at == pytest.approx(normal, abs=1e-15)
    if kind == BOX:
        found, at = cast(HULL, shape(HULL, numbers), origin, direction)
        assert found == pytest.approx(distance, rel=1e-15)
        assert at == pytest.approx(normal, abs=1e-15)


def test_nothing_beyond_the_limit():
    for kind, numbers, origin, direction, distance, _ in EXACT:
        if 0.0 < distance < INFINITY:
            assert cast(kind, numbers, origin, direction, 0.999 * distance) == (INFINITY, pytest.approx(np.zeros(3)))
            assert cast(kind, numbers, origin, direction, 1.001 * distance)[0] == pytest.approx(distance)


def test_a_small_ball_far_away_is_hit_to_the_last_digits():
    distance, normal = cast(SPHERE, [1e-3], (1e3, 0.5e-3, 0.0), (-1.0, 0.0, 0.0), 2e3)
    assert distance == pytest.approx(1e3 - 1e-3 * np.sqrt(0.75), rel=1e-15)
    assert normal == pytest.approx((np.sqrt(0.75), 0.5, 0.0), abs=1e-9)


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_no_ray_slips_through_between_triangles(seed):
    """Rays at the very edge that two triangles share, and at the corner that all share, meet at least one of them."""
    rng = np.random.default_rng(seed)
    angles = (np.arange(7) + rng.uniform(0.0, 0.9, 7)) * 2.0 * np.pi / 7
    around = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(7)))
    around = np.vstack((around, [(0.0, 0.0, rng.uniform(-0.1, 0.1))]))
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    *rim, middle = around @ turn.T + rng.normal(size=3)
    faces = [np.concatenate((middle, rim[k], rim[(k + 1) % 7], np.ones(3))) for k in range(7)]
    for k in range(7):
        for share in (0.0, 0.3, rng.uniform(), 0.9):
            origin = middle + 3.0 * turn[:, 2] + rng.uniform(-1.0, 1.0, 3)
            aim = middle + share * (rim[k] - middle) - origin
            direction = aim / np.linalg.norm(aim)
            assert min(cast(TRIANGLE, face, origin, direction)[0] for face in faces) < INFINITY


def test_rays_as_mujoco_has_them():
    mujoco = pytest.importorskip("mujoco")
    rng = np.random.default_rng(1)
    kinds = {
        SPHERE: (mujoco.mjtGeom.mjGEOM_SPHERE, [0.7, 0.0, 0.0], [0.7]),
        CAPSULE: (mujoco.mjtGeom.mjGEOM_CAPSULE, [0.4, 0.9, 0.0], [0.4, 0.9]),
        CYLINDER: (mujoco.mjtGeom.mjGEOM_CYLINDER, [0.4, 0.9, 0.0], [0.4, 0.4, 0.9]),
        BOX: (mujoco.mjtGeom.mjGEOM_BOX, [0.3, 0.5, 0.8], [0.3, 0.5, 0.8]),
    }
    hits = 0
    for kind, (geom, size, numbers) in kinds.items():
        for _ in range(500):
            origin = rng.choice([0.2, 1.0, 2.0]) * rng.normal(size=3)
            direction = rng.normal(size=3) * (rng.random(3) < 0.8) + (0.0, 0.0, 1e-3)
            direction /= np.linalg.norm(direction)
            args = (np.zeros(3), np.eye(3).ravel(), np.array(size), origin, direction, int(geom))
            try:
                expected = mujoco.mju_rayGeom(*args, None)
            except TypeError:  # before MuJoCo 3.4
                expected = mujoco.mju_rayGeom(*args)
            distance, _ = cast(kind, numbers, origin, direction)
            if expected < 0.0:
                assert distance == INFINITY
            else:
                hits += 1
                assert distance == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert hits > 300

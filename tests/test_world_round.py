"""Where round shapes touch: against the nearest points of convex sets, found by other means."""

import numpy as np
import pytest
from colliding import count_contacts
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, QhullError

from kickdrift.world.shapes.kind_numbers import BOX, CAPSULE, HULL, PLANE, SPHERE, TRIANGLE
from kickdrift.world.shapes.mass_properties import rotation_matrix
from kickdrift.world.shapes.polyhedron import HEADER, LOOPS_AT, PLANES_AT, polyhedron_numbers

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
BOX_LOOPS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def way_out(a, b):
    """By how much the second of two sets of corners has to move until their hulls are apart; 0.0 if they are."""
    points = (b[None, :, :] - a[:, None, :]).reshape(-1, 3)
    try:
        return max(-ConvexHull(points).equations[:, 3].max(), 0.0)
    except (QhullError, ValueError):  # all in one plane
        return 0.0


def core(kind, numbers):
    """Corners and radius."""
    if kind == SPHERE:
        return np.zeros((1, 3)), numbers[0]
    if kind == CAPSULE:
        return np.array([[0.0, 0.0, -numbers[1]], [0.0, 0.0, numbers[1]]]), numbers[0]
    if kind == TRIANGLE:
        return numbers[:9].reshape(3, 3), 0.0
    if kind == HULL:
        return numbers[HEADER : int(numbers[PLANES_AT])].reshape(-1, 3), 0.0
    return CORNERS * numbers, 0.0


def extent(kind, numbers):
    """How far a shape reaches from its origin."""
    corners, radius = core(kind, numbers)
    return np.linalg.norm(corners, axis=1).max() + radius


def moved(points, pose):
    return points @ rotation_matrix(pose[3:]).T + pose[:3]


def moved_back(points, pose):
    return (points - pose[:3]) @ rotation_matrix(pose[3:])


def collide(kinds, a, b, pose, margin=1e9):
    """Find the normal, the points on both shapes in a's frame, and the features; nothing else may be written."""
    manifold = np.full(64, 7.0)
    pose = np.asarray(pose, dtype=float)
    count = count_contacts(kinds, np.asarray(a, float), np.asarray(b, float), pose, margin, manifold)
    rows = manifold[8:40].reshape(4, 8)
    assert (rows[:, 7] == 7.0).all()
    assert (rows[count:] == 7.0).all()
    return manifold[:3].copy(), rows[:count, :3].copy(), moved(rows[:count, 3:6], pose), rows[:count, 6].copy()


def off_core(kind, numbers, point):
    """How far a point is from the axis of a capsule, the centre of a ball, a triangle, the surface of a polyhedron."""
    if kind == SPHERE:
        return np.linalg.norm(point)
    if kind == CAPSULE:
        return np.linalg.norm(point - (0.0, 0.0, np.clip(point[2], -numbers[1], numbers[1])))
    if kind == TRIANGLE:
        u, v, w = core(kind, numbers)[0]
        shares, *_ = np.linalg.lstsq(np.column_stack((v - u, w - u)), point - u)
        shares = np.clip(shares, 0.0, 1.0) / max(np.clip(shares, 0.0, 1.0).sum(), 1.0)
        return np.linalg.norm(u + shares[0] * (v - u) + shares[1] * (w - u) - point)
    if kind == HULL:
        planes = numbers[int(numbers[PLANES_AT]) : int(numbers[LOOPS_AT])].reshape(-1, 4)
        return abs((planes[:, :3] @ point - planes[:, 3]).max())
    out = np.abs(point) - numbers
    return np.linalg.norm(np.maximum(out, 0.0)) if (out > 0.0).any() else -out.max()


sizes = st.floats(-3.0, 3.0).map(lambda x: 10.0**x)
directions = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3)
quaternions = st.one_of(
    st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: np.linalg.norm(q) > 1e-3),
    st.sampled_from([UPRIGHT, (1.0, 1.0, 0.0, 0.0), (1.0, 0.0, 1.0, 0.0), (1.0, 1.0, 1.0, 1.0), (0.0, 1.0, 0.0, 0.0)]),
    st.tuples(st.just(1.0), *[st.floats(-1e-4, 1e-4)] * 3),
).map(lambda q: np.array(q) / np.linalg.norm(q))


def hull(corners):
    """Numbers of the hull of random points, all of whose faces are triangles."""
    found = ConvexHull(corners)
    used, corner = np.unique(found.simplices, return_inverse=True)
    loops = corner.reshape(found.simplices.shape)
    for loop, plane in zip(loops, found.equations, strict=True):
        u, v, w = corners[used[loop]]
        if np.cross(v - u, w - u) @ plane[:3] < 0.0:
            loop[1:] = loop[:0:-1]
    return polyhedron_numbers(corners[used], loops.tolist())


@st.composite
def hulls(draw):
    rng = np.random.default_rng(draw(st.integers(0, 1000)))
    points = rng.normal(size=(draw(st.integers(4, 30)), 3))
    return hull(points / np.linalg.norm(points, axis=1)[:, None] * draw(sizes) * 10.0 ** rng.uniform(-1, 0, 3))


def numbers(kind):
    if kind == HULL:
        return hulls()
    if kind == SPHERE:
        return st.tuples(sizes).map(np.array)
    if kind == CAPSULE:
        return st.tuples(sizes, sizes).map(np.array)
    return st.tuples(sizes, sizes, sizes).map(np.array)


@st.composite
def placements(draw, kinds):
    """Two shapes near each other: their centres from on top of each other to twice as far as they can touch."""
    a, b = draw(numbers(kinds[0])), draw(numbers(kinds[1]))
    way = np.array(draw(directions))
    reach_a, reach_b = extent(kinds[0], a), extent(kinds[1], b)
    at = draw(st.floats(0.0, 1.5)) * draw(st.sampled_from([reach_a, reach_b, a[0], reach_a + reach_b]))
    return a, b, np.concatenate((at * way / np.linalg.norm(way), draw(quaternions)))


CONVEX = [
    (SPHERE, SPHERE),
    (SPHERE, CAPSULE),
    (CAPSULE, CAPSULE),
    (SPHERE, BOX),
    (CAPSULE, BOX),
    (SPHERE, HULL),
    (CAPSULE, HULL),
]


def check_nearest(kinds, a, b, pose, found):
    """Check that points are on both shapes, and that no direction separates these by more than the normal does.

    Points of two convex sets bound their distance from above, the extents of both along any direction from below: where
    the two bounds are equal, no other points are nearer. Where the cores overlap, the way out is the shortest one.
    """
    normal, on_a, on_b, features = found
    core_a, radius_a = core(kinds[0], a)
    core_b, radius_b = core(kinds[1], b)
    core_b = moved(core_b, pose)
    assert len(set(features)) == len(features)
    assert np.isfinite([*on_a.flat, *on_b.flat]).all()
    assert abs(np.linalg.norm(normal) - 1.0) < 1e-12
    separations = (on_b - on_a) @ normal
    k = separations.argmin()
    bound = (core_b @ normal).min() - (core_a @ normal).max()
    scale = extent(kinds[0], a) + extent(kinds[1], b)
    # The direction between cores that all but touch is rounding, times the size of things.
    tolerance = scale * min(1e-7, 1e-11 + 1e-15 * scale / max(abs(bound), 1e-300))
    assert abs(separations[k] + radius_a + radius_b - bound) < tolerance + 1e-9 * (radius_a + radius_b)
    sideways = 0.0
    if len(features) == 2:  # the two points of a pair are not quite opposite each other
        sideways = 0.101 * min(radius for radius in (radius_a, radius_b) if radius > 0.0) + 0.21 * abs(bound)
    assert np.linalg.norm(on_b[k] - on_a[k] - separations[k] * normal) < sideways + tolerance
    assert off_core(kinds[0], a, on_a[k] - radius_a * normal) < tolerance
    assert off_core(kinds[1], b, moved_back(on_b[k] + radius_b * normal, pose)) < tolerance
    depth = way_out(core_a, core_b)
    if depth > tolerance:
        assert abs(bound + depth) < tolerance
    # the second point of a tilted capsule lies a little inside of it
    for k in range(len(features)):
        astray = off_core(kinds[0], a, on_a[k] - radius_a * normal)
        assert astray < 0.2 * radius_a + tolerance
        astray = off_core(kinds[1], b, moved_back(on_b[k] + radius_b * normal, pose))
        assert astray < 0.2 * radius_b + tolerance


@pytest.mark.parametrize("kinds", CONVEX)
@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_the_points_are_the_nearest_ones(kinds, data):
    a, b, pose = data.draw(placements(kinds))
    found = collide(kinds, a, b, pose)
    assert 1 <= len(found[3]) <= 2
    check_nearest(kinds, a, b, pose, found)


@pytest.mark.parametrize("kinds", [(PLANE, SPHERE), (PLANE, CAPSULE)])
@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_a_plane_is_touched_by_the_lowest_points(kinds, data):
    b, pose = data.draw(numbers(kinds[1])), np.concatenate((data.draw(directions), data.draw(quaternions)))
    normal, on_a, on_b, features = collide(kinds, np.zeros(0), b, pose)
    corners, radius = core(kinds[1], b)
    assert (normal == (0.0, 0.0, 1.0)).all()
    assert (features == range(len(corners))).all()
    assert (on_a[:, 2] == 0.0).all()
    assert np.allclose(on_b, moved(corners, pose) - (0.0, 0.0, radius), rtol=0.0, atol=1e-12 * (1.0 + b.sum()))
    assert np.allclose(on_b[:, :2], on_a[:, :2], rtol=0.0, atol=1e-12 * (1.0 + b.sum()))


TILTED = (np.cos(0.3), 0.0, np.sin(0.3), 0.0)  # about the y axis by 0.6
LYING = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)  # z turned into x


def test_capsules_side_by_side_touch_at_both_ends_of_what_they_share():
    normal, on_a, on_b, features = collide((CAPSULE, CAPSULE), [0.2, 1.0], [0.3, 2.0], (0.51, 0.0, 1.5, *UPRIGHT), 0.02)
    assert np.allclose(normal, (1.0, 0.0, 0.0))
    assert np.allclose(on_a, [(0.2, 0.0, -0.5), (0.2, 0.0, 1.0)])
    assert np.allclose(on_b, [(0.21, 0.0, -0.5), (0.21, 0.0, 1.0)])
    assert (features == (0.0, 1.0)).all()


def test_crossed_capsules_touch_at_one_point():
    found = collide((CAPSULE, CAPSULE), [0.2, 1.0], [0.3, 2.0], (0.0, 0.51, 0.25, *LYING), 0.02)
    assert np.allclose(found[0], (0.0, 1.0, 0.0))
    assert np.allclose(found[1], [(0.0, 0.2, 0.25)])
    assert np.allclose(found[2], [(0.0, 0.21, 0.25)])


def test_a_capsule_lies_on_what_of_it_is_over_the_box():
    pose = (0.1, 0.0, -0.5 - 0.2 - 0.01, *UPRIGHT)  # of the box, in the frame of a capsule turned by LYING below
    turned = np.concatenate(
        (moved_back(np.array([pose[:3]]), np.array([0.0, 0.0, 0.0, *LYING]))[0], LYING * np.array([1, -1, -1, -1]))
    )
    normal, on_a, on_b, features = collide((CAPSULE, BOX), [0.2, 2.0], [0.5, 0.5, 0.5], turned, 0.02)
    assert np.allclose(normal, (1.0, 0.0, 0.0))  # down
    assert np.allclose(on_a, [(0.2, 0.0, -0.4), (0.2, 0.0, 0.6)])
    assert np.allclose(on_b, [(0.21, 0.0, -0.4), (0.21, 0.0, 0.6)])
    assert (features == (0.0, 1.0)).all()


def test_a_capsule_along_an_edge_of_a_box_touches_it_twice():
    eighth = np.array([np.cos(np.pi / 8), 0.0, 0.0, np.sin(np.pi / 8)])
    pose = (0.0, np.sqrt(0.5) + 0.1, 0.25, *eighth)
    normal, on_a, on_b, _ = collide((CAPSULE, BOX), [0.1, 1.0], [0.5, 0.5, 0.5], pose, 0.02)
    assert np.allclose(normal, (0.0, 1.0, 0.0))
    assert np.allclose(on_a, [(0.0, 0.1, -0.25), (0.0, 0.1, 0.75)])
    assert np.allclose(on_b, on_a)


@pytest.mark.parametrize("kind", [BOX, HULL])
@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 4, 1.3])
def test_a_capsule_lies_on_a_face_in_any_direction(kind, angle):
    b = np.array([0.5, 0.5, 0.5]) if kind == BOX else polyhedron_numbers(CORNERS * 0.5, BOX_LOOPS)
    turn = np.array(
        [np.cos(angle / 2), np.sin(angle / 2), 0.0, 0.0]
    )  # of the box about the capsule's x axis, normal to it
    q = product(turn, np.array(LYING))
    normal, on_a, on_b, features = collide((CAPSULE, kind), [0.2, 2.0], b, (0.71, 0.0, 0.0, *q), 0.02)
    reach = 0.5 / max(abs(np.cos(angle)), abs(np.sin(angle)))
    assert np.allclose(normal, (1.0, 0.0, 0.0))
    assert np.allclose(on_a, [(0.2, 0.0, -reach), (0.2, 0.0, reach)])
    assert np.allclose(on_b, [(0.21, 0.0, -reach), (0.21, 0.0, reach)])
    assert (features == (0.0, 1.0)).all()


@pytest.mark.parametrize("kind", [BOX, HULL])
@pytest.mark.parametrize("half", [0.3, 2.0])
@pytest.mark.parametrize("edge", range(12))
def test_a_capsule_along_any_edge_touches_it_twice(kind, half, edge):
    """Also where it is longer than the edge, and as near to the ends of the next ones."""
    axis, signs = edge // 4, np.array([1.0 if edge & 1 else -1.0, 1.0 if edge & 2 else -1.0])
    corner = np.insert(0.5 * signs, axis, 0.0)
    outward = np.insert(signs, axis, 0.0) / np.sqrt(2.0)
    turns = [(np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0), (np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0), UPRIGHT]
    q, at = conjugate(turns[axis]), corner + 0.11 * outward  # of the capsule in the box's frame
    pose = np.concatenate((rotation_matrix(q) @ -at, q))
    b = np.array([0.5, 0.5, 0.5]) if kind == BOX else polyhedron_numbers(CORNERS * 0.5, BOX_LOOPS)
    normal, on_a, on_b, features = collide((CAPSULE, kind), [0.1, half], b, pose, 0.02)
    assert (features == (0.0, 1.0)).all()
    assert np.allclose(normal, rotation_matrix(q) @ -outward)
    assert np.allclose(np.sort(on_a[:, 2]), (-min(half, 0.5), min(half, 0.5)))
    assert np.allclose((on_b - on_a) @ normal, 0.01)


@pytest.mark.parametrize("kind", [BOX, HULL])
@pytest.mark.parametrize("turned", [False, True])
def test_a_capsule_whose_lower_end_hangs_over_keeps_its_point_behind(kind, turned):
    """It is nearest to the edge, with a normal that is not quite the face's."""
    b = np.array([0.5, 0.5, 0.5]) if kind == BOX else polyhedron_numbers(CORNERS * 0.5, BOX_LOOPS)
    tilt, half = 0.02, 0.6
    centre = np.array([0.502, 0.0, 0.71]) + half * np.array([-np.cos(tilt), 0.0, np.sin(tilt)])
    angle = tilt - 0.5 * np.pi + (np.pi if turned else 0.0)  # of the capsule's axis to the box's, about y
    q = conjugate((np.cos(0.5 * angle), 0.0, np.sin(0.5 * angle), 0.0))
    pose = np.concatenate((rotation_matrix(q) @ -centre, q))
    found = collide((CAPSULE, kind), [0.2, half], b, pose, 0.05)
    check_nearest((CAPSULE, kind), np.array([0.2, half]), b, pose, found)
    assert (found[3] == (0.0, 1.0)).all()
    assert np.allclose(found[1][:, 2], (-0.4, 0.6) if turned else (-0.6, 0.4), atol=0.02)


@pytest.mark.parametrize("tilt", [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.0099])
def test_a_slightly_tilted_capsule_keeps_its_two_points(tilt):
    """Shapes on a shelf: the points may not jump while the tilt is below what the margin over the length allows."""
    pose = (0.0, 0.0, -0.7, np.cos(np.pi / 4 + tilt / 2), 0.0, -np.sin(np.pi / 4 + tilt / 2), 0.0)
    for kinds, a, b in (((CAPSULE, BOX), [0.2, 1.0], [2.0, 2.0, 0.5]), ((CAPSULE, CAPSULE), [0.2, 1.0], [0.5, 2.0])):
        at = (pose[2], 0.0, 0.0) if kinds[1] == BOX else (0.0, 0.7, 0.0)
        turn = pose[3:] if kinds[1] == BOX else (np.cos(tilt / 2), np.sin(tilt / 2), 0.0, 0.0)
        normal, on_a, on_b, features = collide(kinds, a, b, (*at, *turn), 0.05)
        assert (features == (0.0, 1.0)).all()
        assert np.allclose((on_b - on_a) @ normal, (-tilt, tilt), atol=2e-4) or np.allclose(
            (on_b - on_a) @ normal, (tilt, -tilt), atol=2e-4
        )


DEGENERATE = [
    ((SPHERE, SPHERE), [1.0], [2.0], (0.0, 0.0, 0.0, *UPRIGHT)),
    ((SPHERE, SPHERE), [1.0], [1e-3], (1e-200, 0.0, 0.0, *UPRIGHT)),
    ((SPHERE, CAPSULE), [1.0], [1.0, 2.0], (0.0, 0.0, 0.0, *UPRIGHT)),
    ((SPHERE, CAPSULE), [1.0], [1.0, 2.0], (0.0, 0.0, 2.0, *UPRIGHT)),
    ((CAPSULE, CAPSULE), [1.0, 2.0], [1.0, 2.0], (0.0, 0.0, 0.0, *UPRIGHT)),
    ((CAPSULE, CAPSULE), [1.0, 2.0], [1.0, 2.0], (0.0, 0.0, 3.0, *UPRIGHT)),
    ((CAPSULE, CAPSULE), [1.0, 2.0], [1.0, 2.0], (0.0, 0.0, 4.0, *UPRIGHT)),
    ((CAPSULE, CAPSULE), [1.0, 2.0], [1.0, 2.0], (0.0, 0.0, 0.0, *LYING)),
    ((CAPSULE, CAPSULE), [1.0, 2.0], [1.0, 2.0], (2.0, 0.0, 0.0, *LYING)),
    ((SPHERE, BOX), [1.0], [1.0, 1.0, 1.0], (0.0, 0.0, 0.0, *UPRIGHT)),
    ((SPHERE, BOX), [1.0], [1.0, 2.0, 3.0], (1.0, 0.0, 0.0, *UPRIGHT)),
    ((SPHERE, BOX), [1.0], [1.0, 2.0, 3.0], (1.0, 2.0, 0.0, *UPRIGHT)),
    ((SPHERE, BOX), [1.0], [1.0, 2.0, 3.0], (1.0, 2.0, 3.0, *UPRIGHT)),
    ((CAPSULE, BOX), [1.0, 2.0], [1.0, 1.0, 1.0], (0.0, 0.0, 0.0, *UPRIGHT)),
    ((CAPSULE, BOX), [1.0, 2.0], [1.0, 1.0, 1.0], (0.0, 0.0, 0.0, *LYING)),
    ((CAPSULE, BOX), [1.0, 2.0], [1.0, 1.0, 1.0], (0.0, 0.0, 0.0, *TILTED)),
    ((CAPSULE, BOX), [1.0, 2.0], [1.0, 2.0, 3.0], (1.0, 0.0, 0.0, *UPRIGHT)),
    ((CAPSULE, BOX), [1.0, 2.0], [1.0, 2.0, 3.0], (1.0, 2.0, 0.0, *UPRIGHT)),
    ((CAPSULE, BOX), [1.0, 2.0], [1.0, 2.0, 3.0], (1.0, 2.0, 5.0, *UPRIGHT)),
    ((CAPSULE, BOX), [1e-3, 1e3], [1e-3, 1e3, 1e-3], (0.0, 0.0, 0.0, *TILTED)),
]


@pytest.mark.parametrize(("kinds", "a", "b", "pose"), DEGENERATE)
def test_where_the_direction_is_not_given_one_is_chosen(kinds, a, b, pose):
    a, b, pose = np.array(a), np.array(b), np.array(pose)
    check_nearest(kinds, a, b, pose, collide(kinds, a, b, pose))
    if kinds[1] == BOX:
        box = polyhedron_numbers(CORNERS * b, BOX_LOOPS)
        check_nearest((kinds[0], HULL), a, box, pose, collide((kinds[0], HULL), a, box, pose))


def test_a_face_that_is_parallel_to_a_capsule_but_for_rounding():
    corners = CORNERS.copy()
    corners[(CORNERS[:, 0] > 0.0) & (CORNERS[:, 2] > 0.0), 0] = np.nextafter(1.0, 2.0)
    normal, on_a, on_b, _ = collide(
        (CAPSULE, HULL), [1.0, 0.5], polyhedron_numbers(corners, BOX_LOOPS[4:] + BOX_LOOPS[:4]), (-4, -4, 0, *UPRIGHT)
    )
    assert np.allclose(normal, (-np.sqrt(0.5), -np.sqrt(0.5), 0.0))
    assert np.allclose((on_b - on_a) @ normal, np.sqrt(18.0) - 1.0)
    assert np.allclose(on_b[:, :2], -3.0)


@pytest.mark.parametrize("kind", [SPHERE, CAPSULE])
@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_a_box_and_the_hull_of_its_corners_are_touched_alike(kind, data):
    a, b, pose = data.draw(placements((kind, BOX)))
    box = polyhedron_numbers(CORNERS * b, BOX_LOOPS)
    of_box, of_hull = collide((kind, BOX), a, b, pose), collide((kind, HULL), a, box, pose)
    check_nearest((kind, HULL), a, box, pose, of_hull)
    depths = [((on_b - on_a) @ normal).min() for normal, on_a, on_b, _ in (of_box, of_hull)]
    assert abs(depths[0] - depths[1]) < 1e-9 * (a.sum() + b.sum())


@pytest.mark.parametrize("kinds", CONVEX)
@settings(max_examples=50, deadline=None)
@given(data=st.data())
def test_nothing_is_found_beyond_the_margin_and_nothing_missed_within(kinds, data):
    a, b, pose = data.draw(placements(kinds))
    normal, on_a, on_b, features = collide(kinds, a, b, pose)
    separations = (on_b - on_a) @ normal
    scale = extent(kinds[0], a) + extent(kinds[1], b)
    for margin in np.concatenate((separations - 1e-6 * scale, separations + 1e-6 * scale)):
        if margin >= 0.0:
            _, _, _, kept = collide(kinds, a, b, pose, margin)
            assert kept.tolist() == features[separations <= margin].tolist()


@pytest.mark.parametrize("kinds", [(CAPSULE, CAPSULE), (CAPSULE, BOX), (CAPSULE, HULL)])
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_features_stay_while_things_roll_on(kinds, seed):
    """A capsule lying on something turns a little about the normal and slides: two points, always at the same ends."""
    rng = np.random.default_rng(seed)
    b = {CAPSULE: [0.3, 2.0], BOX: [2.0, 2.0, 0.3], HULL: polyhedron_numbers(CORNERS * (2.0, 2.0, 0.3), BOX_LOOPS)}[
        kinds[1]
    ]
    upright = LYING if kinds[1] == CAPSULE else UPRIGHT  # of b, below a capsule along x
    seen = set()
    for _ in range(20):
        angle = 1e-3 * rng.normal()
        tilt = np.array([*(1.0, *(1e-4 * rng.normal(size=2)), angle)])
        q = product(product(conjugate(LYING), tilt / np.linalg.norm(tilt)), upright)
        at = moved_back(
            np.array([[*(0.05 * rng.normal(size=2)), -0.5]]) * (1.0, 0.01, 1.0), np.array([0.0, 0.0, 0.0, *LYING])
        )[0]
        seen.add(tuple(collide(kinds, [0.2, 0.7], b, (*at, *q), 0.02)[3]))
    assert seen == {(0.0, 1.0)}


def product(p, q):
    w, u, s, v = p[0], np.array(p[1:]), q[0], np.array(q[1:])
    return np.array([w * s - u @ v, *(w * v + s * u + np.cross(u, v))])


def conjugate(q):
    return np.array(q) * (1.0, -1.0, -1.0, -1.0)

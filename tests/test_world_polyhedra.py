"""Where boxes and hulls touch: against the Minkowski difference of their corners, and against each other."""

import itertools
from typing import NamedTuple

import numpy as np
import pytest
from colliding import count_contacts
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.kind_numbers import BOX, HULL, PLANE
from kickdrift.world.shapes.mass_properties import rotation_matrix
from kickdrift.world.world import World

UNHURRIED = settings(deadline=None)  # the first example compiles
SIGNS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
MARGIN = 0.02
KINDS = {Box: BOX, Hull: HULL}


def corners(shape):
    return shape.vertices if isinstance(shape, Hull) else SIGNS * shape.numbers


def turn(axis, angle):
    axis = np.array(axis, dtype=float)
    return np.concatenate(([np.cos(angle / 2)], np.sin(angle / 2) * axis / np.linalg.norm(axis)))


class Contact(NamedTuple):
    """Seen from the first shape."""

    normal: np.ndarray
    on_a: np.ndarray
    on_b: np.ndarray
    gaps: np.ndarray
    features: np.ndarray


def collide(a, b, position, orientation, margin=MARGIN):
    """Find a contact, with a plane if a is None; nothing but what belongs to it may be written."""
    manifold = np.full(64, 7.0)
    pose = np.concatenate((position, orientation))
    kinds = (PLANE, KINDS[type(b)]) if a is None else (KINDS[type(a)], KINDS[type(b)])
    count = count_contacts(kinds, np.zeros(0) if a is None else a.numbers, b.numbers, pose, margin, manifold)
    rows = manifold[8:40].reshape(4, 8)
    assert 0 <= count <= 4
    assert (rows[:, 7] == 7.0).all()
    assert (rows[count:] == 7.0).all()
    assert (manifold[3:6] == 7.0).all()
    assert (manifold[40:] == 7.0).all()
    on_a, on_b = rows[:count, :3], rows[:count, 3:6] @ rotation_matrix(orientation).T + position
    normal = manifold[:3].copy()
    assert count == 0 or abs(np.linalg.norm(normal) - 1.0) < 1e-12
    assert (rows[:count, 6] == np.rint(rows[:count, 6])).all()
    return Contact(normal, on_a, on_b, (on_b - on_a) @ normal, rows[:count, 6].astype(int))


def beyond(shape, points):
    """How far points are from the nearest face's plane, outside positive."""
    equations = ConvexHull(corners(shape)).equations
    return (points @ equations[:, :3].T + equations[:, 3]).max(axis=1)


def distance(a, b):
    """Of the hulls of two sets of points, by non-negative least squares."""
    weight = 1e3 * max(np.ptp(a), np.ptp(b))
    rows = np.zeros((5, len(a) + len(b)))
    rows[:3] = np.concatenate((a, -b)).T
    rows[3, : len(a)], rows[4, len(a) :] = weight, weight
    shares, _ = nnls(rows, np.array([0.0, 0.0, 0.0, weight, weight]), maxiter=1000)
    one, two = shares[: len(a)], shares[len(a) :]
    return float(np.linalg.norm(one @ a / one.sum() - two @ b / two.sum()))


def half_width(shape):
    """Half of the smallest distance between a face and the corner farthest behind it."""
    equations = ConvexHull(corners(shape)).equations
    return -(corners(shape) @ equations[:, :3].T + equations[:, 3]).min(axis=0).max() / 2.0


def tolerance_of(a, b, margin):
    """By how much a contact of faces may be off the best axis, without its share of the depth."""
    return min(margin / 8.0, half_width(a) / 100.0, half_width(b) / 100.0)


def reach_of_sharpest(shape):
    """How far the sharpest corner of a face moves if the sides of the face move outwards by one."""
    if isinstance(shape, Box):
        return np.sqrt(2.0)
    sines = []
    for face in shape.faces:
        points = shape.vertices[list(face)]
        back, ahead = (np.roll(points, shift, axis=0) - points for shift in (1, -1))
        cosines = (back * ahead).sum(axis=1) / np.linalg.norm(back, axis=1) / np.linalg.norm(ahead, axis=1)
        sines.extend(np.sin(0.5 * np.arccos(np.clip(cosines, -1, 1))))
    return 1.0 / min(sines)


coordinate = st.floats(-1.0, 1.0)
vector = st.tuples(coordinate, coordinate, coordinate)
quaternion = st.one_of(
    st.tuples(coordinate, coordinate, coordinate, coordinate).filter(lambda q: np.dot(q, q) > 0.01),
    st.tuples(st.just(1.0), *[st.floats(-1e-3, 1e-3)] * 3),
    st.tuples(*[st.sampled_from((-1.0, 0.0, 1.0))] * 4).filter(any),
).map(lambda q: np.array(q) / np.linalg.norm(q))
boxes = st.tuples(*[st.floats(-0.7, 0.5)] * 3).map(lambda x: Box(10.0 ** np.array(x)))
hulls = st.tuples(st.integers(4, 25), st.integers(0, 2**32 - 1)).map(
    lambda n: Hull(np.random.default_rng(n[1]).normal(size=(n[0], 3)) * (1.0, 0.7, 0.5))
)
shapes = {"boxes": (boxes, boxes), "box and hull": (boxes, hulls), "hulls": (hulls, hulls)}


@pytest.mark.parametrize("pair", shapes)
def test_contacts_are_as_deep_and_as_far_as_the_minkowski_difference_says(pair):
    @settings(UNHURRIED, max_examples=60)
    @given(*shapes[pair], quaternion, vector.filter(lambda x: np.dot(x, x) > 0.01), st.floats(-0.2, 0.04))
    def check(a, b, orientation, direction, gap):
        placed = corners(b) @ rotation_matrix(orientation).T
        difference = ConvexHull((corners(a)[:, None] - placed[None]).reshape(-1, 3)).equations
        direction = np.array(direction) / np.linalg.norm(direction)
        rates = difference[:, :3] @ direction
        ahead = rates > 1e-9
        position = direction * (gap + np.min(-difference[ahead, 3] / rates[ahead]))
        best = np.max(difference[:, :3] @ position + difference[:, 3])  # over all separating axes
        normal, on_a, on_b, gaps, _ = collide(a, b, position, orientation)
        rounding = 1e-9
        tolerance = tolerance_of(a, b, MARGIN)
        if best <= 0.0:
            assert len(gaps)
            assert abs(gaps.min() - best) <= 0.05 * abs(best) + tolerance + rounding
        else:
            apart = distance(corners(a), placed + position)
            assert len(gaps) == 0 or apart <= MARGIN + 1e-6
            assert len(gaps) or apart >= MARGIN - 1e-6
            assert np.allclose(on_b - on_a, gaps[:, None] * normal, atol=rounding)
            if len(gaps):
                assert gaps.min() >= apart - tolerance - 1e-6
                assert gaps.min() <= 1.05 * apart + tolerance + 1e-6
        assert (gaps <= MARGIN + rounding).all()
        # Faces are clipped by sides moved outwards by a tenth of the tolerance.
        for shape, points in ((a, on_a), (b, (on_b - position) @ rotation_matrix(orientation))):
            assert (abs(beyond(shape, points)) <= 0.1 * tolerance * reach_of_sharpest(shape) + rounding).all()

    check()


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("make", [Box, lambda size: Hull(SIGNS * np.array(size) / 2.0)])
def test_boxes_stacked_flush_touch_at_four_corners_that_stay_the_same(make, scale):
    box = make(scale * np.ones(3))
    random = np.random.default_rng(1)
    first = None
    for _ in range(40):
        shift = scale * (np.array([0.0, 0.0, 0.999]) + 1e-6 * random.normal(size=3))
        orientation = turn(random.normal(size=3), 1e-6)
        normal, on_a, _, gaps, features = collide(box, box, shift, orientation, MARGIN * scale)
        assert np.allclose(normal, (0.0, 0.0, 1.0), atol=1e-5)
        assert np.allclose(gaps, -0.001 * scale, atol=1e-5 * scale)
        assert np.allclose(np.sort(np.abs(on_a), axis=0), 0.5 * scale, atol=1e-5 * scale)
        assert len(set(features)) == 4
        first = features if first is None else first
        assert (features == first).all()


def test_turned_face_on_face_keeps_four_of_eight_corners():
    _, on_a, _, gaps, features = collide(Box((1, 1, 1)), Box((1, 1, 1)), (0, 0, 1.0), turn((0, 0, 1), np.pi / 4))
    assert np.allclose(gaps, 0.0, atol=1e-12)
    assert len(set(features)) == 4
    reach = (np.sqrt(2.0) - 1.0) / 2.0  # corners of the octagon at (+-reach, +-1/2) and (+-1/2, +-reach)
    assert np.allclose(np.sort(np.abs(on_a[:, :2]), axis=1), (reach, 0.5), atol=1e-12)
    assert ConvexHull(on_a[:, :2]).volume > 0.55


@pytest.mark.parametrize("make", [Box, lambda size: Hull(SIGNS * np.array(size) / 2.0)])
def test_crossed_edges_touch_at_one_point(make):
    a = b = make(np.ones(3))
    tipped = Rotation.from_euler("x", np.pi / 4)  # an edge along x is on top
    crossed = Rotation.from_euler("z", np.pi / 2) * tipped
    top, way = np.sqrt(0.5), np.array([0.1, 0.2, np.sqrt(2.0) - 0.004])
    relative = (tipped.inv() * crossed).as_quat(scalar_first=True)
    normal, on_a, on_b, gaps, _ = collide(a, b, tipped.inv().apply(way), relative)
    assert np.allclose(tipped.apply(normal), (0.0, 0.0, 1.0), atol=1e-12)
    assert np.allclose(tipped.apply(on_a), [[0.1, 0.0, top]], atol=1e-12)
    assert np.allclose(tipped.apply(on_b), [[0.1, 0.0, top - 0.004]], atol=1e-12)
    assert np.allclose(gaps, -0.004, atol=1e-12)


@pytest.mark.parametrize("angle", [0.1, 0.5])
def test_ridges_that_cross_push_perpendicular_to_both(angle):
    slope = np.tan(angle)  # as one ridge sinks in, corners of the clipped faces are about as deep as the ridges
    roof = np.array([(x, y, -slope * abs(y)) for x in (-1, 1) for y in (-1, 0, 1)])
    below = Hull(np.vstack((roof, [(x, y, -2.0) for x in (-1, 1) for y in (-1, 1)])))
    above = Hull(-below.points[:, [1, 0, 2]])
    for gap in (0.01, 0.0, -0.002):
        normal, on_a, _, gaps, _ = collide(below, above, (0.1, 0.07, gap), UPRIGHT)
        assert np.allclose(normal, (0.0, 0.0, 1.0), atol=1e-12)
        assert np.allclose(on_a, [(0.1, 0.0, 0.0)], atol=1e-12)
        assert np.allclose(gaps, gap, atol=1e-12)


def test_edges_of_boxes_that_cross_push_perpendicular_to_both():
    a, b = Box((0.14, 2.0, 0.25)), Box((0.4, 2.0, 1.0))
    orientation = np.array((0.616822, -0.229339, -0.506747, 0.556903))
    normal, _, _, gaps, _ = collide(a, b, (-0.74656, -0.49656, -0.00344), orientation / np.linalg.norm(orientation))
    difference = corners(a)[:, None] - (corners(b) @ Rotation.from_quat(orientation, scalar_first=True).as_matrix().T)
    least = np.min(-(difference @ normal)) + normal @ (-0.74656, -0.49656, -0.00344)
    assert abs(gaps.min() - least) < 1e-9


def swapped(feature):
    """The same features when the shapes change places: vertices of a follow those of b, then come pairs of edges."""
    if feature < 256:
        return (feature + 128) % 256
    return 256 + 512 * ((feature - 256) % 512) + (feature - 256) // 512


@settings(UNHURRIED, max_examples=60)
@given(st.one_of(st.tuples(boxes, boxes), st.tuples(hulls, hulls)), quaternion, vector)
def test_the_same_contact_seen_from_the_other_shape(pair, orientation, position):
    a, b = pair
    there = Rotation.from_quat(orientation, scalar_first=True)
    back = there.inv()
    gaps = collide(a, b, np.array(position), orientation).gaps
    gaps_too = collide(b, a, -back.apply(position), back.as_quat(scalar_first=True)).gaps
    assert (len(gaps) > 0) == (len(gaps_too) > 0)
    if len(gaps):
        tolerance = 2.0 * (0.05 * abs(gaps.min()) + tolerance_of(a, b, MARGIN)) + 1e-9
        assert abs(gaps.min() - gaps_too.min()) <= tolerance


@pytest.mark.parametrize("angle", [0.1, 0.4, 0.7])
@pytest.mark.parametrize("make", [Box, lambda size: Hull(SIGNS * np.array(size) / 2.0)])
def test_features_are_the_same_whichever_face_clips(make, angle):
    a, b = make((1.0, 1.2, 1.0)), make((1.1, 0.8, 1.0))
    there = Rotation.from_euler("z", angle)
    way = np.array([0.13, 0.21, 0.998])
    normal, on_a, _, _, features = collide(a, b, way, there.as_quat(scalar_first=True))
    other, _, on_a_too, _, features_too = collide(b, a, -there.inv().apply(way), there.inv().as_quat(scalar_first=True))
    assert np.allclose(there.apply(other), -normal, atol=1e-12)
    places = dict(zip(features, on_a[:, :2], strict=True))
    for feature, point in zip(features_too, there.apply(on_a_too) + way, strict=True):
        if swapped(feature) in places:
            assert np.allclose(places[swapped(feature)], point[:2], atol=1e-9)
    assert len({swapped(feature) for feature in features_too} & set(features)) >= 3


@pytest.mark.parametrize("plank", [(0.6, 3.0, 0.1), (0.6, 0.8, 0.1)], ids=["across", "within"])
@pytest.mark.parametrize("make", [Box, lambda size: Hull(SIGNS * np.array(size) / 2.0)], ids=["boxes", "hulls"])
def test_features_are_the_same_when_the_second_shape_clips(make, plank):
    base, upper = make((1.0, 1.0, 1.0)), make(plank)
    tilted = Rotation.from_euler("y", 0.2)
    lowest = (corners(upper) @ tilted.as_matrix().T)[:, 2].min()
    way = np.array([0.1, 0.05, 0.499 - lowest])
    normal, on_a, _, gaps, features = collide(base, upper, way, tilted.as_quat(scalar_first=True))
    back = tilted.inv()
    other, _, on_base, gaps_too, features_too = collide(upper, base, -back.apply(way), back.as_quat(scalar_first=True))
    assert np.allclose(normal, (0.0, 0.0, 1.0))
    assert np.allclose(tilted.apply(other), -normal, atol=1e-12)
    assert np.allclose(gaps, -0.001, atol=1e-12)
    assert np.allclose(gaps_too, -0.001, atol=1e-12)
    assert len(features) == 2
    there = dict(zip(features, on_a, strict=True))
    for feature, point in zip(features_too, tilted.apply(on_base) + way, strict=True):
        assert np.allclose(there[swapped(feature)], point, atol=1e-9)
    assert ((features >= 256) == (plank[1] > 1.0)).all()


@settings(UNHURRIED, max_examples=60)
@given(boxes, boxes, quaternion, vector)
def test_boxes_touch_as_their_hulls_do(a, b, orientation, position):
    one = collide(a, b, np.array(position), orientation)
    for first, second in ((a, Hull(corners(b))), (Hull(corners(a)), Hull(corners(b)))):
        two = collide(first, second, np.array(position), orientation)
        assert (len(one.gaps) > 0) == (len(two.gaps) > 0)
        if len(one.gaps):
            off = 2.0 * (0.05 * abs(one.gaps.min()) + tolerance_of(a, b, MARGIN)) + 1e-9
            assert abs(one.gaps.min() - two.gaps.min()) <= off


@settings(UNHURRIED, max_examples=30)
@given(boxes, boxes, quaternion, vector, st.sampled_from((-10, 10)))
def test_contacts_of_boxes_scale_with_them(a, b, orientation, position, power):
    scale = 2.0**power
    small = collide(a, b, np.array(position), orientation)
    large = [Box(scale * np.array(shape.size)) for shape in (a, b)]
    same = collide(*large, scale * np.array(position), orientation, scale * MARGIN)
    assert (same.normal == small.normal).all()
    assert (same.on_a == scale * small.on_a).all()
    assert (same.features == small.features).all()


@settings(UNHURRIED, max_examples=60)
@given(st.one_of(boxes, hulls), quaternion, st.floats(-0.05, 0.03))
def test_on_a_plane_lie_the_lowest_corners(shape, orientation, gap):
    assume(abs(gap - MARGIN) > 1e-12)  # where rounding decides
    placed = corners(shape) @ rotation_matrix(orientation).T
    height = gap - placed[:, 2].min()
    normal, on_a, on_b, gaps, features = collide(None, shape, (0.3, 0.2, height), orientation)
    assert (len(gaps) > 0) == (gap <= MARGIN)
    if len(gaps):
        assert (normal == (0.0, 0.0, 1.0)).all()
        assert gaps.min() == pytest.approx(gap, abs=1e-9 + tolerance_of(shape, shape, MARGIN) * (len(gaps) == 4))
        assert (gaps <= MARGIN).all()
        assert np.allclose(on_a[:, 2], 0.0, atol=1e-12)
        apart = np.linalg.norm(on_b[:, None] - placed - np.array((0.3, 0.2, height)), axis=2).min(axis=1)
        assert (apart < 1e-9).all()
        assert len(set(features)) == len(features)


@pytest.mark.parametrize("sides", [3, 4, 7, 40])
def test_a_prism_stands_on_four_corners_far_from_each_other(sides):
    angles = 2.0 * np.pi * np.arange(sides) / sides
    rim = np.column_stack((np.cos(angles), np.sin(angles)))
    prism = Hull([(x, y, z) for x, y in rim for z in (-0.5, 0.5)])
    for a, height in ((None, 0.499), (Box((4, 4, 1)), 0.999), (Hull(SIGNS * (2, 2, 0.5)), 0.999)):
        _, on_a, _, gaps, features = collide(a, prism, (0.0, 0.0, height), turn((0, 0, 1), 0.3))
        assert np.allclose(gaps, -0.001, atol=1e-12)
        assert len(set(features)) == min(sides, 4)
        assert ConvexHull(on_a[:, :2]).volume > (1.29 if sides == 3 else 1.7)


def test_a_plank_over_an_edge_touches_within_the_edge():
    _, on_a, _, gaps, _ = collide(Box((1, 1, 1)), Box((2, 0.4, 0.1)), (0.6, 0.0, 0.549), UPRIGHT)
    assert np.allclose(gaps, -0.001, atol=1e-12)
    assert np.allclose(np.sort(on_a[:, 0]), (-0.4, -0.4, 0.5, 0.5), atol=1e-3)


def test_shapes_inside_each_other_leave_by_the_shortest_way():
    for a, b in ((Box((2, 2, 2)), Box((1, 1, 1))), (Box((1, 1, 1)), Box((1, 1, 1)))):
        normal, _, _, gaps, _ = collide(a, b, (0.0, 0.1, 0.3), UPRIGHT)
        assert np.allclose(normal, (0.0, 0.0, 1.0))
        assert gaps.min() == pytest.approx(0.3 - (a.size[2] + b.size[2]) / 2.0)
    assert len(collide(Box((1, 1, 1)), Box((1, 1, 1)), (0.0, 0.0, 0.0), UPRIGHT).gaps) == 4


def test_no_margin_means_touching():
    box = Box((1, 1, 1))
    assert len(collide(box, box, (0.0, 0.0, 1.0 + 1e-9), UPRIGHT, 0.0).gaps) == 0
    assert len(collide(box, box, (0.0, 0.0, 1.0 - 1e-9), UPRIGHT, 0.0).gaps) == 4


def test_depth_agrees_with_mujoco():
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><body mocap="true"><geom type="box" size=".5 .4 .3"/></body>
        <body><freejoint/><geom type="box" size=".3 .5 .4"/></body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    random = np.random.default_rng(3)
    a, b = Box((1.0, 0.8, 0.6)), Box((0.6, 1.0, 0.8))
    compared = 0
    while compared < 30:
        orientation = random.normal(size=4)
        orientation /= np.linalg.norm(orientation)
        position = random.uniform(-0.9, 0.9, 3)
        _, _, _, gaps, _ = collide(a, b, position, orientation, 1.0)
        data.qpos[:] = (*position, *orientation)
        mujoco.mj_forward(model, data)
        theirs = mujoco.mj_geomDistance(model, data, 0, 1, 1.0, None)
        if len(gaps):
            assert gaps.min() == pytest.approx(theirs, abs=0.06 * abs(theirs) + 0.003)
            compared += 1


@pytest.mark.parametrize("floor", [None, Box((4, 4, 1)), Hull(SIGNS * (2, 2, 0.5))])
def test_the_corner_on_which_a_rocking_body_lands_next_is_a_contact_point(floor):
    tip = (0.6, 0.0, 0.03)  # beside the triangle below, whose neighbour on this side rises by 0.05 rad
    body = Hull([(0, -0.5, 0), (0, 0.5, 0), (-0.5, 0, 0), tip, (0, 0, 1)])
    _, _, on_b, _, _ = collide(floor, body, (0.0, 0.0, 0.0 if floor is None else 0.5), UPRIGHT, margin=0.1)
    assert len(on_b) == 4
    assert np.abs(on_b[:, 0] - 0.6).min() < 1e-12
    steep = Hull([(0, -0.5, 0), (0, 0.5, 0), (-0.5, 0, 0), (0.6, 0.0, 0.09), (0, 0, 1)])  # 0.15 rad
    _, _, on_b, _, _ = collide(floor, steep, (0.0, 0.0, 0.0 if floor is None else 0.5), UPRIGHT, margin=0.1)
    assert len(on_b) == 3


def leaning_prism(world, sides, share, yaw):
    """Add a prism of 0.3 m whose centre of mass is above a share of the inradius of its base, and return its body."""
    angles = yaw + 2 * np.pi * np.arange(sides) / sides
    base = 0.3 * np.column_stack([np.cos(angles), np.sin(angles)])
    lean = 2 * share * 0.3 * np.cos(np.pi / sides)
    top = np.column_stack([base + np.array([lean, 0.0]), np.full(sides, 0.6)])
    return world.add_hull(np.vstack([np.column_stack([base, np.zeros(sides)]), top]), mass=1.0, position=(0, 0, 0))


@pytest.mark.parametrize("ground", ["plane", "box", "cylinder"])
@pytest.mark.parametrize(("sides", "share"), [(6, 0.75), (6, 0.9), (8, 0.9), (12, 0.75), (12, 0.9)])
def test_a_prism_that_leans_stands_while_its_centre_of_mass_is_above_its_base(sides, share, ground):
    for yaw in np.linspace(0.0, 2 * np.pi / sides, 5, endpoint=False):
        world = World()
        if ground == "plane":
            world.add_plane(friction=0.6)
        elif ground == "box":
            world.add_box((4, 4, 1), position=(0, 0, -0.5), static=True, friction=0.6)
        else:
            world.add_cylinder(2.0, 1.0, position=(0, 0, -0.5), static=True, friction=0.6)
        prism = leaning_prism(world, sides, share, yaw)
        before = prism.position.copy()
        world.advance(1 / 60, 300)
        assert np.abs(prism.velocity).max() < 1e-6
        assert np.abs(prism.position - before).max() < 0.01


@pytest.mark.parametrize(("sides", "share"), [(6, 0.75), (6, 0.9), (12, 0.75), (12, 0.9)])
def test_an_upright_prism_stands_on_a_slope_while_its_weight_acts_on_its_base(sides, share):
    for yaw in np.linspace(0.0, 2 * np.pi / sides, 5, endpoint=False):
        slope = share * 0.3 * np.cos(np.pi / sides) / 0.3  # of 0.6 m, with the centre of mass in the middle
        world = World(gravity=9.81 * np.array([slope, 0.0, -1.0]) / np.hypot(slope, 1.0))
        world.add_plane(friction=1.5)
        angles = yaw + 2 * np.pi * np.arange(sides) / sides
        base = 0.3 * np.column_stack([np.cos(angles), np.sin(angles)])
        ends = [np.column_stack([base, np.full(sides, height)]) for height in (0.0, 0.6)]
        prism = world.add_hull(np.vstack(ends), mass=1.0, friction=1.5)
        before = prism.position.copy()
        world.advance(1 / 60, 300)
        assert np.abs(prism.velocity).max() < 1e-6
        assert np.abs(prism.position - before).max() < 0.02


@pytest.mark.parametrize(("sides", "share"), [(6, 1.05), (12, 1.05)])
def test_a_prism_that_leans_too_far_falls(sides, share):
    world = World()
    world.add_plane(friction=0.6)
    prism = leaning_prism(world, sides, share, np.pi / sides)
    world.advance(1 / 60, 120)
    assert abs(prism.orientation[0]) < 0.97  # 28 degrees and more

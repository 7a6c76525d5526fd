"""Round shapes on triangles: the nearest points from the front, nothing from behind, and floors without bumps."""

import numpy as np
import pytest
from colliding import count_contacts
from hypothesis import given, settings
from hypothesis import strategies as st

from kickdrift.world.shapes.kind_numbers import CAPSULE, CONE, CYLINDER, SPHERE, TRIANGLE
from kickdrift.world.shapes.mass_properties import rotation_matrix

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
LYING = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)  # z turned into x
BALL, ROD = np.array([0.1]), np.array([0.1, 0.4])


def collide(kind, triangle, b, pose, margin=0.02):
    """Find the normal, the points on both shapes in the triangle's frame, and the features."""
    manifold = np.full(64, 7.0)
    pose = np.asarray(pose, dtype=float)
    count = count_contacts((TRIANGLE, kind), np.asarray(triangle, float), b, pose, margin, manifold)
    rows = manifold[8:40].reshape(4, 8)
    assert (rows[:, 7] == 7.0).all()
    assert (rows[count:] == 7.0).all()
    on_b = rows[:count, 3:6] @ rotation_matrix(pose[3:]).T + pose[:3]
    return manifold[:3].copy(), rows[:count, :3].copy(), on_b, rows[:count, 6].tolist()


def core(kind, b, pose):
    ends = np.zeros((1, 3)) if kind == SPHERE else np.array([[0.0, 0.0, -b[1]], [0.0, 0.0, b[1]]])
    return ends @ rotation_matrix(pose[3:]).T + pose[:3]


def triangle(corners, convex=(1.0, 1.0, 1.0)):
    return np.concatenate((np.ravel(corners), convex))


def shares(corners, point):
    """Barycentric coordinates of a point in the plane of a triangle, and how far it is out of it."""
    matrix = np.vstack((np.transpose(corners), np.ones(3)))
    found, *_ = np.linalg.lstsq(matrix, np.append(point, 1.0))
    return found, np.linalg.norm(matrix @ found - np.append(point, 1.0))


unit = st.floats(-1.0, 1.0)
sizes = st.floats(-2.0, 2.0).map(lambda x: 10.0**x)
quaternions = st.tuples(unit, unit, unit, unit).filter(lambda q: np.linalg.norm(q) > 1e-3)


@pytest.mark.parametrize("kind", [SPHERE, CAPSULE])
@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_from_the_front_the_points_are_the_nearest_ones(kind, data):
    corners = np.array(data.draw(st.tuples(*[st.tuples(unit, unit, unit)] * 3)))
    across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    if np.linalg.norm(across) < 1e-2:
        return
    up = across / np.linalg.norm(across)
    b = np.array(data.draw(st.tuples(*[sizes] * (1 if kind == SPHERE else 2))))
    where = np.array(data.draw(st.tuples(unit, unit, unit))) + corners[0]
    q = np.array(data.draw(quaternions))
    pose = np.concatenate((where, q / np.linalg.norm(q)))
    normal, on_a, on_b, features = collide(kind, triangle(corners), b, pose, 1e9)
    ends = core(kind, b, pose)
    heights = (ends - corners[0]) @ up
    scale = 1.0 + b.sum()
    if not features:  # behind: either by its middle, or where another face would see it better
        middle = heights.mean()
        assert middle < 0.0 or heights.min() < 0.0 or kind == CAPSULE
        return
    assert abs(np.linalg.norm(normal) - 1.0) < 1e-12
    assert normal @ up >= -0.01
    separations = (on_b - on_a) @ normal
    k = separations.argmin()
    if heights.min() >= 0.0:
        bound = (ends @ normal).min() - (corners @ normal).max()
        assert abs(separations[k] + b[0] - bound) < 1e-9 * scale
        parts, off = shares(corners, on_a[k])
        assert off < 1e-9 * scale
        assert parts.min() > -1e-7 * scale
        if len(features) == 1:
            assert np.linalg.norm(on_b[k] - on_a[k] - separations[k] * normal) < 1e-9 * scale
    if heights.min() < -1e-9 and abs(normal @ up - 1.0) < 1e-12:  # sunk in: pushed out by what is under the face
        assert separations[k] <= heights.max() - b[0] + 1e-9 * scale


@pytest.mark.parametrize("height", [-0.06, -0.2, -3.0])
def test_nothing_is_felt_from_behind(height):
    floor = triangle([(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (0.0, 9.0, 0.0)])
    for kind, b, turn in ((SPHERE, BALL, UPRIGHT), (CAPSULE, ROD, LYING)):
        assert not collide(kind, floor, b, (0.0, 0.0, height, *turn))[3]
        assert not collide(kind, floor, b, (0.0, -9.05, height, *turn))[3]
    assert not collide(CAPSULE, floor, ROD, (0.0, 0.0, min(height, -0.6), *UPRIGHT))[3]


@pytest.mark.parametrize("height", [-0.04, -1e-9, 0.0])
def test_what_has_sunk_in_a_little_is_pushed_out(height):
    floor = triangle([(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (0.0, 9.0, 0.0)])
    for kind, b, turn in ((SPHERE, BALL, UPRIGHT), (CAPSULE, ROD, LYING)):
        normal, on_a, on_b, features = collide(kind, floor, b, (0.0, 0.0, height, *turn))
        assert np.allclose(normal, (0.0, 0.0, 1.0))
        assert np.allclose((on_b - on_a) @ normal, height - 0.1)
        assert features == ([0.0] if kind == SPHERE else [0.0, 1.0])


def test_a_rod_through_the_floor_is_pushed_out_by_its_lower_end():
    floor = triangle([(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (0.0, 9.0, 0.0)])
    normal, on_a, on_b, features = collide(CAPSULE, floor, ROD, (0.0, 0.0, 0.1, *UPRIGHT))
    assert np.allclose(normal, (0.0, 0.0, 1.0))
    assert np.allclose((on_b - on_a) @ normal, -0.3 - 0.1)
    assert features == [0.0]


def floor(bend=0.0):
    """Four triangles about a middle corner, folded along the x axis: up by `bend` on both sides, or flat."""
    middle = (0.0, 0.0, 0.0)
    around = [(-1.0, -1.0, bend), (1.0, -1.0, bend), (1.0, 1.0, bend), (-1.0, 1.0, bend)]
    return [triangle([middle, around[k], around[(k + 1) % 4]], (0.0, 1.0, 0.0)) for k in range(4)]


@settings(max_examples=200, deadline=None)
@given(x=st.floats(-0.45, 0.45), y=st.floats(-0.45, 0.45), z=st.floats(0.06, 0.119), angle=st.floats(0.0, 3.2))
def test_a_flat_floor_of_triangles_has_no_edges(x, y, z, angle):
    for kind, b in ((SPHERE, BALL), (CAPSULE, ROD)):
        turn = rotated(angle)
        found = [collide(kind, face, b, (x, y, z, *turn)) for face in floor()]
        assert any(features for *_, features in found)
        for normal, on_a, on_b, features in found:
            if features:
                assert np.allclose(normal, (0.0, 0.0, 1.0), atol=1e-12)
                assert np.allclose((on_b - on_a) @ normal, z - 0.1, atol=1e-12)
                assert np.allclose(on_a[:, :2], on_b[:, :2], atol=1e-12)  # nothing that would make it roll
        touched = np.concatenate([on_a for _, on_a, _, features in found if features])
        if kind == CAPSULE:  # the floor bears both ends
            axis = rotation_matrix(turn) @ (0.0, 0.0, 1.0)
            along = (touched - (x, y, 0.0)) @ axis
            assert np.allclose((along.min(), along.max()), (-0.4, 0.4), atol=1e-12)


def rotated(angle):
    """Orientation of a capsule that lies on the floor, by the angle of its axis to the x axis."""
    half = 0.5 * angle
    return np.array([np.cos(half), 0.0, np.cos(half), 0.0]) * np.sqrt(0.5) + np.sqrt(0.5) * np.array(
        [0.0, -np.sin(half), 0.0, np.sin(half)]
    )


@pytest.mark.parametrize("offset", [0.0, 1e-16, -1e-16, 1e-9, -1e-9, 1e-3, -1e-3])
def test_nothing_falls_between_two_triangles(offset):
    for z in (0.1, 0.02, -0.01):
        for kind, b in ((SPHERE, BALL), (CAPSULE, ROD)):
            turn = UPRIGHT if kind == SPHERE else LYING
            found = [collide(kind, face, b, (0.3 + offset, 0.3, z, *turn)) for face in floor()]
            assert any(features for *_, features in found)


@pytest.mark.parametrize("z", [0.1, 0.12, 1.0])
def test_nothing_falls_between_two_triangles_at_a_blunt_edge(z):
    """An edge that falls away by 4.9 degrees and does not count as convex."""
    drop = np.tan(np.radians(0.5 * 4.9))
    faces = [
        triangle([(-1.0, 0.0, -drop), (0.0, -5.0, 0.0), (0.0, 5.0, 0.0)], (1.0, 0.0, 1.0)),
        triangle([(1.0, 0.0, -drop), (0.0, 5.0, 0.0), (0.0, -5.0, 0.0)], (1.0, 0.0, 1.0)),
    ]
    for x in np.linspace(-0.1, 0.1, 41):
        for kind, b, turn in ((SPHERE, BALL, UPRIGHT), (CAPSULE, ROD, (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0))):
            found = [collide(kind, face, b, (x, 0.0, z, *turn), 1.0) for face in faces]
            depths = [((on_b - on_a) @ normal).min() for normal, on_a, on_b, features in found if features]
            assert min(depths) == pytest.approx(z - 0.1, abs=0.002 * z + 0.05 * abs(x))


def test_a_face_does_not_reach_far_over_its_edge():
    """Beyond an edge that is not convex there is another face, or, if that is narrow, perhaps a hole."""
    face = triangle([(0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)], (0.0, 1.0, 1.0))
    across = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
    for kind, b, turn in ((SPHERE, BALL, UPRIGHT), (CAPSULE, ROD, across)):
        assert collide(kind, face, b, (0.009, 0.0, 0.1, *turn))[3]
        assert not collide(kind, face, b, (0.011, 0.0, 0.1, *turn))[3]


def test_a_ridge_is_touched_on_its_edge():
    left = triangle([(-1.0, 0.0, -1.0), (0.0, -5.0, 0.0), (0.0, 5.0, 0.0)])
    right = triangle([(1.0, 0.0, -1.0), (0.0, 5.0, 0.0), (0.0, -5.0, 0.0)])
    for face in (left, right):
        normal, on_a, on_b, _ = collide(SPHERE, face, BALL, (0.01, 0.0, 0.09, *UPRIGHT))
        exact = np.array([0.01, 0.0, 0.09]) / np.hypot(0.01, 0.09)
        assert np.allclose(normal, exact)
        assert np.allclose(on_a, 0.0)
        assert np.allclose((on_b - on_a) @ normal, np.hypot(0.01, 0.09) - 0.1)
        lying_across = collide(CAPSULE, face, ROD, (0.01, 0.0, 0.09, *LYING))
        assert np.allclose(lying_across[0], (0.0, 0.0, 1.0))
        assert np.allclose(lying_across[1], 0.0)
        along = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
        normal, on_a, on_b, features = collide(CAPSULE, face, ROD, (0.01, 0.0, 0.09, *along))
        assert np.allclose(normal, exact)
        assert features == [0.0, 1.0]
        assert np.allclose(np.sort(on_a[:, 1]), (-0.4, 0.4))
        assert np.allclose((on_b - on_a) @ normal, np.hypot(0.01, 0.09) - 0.1)


@pytest.mark.parametrize("first", range(3))
def test_a_rod_longer_than_an_edge_touches_both_of_its_ends(first):
    """It is as near to the ends of the other two edges."""
    corners = np.roll([(0.0, -0.2, 0.0), (0.0, 0.2, 0.0), (-1.0, 0.0, -1.0)], first, axis=0)
    along = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
    normal, on_a, _, features = collide(CAPSULE, triangle(corners), ROD, (0.03, 0.0, 0.1, *along), 0.02)
    assert np.allclose(normal, np.array([0.03, 0.0, 0.1]) / np.hypot(0.03, 0.1))
    assert features == [0.0, 1.0]
    assert np.allclose(np.sort(on_a[:, 1]), (-0.2, 0.2))


def test_a_valley_is_touched_on_its_faces():
    left = triangle([(-1.0, 0.0, 1.0), (0.0, -5.0, 0.0), (0.0, 5.0, 0.0)], (1.0, 0.0, 1.0))
    right = triangle([(1.0, 0.0, 1.0), (0.0, 5.0, 0.0), (0.0, -5.0, 0.0)], (1.0, 0.0, 1.0))
    z = np.sqrt(2.0) * 0.1
    for face, side in ((left, 1.0), (right, -1.0)):
        for kind, b in ((SPHERE, BALL), (CAPSULE, ROD)):
            turn = UPRIGHT if kind == SPHERE else (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
            normal, on_a, on_b, _ = collide(kind, face, b, (0.0, 0.0, z, *turn))
            assert np.allclose(normal, np.array([side, 0.0, 1.0]) * np.sqrt(0.5))
            assert np.allclose((on_b - on_a) @ normal, 0.0, atol=1e-12)
        assert not collide(SPHERE, face, BALL, (side, 0.0, 1.0 + 0.141, *UPRIGHT), 0.0)[3]


def test_the_margin_counts():
    face = triangle([(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (0.0, 1.0, 0.0)])
    for kind, b, turn in ((SPHERE, BALL, UPRIGHT), (CAPSULE, ROD, LYING)):
        assert collide(kind, face, b, (0.0, 0.0, 0.1199, *turn))[3]
        assert not collide(kind, face, b, (0.0, 0.0, 0.1201, *turn))[3]
        assert not collide(kind, face, b, (0.0, -1.09, 0.09, *turn))[3]


def test_a_barrel_beside_a_triangle_and_behind_it_does_not_touch_it():
    corners = [(0.362, -1.213, -1.007), (0.083, 0.524, 0.774), (0.292, 0.876, -0.281)]
    manifold, barrel = np.zeros(64), np.array([0.898, 0.898, 1.108])
    pose = np.array([-0.1979, 0.0263, 1.5257, *LYING])  # 3 mm apart, and 0.8 m behind the plane at the other end
    assert count_contacts((TRIANGLE, CYLINDER), triangle(corners), barrel, pose, 0.02, manifold) == 0


def test_a_corner_that_is_deep_in_the_base_of_a_cone_pushes_it_out():
    corners = [(0.092, -0.06, 0.068), (-0.026, -0.055, -0.014), (0.086, -0.138, -0.036)]
    manifold, cone = np.zeros(64), np.array([0.299, 0.0, 0.134])
    pose = np.array([-0.1643, -0.1276, 0.157, *UPRIGHT])
    assert count_contacts((TRIANGLE, CONE), triangle(corners), cone, pose, 0.02, manifold) == 1
    assert manifold[:3] == pytest.approx((0.0, 0.0, 1.0))
    assert manifold[8:11] == pytest.approx(corners[0])
    assert manifold[13] == pytest.approx(-0.134)


def test_a_cone_that_rests_beside_a_triangle_is_not_pushed_by_its_far_corner():
    """The neighbour across an edge that is not convex carries it."""
    corners = [(-0.8, 0.8, -0.149936), (0.0, 1.6, 0.0), (-0.8, 1.6, 0.006284)]
    cone, manifold = np.array([0.082411, 0.0, 0.303595]), np.zeros(64)
    pose = np.array([-0.6634, 1.3268, -0.0055, -0.6809, 0.25581, -0.68596, 0.02002])
    pose[3:] /= np.linalg.norm(pose[3:])
    assert count_contacts((TRIANGLE, CONE), triangle(corners, (0.0, 1.0, 0.0)), cone, pose, 0.02, manifold) == 0


def test_the_tip_of_a_cone_above_a_triangle_is_found_while_its_base_is_nearer_to_another_one():
    """A cone that falls flat within a step passed the triangle under its tip."""
    cone, manifold = np.array([0.03926, 0.0, 0.44613]), np.zeros(64)
    pose = np.array([0.32159, 0.38864, 0.03341, 0.05164, 0.70994, 0.06718, -0.69914])
    pose[3:] /= np.linalg.norm(pose[3:])
    corners = [(0.0, 0.0, 0.0), (30.0, 30.0, 0.0), (0.0, 30.0, 0.0)]
    assert count_contacts((TRIANGLE, CONE), triangle(corners, (0.0, 0.0, 0.0)), cone, pose, 0.06, manifold) == 2
    assert manifold[:3] == pytest.approx((0.0, 0.0, 1.0), abs=1e-12)

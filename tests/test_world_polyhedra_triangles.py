"""Where boxes and hulls touch triangles: flat floors of many triangles are smooth, ridges and borders are not."""

import itertools
from typing import NamedTuple

import numpy as np
import pytest
from colliding import count_contacts
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.kind_numbers import BOX, HULL, TRIANGLE
from kickdrift.world.shapes.mass_properties import rotation_matrix
from kickdrift.world.shapes.mesh import Mesh

UNHURRIED = settings(deadline=None)  # the first example compiles
SIGNS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
MARGIN = 0.02
CUBE = Hull(SIGNS / 2.0)
ROCK = Hull(np.random.default_rng(5).normal(size=(20, 3)) / 3.0)
CORNERS = ((0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (0.0, 3.0, 0.0))


class Contact(NamedTuple):
    """In the frame of the triangle."""

    normal: np.ndarray
    on_a: np.ndarray
    on_b: np.ndarray
    gaps: np.ndarray


def collide(triangle, shape, position, orientation=UPRIGHT, margin=MARGIN):
    manifold = np.full(64, np.nan)
    pair = (TRIANGLE, HULL if isinstance(shape, Hull) else BOX)
    pose = np.concatenate((position, orientation))
    count = count_contacts(pair, np.asarray(triangle, dtype=float), shape.numbers, pose, margin, manifold)
    rows = manifold[8:40].reshape(4, 8)[:count]
    on_b = rows[:, 3:6] @ rotation_matrix(orientation).T + position
    assert len(set(rows[:, 6])) == count
    return Contact(manifold[:3], rows[:, :3], on_b, (on_b - rows[:, :3]) @ manifold[:3])


def corners(shape, orientation=UPRIGHT):
    own = shape.vertices if isinstance(shape, Hull) else SIGNS * shape.numbers
    return own @ rotation_matrix(orientation).T


def triangle_of(points, flags=(1.0, 1.0, 1.0)):
    return np.concatenate((np.ravel(points), flags))


def triangles(mesh):
    return mesh.numbers[1:].reshape(-1, 12)


def angles(*degrees):
    """Orientation by turns about x, y and then z."""
    return Rotation.from_euler("xyz", degrees, degrees=True).as_quat(scalar_first=True)


@pytest.mark.parametrize("shape", [Box((1.0, 0.6, 0.4)), CUBE, ROCK], ids=["box", "cube", "rock"])
@pytest.mark.parametrize("tilt", [0.0, 1e-7, 0.01, -0.5, 20.0])
def test_nothing_catches_on_a_flat_floor_of_triangles(shape, tilt):
    floor = triangles(HeightField(np.zeros((5, 5)), 0.5))
    for heading in (0.0, 45.0, 25.0):
        orientation = angles(tilt, 0.7 * tilt, heading)
        sunk = -0.005 - corners(shape, orientation)[:, 2].min()
        for step in range(8):
            position = np.array([0.9 + 0.023 * step, 0.95 + 0.011 * step, sunk])
            touched = [
                contact for contact in (collide(t, shape, position, orientation) for t in floor) if contact.gaps.size
            ]
            assert touched
            assert all(np.allclose(contact.normal, (0.0, 0.0, 1.0), atol=1e-12) for contact in touched)
            deepest = min(contact.gaps.min() for contact in touched)
            assert -0.005 - 1e-9 <= deepest <= -0.005 + 0.0025


def test_a_mesh_of_two_triangles_bears_a_box_like_a_plane_does():
    square = Mesh([(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [(0, 1, 2), (0, 2, 3)])
    box = Box((1.0, 1.0, 1.0))
    contacts = [collide(triangle, box, (0.0, 0.0, 0.499)) for triangle in triangles(square)]
    points = np.concatenate([contact.on_a for contact in contacts])
    for corner in itertools.product((-0.5, 0.5), (-0.5, 0.5)):
        assert np.abs(points - (*corner, 0.0)).max(axis=1).min() < 1e-12


def ridge(slope):
    """A roof whose ridge is the y axis, from -1 to 1."""
    return Mesh([(0, -1, 0), (0, 1, 0), (3, 0, -3 * slope), (-3, 0, -3 * slope)], [(0, 2, 1), (0, 1, 3)])


def test_a_box_lies_on_a_ridge_along_two_points():
    for shape in (Box((1.0, 1.0, 1.0)), CUBE):
        for triangle in triangles(ridge(0.5)):
            contact = collide(triangle, shape, (0.1, 0.2, 0.497))
            assert np.allclose(contact.normal, (0.0, 0.0, 1.0), atol=1e-12)
            touching = contact.on_a[contact.gaps < 0.0]
            assert np.allclose(np.sort(touching[:, 1]), (-0.3, 0.7), atol=1e-6)
            assert np.allclose(touching[:, (0, 2)], 0.0, atol=1e-12)


def test_blunt_ridges_push_along_the_triangles():
    for triangle in triangles(ridge(0.02)):
        contact = collide(triangle, Box((1.0, 1.0, 1.0)), (0.1, 0.2, 0.497))
        assert abs(contact.normal[0]) == pytest.approx(0.02 / np.hypot(1.0, 0.02))


@pytest.mark.parametrize("heading", [0.0, 45.0, 20.0])
@pytest.mark.parametrize("lean", [-1e-6, 0.0, 1e-6, 1.0, -1.0])
def test_borders_push_aside_what_hangs_over_them(heading, lean):
    orientation = angles(0.0, lean, heading)
    box = Box((1.0, 1.0, 1.0))
    edge = (0.0, -1.0, 0.0)  # outwards, of the side of the triangle along x
    reach = (corners(box, orientation) @ edge).min()
    position = np.array([1.0, reach + 0.004, 0.3])
    contact = collide(triangle_of(CORNERS), box, position, orientation)
    assert contact.gaps.size
    assert contact.normal @ edge > 0.99
    assert abs(lean) == 1.0 or contact.gaps.min() == pytest.approx(-0.004, abs=1e-5)
    inner = collide(triangle_of(CORNERS, (0.0, 1.0, 1.0)), box, position, orientation)
    assert inner.gaps.size == 0 or np.allclose(inner.normal, (0.0, 0.0, 1.0), atol=1e-12)
    apart = collide(triangle_of(CORNERS), box, position - (0.0, 0.012, 0.0), orientation)
    assert apart.gaps.size
    assert (apart.gaps > 0.0).all()


def test_what_is_behind_does_not_touch():
    for shape in (Box((0.4, 0.4, 0.4)), CUBE):
        for height in (-0.1, -0.02, -0.011):
            assert collide(triangle_of(CORNERS), shape, (0.8, 0.8, height)).gaps.size == 0
        assert collide(triangle_of(CORNERS), shape, (0.8, 0.8, 0.1)).normal[2] == 1.0
    plate = Box((1.0, 1.0, 0.001))
    sunk = collide(triangle_of(CORNERS), plate, (0.8, 0.8, -0.005))
    assert (sunk.normal == (0.0, 0.0, 1.0)).all()
    assert np.allclose(sunk.gaps, -0.0055, atol=1e-12)


def distance(a, b):
    """Of the hulls of two sets of points, and the direction, by non-negative least squares."""
    weight = 1e3 * max(np.ptp(a), np.ptp(b))
    rows = np.zeros((5, len(a) + len(b)))
    rows[:3] = np.concatenate((a, -b)).T
    rows[3, : len(a)], rows[4, len(a) :] = weight, weight
    shares, _ = nnls(rows, np.array([0.0, 0.0, 0.0, weight, weight]), maxiter=1000)
    one, two = shares[: len(a)], shares[len(a) :]
    way = two @ b / two.sum() - one @ a / one.sum()
    return float(np.linalg.norm(way)), way


coordinate = st.floats(-1.0, 1.0)
quaternion = (
    st.tuples(coordinate, coordinate, coordinate, coordinate)
    .filter(lambda q: np.dot(q, q) > 0.01)
    .map(lambda q: np.array(q) / np.linalg.norm(q))
)
points = st.tuples(st.floats(-2.0, 3.0), st.floats(-2.0, 3.0), st.floats(-0.2, 1.0)).map(np.array)


@settings(UNHURRIED, max_examples=150)
@given(st.sampled_from((Box((1.0, 0.6, 0.4)), CUBE, ROCK)), points, quaternion)
def test_contacts_are_as_far_as_the_nearest_points(shape, position, orientation):
    contact = collide(triangle_of(CORNERS), shape, position, orientation)
    placed = corners(shape, orientation) + position
    apart, way = distance(np.array(CORNERS), placed)
    assert (contact.gaps <= MARGIN + 1e-9).all()
    if apart > 1e-5:
        if contact.gaps.size:
            assert np.allclose(contact.on_b - contact.on_a, contact.gaps[:, None] * contact.normal, atol=1e-9)
            assert contact.gaps.min() >= apart - 0.0025 - 1e-6
        elif way[2] > -0.2 * apart and position[2] > 0.0:
            assert apart >= MARGIN - 1e-6
    elif contact.gaps.size:
        assert contact.normal[2] > -0.26
        inside = np.abs(contact.on_a[:, 2]).max() < 1e-9 and contact.on_a[:, :2].min() > -1e-2
        assert inside
        assert contact.on_a.sum(axis=1).max() < 3.0 + 1e-2


@settings(UNHURRIED, max_examples=60)
@given(st.sampled_from((Box((1.0, 0.6, 0.4)), CUBE, ROCK)), points, quaternion)
def test_smooth_triangles_push_along_their_normal_only(shape, position, orientation):
    contact = collide(triangle_of(CORNERS, (0.0, 0.0, 0.0)), shape, position, orientation)
    assert contact.gaps.size == 0 or np.allclose(contact.normal, (0.0, 0.0, 1.0), atol=1e-12)

"""Boxes, hulls, meshes and height fields: what they weigh, how they are laid out, and what they refuse."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.kind_numbers import BOX, HEIGHT_FIELD, HULL, MESH
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.polyhedron import (
    CENTRE,
    EDGES,
    EDGES_AT,
    FACES,
    HEADER,
    LOOP_EDGES_AT,
    LOOP_VERTICES_AT,
    LOOPS_AT,
    PLANES_AT,
    THICKNESS,
    VERTICES,
)

SIGNS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
CUBE_FACES = [
    (0, 1, 3),
    (0, 3, 2),
    (4, 7, 5),
    (4, 6, 7),
    (0, 5, 1),
    (0, 4, 5),
    (2, 3, 7),
    (2, 7, 6),
    (0, 2, 6),
    (0, 6, 4),
]
CUBE_FACES += [(1, 5, 7), (1, 7, 3)]


def cloud(seed, count=40):
    return np.random.default_rng(seed).normal(size=(count, 3)) * (1.0, 0.6, 0.3)


def wheel(sides, length=1.0):
    angles = 2.0 * np.pi * np.arange(sides) / sides
    return np.array([(np.cos(t), np.sin(t), z) for t in angles for z in (-length / 2.0, length / 2.0)])


class Layout:
    """The numbers of a hull, taken apart."""

    def __init__(self, numbers):
        counts = numbers[[VERTICES, FACES, EDGES]].astype(int)
        self.vertices = numbers[HEADER : HEADER + 3 * counts[0]].reshape(-1, 3)
        self.planes = self.part(numbers, PLANES_AT, 4 * counts[1]).reshape(-1, 4)
        starts = self.part(numbers, LOOPS_AT, counts[1] + 1).astype(int)
        around = self.part(numbers, LOOP_VERTICES_AT, starts[-1]).astype(int)
        leaving = self.part(numbers, LOOP_EDGES_AT, starts[-1]).astype(int)
        self.loops = [around[i:j] for i, j in itertools.pairwise(starts)]
        self.loop_edges = [leaving[i:j] for i, j in itertools.pairwise(starts)]
        self.edges = self.part(numbers, EDGES_AT, 4 * counts[2]).astype(int).reshape(-1, 4)
        assert numbers.size == int(numbers[EDGES_AT]) + 4 * counts[2]

    @staticmethod
    def part(numbers, begin, size):
        return numbers[int(numbers[begin]) : int(numbers[begin]) + size]


def test_a_box_has_the_numbers_and_the_mass_of_the_textbook():
    box = Box((1.0, 2.0, 3.0))
    assert box.kind == BOX
    assert box.numbers.tolist() == [0.5, 1.0, 1.5]
    volume, centre, inertia = box.mass_properties()
    assert volume == 6.0
    assert (centre == 0.0).all()
    assert np.allclose(inertia, np.diag([6.5, 5.0, 2.5]))
    assert Box([1, 2, 3]) == box


@pytest.mark.parametrize("seed", range(3))
def test_hulls_weigh_what_random_points_inside_say(seed):
    hull = Hull(np.add(cloud(seed), (1.0, -2.0, 0.5)))
    volume, centre, inertia = hull.mass_properties()
    low, high = hull.vertices.min(axis=0), hull.vertices.max(axis=0)
    points = np.random.default_rng(9).uniform(low, high, (200_000, 3))
    equations = ConvexHull(hull.points).equations
    inside = points[(points @ equations[:, :3].T + equations[:, 3]).max(axis=1) <= 0.0]
    assert volume == pytest.approx(ConvexHull(hull.points).volume)
    assert volume == pytest.approx(np.prod(high - low) * len(inside) / len(points), rel=0.02)
    assert np.allclose(centre, inside.mean(axis=0), atol=0.01)
    arms = inside - inside.mean(axis=0)
    moments = volume * (np.mean(np.einsum("ni,ni->n", arms, arms)) * np.eye(3) - arms.T @ arms / len(arms))
    assert np.allclose(inertia, moments, atol=0.02 * np.trace(moments))


def test_the_hull_of_a_box_weighs_what_the_box_does_wherever_it_is():
    box, turn = Box((1.0, 2.0, 3.0)), Rotation.from_euler("xyz", (0.3, 0.5, -0.7)).as_matrix()
    volume, centre, inertia = Hull(SIGNS * box.numbers @ turn.T + (100.0, 0.0, -30.0)).mass_properties()
    assert volume == pytest.approx(6.0)
    assert np.allclose(centre, (100.0, 0.0, -30.0))
    assert np.allclose(inertia, turn @ box.mass_properties().inertia @ turn.T, atol=1e-9)


def test_a_tetrahedron_weighs_what_the_integrals_say():
    volume, centre, inertia = Hull([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]).mass_properties()
    assert volume == pytest.approx(1.0 / 6.0)
    assert np.allclose(centre, 0.25)
    assert np.allclose(inertia, np.where(np.eye(3) > 0, 1.0 / 80.0, 1.0 / 480.0))


@pytest.mark.parametrize(
    ("points", "vertices", "faces"),
    [
        (SIGNS, 8, 6),
        (np.concatenate((SIGNS, SIGNS / 2.0, np.eye(3), -np.eye(3), SIGNS * (1, 1, 0), SIGNS)), 8, 6),
        (SIGNS @ Rotation.from_euler("xyz", (0.3, 0.5, -0.7)).as_matrix().T * 1e-3, 8, 6),
        (SIGNS * 1e3 + 1e-5 * cloud(1, 8), 8, 6),
        (wheel(40), 80, 42),
        (wheel(64), 128, 66),
        (np.concatenate((np.eye(3), -np.eye(3))), 6, 8),
        (np.array(list(itertools.product(range(4), repeat=3))), 8, 6),
    ],
    ids=["cube", "crowded cube", "small turned cube", "large rough cube", "wheel", "round wheel", "octahedron", "grid"],
)
def test_facets_in_one_plane_are_one_face(points, vertices, faces):
    hull = Hull(points)
    assert len(hull.vertices) == vertices
    assert len(hull.faces) == faces


@settings(deadline=None, max_examples=40)
@given(st.integers(4, 60), st.integers(0, 1000), st.sampled_from((1e-3, 1.0, 1e3)), st.booleans())
def test_hulls_are_laid_out_as_closed_convex_polyhedra(count, seed, scale, rounded):
    points = cloud(seed, count)
    points = scale * (np.round(4.0 * points) / 4.0 if rounded and count > 20 else points)
    hull = Hull(points)
    layout = Layout(hull.numbers)
    rounding = 3e-6 * np.ptp(points, axis=0).max()
    assert len(layout.vertices) - len(layout.edges) + len(layout.planes) == 2
    assert np.allclose(np.linalg.norm(layout.planes[:, :3], axis=1), 1.0)
    assert (points @ layout.planes[:, :3].T <= layout.planes[:, 3] + rounding).all()
    assert (hull.numbers[CENTRE : CENTRE + 3] @ layout.planes[:, :3].T < layout.planes[:, 3]).all()
    heights = layout.planes[:, 3, None] - layout.planes[:, :3] @ layout.vertices.T
    assert hull.numbers[THICKNESS] == pytest.approx(heights.max(axis=1).min() / 2.0)
    for face, (loop, leaving) in enumerate(zip(layout.loops, layout.loop_edges, strict=True)):
        assert np.allclose(heights[face, loop], 0.0, atol=rounding)
        for k, number in enumerate(leaving):
            begin, end = loop[k], loop[(k + 1) % len(loop)]
            p, q, left, right = layout.edges[number]
            assert (begin, end, face) in ((p, q, left), (q, p, right))
            side = np.cross(layout.vertices[end] - layout.vertices[begin], layout.planes[face, :3])
            assert ((layout.vertices[loop] - layout.vertices[begin]) @ side <= rounding * np.linalg.norm(side)).all()


def test_a_mesh_lists_its_triangles_and_where_it_is_sharp():
    cube = Mesh(SIGNS, CUBE_FACES)
    assert cube.kind == MESH
    rows = cube.numbers[1:].reshape(-1, 12)
    assert cube.numbers[0] == len(rows) == 12
    assert (rows[:, :9].reshape(-1, 3, 3) == SIGNS[np.array(CUBE_FACES)]).all()
    corners = rows[:, :9].reshape(-1, 3, 3)
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    assert ((rows[:, 9:] == 1.0) == (lengths < 2.5)).all()  # diagonals of faces are flat
    inside_out = Mesh(SIGNS, np.array(CUBE_FACES)[:, ::-1])
    assert not inside_out.active_edges().any()
    soup = Mesh(corners.reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert (soup.active_edges() == cube.active_edges()).all()


@pytest.mark.parametrize(("degrees", "sharp"), [(-20.0, False), (0.0, False), (4.0, False), (6.0, True), (90.0, True)])
def test_edges_are_sharp_where_the_surface_bends_away_by_five_degrees(degrees, sharp):
    bend = np.radians(degrees)
    mesh = Mesh([(0, 0, 0), (0, 1, 0), (-1, 0, 0), (np.cos(bend), 0, -np.sin(bend))], [(0, 1, 2), (1, 0, 3)])
    assert mesh.active_edges().tolist() == [[sharp, True, True], [sharp, True, True]]


def test_a_height_field_is_two_triangles_a_cell_seen_from_above():
    field = HeightField([[0.0, 1.0, 2.0], [0.0, 0.0, 5.0]], (0.5, 2.0))
    assert field.kind == HEIGHT_FIELD
    rows = field.numbers[1:].reshape(-1, 12)
    corners = rows[:, :9].reshape(-1, 3, 3)
    assert len(rows) == 4
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.allclose(normals[:, 2], 1.0)  # twice the area seen from above
    assert {tuple(point) for point in corners.reshape(-1, 3)} == {
        (0.5 * i, 2.0 * j, field.heights[i, j]) for i in range(2) for j in range(3)
    }
    assert HeightField(np.zeros((2, 2)), 0.5).spacing == (0.5, 0.5)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Box((1.0, 2.0)), ["size", "(2,)", "three"]),
        (lambda: Box(1.0), ["size", "()"]),
        (lambda: Box((1.0, 0.0, 1.0)), ["size[1]=0", "positive"]),
        (lambda: Box((1.0, 1.0, -2.0)), ["size[2]=-2", "positive"]),
        (lambda: Box((np.nan, 1.0, 1.0)), ["size[0]=nan", "finite"]),
        (lambda: Box((np.inf, 1.0, 1.0)), ["size[0]=inf", "finite"]),
        (lambda: Box(("a", "b", "c")), ["size", "number"]),
        (lambda: Hull([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), ["3 rows", "four"]),
        (lambda: Hull([[0, 0], [1, 0], [0, 1], [1, 1]]), ["(4, 2)", "(N, 3)"]),
        (lambda: Hull(SIGNS * (1, 1, 0)), ["one plane", "smallest is 0 m"]),
        (lambda: Hull(cloud(0) * (1, 1, 1e-8)), ["one plane", "smallest"]),
        (lambda: Hull(np.ones((5, 3))), ["one plane", "0 m"]),
        (lambda: Hull(np.outer(range(9), (1, 2, 3))), ["one plane"]),
        (lambda: Hull(np.where(np.arange(24).reshape(8, 3) == 7, np.nan, SIGNS)), ["points[2]", "finite"]),
        (lambda: Hull(wheel(65)), ["130", "128", "fewer"]),
        (lambda: Mesh(SIGNS[:, :2], CUBE_FACES), ["vertices", "(8, 2)"]),
        (lambda: Mesh(SIGNS * np.inf, CUBE_FACES), ["vertices[0]", "finite"]),
        (lambda: Mesh(SIGNS, [(0, 1, 8)]), ["faces[0]=[0, 1, 8]", "there are 8"]),
        (lambda: Mesh(SIGNS, [(0, 1, 3), (-1, 0, 1)]), ["faces[1]", "without a vertex"]),
        (lambda: Mesh(SIGNS, [(0, 1)]), ["faces", "(1, 2)"]),
        (lambda: Mesh(SIGNS, np.zeros((0, 3), dtype=int)), ["faces", "(0, 3)"]),
        (lambda: Mesh(SIGNS, [(0.0, 1.0, 3.0)]), ["faces", "float64", "integers"]),
        (lambda: Mesh(SIGNS, [(0, 1, 1)]), ["faces[0]", "one line"]),
        (lambda: Mesh([(0, 0, 0), (1, 1, 1), (2, 2, 2)], [(0, 1, 2)]), ["faces[0]", "one line"]),
        (lambda: Mesh(SIGNS, [*CUBE_FACES[:-1], CUBE_FACES[-1][::-1]]), ["share an edge", "opposite", "reverse"]),
        (lambda: Mesh(SIGNS, CUBE_FACES).mass_properties(), ["mesh", "static"]),
        (lambda: HeightField(np.zeros((1, 5)), 1.0), ["heights", "(1, 5)"]),
        (lambda: HeightField(np.zeros(4), 1.0), ["heights", "(4,)"]),
        (lambda: HeightField([[0, 0], [np.nan, 0]], 1.0), ["heights[1, 0]=nan", "finite"]),
        (lambda: HeightField(np.zeros((2, 2)), 0.0), ["spacing=0", "positive"]),
        (lambda: HeightField(np.zeros((2, 2)), (1.0, 1.0, 1.0)), ["spacing", "(3,)"]),
        (lambda: HeightField(np.zeros((2, 2)), (1.0, np.nan)), ["spacing=nan"]),
        (lambda: HeightField(np.zeros((2, 2)), 1.0).mass_properties(), ["surface", "static"]),
    ],
)
def test_what_is_no_shape_is_an_error_that_says_why(make, words):
    with pytest.raises(ArgumentError) as caught:
        make()
    for word in words:
        assert word in str(caught.value)


def test_hulls_keep_what_they_are_given():
    points = cloud(4)
    hull = Hull(points)
    assert hull.kind == HULL
    assert (hull.points == points).all()
    assert hull.points is not points
    assert all(np.abs(points - vertex).sum(axis=1).min() < 1e-12 for vertex in hull.vertices)

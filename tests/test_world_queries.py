"""Rays and overlap queries against asking every shape."""

from types import SimpleNamespace

import numpy as np
import pytest
from colliding import count_contacts
from hypothesis import given, settings
from hypothesis import strategies as st
from stages import run_stage

from kickdrift.core.errors import ArgumentError, KickdriftError, LostBodyError
from kickdrift.world import tables as t
from kickdrift.world.bodies.part import Part
from kickdrift.world.collision.broad_phase.bvh import build, fit
from kickdrift.world.collision.broad_phase.pair_update import find_pairs
from kickdrift.world.collision.broad_phase.search_state import CHANGED, shapes_changed
from kickdrift.world.collision.queries.bvh_ray_cast import NOTHING, WALK, advance, reciprocal, start
from kickdrift.world.collision.queries.world_queries import overlap_box, overlap_sphere, ray_cast_many
from kickdrift.world.collision.shape_properties import describe_kinds, find_extents
from kickdrift.world.layout import BODY_KIND, BODY_ROW, DYNAMIC, IS_SENSOR, LAYER, RADIUS, SHAPE_KIND, STATIC
from kickdrift.world.query_api import SpatialQueries
from kickdrift.world.settings import GRAVITY, MARGIN
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.kind_numbers import BOX, CAPSULE, HULL, MESH, PLANE, SPHERE, TRIANGLE
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.polyhedron import HEADER, PLANES_AT
from kickdrift.world.shapes.shape_kinds import RAYS
from kickdrift.world.shapes.sphere import Sphere
from kickdrift.world.step.status import FULL, ROWS_WANTED, STATUS, TABLE
from kickdrift.world.world import World

ALL = (1 << 62) - 1


def reach(kind, numbers):
    """How far a shape reaches from its origin."""
    if kind == HULL:
        return np.linalg.norm(numbers[HEADER : int(numbers[PLANES_AT])].reshape(-1, 3), axis=1).max()
    return {SPHERE: np.sum, CAPSULE: np.sum, BOX: np.linalg.norm}.get(int(kind), lambda _: 0.0)(numbers)


class Scene(SpatialQueries):
    """Tables of a world that holds shapes and nothing else, each of a body of its own or of the ground."""

    def __init__(self, seed=0):
        self.tables, self.rng = t.Tables(), np.random.default_rng(seed)
        for table in (t.SETTINGS, t.STEP_STATUS, t.SEARCH):
            self.tables.resize(table, 1)
        describe_kinds(self.tables)
        find_extents(self.tables, [SPHERE, CAPSULE, BOX, HULL, MESH])
        self[t.SETTINGS][0, GRAVITY + 2], self[t.SETTINGS][0, MARGIN] = -9.81, 0.02
        self.body(STATIC, (0, 0, 0), (1, 0, 0, 0))
        self.bodies = SimpleNamespace(handle=lambda row: SimpleNamespace(index=row))

    def __getitem__(self, table):
        return self.tables.array(table)

    def body(self, kind, position, turn):
        row = len(self[t.POSE])
        for table in (t.POSE, t.MOTION, t.BODY, t.FORCE, t.PREDICTED, t.INVERSE_MASS):
            self.tables.resize(table, row + 1)
        self[t.POSE][row, :3], self[t.POSE][row, 3:7] = position, np.divide(turn, np.linalg.norm(turn))
        self[t.BODY][row, :2] = kind, kind != STATIC
        return row

    def add(self, kind, numbers, position=(0, 0, 0), turn=(1, 0, 0, 0), body=None, layer=0, sensor=0):
        """Add a shape; returns its row."""
        row, begin = len(self[t.SHAPE]), len(self[t.GEOMETRY])
        body = self.body(DYNAMIC, (0, 0, 0), (1, 0, 0, 0)) if body is None else body
        for table in (t.SHAPE, t.PLACE, t.BOUNDS):
            self.tables.resize(table, row + 1)
        self.tables.resize(t.GEOMETRY, begin + len(numbers))[begin:, 0] = numbers
        self[t.SHAPE][row] = kind, body, begin, len(numbers), 1 << layer, ALL, sensor, 0
        self[t.PLACE][row, :3], self[t.PLACE][row, 3:7] = position, np.divide(turn, np.linalg.norm(turn))
        self[t.PLACE][row, RADIUS] = reach(kind, np.asarray(numbers))
        shapes_changed(self.tables)
        return row

    def step(self):
        status = self[t.STEP_STATUS][0]
        run_stage(find_pairs, 1 / 60, self.tables)
        while status[STATUS] == FULL:
            place, wanted = int(status[TABLE]), int(status[ROWS_WANTED])
            status[:] = 0
            self.tables.make_room(place, wanted)
            run_stage(find_pairs, 1 / 60, self.tables)

    def pose(self, shape):
        """Frame of a shape in the world: origin and rotation matrix."""
        body, place = self[t.POSE][self[t.SHAPE][shape, BODY_ROW]], self[t.PLACE][shape]
        return body[:3] + matrix(body[3:7]) @ place[:3], matrix(body[3:7]) @ matrix(place[3:7])

    def numbers(self, shape):
        kind, _, begin, size = self[t.SHAPE][shape, :4]
        numbers = self[t.GEOMETRY][begin : begin + size, 0]
        return [(TRIANGLE, row) for row in numbers[1:].reshape(-1, 12)] if kind == MESH else [(int(kind), numbers)]


def matrix(q):
    w, x, y, z = q
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * k + 2 * k @ k


def crowded(seed, kinds=(SPHERE, CAPSULE, BOX, HULL), count=60):
    """Shapes of some kinds above a plane and a mesh."""
    scene = Scene(seed)
    rng = scene.rng
    scene.add(PLANE, [], (0, 0, -2), (1, 0.05, 0, 0), body=0)
    vertices = np.array([[x, y, -1 + 0.3 * rng.normal()] for x in (-2, -1, 0, 1, 2) for y in (-2, -1, 0, 1, 2)])
    faces = [f for a in range(19) if a % 5 < 4 for f in ((a, a + 5, a + 6), (a, a + 6, a + 1))]
    scene.add(MESH, Mesh(vertices, faces).numbers, (0.1, 0, 0), (1, 0, 0, 0.2), body=0)
    while len(scene[t.SHAPE]) < count:
        kind = int(rng.choice(kinds))
        size = 10 ** rng.uniform(-2, 0)
        width = {SPHERE: 1, CAPSULE: 2, BOX: 3}.get(kind)
        numbers = Hull(size * rng.normal(size=(8, 3))).numbers if width is None else size * rng.uniform(0.2, 1, width)
        place = size * rng.normal(size=3), rng.normal(size=4)
        body = scene.body(rng.choice([DYNAMIC, STATIC]), rng.uniform(-2, 2, 3), rng.normal(size=4))
        scene.add(kind, numbers, *place, body=body, layer=int(rng.integers(3)), sensor=int(rng.random() < 0.1))
    return scene


def met(scene, origin, direction, limit=np.inf, layers=ALL):
    """Distances and normals of what a ray meets, by shape, of all shapes."""
    hits = {}
    direction = np.asarray(direction) / np.linalg.norm(direction)
    for shape, row in enumerate(scene[t.SHAPE]):
        if row[SHAPE_KIND] < 0 or row[IS_SENSOR] or not row[LAYER] & layers:
            continue
        at, turn = scene.pose(shape)
        ray = tuple(map(float, turn.T @ (origin - at))), tuple(map(float, turn.T @ direction))
        found = [RAYS[kind](np.array(numbers), *ray, limit) for kind, numbers in scene.numbers(shape)]
        nearest = min(found)
        if nearest[0] < np.inf:
            hits[shape] = nearest[0], turn @ nearest[1:]
    return hits


def same(hit, expected):
    return abs(hit.distance - expected[0]) < 1e-9 and np.abs(hit.normal - expected[1]).max() < 1e-6


@pytest.mark.parametrize("stepped", [False, True])
def test_rays_meet_what_they_meet_when_every_shape_is_asked(stepped):
    scene = crowded(1)
    if stepped:
        scene.step()
        move = scene.rng.random(len(scene[t.POSE])) < 0.3
        move &= scene[t.BODY][:, BODY_KIND] == DYNAMIC
        scene[t.POSE][move, :3] += scene.rng.normal(size=(move.sum(), 3))
    origins, directions = scene.rng.uniform(-3, 3, (200, 3)), scene.rng.normal(size=(200, 3))
    directions[::10] = np.sign(directions[::10]) * [0, 0, 1]
    for k in range(1, 200, 2):
        directions[k] = scene.pose(2 + k % 58)[0] - origins[k]
    many = ray_cast_many(scene.tables, origins, directions)
    missed = 0
    for k, (origin, direction) in enumerate(zip(origins, directions, strict=True)):
        expected = met(scene, origin, direction)
        hit = scene.ray_cast(origin, direction)
        every = scene.ray_cast_all(origin, direction)
        assert [one.shape for one in every] == sorted(expected, key=lambda shape: expected[shape][0])
        assert all(same(one, expected[one.shape]) for one in every)
        if not expected:
            missed += 1
            assert hit is None
            assert (many.shape[k], many.body[k], many.distance[k]) == (-1, -1, np.inf)
            assert np.isnan(many.point[k]).all()
            continue
        assert hit.shape == every[0].shape == many.shape[k]
        assert hit.body.index == scene[t.SHAPE][hit.shape, BODY_ROW] == many.body[k]
        assert hit.distance == every[0].distance == many.distance[k]
        unit = direction / np.linalg.norm(direction)
        assert np.abs(hit.point - origin - hit.distance * unit).max() < 1e-12
        assert (hit.point == many.point[k]).all()
        assert (hit.normal == many.normal[k]).all()
    assert 10 < missed < 100


def test_limits_and_layers_leave_shapes_out():
    scene = crowded(2)
    origins, directions = scene.rng.uniform(-3, 3, (60, 3)), scene.rng.normal(size=(60, 3))
    for origin, direction in zip(origins, directions, strict=True):
        for limit, layers in ((1.0, None), (np.inf, [0, 2]), (2.0, [1]), (np.inf, [])):
            bits = ALL if layers is None else sum(1 << layer for layer in layers)
            expected = met(scene, origin, direction, limit, bits)
            every = scene.ray_cast_all(origin, direction, limit, layers)
            assert [one.shape for one in every] == sorted(expected, key=lambda shape: expected[shape][0])
            hit = scene.ray_cast(origin, direction, limit, layers)
            assert (hit is None) == (not expected)
            assert hit is None or hit.shape == every[0].shape


def test_of_shapes_at_the_same_distance_the_lowest_is_met():
    scene = Scene()
    for _ in range(30):
        scene.add(BOX, [0.5, 0.5, 0.5])
    for _ in range(2):
        assert scene.ray_cast((3, 0.1, 0.2), (-1, 0, 0)).shape == 0
        scene.step()


def test_a_flat_mesh_has_no_gaps():
    scene = Scene()
    vertices = [[x, y, 0.0] for x in range(9) for y in range(9)]
    faces = [f for a in range(71) if a % 9 < 8 for f in ((a, a + 9, a + 10), (a, a + 10, a + 1))]
    scene.add(MESH, Mesh(vertices, faces).numbers, body=0)
    x, y = np.meshgrid(np.linspace(0, 8, 65), np.linspace(0, 8, 65))
    down = ray_cast_many(
        scene.tables, np.stack((x, y, np.ones_like(x)), axis=-1).reshape(-1, 3), np.tile((0, 0, -1), (65**2, 1))
    )
    assert (down.distance == 1.0).all()
    assert (down.normal == (0.0, 0.0, 1.0)).all()
    targets = np.stack((x, y, np.zeros_like(x)), axis=-1).reshape(-1, 3)[65 * 4 : -65 * 4]
    targets = targets[(targets[:, 0] > 0.1) & (targets[:, 0] < 7.9)]
    eye = np.array([3.1, -2.7, 4.9])
    seen = ray_cast_many(scene.tables, eye, targets - eye)
    assert np.abs(seen.point - targets).max() < 1e-12


def test_questions_leave_the_world_as_it_is():
    asked, silent = (crowded(3, (SPHERE, BOX)) for _ in range(2))
    for scene in (asked, silent):
        scene[t.MOTION][1:, :3] = scene.rng.normal(size=(len(scene[t.POSE]) - 1, 3))
    for step in range(8):
        asked.ray_cast((5, 0, 0), (-1, 0, 0))
        overlap_sphere(asked.tables, 1.0)
        for scene in (asked, silent):
            scene.step()
            scene[t.POSE][:, :3] += scene[t.MOTION][:, :3] / 60
            if step == 4:
                scene.add(BOX, [0.3, 0.4, 0.5])
        for table in (t.CONTACT, t.MANIFOLD, t.BOUNDS, t.SHAPE, t.SOUGHT):
            assert np.array_equal(asked[table], silent[table], equal_nan=True)


def test_shapes_are_found_before_the_first_step_and_after_they_are_gone():
    scene = Scene()
    ball = scene.add(SPHERE, [0.5])
    assert scene.ray_cast((3, 0, 0), (-2, 0, 0)).distance == 2.5
    built = scene[t.TREE].copy()
    scene[t.TREE][0, 0] -= 1e-3
    assert scene.ray_cast((3, 0, 0), (-2, 0, 0)).distance == 2.5
    assert scene[t.TREE][0, 0] != built[0, 0]  # the tree is not built for every question
    assert scene[t.SEARCH][0, CHANGED] != 0
    scene.step()
    wall = scene.add(BOX, [0.1, 1, 1], (1, 0, 0), body=0)
    assert scene.ray_cast((3, 0, 0), (-1, 0, 0)).shape == wall
    scene[t.SHAPE][wall] = 0
    scene[t.SHAPE][wall, SHAPE_KIND] = -1
    shapes_changed(scene.tables)
    assert scene.ray_cast((3, 0, 0), (-1, 0, 0)).shape == ball


def facing(triangle, point):
    """A triangle with its front towards a point, and active edges: without these, contacts are on one side of a mesh."""
    corners = np.reshape(triangle[:9], (3, 3))
    if np.cross(corners[1] - corners[0], corners[2] - corners[0]) @ (point - corners[0]) < 0.0:
        corners = corners[[0, 2, 1]]
    return np.concatenate((corners.ravel(), np.ones(3)))


def touches(scene, kind, numbers, position, turn):
    """Rows of the shapes that overlap one, of all shapes."""
    found = []
    for shape, row in enumerate(scene[t.SHAPE]):
        at, own = scene.pose(shape)
        for own_kind, own_numbers in scene.numbers(shape):
            if own_kind == TRIANGLE:
                own_numbers = facing(own_numbers, own.T @ (position - at))
            a, b = (own_kind, own, at, own_numbers), (kind, matrix(turn), position, numbers)
            a, b = (a, b) if own_kind <= kind else (b, a)
            relative = np.concatenate((a[1].T @ (b[2] - a[2]), quaternion(a[1].T @ b[1])))
            count = count_contacts(
                (a[0], b[0]), np.array(a[3]), np.array(b[3], dtype=float), relative, 0.0, np.zeros(64)
            )
            if count > 0 and not row[IS_SENSOR] and shape not in found:
                found.append(shape)
    return found


def quaternion(turn):
    """Quaternion of a rotation matrix (Shepperd's method, by the largest of the four)."""
    squares = np.array([[turn.trace(), *np.diag(turn)]]).ravel()
    k = int(np.argmax(squares))
    skew = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    if k == 0:
        q = np.concatenate(([1 + turn.trace()], skew))
    else:
        i, j, m = k - 1, k % 3, (k + 1) % 3
        q = np.zeros(4)
        q[0], q[1 + i] = skew[i], 1 + 2 * turn[i, i] - turn.trace()
        q[1 + j], q[1 + m] = turn[i, j] + turn[j, i], turn[i, m] + turn[m, i]
    return q / np.linalg.norm(q)


@pytest.mark.parametrize("stepped", [False, True])
def test_overlaps_are_those_of_asking_every_shape(stepped):
    scene = crowded(4, (SPHERE, BOX))
    if stepped:
        scene.step()
        scene[t.POSE][1:, :3] += scene.rng.normal(size=(len(scene[t.POSE]) - 1, 3)) * (scene[t.BODY][1:, :1] == DYNAMIC)
    sizes = []
    for _ in range(25):
        at, turn = scene.rng.uniform(-2, 2, 3), scene.rng.normal(size=4)
        turn /= np.linalg.norm(turn)
        radius, size = 10 ** scene.rng.uniform(-2, 0.3), 10 ** scene.rng.uniform(-2, 0.3, 3)
        ball = overlap_sphere(scene.tables, radius, at)
        assert list(ball) == touches(scene, SPHERE, [radius], at, (1, 0, 0, 0))
        box = overlap_box(scene.tables, size, at, 3 * turn)
        assert list(box) == touches(scene, BOX, size / 2, at, turn)
        some = overlap_box(scene.tables, size, at, turn, layers=[1])
        assert list(some) == [shape for shape in box if scene[t.SHAPE][shape, LAYER] == 2]
        sizes += [len(ball), len(box)]
    assert min(sizes) == 0
    assert max(sizes) > 4


def test_nothing_is_met_in_an_empty_world():
    scene = Scene()
    assert scene.ray_cast((0, 0, 0), (1, 0, 0)) is None
    assert scene.ray_cast_all((0, 0, 0), (1, 0, 0)) == []
    assert len(ray_cast_many(scene.tables, np.zeros((0, 3)), np.zeros((0, 3))).shape) == 0
    assert len(overlap_box(scene.tables, (1, 1, 1))) == 0


def test_rays_of_any_length_and_along_the_axes_are_met():
    scene = Scene()
    scene.add(BOX, [1, 1, 1])
    for scale in (1e-300, 1e-9, 1.0, 1e300):
        assert scene.ray_cast((3, 0.5, 0), (-scale, 0, 0)).distance == 2.0
    assert scene.ray_cast((3, 1.0, 1.0), (-1, 0, 0)).distance == 2.0  # along an edge
    assert scene.ray_cast((3, 1.1, 0), (-1, 0, 0)) is None
    assert scene.ray_cast((-1e9, 0, 0), (1, 0, 0)).distance == 1e9 - 1


@pytest.mark.parametrize(
    ("arguments", "options", "part"),
    [
        (((0, 0), (1, 0, 0)), {}, r"origin has the shape \(2,\)"),
        (((0, 0, 0), (0, 0, 0)), {}, "zero length"),
        (((0, np.nan, 0), (1, 0, 0)), {}, "not finite"),
        (((0, 0, 0), (1, np.inf, 0)), {}, "not finite"),
        ((((0, 0, 0), (1, 1, 1)), (1, 0, 0)), {}, "three numbers"),
        (("up", (1, 0, 0)), {}, "not an array of numbers"),
        (((0, 0, 0), (1, 0, 0)), {"limit": 0}, "positive"),
        (((0, 0, 0), (1, 0, 0)), {"limit": -1.0}, "positive"),
        (((0, 0, 0), (1, 0, 0)), {"limit": np.nan}, "positive"),
        (((0, 0, 0), (1, 0, 0)), {"layers": [62]}, "0 to 61"),
        (((0, 0, 0), (1, 0, 0)), {"layers": [-1]}, "0 to 61"),
        (((0, 0, 0), (1, 0, 0)), {"layers": [0.5]}, "0 to 61"),
    ],
)
def test_rays_that_cannot_be_are_refused(arguments, options, part):
    scene = Scene()
    for function in (scene.ray_cast, scene.ray_cast_all):
        with pytest.raises(ArgumentError, match=part):
            function(*arguments, **options)


def test_other_questions_that_cannot_be_are_refused():
    scene = Scene()
    with pytest.raises(ArgumentError, match="one origin for all"):
        ray_cast_many(scene.tables, np.zeros((2, 3)), np.ones((3, 3)))
    with pytest.raises(ArgumentError, match="radius"):
        overlap_sphere(scene.tables, 0.0)
    with pytest.raises(ArgumentError, match="size"):
        overlap_box(scene.tables, (1, -1, 1))
    with pytest.raises(ArgumentError, match="position"):
        overlap_box(scene.tables, (1, 1, 1), (0, 0))
    with pytest.raises(ArgumentError, match="orientation"):
        overlap_box(scene.tables, (1, 1, 1), orientation=(0, 0, 0, 0))
    scene.add(SPHERE, [1.0])
    scene[t.POSE][1, 0] = np.nan
    with pytest.raises(KickdriftError, match="Body 1 has a pose that is not finite"):
        scene.ray_cast((3, 0, 0), (-1, 0, 0))
    scene[t.POSE][1, 0] = 0.0
    assert scene.ray_cast((3, 0, 0), (-1, 0, 0)).distance == 2.0


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 100), st.sampled_from(["any", "along x", "within a plane"]))
def test_walks_come_to_every_box_that_a_ray_enters(seed, count, kind):
    rng = np.random.default_rng(seed)
    centres, sizes = rng.normal(size=(count, 3)), 10 ** rng.uniform(-2, 0, (count, 3))
    sizes[::3, 2] = 0.0
    origin, direction = rng.normal(size=3), rng.normal(size=3)
    direction[1:] *= kind != "along x"
    direction[2] *= kind == "any"
    boxes = np.concatenate((centres - sizes, centres + sizes), axis=1)
    nodes = np.zeros((3 * count, 8))
    nodes = nodes[: build(np.column_stack((centres, np.arange(count))), nodes)]
    fit(nodes, boxes)
    limit = float(rng.uniform(0.5, 4))
    walk, o, inverse = np.zeros(WALK), tuple(map(float, origin)), reciprocal(tuple(map(float, direction)))
    start(walk, nodes, o, inverse)
    found = []
    while (item := advance(walk, nodes, o, inverse, limit)) != NOTHING:
        found.append(item)
    with np.errstate(divide="ignore"):
        ends = (boxes.reshape(-1, 2, 3) - origin) / direction
    enters, leaves = ends.min(axis=1).max(axis=1, initial=0.0), ends.max(axis=1).min(axis=1)
    assert sorted(found) == list(np.flatnonzero((enters <= leaves) & (enters <= limit)))


def test_a_world_answers_with_rows_and_handles():
    world = World()
    floor = world.add_plane()
    ball = world.add_sphere(0.5, position=(0, 0, 1), layer=2)
    pair = world.add_body([Part(Sphere(0.2), (3, 0, 1)), Part(Sphere(0.2), (3.3, 0, 1))], static=True)
    hit = world.ray_cast((0, 0, 5), (0, 0, -2))
    assert (hit.body, hit.distance) == (ball, pytest.approx(3.5))
    assert hit.normal == pytest.approx([0, 0, 1])
    assert world.ray_cast((0, 0, 5), (0, 0, -1), layers=[0]).body == floor
    assert world.ray_cast((0, 0, 5), (0, 0, -1), limit=3.0) is None
    assert [hit.body for hit in world.ray_cast_all((0, 0, 5), (0, 0, -1))] == [ball, floor]
    assert world.ray_cast_many((0, 0, 5), [(0, 0, -1), (0, 0, 1)]).body.tolist() == [ball.index, -1]
    assert world.overlap_box((8, 1, 1), position=(0, 0, 1)) == [ball, pair]
    assert world.overlap_sphere(0.6, position=(0, 0, 0), layers=[0]) == [floor]
    world.advance(1 / 60, 60)
    assert world.ray_cast((0, 0, 5), (0, 0, -1)).distance == pytest.approx(4.0, abs=0.01)


def test_queries_that_need_room_leave_the_status_of_the_step():
    world = World()
    world.add_sphere(0.1)
    world.step(1 / 60)
    before = world.tables.array(t.STEP_STATUS).copy()
    for k in range(300):
        world.add_sphere(0.1, position=(k, 0, 0), static=True)
    assert world.ray_cast((250, 0, 5), (0, 0, -1)) is not None
    assert np.array_equal(world.tables.array(t.STEP_STATUS), before)


def gap_to_triangle(corners, point):
    """Distance of a point from a triangle: to its face, if it is above or below that, else to its sides."""
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal /= np.linalg.norm(normal)
    sides = np.roll(corners, -1, axis=0) - corners
    if (np.cross(sides, point - corners) @ normal >= 0.0).all():
        return abs((point - corners[0]) @ normal)
    share = np.clip(((point - corners) * sides).sum(axis=1) / (sides * sides).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(point - corners - share[:, None] * sides, axis=1).min()


def gap_to_box(corners, half):
    """Largest separation of a triangle and a box of half edges around the origin along any axis that may separate them."""
    sides = np.roll(corners, -1, axis=0) - corners
    axes = np.concatenate((np.eye(3), np.cross(sides[:1], sides[1:2]), *(np.cross(axis, sides) for axis in np.eye(3))))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    shadows, reach = corners @ axes.T, np.abs(axes) @ half
    return max((shadows.min(axis=0) - reach).max(), (-shadows.max(axis=0) - reach).max())


def test_overlaps_find_triangles_from_both_sides():
    rng, hits = np.random.default_rng(4), 0
    for _ in range(60):
        corners, point, radius, half = (
            rng.normal(size=(3, 3)),
            rng.normal(size=3),
            rng.uniform(0.1, 1.2),
            rng.uniform(0.1, 1, 3),
        )
        world = World()
        world.add_mesh(corners, [(0, 1, 2)])
        assert (world.overlap_sphere(radius, point) != []) == (gap_to_triangle(corners, point) < radius)
        assert (world.overlap_box(2 * half, point) != []) == (gap_to_box(corners - point, half) < 0.0)
        hits += gap_to_triangle(corners, point) < radius
    assert 10 < hits < 50


def test_rays_and_overlaps_go_through_what_they_are_to_ignore():
    world = World()
    floor = world.add_plane()
    compound = world.add_body([Part(Sphere(0.5)), Part(Sphere(0.5), position=(0, 0, 2))], position=(0, 0, 5))
    box = world.add_box((1, 1, 1), position=(0, 0, 2))
    mesh = world.add_mesh([(-1, -1, 1), (1, -1, 1), (0, 1, 1)], [(0, 1, 2)])
    down = (0, 0, 9), (0, 0, -1)
    for ignore, expected in (
        ((), compound),
        (compound, box),
        ([box], compound),
        ((compound, box), mesh),
        ({compound, box, mesh}, floor),
        ([compound, box, mesh, floor], None),
    ):
        for _ in range(2):
            hit = world.ray_cast(*down, ignore=ignore)
            assert (hit and hit.body) == expected
            every = world.ray_cast_all(*down, ignore=ignore)
            assert (every[0].body if every else None) == expected
            many = world.ray_cast_many(np.array([down[0]] * 3), np.array([down[1]] * 3), ignore=ignore)
            assert many.body.tolist() == [expected.index if expected else -1] * 3
            world.step(1e-6)
    assert world.overlap_sphere(10.0, ignore=compound) == [floor, box, mesh]
    assert world.overlap_box((20, 20, 20), ignore=(floor, mesh, box)) == [compound]
    gone = world.add_sphere(1.0)
    world.remove(gone)
    for ignore in (3, "ball", None, gone, [gone], [box, 2], [None]):
        for ask in (
            lambda ignore: world.ray_cast(*down, ignore=ignore),
            lambda ignore: world.ray_cast_all(*down, ignore=ignore),
            lambda ignore: world.ray_cast_many(np.zeros((1, 3)), np.ones((1, 3)), ignore=ignore),
            lambda ignore: world.overlap_sphere(1.0, ignore=ignore),
            lambda ignore: world.overlap_box((1, 1, 1), ignore=ignore),
        ):
            with pytest.raises(ArgumentError, match="ignore"):
                ask(ignore)


@pytest.mark.parametrize("lost", [np.nan, np.inf, 1e308])
def test_rays_meet_what_is_there_after_a_body_was_lost(lost):
    world = World()
    world.add_plane()
    balls = [world.add_sphere(0.2, position=(k, 0, 1)) for k in range(20)]
    world.advance(1 / 60, 3)
    balls[7].velocity[:] = lost
    with pytest.raises(LostBodyError):
        world.advance(1 / 60, 3)
    balls[7].velocity = 0, 0, 0
    for k, ball in enumerate(balls):
        hit = world.ray_cast((k, 0, 5), (0, 0, -1))
        assert hit.body == ball
        assert hit.distance == pytest.approx(5 - ball.position[2] - 0.2)
    assert world.ray_cast((40, 0, 5), (0, 0, -1)).body != balls[7]
    assert len(world.overlap_box((50, 1, 3))) == 21
    world.advance(1 / 60, 60)
    assert world.position[2:22, 2] == pytest.approx(0.2, abs=0.01)

"""The broad phase against comparing every shape with every other one."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stages import run_stage

from kickdrift.world import tables as t
from kickdrift.world.collision.broad_phase.bvh import ITEM, build, fit, gather
from kickdrift.world.collision.broad_phase.filters_and_sensors import exclude
from kickdrift.world.collision.broad_phase.pair_update import find_pairs
from kickdrift.world.collision.broad_phase.search_state import (
    FITTED,
    LEFT,
    MOVERS_CHANGED,
    VISITS,
    filters_changed,
    shapes_changed,
)
from kickdrift.world.collision.shape_properties import describe_kinds, find_extents
from kickdrift.world.contacts.layout import BODY_A, BODY_B, CONTACT_STATE, SENSOR, TOUCHING
from kickdrift.world.layout import (
    AWAKE,
    BEGINS,
    BODY_KIND,
    BODY_ROW,
    DYNAMIC,
    FIRST_BODY,
    IS_SENSOR,
    KINEMATIC,
    LAYER,
    MASK,
    RADIUS,
    SEARCH_STATE,
    SECOND_BODY,
    SHAPE_KIND,
    STATIC,
)
from kickdrift.world.settings import GRAVITY, MARGIN
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.kind_numbers import BOX, CAPSULE, HULL, MESH, PLANE, SPHERE, TRIANGLE
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.polyhedron import HEADER, PLANES_AT, VERTICES
from kickdrift.world.step.status import FULL, LOST_BODY, NOT_FINITE, ROWS_WANTED, STATUS, TABLE

STEP = 1 / 60
ALL = (1 << 62) - 1
PLACES = {table.place: table for table in vars(t).values() if isinstance(table, t.Table)}


def reach(kind, numbers):
    """How far a shape reaches from its origin."""
    if kind == HULL:
        return np.linalg.norm(numbers[HEADER : int(numbers[PLANES_AT])].reshape(-1, 3), axis=1).max()
    return {SPHERE: np.sum, CAPSULE: np.sum, BOX: np.linalg.norm}.get(int(kind), lambda _: 0.0)(numbers)


class Scene:
    """Tables of a world that holds shapes and nothing else."""

    def __init__(self, seed=0, margin=0.02):
        self.tables, self.rng = t.Tables(), np.random.default_rng(seed)
        for table in (t.SETTINGS, t.STEP_STATUS, t.SEARCH):
            self.tables.resize(table, 1)
        describe_kinds(self.tables)
        find_extents(self.tables, [SPHERE, CAPSULE, BOX, HULL, MESH])
        self[t.SETTINGS][0, GRAVITY : GRAVITY + 3] = 0.0, 0.0, -9.81
        self[t.SETTINGS][0, MARGIN] = margin
        self.retries = 0
        self.body(STATIC)

    def __getitem__(self, table):
        return self.tables.array(table)

    def body(self, kind=DYNAMIC, position=(0, 0, 0), turn=(1, 0, 0, 0), velocity=(0, 0, 0), spin=(0, 0, 0)):
        row = len(self[t.POSE])
        for table in (t.POSE, t.MOTION, t.BODY, t.FORCE, t.PREDICTED, t.INVERSE_MASS):
            self.tables.resize(table, row + 1)
        self[t.POSE][row, :3], self[t.POSE][row, 3:7] = position, np.divide(turn, np.linalg.norm(turn))
        self[t.MOTION][row, :3], self[t.MOTION][row, 3:6] = velocity, spin
        self[t.BODY][row, :2] = kind, kind != STATIC
        self[t.INVERSE_MASS][row, 0] = kind == DYNAMIC
        return row

    def shape(self, body, kind, numbers, position=(0, 0, 0), turn=(1, 0, 0, 0), layer=1, mask=ALL, sensor=0, row=None):
        if row is None:
            row = len(self[t.SHAPE])
            for table in (t.SHAPE, t.PLACE, t.BOUNDS):
                self.tables.resize(table, row + 1)
        begin = len(self[t.GEOMETRY])
        self.tables.resize(t.GEOMETRY, begin + len(numbers))[begin:, 0] = numbers
        self[t.SHAPE][row] = kind, body, begin, len(numbers), layer, mask, sensor, 0
        self[t.PLACE][row, :3], self[t.PLACE][row, 3:7] = position, np.divide(turn, np.linalg.norm(turn))
        self[t.PLACE][row, RADIUS] = reach(kind, np.asarray(numbers))
        shapes_changed(self.tables)
        return row

    def box(self, position=(0, 0, 0), half=0.5, kind=DYNAMIC, **options):
        return self.shape(self.body(kind, position), BOX, np.broadcast_to(half, 3), **options)

    def remove(self, row):
        self[t.SHAPE][row, SHAPE_KIND] = -1
        shapes_changed(self.tables)

    def find(self, step=STEP):
        """Run the stage, making room where it asks for it; returns the pairs."""
        status = self[t.STEP_STATUS][0]
        run_stage(find_pairs, step, self.tables)
        while status[STATUS] == FULL:
            self.retries += 1
            full = {t.CONTACT, t.MANIFOLD} if status[TABLE] == t.CONTACT.place else {PLACES[int(status[TABLE])]}
            for table in full:
                self.tables.reserve(table, int(status[ROWS_WANTED]))
            status[:] = 0
            run_stage(find_pairs, step, self.tables)
        assert status[STATUS] == 0, status
        return [tuple(map(int, row[:3])) for row in self[t.CONTACT]]

    def move(self, step=STEP):
        pose, motion, kind = self[t.POSE], self[t.MOTION], self[t.BODY][:, BODY_KIND]
        moving = kind != STATIC
        pose[moving, :3] += step * motion[moving, :3]
        for body in np.flatnonzero(moving):
            pose[body, 3:7] = turned_by(step * motion[body, 3:6], pose[body, 3:7])

    def visits(self):
        return int(self[t.SEARCH][0, VISITS])


def quaternion_product(p, q):
    w = p[0] * q[0] - p[1:] @ q[1:]
    return np.concatenate(([w], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])))


def turned_by(rotation, q):
    angle = np.linalg.norm(rotation)
    axis = rotation / angle if angle > 0 else rotation
    return quaternion_product(np.concatenate(([np.cos(angle / 2)], np.sin(angle / 2) * axis)), q)


def matrix(q):
    w, x, y, z = q
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * k + 2 * k @ k


def corners(scene, shape):
    """Points that span a shape, in its frame, and the radius of the ball around each."""
    kind, _, begin, size = scene[t.SHAPE][shape, :4]
    numbers = scene[t.GEOMETRY][begin : begin + size, 0]
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    if kind == SPHERE:
        return np.zeros((1, 3)), numbers[0]
    if kind == CAPSULE:
        return np.array([[0, 0, -numbers[1]], [0, 0, numbers[1]]]), numbers[0]
    if kind == BOX:
        return signs * numbers, 0.0
    if kind == HULL:
        return numbers[HEADER : HEADER + 3 * int(numbers[VERTICES])].reshape(-1, 3), 0.0
    return numbers[1:].reshape(-1, 12)[:, :9].reshape(-1, 3), 0.0


def tight_box(scene, shape, ahead=0.0):
    """Box of a shape as its body will be after some time of free flight."""
    body = scene[t.SHAPE][shape, BODY_ROW]
    motion = scene[t.MOTION][body]
    turn = turned_by(ahead * motion[3:6], scene[t.POSE][body, 3:7])
    points, radius = corners(scene, shape)
    inside = points @ matrix(scene[t.PLACE][shape, 3:7]).T + scene[t.PLACE][shape, :3]
    outside = inside @ matrix(turn).T + scene[t.POSE][body, :3] + ahead * motion[:3]
    return np.concatenate((outside.min(axis=0) - radius, outside.max(axis=0) + radius))


def overlap(a, b):
    """Whether two boxes do; of lists: hundreds of thousands are asked."""
    return all(a[axis] <= b[axis + 3] and b[axis] <= a[axis + 3] for axis in range(3))


def under(scene, plane, box):
    body = scene[t.SHAPE][plane, BODY_ROW]
    turn = matrix(scene[t.POSE][body, 3:7])
    normal = turn @ matrix(scene[t.PLACE][plane, 3:7])[:, 2]
    origin = turn @ scene[t.PLACE][plane, :3] + scene[t.POSE][body, :3]
    lowest = np.where(normal > 0.0, box[:3], box[3:])
    return (lowest - origin) @ normal <= 0.0


def triangle_boxes(scene, mesh):
    begin, size = scene[t.SHAPE][mesh, 2:4]
    points = scene[t.GEOMETRY][begin + 1 : begin + size, 0].reshape(-1, 12)[:, :9].reshape(-1, 3, 3)
    return np.concatenate((points.min(axis=1), points.max(axis=1)), axis=1).tolist()


def near(scene, a, b, boxes, triangles):
    """Parts of a that the box of b overlaps: [0] or [] for a shape without parts."""
    kind = scene[t.SHAPE][a, SHAPE_KIND]
    if kind == PLANE:
        return [0] if under(scene, a, boxes[b]) else []
    if kind == MESH:  # meshes of these scenes stand where they were made
        return [part for part, box in enumerate(triangles[a]) if overlap(box, boxes[b])]
    return [0] if overlap(boxes[a], boxes[b]) else []


def expected(scene, boxes, excluded=()):
    """All pairs there must be if the shapes are in these boxes."""
    shapes, kinds, boxes = scene[t.SHAPE].tolist(), scene[t.BODY][:, BODY_KIND].tolist(), boxes.tolist()
    triangles = {row: triangle_boxes(scene, row) for row, shape in enumerate(shapes) if shape[SHAPE_KIND] == MESH}
    excluded, found = {frozenset(pair) for pair in excluded}, set()
    for a, b in combinations([row for row in range(len(shapes)) if shapes[row][SHAPE_KIND] >= 0], 2):
        i, j = shapes[a][BODY_ROW], shapes[b][BODY_ROW]
        if i == j or DYNAMIC not in (kinds[i], kinds[j]) or frozenset((i, j)) in excluded:
            continue
        if not (shapes[a][LAYER] & shapes[b][MASK] and shapes[b][LAYER] & shapes[a][MASK]) or (
            shapes[a][IS_SENSOR] and shapes[b][IS_SENSOR]
        ):
            continue
        rank = [(TRIANGLE if shapes[s][SHAPE_KIND] == MESH else shapes[s][SHAPE_KIND], s) for s in (a, b)]
        first, second = (a, b) if rank[0] < rank[1] else (b, a)
        found |= {(first, second, part) for part in near(scene, first, second, boxes, triangles)}
    return found


def check(scene, pairs, step=STEP, excluded=()):
    """Pairs are those of the fat bounds, and none is missing that comes near in the step."""
    shapes = scene[t.SHAPE]
    assert len(set(pairs)) == len(pairs)
    assert set(pairs) == expected(scene, scene[t.BOUNDS][:, :6], excluded)
    for ahead in (0.0, 0.37 * step, step):
        finite = [row for row in range(len(shapes)) if shapes[row, SHAPE_KIND] > PLANE]
        boxes = np.zeros((len(shapes), 6))
        for row in finite:
            boxes[row] = tight_box(scene, row, ahead)
        assert expected(scene, boxes, excluded) <= set(pairs)
    for contact, (a, b, _) in zip(scene[t.CONTACT], pairs, strict=True):
        assert list(contact[[BODY_A, BODY_B]]) == [shapes[a, BODY_ROW], shapes[b, BODY_ROW]]


def random_scene(seed, count=60, decades=3.0, speed=10.0):
    """Shapes of all kinds with sizes over some decades, in compounds of up to three, on planes, boxes and a mesh."""
    scene = Scene(seed)
    rng = scene.rng
    scene.shape(0, PLANE, [], turn=(1, 0.1, 0, 0))
    scene.shape(0, PLANE, [], position=(-3, 0, 0), turn=(1, 0, 1, 0))
    grid = np.stack(np.meshgrid(np.linspace(-2, 2, 6), np.linspace(-2, 2, 6), indexing="ij"), axis=-1).reshape(-1, 2)
    vertices = np.column_stack((grid, 0.2 * rng.normal(size=len(grid))))
    faces = [f for k in range(5) for m in range(5) for a in [6 * k + m] for f in ((a, a + 6, a + 7), (a, a + 7, a + 1))]
    scene.shape(0, MESH, Mesh(vertices, faces).numbers)
    scene.box((1, 1, 0.5), (0.5, 0.3, 0.2), STATIC)
    while len(scene[t.SHAPE]) < count:
        kind = rng.choice([DYNAMIC, DYNAMIC, DYNAMIC, KINEMATIC])
        body = scene.body(
            kind, rng.uniform(-2, 2, 3), rng.normal(size=4), speed * rng.normal(size=3), 5 * rng.normal(size=3)
        )
        size = 10 ** rng.uniform(-decades, 0)
        for _ in range(rng.integers(1, 4)):
            kind = rng.choice([SPHERE, CAPSULE, BOX, HULL])
            numbers = {SPHERE: 1, CAPSULE: 2, BOX: 3}.get(int(kind))
            numbers = (
                Hull(size * rng.normal(size=(8, 3))).numbers if numbers is None else size * rng.uniform(0.2, 1, numbers)
            )
            scene.shape(body, kind, numbers, size * rng.normal(size=3), rng.normal(size=4))
    return scene


@pytest.mark.parametrize("seed", range(4))
def test_pairs_are_those_of_comparing_all_shapes(seed):
    scene = random_scene(seed, speed=[0.3, 3.0, 10.0, 60.0][seed])
    for _ in range(8):
        check(scene, scene.find())
        scene.move()
        strike = scene.rng.integers(1, len(scene[t.POSE]), 5)
        scene[t.MOTION][strike] = -scene[t.MOTION][strike]


@pytest.mark.parametrize("step", [1e-3, 0.1])
def test_nothing_is_missed_in_short_and_long_steps(step):
    scene = random_scene(7)
    for _ in range(6):
        check(scene, scene.find(step), step)
        scene.move(step)


def test_pairs_do_not_depend_on_how_trees_were_built_or_room_was_made():
    one, other = random_scene(3), random_scene(3)
    for table in (t.CONTACT, t.MANIFOLD, t.SCRATCH):
        other.tables.reserve(table, 100_000)
    for _ in range(15):
        assert one.find() == other.find()
        other[t.SEARCH][0, MOVERS_CHANGED] = 1
        for scene in (one, other):
            scene.move()
    assert one.retries > other.retries


def test_manifolds_stay_with_their_contacts_and_new_ones_are_empty():
    scene = random_scene(5, speed=4.0)
    known, new, gone = {}, 0, 0
    for _ in range(20):
        pairs = scene.find()
        numbers = scene[t.MANIFOLD]
        assert len(numbers) == len(pairs)
        gone += len(known.keys() - set(pairs))
        known = {pair: known.get(pair, 0.0) for pair in pairs}
        for row, pair in enumerate(pairs):
            assert (numbers[row] == known[pair]).all()
            if known[pair] == 0.0:
                new += 1
                assert not scene[t.CONTACT][row, 5:].any()
                numbers[row] = known[pair] = scene.rng.uniform(1, 2)
        scene.move()
    assert min(new, gone) > 100


def test_new_contacts_are_in_the_order_of_their_shapes():
    scene = Scene(1)
    for row in scene.rng.permutation(27):
        scene.box((row % 3, row // 3 % 3, row // 9))
    pairs = scene.find()
    assert pairs == sorted(pairs)
    assert len(pairs) > 54


def test_what_rests_costs_nothing():
    scene = Scene()
    scene.shape(0, PLANE, [])
    for k in range(50):
        scene.box((0, 0, 0.5 + k))
    assert len(scene.find()) == 50
    visits, left = scene.visits(), scene[t.SEARCH][0, LEFT]
    for _ in range(10):
        scene[t.POSE][1:, :3] += scene.rng.uniform(-0.003, 0.003, (50, 3))
        scene.find()
    assert (scene.visits(), scene[t.SEARCH][0, LEFT]) == (visits, left)


def test_boxes_that_move_are_drawn_anew_and_the_tree_built_once_in_a_while():
    scene = Scene()
    rows = [scene.box((3 * k, 0, 0)) for k in range(30)]
    scene.find()
    seen = set()
    for _ in range(40):
        scene[t.POSE][scene[t.SHAPE][rows[:10], 1], 2] += 0.3
        scene.find()
        search = scene[t.SEARCH][0]
        assert search[LEFT] == search[FITTED]
        seen.add(int(search[LEFT]))
    assert 0 in seen
    assert 10 in seen
    assert max(seen) <= 30


def crowd(count, seed=0):
    scene = Scene(seed)
    side = count ** (1 / 3)
    for point in scene.rng.uniform(0, 1.3 * side, (count, 3)):
        scene.box(point)
    return scene


def test_work_grows_little_more_than_the_number_of_shapes():
    visits = []
    for count in (500, 4000):
        scene = crowd(count)
        scene.find()
        before = scene.visits()
        scene[t.POSE][1:, :3] += 10.0  # all of them leave their boxes
        scene.find()
        visits.append((scene.visits() - before) / count)
    # The depth grows by three of a dozen, and fewer boxes stand at the rim; comparing all of them would cost 8 times.
    assert visits[1] < 1.6 * visits[0]
    assert visits[1] < 100


def test_static_shapes_are_sorted_once():
    scene = Scene()
    for k in range(300):
        scene.box((2 * k, 0, 0), kind=STATIC)
    ball = scene.shape(scene.body(position=(10, 0, 2)), SPHERE, [0.5])
    assert scene.find() == []
    scene[t.STATIC_TREE][0, 0] = mark = -1e9
    scene.remove(ball)
    scene.shape(scene.body(position=(10, 0, 1)), SPHERE, [0.5], row=ball)
    assert len(scene.find()) == 1
    assert scene[t.STATIC_TREE][0, 0] == mark
    scene.box((0, 5, 0), kind=STATIC)
    scene.find()
    assert scene[t.STATIC_TREE][0, 0] == -0.5


def test_a_fast_small_ball_finds_a_thin_wall():
    scene = Scene()
    wall = scene.box(half=(0.005, 5, 5), kind=STATIC)
    ball = scene.shape(scene.body(position=(-98, 0, 0), velocity=(300, 0, 0)), SPHERE, [0.01])
    met = False
    for _ in range(40):
        met = (ball, wall, 0) in scene.find()
        before = scene[t.POSE][2, 0]
        scene.move()
        if before < 0.0 < scene[t.POSE][2, 0]:
            break
    assert met
    assert scene[t.POSE][2, 0] > 0.0


def test_a_turning_rod_finds_what_it_strikes_in_the_step():
    scene = Scene()
    rod = scene.shape(scene.body(spin=(0, 0, 40)), BOX, (1.0, 0.01, 0.01))
    still = scene.box((0.8, 0.4, 0), 0.01, kind=STATIC)
    assert (min(rod, still), max(rod, still), 0) in scene.find()
    scene[t.MOTION][1, 5] = 1.0
    filters_changed(scene.tables, [1])
    shapes_changed(scene.tables, [rod])
    assert scene.find() == []


def test_a_shape_far_from_the_axis_finds_what_it_swings_into():
    scene = Scene()
    ball = scene.shape(scene.body(spin=(0, 0, 12)), SPHERE, [0.1], position=(5, 0, 0))
    ahead = scene.box((5, 0.9, 0), 0.05, kind=STATIC)
    behind = scene.box((5, -0.9, 0), 0.05, kind=STATIC)
    pairs = scene.find()
    assert (ball, ahead, 0) in pairs
    assert (ball, behind, 0) not in pairs


def test_a_ball_that_spins_in_place_is_in_its_own_box():
    scene = Scene()
    scene.shape(scene.body(spin=(0, 0, 1000)), SPHERE, [1.0])
    scene.find()
    assert np.abs(scene[t.BOUNDS][0, :6]).max() < 1.0 + 0.02 + 0.05 + 1e-12 + 4 * 9.81 / 3600


def test_layers_masks_sensors_and_bodies_decide_who_may_touch():
    scene = Scene()
    at = (0, 0, 0)
    plain = scene.box(at)
    other = scene.box(at, layer=2, mask=4)
    third = scene.box(at, layer=4, mask=2)
    sensor = scene.box(at, sensor=1)
    second_sensor = scene.box(at, sensor=1)
    scene.box(at, kind=STATIC, sensor=1)
    same = scene.shape(scene[t.SHAPE][plain, BODY_ROW], SPHERE, [0.5])
    pushed = scene.box(at, kind=KINEMATIC)
    fixed = scene.box(at, kind=STATIC)
    pairs = scene.find()
    check(scene, pairs)
    assert (plain, other, 0) not in pairs
    assert (other, third, 0) in pairs
    assert (sensor, second_sensor, 0) not in pairs
    assert (same, plain, 0) not in pairs
    assert (pushed, fixed, 0) not in pairs
    assert (same, pushed, 0) in pairs  # a sphere comes before a box
    flags = dict(zip(pairs, scene[t.CONTACT][:, CONTACT_STATE], strict=True))
    assert flags[plain, sensor, 0] == SENSOR
    assert flags[plain, pushed, 0] == 0


def test_excluded_bodies_part_and_meet_again_and_leave_other_contacts_alone():
    scene = Scene(2)
    for point in scene.rng.uniform(-1, 1, (12, 3)):
        scene.box(point)
    all_pairs = scene.find()
    scene[t.MANIFOLD][:] = 7.0
    excluded = [tuple(reversed(scene[t.SHAPE][pair[:2], 1])) for pair in all_pairs[::3]] + [(1, 12), (12, 2)]
    exclude(scene.tables, excluded + excluded[:3])
    pairs = scene.find()
    check(scene, pairs, excluded=excluded)
    assert len(pairs) < len(all_pairs)
    assert (scene[t.MANIFOLD] == 7.0).all()
    exclude(scene.tables, excluded[1:])
    again = scene.find()
    check(scene, again, excluded=excluded[1:])
    assert len(again) == len(pairs) + 1
    assert not scene[t.MANIFOLD][-1].any()
    assert (scene[t.MANIFOLD][:-1] == 7.0).all()
    exclude(scene.tables, [])
    check(scene, scene.find())


def test_sleeping_bodies_keep_their_contacts_and_are_found_by_others():
    scene = Scene()
    a, b = scene.box(), scene.box((0.9, 0, 0))
    scene.find()
    bodies = scene[t.SHAPE][[a, b], 1]
    scene[t.BODY][bodies, AWAKE] = 0
    scene[t.MOTION][bodies, 0] = 5.0, -5.0
    before = scene[t.BOUNDS].copy()
    ball = scene.shape(scene.body(position=(0.45, 0, 0.7)), SPHERE, [0.2])
    assert scene.find() == [(a, b, 0), (ball, a, 0), (ball, b, 0)]
    assert (scene[t.BOUNDS][:2] == before[:2]).all()


def test_removed_shapes_lose_their_contacts_and_their_rows_are_used_again():
    scene = Scene()
    a, b, c = scene.box(), scene.box((0.9, 0, 0)), scene.box((1.8, 0, 0))
    scene.find()
    scene[t.MANIFOLD][:] = 3.0
    scene.remove(a)
    assert scene.find() == [(b, c, 0)]
    assert (scene[t.MANIFOLD] == 3.0).all()
    scene.remove(b)
    scene.shape(scene.body(position=(1.5, 0, 0.9)), SPHERE, [0.5], row=b)
    assert scene.find() == [(b, c, 0)]
    assert not scene[t.MANIFOLD].any()


def test_a_body_that_begins_to_move_leaves_the_static_tree():
    scene = Scene()
    a, b = scene.box(kind=STATIC), scene.box((0, 0, 0.9), kind=STATIC)
    assert scene.find() == []
    body = scene[t.SHAPE][b, BODY_ROW]
    scene[t.BODY][body, :2] = DYNAMIC, 1
    shapes_changed(scene.tables, [b])
    assert scene.find() == [(a, b, 0)]
    scene[t.MOTION][body, 2] = 3.0
    for _ in range(30):
        scene.move()
        pairs = scene.find()
    assert pairs == []


def test_a_static_shape_that_is_put_elsewhere_is_found_there():
    scene = Scene()
    wall = scene.box((50, 0, 0), kind=STATIC)
    box = scene.box()
    assert scene.find() == []
    scene[t.POSE][scene[t.SHAPE][wall, BODY_ROW], 0] = 0.9
    shapes_changed(scene.tables, [wall])
    assert scene.find() == [(wall, box, 0)]


def test_shapes_that_part_in_one_step_no_longer_touch():
    scene = Scene()
    a, b = scene.box(), scene.box((0.9, 0, 0))
    scene.find()
    scene[t.CONTACT][0, CONTACT_STATE] |= TOUCHING
    scene[t.POSE][scene[t.SHAPE][b, BODY_ROW], 0] = 40.0
    assert scene.find() == []
    (event,) = scene[t.EVENTS]
    assert not event[BEGINS]
    assert list(event[[FIRST_BODY, SECOND_BODY]]) == list(scene[t.SHAPE][[a, b], 1])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("table", [t.POSE, t.MOTION])
def test_a_body_that_is_nowhere_is_named_and_can_be_brought_back(table, value):
    scene = Scene()
    rows = [scene.box((0.9 * k, 0, 0)) for k in range(5)]
    pairs = scene.find()
    body = int(scene[t.SHAPE][rows[2], 1])
    scene[table][body, 1] = value
    run_stage(find_pairs, STEP, scene.tables)
    status = scene[t.STEP_STATUS][0]
    assert (status[STATUS], status[LOST_BODY]) == (NOT_FINITE, body)
    assert len(scene[t.CONTACT]) == len(pairs)
    status[:] = 0
    scene[table][body, 1] = 0.0
    assert set(scene.find()) == set(pairs)
    assert np.isfinite(scene[t.BOUNDS][:, :6]).all()


def test_nothing_is_changed_before_there_is_room():
    scene = Scene()
    for k in range(40):
        scene.box((0.9 * k, 0, 0))
    scene.tables.reserve(t.SCRATCH, 1000)
    status = scene[t.STEP_STATUS][0]
    asked = []
    for _ in range(20):
        run_stage(find_pairs, STEP, scene.tables)
        if status[STATUS] == 0:
            break
        assert len(scene[t.CONTACT]) == 0
        asked.append(int(status[TABLE]))
        scene.tables.reserve(PLACES[asked[-1]], int(status[ROWS_WANTED]))
        status[:] = 0
    assert asked[-1] == t.CONTACT.place
    assert scene.tables.row(t.MANIFOLD, 38).size  # has room with it
    assert len(scene[t.CONTACT]) == 39
    assert (scene[t.SHAPE][:, SEARCH_STATE] == 1).all()


def test_contacts_that_someone_else_removes_are_found_again():
    scene = Scene()
    for k in range(20):
        scene.box((0.9 * k, 0, 0))
    pairs = scene.find()
    scene[t.MANIFOLD][:] = 5.0
    for left in (0, 7):
        for table in (t.CONTACT, t.MANIFOLD):
            scene.tables.resize(table, left)
        assert sorted(scene.find()) == pairs
        assert (scene[t.MANIFOLD][:left] == 5.0).all()
        assert not scene[t.MANIFOLD][left:].any()
        scene[t.MANIFOLD][:] = 5.0


def test_an_empty_world_has_no_pairs():
    scene = Scene()
    assert scene.find() == []
    row = scene.box()
    assert scene.find() == []
    scene.remove(row)
    assert scene.find() == []


def grown(centres, sizes):
    """Build a tree over boxes; returns the nodes and the boxes."""
    boxes = np.concatenate((centres - sizes, centres + sizes), axis=1)
    seeds = np.column_stack((centres, np.arange(len(centres))))
    nodes = np.zeros((3 * len(centres), 8))
    nodes = nodes[: build(seeds, nodes)]
    fit(nodes, boxes)
    return nodes, boxes


def look(nodes, box, count):
    found = np.zeros(count + 1)
    hits, visits = gather(nodes, tuple(map(float, box)), found)
    return sorted(found[:hits].astype(int)), visits


@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 2**32), st.integers(0, 200), st.sampled_from(["even", "line", "one place", "scales", "neighbours"])
)
def test_trees_find_what_comparing_all_finds(seed, count, kind):
    rng = np.random.default_rng(seed)
    centres = rng.normal(size=(count, 3))
    if kind == "line":
        centres[:, 1:] = 0.0
    elif kind == "one place":
        centres[:] = centres[:1]
    elif kind == "scales":
        centres *= 10.0 ** rng.uniform(-12, 12, (count, 1))
    elif kind == "neighbours":
        centres = 1.0 + np.spacing(1.0) * rng.integers(0, 2, (count, 3))
    sizes = 10.0 ** rng.uniform(-3, 0, (count, 3))
    nodes, boxes = grown(centres, sizes)
    assert sorted(nodes[nodes[:, ITEM] >= 0, ITEM]) == list(range(count))
    for _ in range(5):
        centre, size = rng.normal(size=3), 10.0 ** rng.uniform(-3, 0.5, 3)
        box = np.concatenate((centre - size, centre + size))
        assert look(nodes, box, count)[0] == [k for k in range(count) if overlap(boxes[k], box)]


def test_a_tree_over_shapes_on_all_scales_is_not_deep():
    centres = np.zeros((2000, 3))
    centres[:, 0] = 2.0 ** -np.arange(2000.0)
    nodes, _ = grown(centres, np.full((2000, 3), 1e-320))
    found, visits = look(nodes, (0.4, 0, 0, 0.6, 0, 0), 2000)
    assert found == [1]
    assert visits < 200


def test_a_tree_is_walked_in_few_steps():
    rng = np.random.default_rng(0)
    centres = rng.uniform(0, 30, (27_000, 3))
    nodes, boxes = grown(centres, np.full((27_000, 3), 0.5))
    visits = [look(nodes, boxes[k], 27_000)[1] for k in range(0, 27_000, 270)]
    assert np.mean(visits) < 150

"""Cylinders and cones: weight, place, contacts against Minkowski differences, rest, rolling, tumbling."""

import math

import numpy as np
import pytest
from colliding import count_contacts
from scipy.optimize import nnls
from scipy.spatial import ConvexHull

import kickdrift as kd
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.kind_numbers import BOX, CAPSULE, CONE, CYLINDER, HULL, SPHERE, TRIANGLE
from kickdrift.world.shapes.mass_properties import rotation_matrix
from kickdrift.world.shapes.shape_kinds import KINDS

G, STEP = 9.81, 1 / 60
LYING = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
ROUND = [CYLINDER, CONE]
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
SIDES = 48  # of the polygons that stand for rims: off by 1 - cos(pi / 48), two thousandths of the radius
COSINES = np.cos(np.arange(SIDES) * 2 * np.pi / SIDES), np.sin(np.arange(SIDES) * 2 * np.pi / SIDES)


def ring(radius, z):
    return np.column_stack((radius * COSINES[0], radius * COSINES[1], np.full(SIDES, z)))


def made(kind, rng):
    """Numbers of a shape, and points and radius of the set that it is."""
    a, b, c = rng.uniform(0.2, 1.0, 3)
    if kind == SPHERE:
        return np.array([a]), np.zeros((1, 3)), a
    if kind == CAPSULE:
        return np.array([a, b]), np.array([[0.0, 0.0, -b], [0.0, 0.0, b]]), a
    if kind == BOX:
        return np.array([a, b, c]), CORNERS * (a, b, c), 0.0
    if kind == HULL:
        hull = Hull(rng.normal(size=(9, 3)) * 0.6)
        return hull.numbers, hull.vertices, 0.0
    upper = a if kind == CYLINDER else 0.0
    return np.array([a, upper, b]), np.vstack((ring(a, -b), ring(upper, b) if upper else [[0.0, 0.0, b]])), 0.0


def apart(points, other):
    """Return the distance of two hulls of points, or by how much they overlap, negative."""
    difference = (other[None] - points[:, None]).reshape(-1, 3)
    hull = ConvexHull(difference)
    depth = hull.equations[:, 3].max()
    if depth <= 0.0:
        return depth
    rows = difference[hull.vertices].T
    shares, _ = nnls(np.vstack((rows, np.full(rows.shape[1], 1e4))), np.array([0.0, 0.0, 0.0, 1e4]), maxiter=10_000)
    return np.linalg.norm(rows @ shares / shares.sum())


PAIRS_WITH_ROUND = [(a, b) for b in ROUND for a in (SPHERE, CAPSULE, BOX, HULL, CYLINDER, CONE) if a <= b]


@pytest.mark.parametrize(("first", "second"), PAIRS_WITH_ROUND)
def test_contacts_are_as_far_apart_as_the_sets_are(first, second):
    """Where points are, they have the distance of the two along the normal, and no other direction separates them more."""
    rng, found = np.random.default_rng(first + 10 * second), 0
    for trial in range(8):
        (a, points_a, radius_a), (b, points_b, radius_b) = made(first, rng), made(second, rng)
        q = rng.normal(size=4) if trial % 3 else np.array([1.0, 0.0, trial % 2, 0.0])
        turn = rotation_matrix(q)
        way = rng.normal(size=3)
        # From afar until they nearly touch: contacts are as far apart as 5 cm, or as deep
        at = points_b @ turn.T
        distance, goal = 5.0, rng.uniform(-0.05, 0.05)
        for _ in range(6):
            gap = apart(points_a, at + distance * way / np.linalg.norm(way)) - radius_a - radius_b
            distance -= 0.9 * (gap - goal)
        pose = np.concatenate((distance * way / np.linalg.norm(way), q / np.linalg.norm(q)))
        gap = apart(points_a, at + pose[:3]) - radius_a - radius_b
        manifold = np.zeros(64)
        count = count_contacts((first, second), a, b, pose, 0.2, manifold)
        rows = manifold[8:40].reshape(4, 8)[:count]
        gaps = [manifold[:3] @ (turn @ row[3:6] + pose[:3] - row[:3]) for row in rows]
        exact = first in (SPHERE, CAPSULE)
        assert min(gaps) == pytest.approx(gap, abs=4e-3 if exact else 8e-3)
        assert np.linalg.norm(manifold[:3]) == pytest.approx(1.0)
        found += count
    assert found >= 8


@pytest.mark.parametrize("second", ROUND)
@pytest.mark.parametrize("first", [BOX, HULL, CYLINDER])
def test_what_is_stuck_in_a_thin_plate_is_as_deep_in_it_as_the_sets_are(first, second):
    half = np.array([6.0, 6.0, 0.02])
    plates = {
        BOX: (half, CORNERS * half),
        HULL: (Hull(CORNERS * half).numbers, CORNERS * half),
        CYLINDER: (half, np.vstack((ring(6.0, -0.02), ring(6.0, 0.02)))),
    }
    a, points_a = plates[first]
    for seed in range(20):
        rng = np.random.default_rng(seed)
        b, points_b, _ = made(second, rng)
        q = rng.normal(size=4)
        turn = rotation_matrix(q)
        pose = np.concatenate(((*rng.uniform(-1, 1, 2), rng.uniform(-0.1, 0.1)), q / np.linalg.norm(q)))
        manifold = np.zeros(64)
        count = count_contacts((first, second), a, b, pose, 0.02, manifold)
        rows = manifold[8:40].reshape(4, 8)[:count]
        gaps = [manifold[:3] @ (turn @ row[3:6] + pose[:3] - row[:3]) for row in rows]
        assert min(gaps) == pytest.approx(apart(points_a, points_b @ turn.T + pose[:3]), abs=2e-3)


def thin(kind, rng):
    """Numbers and points of a shape whose sides differ by up to a factor of thirty."""
    a, b, c = np.exp(rng.uniform(math.log(0.05), math.log(1.5), 3))
    if kind == HULL:
        hull = Hull(rng.normal(size=(9, 3)) * (a, b, c))
        return hull.numbers, hull.vertices
    if kind == BOX:
        return np.array([a, b, c]), CORNERS * (a, b, c)
    upper = a if kind == CYLINDER else 0.0
    return np.array([a, upper, b]), np.vstack((ring(a, -b), ring(upper, b) if upper else [[0.0, 0.0, b]]))


@pytest.mark.parametrize(("first", "second"), [pair for pair in PAIRS_WITH_ROUND if pair[0] >= BOX])
def test_deep_overlaps_are_as_deep_as_the_sets_are_and_touch_where_these_are(first, second):
    found = 0
    for seed in range(30):
        rng = np.random.default_rng(seed)
        (a, points_a), (b, points_b) = thin(first, rng), thin(second, rng)
        q = rng.normal(size=4)
        turn = rotation_matrix(q)
        pose = np.concatenate((0.2 * rng.normal(size=3), q / np.linalg.norm(q)))
        at = points_b @ turn.T + pose[:3]
        depth = -apart(points_a, at)
        if depth < 0.02:
            continue
        manifold = np.zeros(64)
        count = count_contacts((first, second), a, b, pose, 0.02, manifold)
        rows = manifold[8:40].reshape(4, 8)[:count]
        gaps = [manifold[:3] @ (turn @ row[3:6] + pose[:3] - row[:3]) for row in rows]
        assert -min(gaps) == pytest.approx(depth, abs=4e-3, rel=0.06)
        deepest = rows[np.argmin(gaps)]
        for x, points in ((deepest[:3], points_a), (turn @ deepest[3:6] + pose[:3], at)):
            assert (ConvexHull(points).equations @ (*x, 1.0)).max() < 8e-3
        found += 1
    assert found > 8


def highest(numbers, normals):
    """Support function of a frustum along many directions."""
    lower, upper, half = numbers
    across = np.hypot(normals[:, 0], normals[:, 1])
    return np.maximum(upper * across + half * normals[:, 2], lower * across - half * normals[:, 2])


def widest_gap(a, b, pose, rng):
    """Largest separation of two frusta over all directions: the best of many, improved by ever smaller random changes."""
    turn, size, best = rotation_matrix(pose[3:]), 1.0, -np.inf
    normals = rng.normal(size=(4000, 3))
    for _ in range(60):
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        gaps = normals @ pose[:3] - highest(a, normals) - highest(b, -normals @ turn)
        if gaps.max() > best:
            best, found = gaps.max(), normals[gaps.argmax()]
        else:
            size *= 0.6
        normals = found + size * rng.normal(size=(200, 3))
    return best


@pytest.mark.parametrize(("first", "second"), [(CYLINDER, CYLINDER), (CYLINDER, CONE), (CONE, CONE)])
def test_one_point_is_on_both_frusta_where_no_direction_separates_them_more(first, second):
    """Those that overlap by less than a tenth of their size, and do not lie on each other."""
    rng, found = np.random.default_rng(first + second), 0
    while found < 60:
        (a, _, _), (b, _, _) = made(first, rng), made(second, rng)
        q = rng.normal(size=4)
        pose = np.concatenate((rng.normal(size=3) * 0.8, q / np.linalg.norm(q)))
        gap = widest_gap(a, b, pose, rng)
        if not -0.02 < gap < 0.1:
            continue
        manifold = np.zeros(64)
        if count_contacts((first, second), a, b, pose, 0.2, manifold) != 1:
            continue
        turn, (x, y), normal = rotation_matrix(pose[3:]), manifold[8:14].reshape(2, 3), manifold[:3]
        lies = [abs(normal[2]), abs(turn[:, 2] @ normal)]
        if max(lies) > 0.97:  # within reach of an end, whose normal is preferred
            continue
        found_gap = normal @ (turn @ y + pose[:3] - x)
        assert gap - 1e-8 < found_gap < gap + 1e-4
        assert turn @ y + pose[:3] - x == pytest.approx(found_gap * normal, abs=1e-7)
        for numbers, point in ((a, x), (b, y)):
            normals = rng.normal(size=(200, 3))
            assert (normals @ point <= highest(numbers, normals) + 1e-7 * np.linalg.norm(normals, axis=1)).all()
        found += 1


def test_cylinders_side_by_side_touch_at_their_sides_wherever_their_ends_are_level():
    """Each rim is nearer to an end of the other than to its side."""
    for tilt in (0.0, 1e-6, 1e-4, 1e-2):
        pose = np.array([0.9995, 0.0, 1e-4, math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0])
        manifold = np.zeros(64)
        count = count_contacts((CYLINDER, CYLINDER), np.full(3, 0.5), np.full(3, 0.5), pose, 0.02, manifold)
        assert count == 2
        assert manifold[:3] == pytest.approx((1.0, 0.0, 0.0), abs=2e-3)


@pytest.mark.parametrize("azimuth", [0, 10, 45, 90, 180, 270])
@pytest.mark.parametrize("tip", [1.0, -1.0])
@pytest.mark.parametrize(("radius", "height"), [(0.5, 0.4), (0.3, 0.5), (0.5, 2.0)])
def test_a_can_and_a_cone_beside_it_on_a_floor_are_as_far_apart_as_their_edges(azimuth, tip, radius, height):
    """Directions that are tried for the search are exact here."""
    x, y = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
    turn = [1.0, 0.0, 0.0, 0.0] if tip > 0 else [0.0, 1.0, 0.0, 0.0]
    reach = 0.5 + radius + 0.01
    pose = np.array([reach * x, reach * y, height / 2 - 0.5, *turn])
    can, cone = np.array([0.5, 0.5, 0.5]), np.array([radius, 0.0, height / 2])
    manifold = np.zeros(64)
    count = count_contacts((CYLINDER, CONE), can, cone, pose, 0.02, manifold)
    if tip < 0 and height > 1.0:  # its base is above the can, and its side leaves it
        assert count == 0
        return
    points = manifold[8 : 8 + 8 * count].reshape(count, 8)
    ahead = rotation_matrix(pose[3:]) @ points[:, 3:6].T + pose[:3, None]
    assert manifold[:3] == pytest.approx((x, y, 0.0), abs=1e-6)
    assert (manifold[:3] @ (ahead - points[:, :3].T)).min() == pytest.approx(0.01, abs=1e-8)


@pytest.mark.parametrize("second", ROUND)
@pytest.mark.parametrize("slenderness", [5, 40, 100])
def test_thin_rods_that_cross_are_separated_perpendicular_to_both(second, slenderness):
    rng, found = np.random.default_rng(slenderness), 0
    while found < 300:
        halves = 10 ** rng.uniform(-0.2, 0.2, 2)
        radii = halves / slenderness
        q = rng.normal(size=4)
        turn = rotation_matrix(q / np.linalg.norm(q))
        normal = np.cross((0.0, 0.0, 1.0), turn[:, 2])
        if np.linalg.norm(normal) < 0.3:
            continue
        normal /= np.linalg.norm(normal)
        on_a, on_b = rng.uniform(-0.9, 0.9) * halves[0], rng.uniform(-0.9, 0.0) * halves[1]
        own = radii[1] if second == CYLINDER else radii[1] * 0.5 * (1.0 - on_b / halves[1])  # of a cone there
        apart = radii[0] + own + min(rng.uniform(0.0, 0.3) * radii.min(), 0.015)
        pose = np.concatenate(
            (on_a * np.array([0, 0, 1.0]) + apart * normal - on_b * turn[:, 2], q / np.linalg.norm(q))
        )
        a = np.array([radii[0], radii[0], halves[0]])
        b = np.array([radii[1], radii[1] if second == CYLINDER else 0.0, halves[1]])
        manifold = np.zeros(64)
        assert count_contacts((CYLINDER, second), a, b, pose, 0.02, manifold) > 0
        assert manifold[:3] @ normal > 0.9
        found += 1


@pytest.mark.parametrize("kind", ROUND)
def test_a_triangle_is_touched_as_the_box_under_it(kind):
    rng = np.random.default_rng(kind)
    triangle = np.array([-9.0, -9.0, 0.0, 9.0, -9.0, 0.0, 0.0, 9.0, 0.0, 1.0, 1.0, 1.0])
    for _ in range(50):
        numbers, points, _ = made(kind, rng)
        q = rng.normal(size=4)
        q /= np.linalg.norm(q)
        height = -(points @ rotation_matrix(q)[2]).min() + rng.uniform(-0.01, 0.01)
        pose = np.concatenate((rng.uniform(-1.0, 1.0, 2), [height], q))
        below = np.concatenate((pose[:2], [height + 9.0], q))
        flat, solid = np.zeros(64), np.zeros(64)
        count = count_contacts((TRIANGLE, kind), triangle, numbers, pose, 0.02, flat)
        assert count == count_contacts((BOX, kind), np.full(3, 9.0), numbers, below, 0.02, solid) > 0
        assert flat[:3] == pytest.approx(solid[:3], abs=1e-12)
        rows, others = (m[8:40].reshape(4, 8)[:count] for m in (flat, solid))
        assert rows[:, 3:6] == pytest.approx(others[:, 3:6], abs=1e-9)
        assert rows[:, :3] == pytest.approx(others[:, :3] - (0.0, 0.0, 9.0), abs=1e-9)


@pytest.mark.parametrize("shape", [kd.Cylinder(0.3, 1.7), kd.Cone(0.8, 0.5)])
def test_mass_is_the_sum_of_slices(shape):
    lower, upper, half = shape.numbers
    x, weights = np.polynomial.legendre.leggauss(8)  # exact for the polynomials of fourth degree that these are
    z, dz = half * x, half * weights
    r = lower + (upper - lower) * (z + half) / (2 * half)
    volume = np.pi * r**2 @ dz
    middle = np.pi * r**2 * z @ dz / volume
    across = (np.pi * r**4 / 4 + np.pi * r**2 * (z - middle) ** 2) @ dz
    found = shape.mass_properties()
    assert found.volume == pytest.approx(volume, rel=1e-13)
    assert found.centre == pytest.approx([0, 0, middle], abs=1e-13)
    assert found.inertia == pytest.approx(np.diag([across, across, np.pi * r**4 / 2 @ dz]), rel=1e-12)


def test_the_centre_of_mass_of_a_cone_is_a_quarter_up():
    world = kd.World()
    cone = world.add_cone(0.5, 2.0, position=(1, 2, 3), orientation=LYING)
    assert kd.Cone(0.5, 2.0).mass_properties().centre == pytest.approx([0, 0, -0.5])
    assert world.position[cone.index] == pytest.approx([1, 2.5, 3])


@pytest.mark.parametrize("kind", ROUND)
def test_the_box_around_one_is_as_large_as_it_is(kind):
    rng = np.random.default_rng(kind)
    for _ in range(50):
        numbers, points, _ = made(kind, rng)
        q = rng.normal(size=4)
        q /= np.linalg.norm(q)
        box = np.array(KINDS[kind].extent(numbers, tuple(q)))
        seen = points @ rotation_matrix(q).T
        assert (box[:3] <= seen.min(axis=0) + 1e-12).all()
        assert (box[3:] >= seen.max(axis=0) - 1e-12).all()
        assert np.concatenate((seen.min(axis=0), seen.max(axis=0))) == pytest.approx(box, abs=3e-3)


def ground(world, kind, **options):
    """Add ground whose surface is z = 0."""
    if kind == "plane":
        world.add_plane(**options)
    elif kind == "box":
        world.add_box((40, 8, 1), position=(15, 0, -0.5), static=True, **options)
    elif kind == "cylinder":
        world.add_cylinder(3.0, 1.0, position=(0, 0, -0.5), static=True, **options)
    else:
        world.add_height_field(np.zeros((80, 16)), 0.5, position=(-5.1, -3.1, 0), **options)


@pytest.mark.parametrize("kind", ["plane", "box", "cylinder", "surface"])
@pytest.mark.parametrize("pose", ["cylinder on its end", "cylinder on its side", "cone on its base"])
def test_it_rests_where_it_is_put(pose, kind):
    world = kd.World()
    ground(world, kind)
    if "cone" in pose:
        body = world.add_cone(0.5, 1.0, position=(0, 0, 0.5))
    else:
        body = world.add_cylinder(0.5, 1.0, position=(0, 0, 0.5), orientation=LYING if "side" in pose else (1, 0, 0, 0))
    start, turn = world.position[body.index].copy(), world.orientation[body.index].copy()
    world.advance(STEP, 600)
    rolls = 5e-3 if "side" in pose and kind == "surface" else 1e-4  # what leans on nothing but friction
    assert world.position[body.index] == pytest.approx(start, abs=rolls)
    assert world.orientation[body.index] == pytest.approx(turn, abs=2 * rolls)


@pytest.mark.parametrize("kind", ["plane", "box", "surface"])
def test_a_cylinder_rolls_down_a_slope_with_two_thirds_of_the_acceleration(kind):
    angle, radius = 0.3, 0.25
    world = kd.World(gravity=(G * math.sin(angle), 0, -G * math.cos(angle)))
    ground(world, kind, friction=1.0)
    body = world.add_cylinder(radius, 0.6, position=(0, 0, radius), orientation=LYING, friction=1.0).index
    world.advance(STEP, 30)
    before = world.velocity[body].copy()
    world.advance(STEP, 60)
    assert (world.velocity[body] - before)[0] == pytest.approx(2 / 3 * G * math.sin(angle), rel=1e-3)
    assert radius * world.angular_velocity[body, 1] == pytest.approx(world.velocity[body, 0], rel=1e-3)
    assert world.position[body, 1:] == pytest.approx([0, radius], abs=1e-3)


@pytest.mark.parametrize("kind", ["cylinder", "cone"])
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_tumbling_gains_no_energy(kind, restitution):
    for seed in range(3):
        rng = np.random.default_rng(seed)
        world = kd.World()
        world.add_plane(restitution=restitution, friction=0.5)
        add = world.add_cylinder if kind == "cylinder" else world.add_cone
        add(0.3, 0.8, position=(0, 0, 2), orientation=rng.normal(size=4), angular_velocity=4 * rng.normal(size=3))
        start, most = world.energy().total, 0.0
        for _ in range(240):
            world.step(STEP)
            most = max(most, world.energy().total)
        assert most <= start * (1 + 1e-9)


def test_cylinders_stand_on_each_other():
    world = kd.World()
    world.add_plane()
    bodies = [world.add_cylinder(0.5, 0.5, position=(0.02 * (-1) ** k, 0, 0.25 + 0.5 * k)).index for k in range(5)]
    start = world.position[bodies].copy()
    world.advance(STEP, 300)
    assert world.position[bodies] == pytest.approx(start, abs=0.01)
    assert np.abs(world.velocity[bodies]).max() < 1e-3


@pytest.mark.parametrize("shape", ["cylinder", "cone"])
def test_what_lands_fast_and_tumbles_does_not_sink_in(shape):
    rng = np.random.default_rng(5)
    world = kd.World()
    world.add_plane(friction=0.5)
    points, bodies = [], []
    for k in range(24):
        size = rng.uniform(0.2, 0.4)
        turn = rng.normal(size=4)
        velocity = (*rng.normal(size=2) * 20, -24)
        options = {
            "velocity": velocity,
            "angular_velocity": rng.normal(size=3) * 5,
            "position": (3 * k, 0, 1.2),
            "friction": 0.5,
        }
        add = getattr(world, f"add_{shape}")
        bodies.append(add(size / 2, size / 2, orientation=turn / np.linalg.norm(turn), **options))
        lower, upper = (size / 2, size / 2) if shape == "cylinder" else (size / 2, 0.0)
        base = -size / 4 if shape == "cylinder" else -size / 8  # from the centre of mass
        points.append(np.vstack((ring(lower, base), ring(upper, base + size / 2))))
    lowest = []
    for _ in range(60):
        world.step(STEP)
        turns = [rotation_matrix(body.orientation) for body in bodies]
        lowest.append([(p @ m.T)[:, 2].min() + b.position[2] for p, m, b in zip(points, turns, bodies, strict=True)])
    assert np.min(lowest) > -0.15  # they fall by 0.1 m in a substep
    assert np.min(lowest[20:]) > -0.06


@pytest.mark.parametrize(("radius", "length", "deepest"), [(0.3, 0.03, 0.03), (0.05, 0.01, 0.02)])
def test_discs_that_land_turning_do_not_sink_in(radius, length, deepest):
    points = np.vstack((ring(radius, -0.5 * length), ring(radius, 0.5 * length)))
    for seed in range(40):
        rng, world = np.random.default_rng(seed), kd.World()
        world.add_plane(friction=0.0)
        turn = rng.normal(size=4)
        disc = world.add_cylinder(
            radius, length, position=(0, 0, 1.2), orientation=turn / np.linalg.norm(turn), friction=0.0,
            velocity=2.0 * rng.normal(size=3), angular_velocity=5.0 * rng.normal(size=3),
        )  # fmt: skip
        energies, lowest = [world.energy().total], []
        for _ in range(90):
            world.step(STEP)
            energies.append(world.energy().total)
            lowest.append((points @ rotation_matrix(disc.orientation).T)[:, 2].min() + disc.position[2])
        assert min(lowest) > -deepest
        assert np.max(energies - np.minimum.accumulate(energies)) < 0.06 * energies[0]


@pytest.mark.parametrize("dip", [-0.3, 0.1, 0.5, 0.9])
def test_a_blunt_cone_that_tips_over_its_rim_stands_on_it(dip):
    turn = 0.5 * (
        0.5 * math.pi + dip
    )  # the tip points down by so many radians, of 1.11 at which its side lies on the plane
    world = kd.World()
    world.add_plane(friction=0.5)
    cone = world.add_cone(0.2, 0.2, position=(0, 0, 1), orientation=(math.cos(turn), 0, math.sin(turn), 0))
    points = np.vstack((ring(0.2, -0.05), ring(0.0, 0.15)))  # from the centre of mass
    cone.position = (0, 0, -(points @ rotation_matrix(cone.orientation).T)[:, 2].min())
    lowest = []
    for _ in range(30):
        world.step(STEP)
        lowest.append((points @ rotation_matrix(cone.orientation).T)[:, 2].min() + cone.position[2])
    assert np.min(lowest) > -0.01


@pytest.mark.parametrize("angle", [90, 50, 30])
@pytest.mark.parametrize("depth", [1e-3, 1e-6, -1e-3])
@pytest.mark.parametrize("along", [0.0, 0.4])
def test_crossed_cylinders_touch_at_one_point_where_their_axes_cross(angle, depth, along):
    half = math.radians(angle) / 2
    turn = (math.cos(half), 0.0, math.sin(half), 0.0)  # about y
    manifold, thin, thick = np.zeros(64), np.array([0.2, 0.2, 1.0]), np.array([0.3, 0.3, 0.7])
    pose = np.array([along * math.sin(2 * half), 0.5 - depth, along * math.cos(2 * half), *turn])
    assert count_contacts((CYLINDER, CYLINDER), thin, thick, pose, 0.02, manifold) == 1
    assert manifold[:3] == pytest.approx((0.0, 1.0, 0.0), abs=2e-3)
    assert manifold[8:11] == pytest.approx((0.0, 0.2, 0.0), abs=3e-3)
    assert manifold[11:14] == pytest.approx((0.0, -0.3, -along), abs=3e-3)


@pytest.mark.parametrize("depth", [1e-3, 1e-6])
def test_a_plate_lies_on_the_middle_of_a_longer_cylinder(depth):
    manifold, pose = np.zeros(64), np.array([0.0, 0.0, -0.5 + depth, math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0])
    assert (
        count_contacts((BOX, CYLINDER), np.array([0.5, 0.5, 0.2]), np.array([0.3, 0.3, 1.0]), pose, 0.02, manifold) == 2
    )
    assert manifold[:3] == pytest.approx((0.0, 0.0, -1.0))
    assert sorted(manifold[[8, 16]]) == pytest.approx((-0.5, 0.5), abs=1e-3)


@pytest.mark.parametrize("layers", [2, 4])
def test_cylinders_that_lie_across_each_other_stay_there(layers):
    world = kd.World()
    world.add_plane(friction=0.6)
    for layer in range(layers):
        for side in (-0.4, 0.4):
            place, axis = ((side, 0), 1) if layer % 2 else ((0, side), 2)
            turn = np.zeros(4)
            turn[[0, axis]] = math.sqrt(0.5)
            world.add_cylinder(0.2, 1.6, position=(*place, 0.2 + 0.4 * layer), orientation=turn, mass=1.0, friction=0.6)
    start = world.position.copy()
    world.advance(STEP, 120)
    assert np.abs(world.velocity).max() < 2e-3
    assert world.position == pytest.approx(start, abs=2e-3)


@pytest.mark.parametrize("depth", [1e-3, 1e-4, -1e-3])
def test_the_apex_of_a_cone_touches_the_side_of_a_cylinder_where_it_is(depth):
    manifold, pose = np.zeros(64), np.array([0.0, 0.5 - depth, 0.0, math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0])
    count = count_contacts((CYLINDER, CONE), np.array([0.2, 0.2, 1.0]), np.array([0.5, 0.0, 0.3]), pose, 0.02, manifold)
    assert count == 1
    assert manifold[:3] == pytest.approx((0.0, 1.0, 0.0), abs=0.01)
    assert manifold[8:11] == pytest.approx((0.0, 0.2, 0.0), abs=2e-3)
    assert manifold[11:14] == pytest.approx((0.0, 0.0, 0.3), abs=2e-3)


def test_cones_that_are_apart_do_not_push_each_other():
    turn = np.array((-0.432756, 0.724374, 0.364195, -0.394166))
    pose = np.concatenate(((0.3125, 0.40625, 0.03125), turn / np.linalg.norm(turn)))  # 26 mm apart
    small, flat = np.array([0.125, 0.0, 0.25]), np.array([1.208342, 0.0, 0.278778])
    assert count_contacts((CONE, CONE), small, flat, pose, 0.02, np.zeros(64)) == 0


@pytest.mark.parametrize("degrees", [2, 5, 10])
def test_a_ridge_that_leans_on_the_rim_of_a_cylinder_tips_onto_its_end(degrees):
    world, tilt = kd.World(), math.radians(degrees)
    world.add_cylinder(0.25, 1.0, position=(0, 0, -0.5), static=True, friction=0.6)
    corners = [(x, y, z) for x in (-1, 1) for y, z in ((0.0, -0.05), (-0.08, 0.05), (0.08, 0.05))]
    ridge = world.add_hull(
        corners,
        position=(0, 0, 0.25 * math.tan(tilt) + 0.05 / math.cos(tilt)),
        orientation=(math.cos(tilt / 2), 0, math.sin(tilt / 2), 0),
        mass=1.0,
        friction=0.6,
    )
    world.advance(STEP, 120)
    assert abs(rotation_matrix(ridge.orientation)[2, 0]) < 1e-3


def test_a_cone_touches_the_long_edge_of_a_column_where_it_is():
    turn = np.array((0.35652, -0.414327, -0.297535, 0.782751))
    pose = np.concatenate(((0.419284, -0.411303, 0.170677), turn / np.linalg.norm(turn)))
    column, cone, manifold = np.array([0.25, 0.25, 1.187837]), np.array([0.5, 0.0, 0.095627]), np.zeros(64)
    assert count_contacts((BOX, CONE), column, cone, pose, 0.02, manifold) == 1
    assert math.hypot(manifold[11], manifold[12]) <= 0.5 + 1e-3
    assert abs(manifold[13]) <= 0.095627 + 1e-3


@pytest.mark.parametrize("degrees", [35, 65, 305])
@pytest.mark.parametrize("shape", ["cylinder", "cone"])
def test_what_stands_over_the_rim_of_a_round_plate_stays_there_in_every_direction(shape, degrees):
    world, angle = kd.World(), math.radians(degrees)
    world.add_cylinder(1.0, 0.1, position=(0, 0, -0.05), static=True, friction=0.6)
    at = (0.95 * math.cos(angle), 0.95 * math.sin(angle), 0.2)
    body = getattr(world, f"add_{shape}")(0.3, 0.4, position=at, mass=1.0, friction=0.6)
    start = body.position.copy()
    world.advance(STEP, 60)
    assert body.position == pytest.approx(start, abs=1e-3)


def test_the_base_of_a_cone_is_found_before_it_lies_on_the_middle_of_a_side():
    """Face and end have the same separation then, and rounding decides which is tried first."""
    rng = np.random.default_rng(0)
    for _ in range(40):
        side, half, gap = rng.uniform(0.3, 0.5), rng.uniform(0.1, 0.3), rng.uniform(-1e-3, 6e-3)
        pose = np.array([side + half + gap, 0.5, 0.2, *np.array([1.0, 0.0, 1.0, 0.0]) / math.sqrt(2.0)])
        box, cone, manifold = np.array([side, 1.4, 0.4]), np.array([0.06, 0.0, half]), np.zeros(64)
        assert count_contacts((BOX, CONE), box, cone, pose, 0.02, manifold) == 4
        assert manifold[:3] == pytest.approx((1.0, 0.0, 0.0))


def test_a_rod_that_has_passed_through_the_middle_of_a_can_comes_out():
    """The way out is along the normal of both axes: by their rims the direction turned over from step to step."""
    turn = np.array((-0.4009, -0.13675, 0.60919, 0.67042))
    world = kd.World(gravity=(0, 0, 0))
    rod = world.add_cylinder(0.0574, 2.5929, mass=1.0)
    place = (-0.0102, 0.0107, -0.008)
    can = world.add_cylinder(0.185, 0.4072, position=place, orientation=turn / np.linalg.norm(turn), mass=1.0)
    world.advance(STEP, 300)
    rod_at, can_at = (
        np.vstack((ring(r, -h), ring(r, h))) @ rotation_matrix(body.orientation).T + body.position
        for body, r, h in ((rod, 0.0574, 1.29645), (can, 0.185, 0.2036))
    )
    assert apart(rod_at, can_at) > -2e-3


def test_a_needle_through_a_plate_is_found():
    """No edge of the plate is near it, and where its tip is, there is no face beside it."""
    turn = np.array((-0.08229, 0.81661, -0.45959, 0.33935))
    pose = np.concatenate(((0.13172, 0.06541, -0.14768), turn / np.linalg.norm(turn)))
    plate, needle = np.array([0.414145, 0.103805, 1.27099]), np.array([0.05043, 0.0, 0.962465])
    manifold, m = np.zeros(64), rotation_matrix(pose[3:])
    assert count_contacts((BOX, CONE), plate, needle, pose, 0.02, manifold) == 1
    points = np.vstack((ring(0.05043, -0.962465), [(0.0, 0.0, 0.962465)])) @ m.T + pose[:3]
    gap = manifold[:3] @ (m @ manifold[11:14] + pose[:3] - manifold[8:11])
    assert gap == pytest.approx(apart(CORNERS * plate, points), rel=0.02)


def test_a_small_cylinder_in_the_side_of_a_wide_one_is_not_pushed_along_its_axis():
    turn = np.array((0.706987, 0.000273, 0.707225, 0.001435))
    pose = np.concatenate(((0.483964, -1.272786, 0.161384), turn / np.linalg.norm(turn)))
    wide, small = np.array([1.275277, 1.275277, 0.358564]), np.array([0.074579, 0.074579, 0.093716])
    manifold = np.zeros(64)
    assert count_contacts((CYLINDER, CYLINDER), wide, small, pose, 0.02, manifold) > 0
    assert manifold[:3] == pytest.approx((0.31, -0.951, 0.0), abs=2e-3)

"""Cloths that touch themselves and each other: nothing passes through, and nothing is thrown about."""

import copy

import numpy as np
import pytest
from random_sheets import crossed, crossings, random_sheet

import kickdrift as kd
from kickdrift.world import tables
from kickdrift.world.collision.broad_phase.bvh import BRANCH
from kickdrift.world.deformables import layout
from kickdrift.world.deformables.mesh import cloth_mesh, grid
from kickdrift.world.deformables.self_collision.closest_features import EDGE_EDGE, VERTEX_FACE, nearest
from kickdrift.world.deformables.self_collision.face_bvh import face_tree, stars

STEP = 1 / 60
UPRIGHT = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)  # warp hangs down


def has_crossings(cloth):
    """What the IPC toolkit says of a cloth."""
    ipctk = pytest.importorskip("ipctk", reason="the IPC toolkit is not installed")
    faces = cloth.triangles.astype(np.int32)
    x = np.asfortranarray(cloth.position)
    return ipctk.has_intersections(ipctk.CollisionMesh(x, ipctk.edges(faces), faces), x)


def heap(self_collision):
    """A strip that stands on its end, and falls into a heap."""
    world = kd.World()
    world.add_plane()
    strip = world.add_cloth_grid(
        (0.6, 0.25), (21, 9), position=(0, 0, 0.32), orientation=UPRIGHT, bending_stiffness=1e-6, damping=1e-3,
        linear_damping=0.5, stretch_stiffness=60.0, shear_stiffness=10.0, thickness=0.008, self_collision=self_collision,
    )  # fmt: skip
    strip.velocity[:, 0] = 0.1 * np.sin(15.0 * strip.position[:, 2])
    return world, strip


def test_a_heap_of_cloth_does_not_cross_itself_and_comes_to_rest():
    world, strip = heap(True)
    fastest = 0.0
    for _ in range(20):
        world.advance(STEP, 6)
        assert crossings(strip) == 0
        fastest = max(fastest, np.abs(strip.velocity).max())
    assert strip.position[:, 2].max() < 0.15
    assert np.sqrt((strip.velocity**2).sum(axis=1).mean()) < 0.02 * fastest


def test_a_heap_of_cloth_sleeps():
    """Folds in which layers touch do not tremble: contact is resolved as often as the cloth's forces that it holds."""
    world, strip = heap(True)
    world.sleeping = True
    world.advance(STEP, 300)
    assert not strip.velocity.any()
    assert crossings(strip) == 0


@pytest.mark.parametrize(("side", "thickness"), [(25, 0.02), (30, 0.012)])
def test_a_sheet_that_drapes_over_a_ball_sleeps(side, thickness):
    """Its folds touch in many places: where these swing freely in any part of a step, it moves at 0.1 m/s for ever."""
    world = kd.World(sleeping=True)
    world.add_plane()
    world.add_sphere(0.3, position=(0, 0, 0.3), static=True)
    sheet = world.add_cloth_grid(
        (1, 1), (side, side), position=(0, 0, 0.65), density=0.2, thickness=thickness, damping=1e-3, linear_damping=0.5,
        self_collision=True,
    )  # fmt: skip
    world.advance(STEP, 600)
    assert not sheet.velocity.any()
    assert crossings(sheet) == 0


def test_a_heap_that_does_not_collide_with_itself_crosses():
    world, strip = heap(False)
    world.advance(STEP, 120)
    assert crossings(strip) > 10


def test_what_is_known_of_pairs_holds_until_they_are_sought_anew():
    """The distance that particles have travelled is counted from the search on, over all substeps."""
    world, _ = heap(True)
    world.advance(STEP, 80)
    count, travelled = world.tables.count(tables.CLOTH_PAIR), world.tables.row(tables.CLOTH_SEARCH, 0)[layout.TRAVELLED]
    seen = [world.tables.row(tables.CLOTH_PAIR_NUMBERS, row)[layout.PAIR_SEEN] for row in range(count)]
    assert 0.0 < max(seen) <= travelled


def test_pairs_that_are_sought_again_around_strays_are_all_that_are_near():
    world = kd.World(gravity=(0, 0, 0))
    below = world.add_cloth_grid((0.5, 0.5), (11, 11), density=0.3)
    above = world.add_cloth_grid((0.4, 0.4), (8, 8), position=(0.03, 0.02, 0.02), orientation=(0.98, 0.15, 0.1, 0.05))
    above.velocity[:, 2], above.velocity[:, 0] = -1.0, 2.0 * np.sin(20.0 * above.position[:, 0])
    stray, near = [], 0
    for _ in range(7):
        world.step(STEP)
        stray.append((world.tables.array(tables.PARTICLE_PATH)[:, layout.PREDICTED_AT] > 0.0).mean())
        pairs = world.tables.array(tables.CLOTH_PAIR)
        vertices = pairs[pairs[:, layout.PAIR_KIND] == VERTEX_FACE, layout.PAIR_PARTICLES :][:, :4]
        known, x = set(map(tuple, vertices.tolist())), np.concatenate((below.position, above.position))
        for points, faces in ((range(121), above.triangles + 121), (range(121, 185), below.triangles)):
            apart = np.linalg.norm(x[points, None] - x[faces].mean(axis=1), axis=2)
            reach = np.linalg.norm(x[faces] - x[faces].mean(axis=1, keepdims=True), axis=2).max(axis=1)
            for k, f in np.argwhere(apart < reach + 0.005).tolist():
                i, face = points[k], faces[f].tolist()
                if np.linalg.norm(nearest(VERTEX_FACE, *map(tuple, x[[i, *face]]))[1]) < 0.005:
                    near += 1
                    assert (i, *face) in known
    assert near > 50  # 87 are
    assert 0.1 < max(stray) < 0.5
    assert min(stray) == 0.0


def test_neighbouring_triangles_of_a_crumpled_sheet_do_not_fold_through_each_other():
    """At its corners a sheet on a ball folds within a triangle's length, where pairs are sought again around few particles."""
    world = kd.World()
    world.add_plane()
    world.add_sphere(0.3, position=(0, 0, 0.3), static=True)
    sheet = world.add_cloth_grid(
        (1.0, 1.0), (24, 24), position=(0, 0, 0.65), density=0.2, damping=1e-3, linear_damping=0.5, self_collision=True
    )
    for _ in range(4):
        world.advance(STEP, 10)
        assert crossings(sheet) == 0


@pytest.mark.parametrize("seed", [4, 5, 11, 12, 21, 23])
def test_random_sheets_that_crumple_do_not_cross_themselves(seed):
    assert crossed(*random_sheet(seed), 80) == (0, 0, 0)


def test_triangles_around_a_particle_overlap_where_another_one_is_folded_away():
    """Five of six triangles are in one plane, all but a turn, and the last lies over the first, whose normal it has."""
    world = kd.World(gravity=(0, 0, 0))
    hexagon = [(0, 0, 0), *((np.cos(k * np.pi / 3), np.sin(k * np.pi / 3), 0) for k in range(6))]
    soft = {"stretch_stiffness": 1e-3, "shear_stiffness": 1e-3, "bending_stiffness": 0.0, "thickness": 0.01}
    fan = world.add_cloth(hexagon, [(0, k + 1, (k + 1) % 6 + 1) for k in range(6)], **soft, self_collision=True)
    turns = np.radians([0, 75, 150, 225, 300, 365])
    fan.position[1:] = np.stack((np.cos(turns), np.sin(turns), 0.01 * np.arange(6)), axis=1)
    fan.position[[0, 6], 2] = 0.02
    fan.velocity[6] = (0, 0, -2)
    for _ in range(10):
        world.step(STEP)
        centre, first, second = fan.position[:3]
        assert np.dot(fan.position[6] - centre, np.cross(first - centre, second - centre)) > 0.0


def test_corners_at_a_vertex_are_a_cycle():
    mesh = cloth_mesh(*grid(5, 4, (1.0, 0.6)))
    after, corners = stars(mesh.triangles).ravel(), mesh.triangles.ravel()
    for corner in range(len(corners)):
        found, at = [corner], int(after[corner])
        while at != corner:
            found.append(at)
            at = int(after[at])
        assert sorted(found) == np.flatnonzero(corners == corners[corner]).tolist()


def test_patches_that_are_not_compared_are_one_piece_with_what_joins_them():
    mesh = cloth_mesh(*grid(14, 9, (1.0, 0.6)))
    tree = face_tree(mesh)

    def faces(node):
        items = tree.items[node : fit(node)]
        return set(items[items >= 0].tolist())

    def fit(node):
        """The node after all that is below, as `bvh.fit` finds it for branches."""
        if tree.items[node] != BRANCH:
            return tree.skips[node]
        return fit(fit(node + 1))

    of_sides = [set(sides[sides >= 0].tolist()) for sides in mesh.sides]

    def share_sides(one, other):
        return any(of_sides[f] & of_sides[g] for f in faces(one) for g in faces(other))

    assert len(tree.neighbours) > 50
    for first, second, between in tree.neighbours.tolist():
        assert first < second
        assert not faces(first) & faces(second)
        assert share_sides(first, between)
        assert between == second or share_sides(between, second)


@pytest.mark.parametrize("self_collision", [True, False])
def test_the_toolkit_sees_the_crossings_too(self_collision):
    world, strip = heap(self_collision)
    world.advance(STEP, 60)
    assert has_crossings(strip) != self_collision


@pytest.mark.parametrize("speed", [1.0, 10.0, 50.0])
def test_sheets_that_fly_into_each_other_keep_momentum_and_do_not_cross(speed):
    world = kd.World(gravity=(0, 0, 0))
    below = world.add_cloth_grid((0.5, 0.5), (11, 11), density=0.3)
    above = world.add_cloth_grid((0.4, 0.4), (8, 8), position=(0.03, 0.02, 0.1), orientation=(0.98, 0.15, 0.1, 0.05))
    above.velocity[:, 2] = -speed
    momentum, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    for _ in range(12):
        world.step(STEP)
        assert crossings(below, above) == 0
    assert world.momentum() == pytest.approx(momentum, abs=1e-11)
    assert world.angular_momentum() == pytest.approx(spin, abs=1e-2 * np.abs(momentum).max() * 0.5)
    assert world.energy().total <= energy * (1 + 1e-3)
    assert below.velocity[:, 2].mean() < -0.1 * speed


def test_a_sheet_lies_on_another_one_a_thickness_above_it():
    world = kd.World()
    world.add_plane()
    below = world.add_cloth_grid((0.5, 0.5), (8, 8), position=(0, 0, 0.003), thickness=0.006, linear_damping=2.0)
    above = world.add_cloth_grid((0.4, 0.4), (9, 9), position=(0, 0, 0.02), thickness=0.01, linear_damping=2.0)
    world.advance(STEP, 90)
    assert below.position[:, 2] == pytest.approx(0.003, abs=3e-4)
    assert above.position[:, 2] == pytest.approx(0.003 + 0.008, abs=5e-4)


@pytest.mark.parametrize(("friction", "slides"), [(0.0, True), (0.5, False)])
def test_friction_stops_a_sheet_on_another_one(friction, slides):
    world = kd.World()
    below = world.add_cloth_grid((1.0, 0.6), (12, 8), friction=friction)
    below.pin(np.arange(96))
    above = world.add_cloth_grid((0.3, 0.3), (6, 6), position=(-0.3, 0, 0.0051), friction=friction)
    above.velocity[:, 0] = 1.0
    world.advance(STEP, 20)
    wanted = 1.0 if slides else 0.0  # after 0.2 s of 0.5 g
    assert above.velocity[:, 0].mean() == pytest.approx(wanted, abs=0.05)


def test_sheets_that_cross_from_the_start_gain_no_energy():
    world = kd.World(gravity=(0, 0, 0))
    first = world.add_cloth_grid((0.6, 0.6), (13, 13), damping=1e-3, linear_damping=1.0)
    second = world.add_cloth_grid(
        (0.5, 0.5), (11, 11), position=(0.013, 0.017, 0.01), orientation=UPRIGHT, damping=1e-3, linear_damping=1.0
    )
    assert crossings(first, second) > 0
    energies = []
    for _ in range(12):
        world.advance(STEP, 10)
        energies.append(world.energy().total)
    assert max(energies) < 1e-3  # of a joule that 10 m/s would be
    assert np.abs(first.velocity).max() < 0.5
    assert np.abs(second.velocity).max() < 0.5


def test_a_crumpled_sheet_that_crosses_itself_a_thousand_times_gains_no_energy():
    world = kd.World(gravity=(0, 0, 0))
    sheet = world.add_cloth_grid(
        (0.8, 0.8), (14, 14), density=0.13, thickness=0.006, stretch_stiffness=130.0, shear_stiffness=31.0, self_collision=True
    )  # fmt: skip
    x, noise = sheet.position[:, 0] + 0.4, np.random.default_rng(0).normal(scale=0.005, size=14 * 14)
    sheet.position[:, 0] = np.abs((x / 0.2 + 1.0) % 2.0 - 1.0) * 0.2  # four layers
    sheet.position[:, 2] = 0.01 * x + noise
    before = world.energy().total
    assert crossings(sheet) > 300
    for _ in range(3):
        world.advance(STEP, 3)
        assert (
            world.energy().total < 1.02 * before
        )  # half as much again, when each crossing shifted a particle for itself


def test_a_corner_that_sticks_through_comes_out():
    world = kd.World(gravity=(0, 0, 0))
    sheet = world.add_cloth_grid((0.6, 0.6), (13, 13), damping=1e-3)
    flap = world.add_cloth([[0.0, 0.02, -0.01], [0.3, 0.1, 0.3], [-0.3, 0.12, 0.3]], [[0, 1, 2]])
    before = crossings(sheet, flap)
    world.advance(STEP, 120)
    assert before > 0
    assert crossings(sheet, flap) == 0


@pytest.mark.parametrize(
    "steps", [20, 50, 57, 240]
)  # falling, crumpling and at rest, where pairs are known for many steps
def test_snapshots_and_copies_of_a_heap_go_on_with_the_same_bits(steps, tmp_path):
    world, strip = heap(True)
    world.advance(STEP, steps)
    snapshot, other, path, new = world.snapshot(), copy.copy(world), world.save(tmp_path / "heap.npz"), kd.World()
    world.advance(STEP, 30)
    end = strip.position.copy()
    world.restore(snapshot)
    new.restore(snapshot)
    for again in (world, other, new, kd.load_world(path)):
        again.advance(STEP, 4)
        again.advance(STEP, 26)
        assert np.array_equal(again.cloths.handle(0).position, end)


def test_pairs_of_a_sheet_at_rest_are_sought_once_in_many_steps():
    world, _ = heap(True)
    world.advance(STEP, 240)
    ages = []
    for _ in range(20):
        world.step(STEP)
        ages.append(world.tables.row(tables.CLOTH_SEARCH, 0)[layout.SEARCH_AGE])
    assert max(ages) > 4.5 * STEP
    assert sum(np.diff(ages) < 0.0) < 4


def test_a_sheet_that_is_put_elsewhere_between_steps_meets_what_is_there():
    world, strip = heap(True)
    other = world.add_cloth_grid((0.5, 0.5), (9, 9), position=(2.0, 0.0, 0.0125), thickness=0.01)
    world.advance(STEP, 240)
    strip.position[:] += (2.0, 0.0, 0.02)
    world.advance(STEP, 60)
    assert crossings(strip, other) == 0
    assert strip.position[:, 2].min() > 0.01
    assert strip.position[:, 2].mean() > other.position[:, 2].mean()


def test_sleeping_cloth_that_is_moved_after_restoring_wakes(tmp_path):
    world = kd.World(sleeping=True)
    world.add_plane()
    world.add_cloth_grid((0.3, 0.3), (5, 5), position=(0, 0, 0.003), linear_damping=2.0)
    world.advance(STEP, 120)
    ends = []
    for again in (world, kd.load_world(world.save(tmp_path / "world.npz"))):
        sheet = again.cloths.handle(0)
        assert not sheet.velocity.any()
        sheet.position[:, 2] += 0.1
        again.advance(STEP, 30)
        ends.append(sheet.position.copy())
    assert np.array_equal(*ends)
    assert ends[0][:, 2].max() < 0.02


def test_a_heap_goes_on_with_the_same_bits_after_a_step_that_fails():
    world, strip = heap(True)
    ball = world.add_sphere(0.1, position=(5, 0, 3))
    world.advance(STEP, 60)
    other, velocity = copy.copy(world), ball.velocity.copy()
    ball.velocity[0] = np.nan
    with pytest.raises(kd.KickdriftError):
        world.step(STEP)
    ball.velocity[:] = velocity
    for again in (world, other):
        again.advance(STEP, 30)
    assert np.array_equal(strip.position, other.cloths.handle(0).position)


def test_a_step_that_fails_after_pairs_are_forgotten_leaves_pairs_of_present_particles(tmp_path):
    world = kd.World(gravity=(0, 0, 0))
    sheets = [world.add_cloth_grid((0.5, 0.5), (14, 14), position=(0, 0, 0.009 * k), thickness=0.01) for k in range(3)]
    world.advance(STEP, 2)
    world.remove_cloth(sheets.pop())
    world.step(STEP)
    world.remove_cloth(sheets.pop())
    other = world.add_cloth_grid((0.5, 0.5), (6, 6), position=(0, 0, 0.009), thickness=0.01)
    world.step(STEP)
    other.friction = 0.9
    other.velocity[3] = np.nan
    with pytest.raises(kd.KickdriftError, match="was lost"):
        world.step(STEP)
    other.velocity[3] = 0.0
    assert world.tables.count(tables.CLOTH_PAIR) > 0
    assert kd.load_world(world.save(tmp_path / "world.npz")).n_steps == world.n_steps


def test_a_tangle_in_the_place_of_removed_cloth_is_saved_and_loaded(tmp_path):
    world = kd.World(gravity=(0, 0, 0))
    sheets = [world.add_cloth_grid((0.5, 0.5), (14, 14), position=(0, 0, 0.004 * k), thickness=0.01) for k in range(3)]
    world.advance(STEP, 2)
    for sheet in sheets[1:]:
        world.remove_cloth(sheet)
    world.add_cloth_grid((0.4, 0.4), (6, 6), orientation=UPRIGHT, thickness=0.01)
    world.step(STEP)
    assert world.tables.row(tables.CLOTH_SEARCH, 0)[layout.CROSSINGS] > 0
    again = kd.load_world(world.save(tmp_path / "world.npz"))
    for one in (world, again):
        one.advance(STEP, 3)
    assert np.array_equal(world.cloths.handle(0).position, again.cloths.handle(0).position)


@pytest.mark.parametrize("speed", [4.0, 15.0])
def test_sheets_that_hit_each_other_hardly_bounce(speed):
    """In intervals that are longer than the way to the other sheet, impulses came too late: restitution was 0.18."""
    found = []
    for gap in np.linspace(0.03, 0.03 + speed * STEP, 8):
        world = kd.World(gravity=(0, 0, 0))
        sheets = [
            world.add_cloth_grid((0.5, 0.5), (9, 9), position=place, thickness=0.005, damping=1e-3, drag=0.0)
            for place in ((0, 0, 0), (0.013, 0.007, gap))
        ]
        sheets[1].velocity[:, 2] = -speed
        world.advance(STEP, 6 + int(2 * gap / speed / STEP))
        found.append((sheets[1].velocity[:, 2].mean() - sheets[0].velocity[:, 2].mean()) / speed)
    assert -0.01 < np.mean(found) < 0.12


def test_the_distance_of_pairs_is_the_least_of_many():
    rng = np.random.default_rng(7)
    grid = np.linspace(0.0, 1.0, 60)
    u, v = (part.ravel() for part in np.meshgrid(grid, grid))
    for _ in range(50):
        p, a, b, c = points = rng.normal(size=(4, 3))
        for kind in (VERTEX_FACE, EDGE_EDGE):
            if kind == VERTEX_FACE:
                inside = u + v <= 1.0
                one, other = p, a + np.outer(u, b - a)[inside] + np.outer(v, c - a)[inside]
            else:
                one, other = p + np.outer(u, a - p), b + np.outer(v, c - b)
            weights, way = nearest(kind, *map(tuple, points))
            least = np.linalg.norm(one - other, axis=1).min()
            assert np.array(weights) @ points == pytest.approx(way)
            assert sum(weights) == pytest.approx(0.0, abs=1e-12)
            assert np.linalg.norm(way) <= least + 1e-12
            assert np.linalg.norm(way) > least - 0.1


@pytest.mark.parametrize("speed", [np.nan, np.inf, 1e200])
def test_a_heap_that_is_lost_ends_the_step_and_leaves_the_world_as_it_was(speed):
    world, strip = heap(True)
    world.advance(STEP, 45)
    strip.velocity[40] = speed
    before = strip.position.copy()
    with pytest.raises(kd.KickdriftError, match="cloth 0 was lost"):
        world.step(STEP)
    assert np.array_equal(strip.position, before)
    strip.velocity[40] = 0.0
    world.step(STEP)
    assert crossings(strip) == 0


def test_self_collision_is_on_or_off():
    with pytest.raises(kd.KickdriftError, match="self_collision"):
        kd.World().add_cloth_grid(self_collision="yes")


@pytest.mark.parametrize("seed", range(4))
def test_a_flat_sheet_at_an_angle_does_not_cross_itself_by_rounding_errors(seed):
    world = kd.World()
    turn = np.array([0.9, 0.1, 0.2, 0.3])
    turn /= np.linalg.norm(turn)
    sheet = world.add_cloth_grid((0.6, 0.25), (10, 10), orientation=turn, self_collision=True)
    sheet.velocity[:] = 0.3 * np.random.default_rng(seed).normal(size=sheet.velocity.shape)
    world.step(1 / 60)
    assert world.tables.array(tables.CLOTH_SEARCH)[0, layout.CROSSINGS] == 0

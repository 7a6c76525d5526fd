"""Contacts of the triangles of cloths with shapes, between vertices."""

import numpy as np
import pytest

import kickdrift as kd

STEP = 1 / 60


def sheet_of(world, n, *, size=2.0, height=1.0, **fabric):
    """A square sheet that is held all around, with n vertices along each side."""
    sheet = world.add_cloth_grid((size, size), (n, n), position=(0, 0, height), **fabric)
    index = np.arange(n * n).reshape(n, n)
    sheet.pin(np.unique(np.concatenate((index[0], index[-1], index[:, 0], index[:, -1]))))
    return sheet


def add(world, kind, size, **body):
    if kind == "ball":
        return world.add_sphere(size, **body)
    if kind == "capsule":
        return world.add_capsule(0.5 * size, 2 * size, **body)
    if kind == "box":
        return world.add_box((2 * size,) * 3, **body)
    if kind == "cylinder":
        return world.add_cylinder(size, 2 * size, **body)
    if kind == "cone":
        return world.add_cone(size, 2 * size, **body)
    return world.add_hull(size * np.random.default_rng(3).normal(size=(14, 3)), **body)


def heights(sheet, points):
    """The heights of the sheet above and below points, by the triangle that is there."""
    corners = sheet.position[sheet.triangles]
    found = []
    for x, y, _ in points:
        u, v = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
        w = np.array((x, y)) - corners[:, 0, :2]
        area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        b, c = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / area, (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / area
        k = np.argmax(np.minimum(np.minimum(b, c), 1 - b - c))
        found.append(
            corners[k, 0, 2]
            + b[k] * (corners[k, 1, 2] - corners[k, 0, 2])
            + c[k] * (corners[k, 2, 2] - corners[k, 0, 2])
        )
    return np.array(found)


def corners_of(box, size):
    signs = np.array(np.meshgrid((-1, 1), (-1, 1), (-1, 1))).reshape(3, -1).T
    w, x, y, z = box.orientation
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return box.position + size * signs @ turn.T


@pytest.mark.parametrize("speed", [3.0, 12.0])
@pytest.mark.parametrize("kind", ["ball", "capsule", "box", "cylinder", "cone", "hull"])
def test_shapes_smaller_than_the_triangles_do_not_fall_through(kind, speed):
    world = kd.World()
    sheet = sheet_of(world, 9, stretch_stiffness=2000.0, shear_stiffness=400.0)
    body = add(
        world,
        kind,
        0.05,
        position=(0.13, 0.06, 1.2),
        velocity=(0, 0, -speed),
        orientation=(0.9, 0.2, 0.3, 0.1),
        density=200.0,
    )
    for _ in range(90):
        world.step(STEP)
        if np.abs(body.position[:2]).max() > 0.95:
            return
        assert body.position[2] > heights(sheet, [body.position])[0]


def test_corners_of_a_box_do_not_show_below_a_net():
    world = kd.World()
    sheet = sheet_of(world, 9, density=0.4, damping=2e-3, linear_damping=1.0)
    box = world.add_box((0.3, 0.3, 0.3), position=(0.04, 0.07, 1.4), orientation=(0.9, 0.3, 0.2, 0.1), density=50.0)
    world.advance(STEP, 300)
    corners = corners_of(box, 0.15)
    assert (corners[:, 2] > heights(sheet, corners) - 1e-3).all()
    assert corners[:, 2].min() < 0.95


def test_the_edge_of_a_table_does_not_show_through_a_coarse_tablecloth():
    world = kd.World()
    world.add_box((1.0, 1.0, 0.1), static=True, position=(0, 0, 0.95), friction=0.8)
    sheet = world.add_cloth_grid((1.4, 1.4), (12, 12), position=(0.02, 0.01, 1.05), damping=5e-3, linear_damping=2.0)
    world.advance(STEP, 240)
    along = np.linspace(-0.45, 0.45, 19)
    rim = np.array(
        [(x, side, 1.0) for side in (-0.5, 0.5) for x in along]
        + [(side, x, 1.0) for side in (-0.5, 0.5) for x in along]
    )
    assert (heights(sheet, rim) > 1.0 - 1e-3).all()
    assert sheet.position[:, 2].min() < 0.9


def test_momentum_of_a_free_sheet_and_a_ball_that_hits_a_triangle():
    world = kd.World(gravity=(0, 0, 0))
    sheet = world.add_cloth_grid((1.0, 1.0), (6, 6), density=0.5)
    ball = world.add_sphere(0.04, position=(0.05, 0.03, 0.2), velocity=(0.1, 0, -2.0), mass=0.1)
    start = ball.mass * ball.velocity
    world.advance(STEP, 60)
    total = ball.mass * ball.velocity + sheet.mass @ sheet.velocity
    assert np.abs(total - start).max() < 1e-12
    assert ball.velocity[2] > -1.0


def test_a_heavy_ball_comes_to_rest_on_a_light_sheet():
    """Without the torque against the tilting of triangles, the sheet trembles with metres a second."""
    world = kd.World()
    sheet = sheet_of(
        world, 19, density=0.37, stretch_stiffness=890.0, shear_stiffness=220.0, damping=5e-3, linear_damping=1.0
    )
    world.add_sphere(0.25, position=(0.05, -0.03, 1.3), mass=5.0, damping=0.5, angular_damping=1.0)
    world.advance(STEP, 900)
    fastest = 0.0
    for _ in range(30):
        world.step(STEP)
        fastest = max(fastest, np.linalg.norm(sheet.velocity, axis=1).max())
    assert fastest < 0.1


def test_energy_does_not_grow_where_a_ball_hits_triangles():
    world = kd.World()
    sheet_of(world, 7, stretch_stiffness=1000.0, shear_stiffness=200.0)
    world.add_sphere(0.06, position=(0.1, 0.05, 1.5), mass=0.3)
    start, most = world.energy().total, -np.inf
    for _ in range(240):
        world.step(STEP)
        most = max(most, world.energy().total)
    assert most < start + 0.01 * 0.3 * 9.81 * 0.5


@pytest.mark.parametrize("gap", [0.0, 0.06])
def test_momentum_where_a_ball_hits_triangles_whose_corners_are_pinned_to_another_body(gap):
    """With no gap the sheet touches the body to which it is pinned as well."""
    world = kd.World(gravity=(0, 0, 0))
    beam = world.add_box((1.0, 0.1, 0.1), position=(0, 0.5 + gap, 0), mass=1.0)
    sheet = world.add_cloth_grid((1.0, 1.0), (4, 4))
    sheet.pin(np.flatnonzero(sheet.position[:, 1] > 0.49), beam)
    ball = world.add_sphere(0.05, position=(0.05, 0.42, 0.3), velocity=(0, 0, -3.0), mass=0.5)
    momentum, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    for _ in range(60):
        world.step(STEP)
        assert world.energy().total < 1.001 * energy
    assert ball.velocity[2] > -1.5
    assert np.abs(world.momentum() - momentum).max() < 1e-12
    assert np.abs(world.angular_momentum() - spin).max() < 0.02 * np.linalg.norm(spin)


@pytest.mark.parametrize("kind", ["ball", "capsule", "box", "cylinder", "cone"])
def test_bodies_lie_on_a_sheet_all_of_whose_vertices_are_pinned(kind):
    world = kd.World()
    sheet = world.add_cloth_grid((1, 1), (7, 7), position=(0, 0, 1), thickness=0.01)
    sheet.pin(np.arange(49))
    turn = (np.sqrt(0.5), 0, np.sqrt(0.5), 0) if kind == "capsule" else (1, 0, 0, 0)
    body = add(world, kind, 0.1, position=(0.03, 0.02, 1.2), orientation=turn, mass=3.0)
    lowest = {"capsule": 0.05, "cone": 0.05}.get(kind, 0.1)  # a quarter of the height of a cone
    world.advance(STEP, 200)
    assert body.position[2] == pytest.approx(1.0 + 0.005 + lowest, abs=1e-4)
    assert np.abs(body.velocity).max() < 0.01


def test_balls_do_not_sink_into_the_pinned_edge_of_a_sheet():
    world, balls = kd.World(), []
    sheet = sheet_of(world, 9, size=1.0, thickness=0.01, friction=0.0)
    for x, y in ((0.5, 0.0), (-0.5, 0.1), (0.22, 0.5), (0.04, -0.49), (0.5, 0.5)):
        balls.append(world.add_sphere(0.06, position=(x, y, 1.15), mass=0.5))
    for _ in range(60):
        world.step(STEP)
        for ball in balls:
            assert np.linalg.norm(sheet.position - ball.position, axis=1).min() > 0.06


def test_pins_push_neither_the_body_they_are_in_nor_one_that_is_joined_to_it():
    world = kd.World(gravity=(0, 0, 0))
    torso = world.add_box((0.4, 0.4, 0.6), mass=5.0)
    arm = world.add_capsule(0.06, 0.4, position=(0, 0.26, 0.1), mass=1.0)
    world.add_ball_joint(torso, arm, anchor=(0, 0.2, 0.25))
    cape = world.add_cloth_grid((0.4, 0.6), (6, 9), position=(0, 0, 0.25))
    cape.pin(np.arange(54), torso)
    assert np.linalg.norm(cape.position - (0, 0.26, 0.25), axis=1).min() < 0.06  # in the arm, too
    world.advance(STEP, 10)
    assert np.abs((arm.velocity, torso.velocity)).max() < 1e-12


@pytest.mark.parametrize("pinned", [False, True])
def test_bodies_of_a_planar_world_stay_in_its_plane_where_sheets_push_or_pull_them(pinned):
    world = kd.World(plane_normal=(0, 1, 0))
    sheet = world.add_cloth_grid((1.0, 1.0), (5, 5), position=(0, 0, 0.5))
    sheet.pin([0, 4, 20, 24])
    ball = world.add_sphere(0.1, position=(0.03, 0.02, 0.61), mass=1.0)
    if pinned:
        sheet.pin([13], ball)
    world.advance(STEP, 20)
    assert ball.position[2] < 0.6
    assert ball.position[1] == pytest.approx(0.02, abs=1e-15)
    assert ball.velocity[1] == 0.0


@pytest.mark.parametrize(("thickness", "radius", "speed"), [(0.004, 0.05, 10.0), (0.01, 0.1, 5.0)])
def test_a_capsule_does_not_press_a_sheet_into_the_floor_by_many_triangles(thickness, radius, speed):
    world = kd.World()
    world.add_plane()
    sheet = world.add_cloth_grid(
        (1.0, 1.0), (13, 13), position=(0, 0, 0.5 * thickness), density=1.0, thickness=thickness,
        stretch_stiffness=100.0, shear_stiffness=20.0, damping=1e-3,
    )  # fmt: skip
    world.add_capsule(
        radius, 0.2, position=(0.02, 0.03, radius + 0.2), orientation=(0.7071, 0.7071, 0, 0), mass=5.0, velocity=(1, 0, -speed)
    )  # fmt: skip
    lowest = 0.0
    for _ in range(24):
        world.advance(1 / 30, 1)
        lowest = min(lowest, sheet.position[:, 2].min())
    # It lies on the floor itself, which leaves no room for the sheet. When each triangle pushed for itself, -7 thicknesses.
    assert lowest > -2.0 * thickness

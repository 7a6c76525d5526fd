"""What gets fast within a step, by gravity, forces, torques and impacts, and what is fast: nothing passes thin walls."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kickdrift import World

STEP = 1 / 60
SHAPES = {
    "box": lambda world, **options: world.add_box((0.1, 0.1, 0.1), **options),
    "sphere": lambda world, **options: world.add_sphere(0.05, **options),
    "capsule": lambda world, **options: world.add_capsule(0.05, 0.2, orientation=(1, 1, 0, 0), **options),
    "cylinder": lambda world, **options: world.add_cylinder(0.05, 0.1, **options),
}


def pushes(acceleration):
    """Gravity as a function of a user's."""
    x, y, z = (float(a) for a in acceleration)

    def push(mass, force):
        for body in range(len(force)):
            force[body, 0] += mass[body] * x
            force[body, 1] += mass[body] * y
            force[body, 2] += mass[body] * z

    return push


def falling(acceleration, way):
    """A world in which that much acts on bodies: as gravity, or by a function; or both, half of it each."""
    acceleration = np.array(acceleration)
    part = {"gravity": 1.0, "function": 0.0, "both": 0.5}[way]
    world = World(gravity=part * acceleration)
    if part < 1.0:
        world.add_force(pushes((1.0 - part) * acceleration))
    return world


@pytest.mark.parametrize("way", ["gravity", "function", "both"])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("gap", [0.001, 0.06, 0.13])
def test_a_body_that_is_pulled_hard_from_rest_does_not_pass_a_thin_floor(gap, shape, way):
    world = falling((0, 0, -800.0), way)
    world.add_box((2, 2, 0.02), position=(0, 0, -0.01), static=True)
    body = SHAPES[shape](world, position=(0, 0, 0.05 + gap), mass=2.0)
    world.advance(STEP, 60)
    assert body.position[2] == pytest.approx(0.05, abs=0.006)


def test_a_body_that_is_pulled_sideways_meets_the_wall_beside_it_and_not_the_post_before_it():
    world = falling((0, 4000.0, 0), "function")
    world.add_box((2, 0.02, 2), position=(0, 0.5, 0), static=True, friction=0.0)
    world.add_box((0.02, 0.2, 2), position=(0.4, 0, 0), static=True)
    body = world.add_sphere(0.05, velocity=(30, 0, 0), mass=1.0, friction=0.0)
    world.step(STEP)  # at 30 m/s it is at the post after 0.35 / 30 s, but 0.27 m aside by then
    assert body.position[:2] == pytest.approx((0.5, 0.44), abs=0.01)
    assert body.velocity[0] == pytest.approx(30.0, abs=1e-6)


def test_a_lever_that_a_torque_swings_does_not_pass_a_thin_wall():
    world = World(gravity=(0, 0, 0))
    world.add_box((0.5, 0.04, 1), position=(0.9, 0.09, 0), static=True)
    lever = world.add_box((2, 0.04, 0.04), mass=1.0)
    world.add_ball_joint(None, lever, anchor=(0, 0, 0))
    for _ in range(20):
        world.apply_torque(lever, (0, 0, 600.0))
        world.step(STEP)
    assert 0.0 < 2.0 * np.arctan2(lever.orientation[3], lever.orientation[0]) < 0.12


@pytest.mark.parametrize("restitution", [0.0, 0.6, 1.0])
def test_forces_of_a_function_do_what_gravity_does(restitution):
    paths = []
    for way in ("gravity", "function"):
        world = falling((0, 0, -9.81), way)
        world.add_plane(friction=0.3, restitution=restitution)
        world.add_box((1, 1, 0.1), position=(0, 0, 0.4), static=True, friction=0.3, restitution=restitution)
        bodies = [
            world.add_sphere(0.1, position=(-0.4, 0, 0.7), velocity=(0.5, 0, 0), restitution=restitution),
            world.add_box((0.2, 0.1, 0.1), position=(0.4, 0, 0.7), angular_velocity=(1, 2, 3), friction=0.3),
        ]
        path = []
        for _ in range(90):
            world.step(STEP)
            path.append([body.position.copy() for body in bodies])
        paths.append(np.array(path))
    assert paths[0] == pytest.approx(paths[1], abs=1e-9)


def test_a_ball_that_a_force_holds_against_a_wall_without_gravity_rests():
    world = falling((1000.0, 0, 0), "function")
    world.add_box((0.01, 4, 4), position=(0.2, 0, 0), static=True, restitution=0.5)
    ball = world.add_sphere(0.05, position=(0.14, 0, 0), mass=1.0)
    world.advance(STEP, 60)
    assert ball.position[0] == pytest.approx(0.145, abs=0.006)
    assert np.abs(ball.velocity).max() < 1e-9


def walls(world, kind, size=1.0, thickness=0.02):
    """Add six smooth, elastic walls around a cube, of boxes or of one mesh with two triangles a side."""
    surface = {"friction": 0.0, "restitution": 1.0}
    if kind == "mesh":
        corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        world.add_mesh(corners, [face for a, b, c, d in sides for face in ((a, c, b), (a, d, c))], **surface)
        return
    for axis in range(3):
        for side in (-1, 1):
            edges, at = [2.1 * size] * 3, [0.0] * 3
            edges[axis], at[axis] = thickness, side * (size + thickness / 2)
            world.add_box(edges, position=at, static=True, **surface)


@pytest.mark.parametrize("kind", ["boxes", "mesh"])
@pytest.mark.parametrize("seed", range(3))
def test_a_gas_of_light_and_heavy_balls_stays_between_thin_walls(seed, kind):
    rng, world, balls = np.random.default_rng(seed), World(gravity=(0, 0, 0)), []
    walls(world, kind)
    while len(balls) < 30:
        radius, at = rng.uniform(0.03, 0.1), rng.uniform(-0.88, 0.88, 3)
        if all(np.linalg.norm(at - ball.position) > radius + 0.11 for ball in balls):
            options = {"velocity": 5 * rng.normal(size=3), "mass": 100 ** rng.uniform(), "friction": 0.0}
            balls.append(world.add_sphere(radius, position=at, restitution=1.0, **options))
    before = world.energy().total
    world.advance(STEP, 300)
    assert max(np.abs(ball.position).max() for ball in balls) < 1.0
    assert world.energy().total == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("gap", [0.005, 0.1, 0.3])
@pytest.mark.parametrize("speed", [10.0, 100.0])
def test_a_light_ball_that_is_struck_does_not_pass_the_thin_wall_behind_it(speed, gap, restitution):
    for way in (0.05, 0.2, 0.5):
        world = World(gravity=(0, 0, 0))
        world.add_box((0.02, 4, 4), position=(0.01, 0, 0), static=True, restitution=restitution)
        light = world.add_sphere(0.05, position=(-0.05 - gap, 0, 0), mass=0.1, restitution=restitution)
        heavy = world.add_sphere(0.05, position=(-0.15 - gap - way, 0, 0), mass=1.0, restitution=restitution)
        heavy.velocity = (speed, 0, 0)
        world.advance(STEP, 20)
        assert light.position[0] < -0.03
        assert heavy.position[0] < -0.1
        assert world.energy().total <= 0.5 * speed**2 * 1.001


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("surface", ["mesh", "height field"])
def test_what_is_shot_at_a_surface_along_its_triangles_does_not_pass_it(surface, shape):
    rng = np.random.default_rng(0)
    for _ in range(15):
        world = World(gravity=(0, 0, 0))
        if surface == "mesh":
            world.add_mesh([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [(0, 1, 2), (0, 2, 3)], friction=0.0)
        else:
            world.add_height_field(np.zeros((19, 19)), 1.0, position=(-9, -9, 0), friction=0.0)
        start, velocity = rng.uniform((-1, -1, 0.2), (1, 1, 2)), rng.uniform((-90, -90, -90), (90, 90, -20))
        body = SHAPES[shape](world, position=start, velocity=velocity, friction=0.0, mass=1.0)
        world.advance(STEP, 4)
        assert body.position[2] > 0.0


def test_a_capsule_bounces_alike_whichever_way_the_world_is_turned():
    surface = {"friction": 0.4, "restitution": 0.5}
    for seed in (166, 206, 233, 278):  # their second end hits in the substep in which the first one has left
        rng = np.random.default_rng(seed)
        position, velocity, spin = (
            rng.uniform((-0.1, -0.1, 0.4), (0.1, 0.1, 0.8)),
            rng.normal(size=3),
            rng.normal(size=3),
        )
        turned, ends = Rotation.from_quat(rng.normal(size=4)), []
        for turn in (Rotation.identity(), Rotation.from_quat(rng.normal(size=4))):
            world = World(gravity=turn.apply((0, 0, -9.81)))
            way = turn.as_quat(scalar_first=True)
            world.add_box((10, 10, 1), position=turn.apply((0, 0, -0.5)), orientation=way, static=True, **surface)
            body = world.add_capsule(
                0.1,
                0.3,
                position=turn.apply(position),
                orientation=(turn * turned).as_quat(scalar_first=True),
                velocity=turn.apply(velocity),
                angular_velocity=turn.apply(4 * spin),
                mass=1.0,
                **surface,
            )
            world.advance(STEP, 40)
            ends.append(turn.inv().apply([body.velocity, body.angular_velocity]))
        assert ends[0] == pytest.approx(ends[1], abs=1e-8), seed


@pytest.mark.parametrize("held", ["on blocks", "fixed"])
@pytest.mark.parametrize(("gravity", "step"), [(800.0, 1 / 60), (9.81, 0.1), (2000.0, 1 / 60)])
def test_what_gravity_pulls_onto_a_thin_plate_that_others_hold_does_not_pass_it(held, gravity, step):
    world = World(gravity=(0, 0, -gravity))
    world.add_plane()
    plate = world.add_box((4, 4, 0.02), position=(0, 0, 1.01), mass=5.0)
    if held == "fixed":
        world.add_fixed_joint(world.ground, plate, anchor=(0, 0, 1.01))
    else:
        for x in (-1.5, 1.5):
            world.add_box((0.5, 4, 1), position=(x, 0, 0.5), static=True)
    world.advance(step, 3)
    ball = world.add_sphere(0.01, position=(0, 0, 1.08), mass=0.01)
    world.advance(step, 5)
    assert ball.position[2] > 1.02


@pytest.mark.parametrize("force", [(1000.0, 0, 0), (0, 0, 1000.0)], ids=["along the wall", "away from it"])
def test_forces_that_do_not_press_leave_restitution_as_it_is(force):
    world = World(gravity=(0, 0, 0))
    world.add_box((50, 50, 1), position=(0, 0, -0.5), static=True, friction=0.0)
    ball = world.add_sphere(0.1, position=(0, 0, 0.1 + 1.5 / 60), velocity=(0, 0, -3.0), mass=1.0, restitution=0.5)
    ball.friction = 0.0
    for _ in range(2):
        world.apply_force(ball, force)
        world.step(1 / 60)
    assert ball.velocity[2] > 1.4


def test_forces_that_press_slower_than_they_add_in_a_few_substeps_do_not_bounce():
    world = World(gravity=(0, 0, 0))
    world.add_box((50, 50, 1), position=(0, 0, -0.5), static=True)
    ball = world.add_sphere(0.1, position=(0, 0, 0.1 + 1.5 / 60), velocity=(0, 0, -3.0), mass=1.0, restitution=0.5)
    for _ in range(60):
        world.apply_force(ball, (0, 0, -1000.0))
        world.step(1 / 60)
    assert abs(ball.velocity[2]) < 1e-6

"""Free flight of rigid bodies against exact solutions and conservation laws; kinematic bodies; forces of users."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

from kickdrift.world.world import World

G = 9.81
STEP = 1 / 60
SUBSTEP = STEP / 4


def free(inertia, angular_velocity, orientation=(1.0, 0.0, 0.0, 0.0)):
    """A body of 1 kg that turns where nothing acts on it."""
    world = World(gravity=(0.0, 0.0, 0.0))
    options = {"mass": 1.0, "inertia": inertia, "orientation": orientation, "angular_velocity": angular_velocity}
    world.add_sphere(0.1, **options)
    return world


def rotation(q):
    return Rotation.from_quat(np.roll(q, -1))


def angle_between(p, q):
    return (rotation(p).inv() * rotation(q)).magnitude()


def exact_orientation(inertia, w, time):
    """Euler's equations with the quaternion that goes with them, from the unit quaternion on."""
    inertia = np.array(inertia)

    def rates(t, y):
        (q0, *u), w = y[:4], y[4:]
        return [-0.5 * np.dot(u, w), *(0.5 * (q0 * w + np.cross(u, w))), *(np.cross(inertia * w, w) / inertia)]

    return solve_ivp(rates, (0.0, time), [1, 0, 0, 0, *w], rtol=1e-12, atol=1e-13, method="DOP853").y[:4, -1]


def test_a_projectile_follows_its_parabola():
    world = World()
    ball = world.add_sphere(0.1, position=(0, 0, 5), velocity=(1, 2, 3)).index
    world.advance(STEP, 120)
    assert world.position[ball] == pytest.approx([2, 4, 5 + 3 * 2 - G / 2 * 4], abs=1e-12)
    assert world.velocity[ball] == pytest.approx([1, 2, 3 - G * 2], abs=1e-12)


def test_without_the_midpoint_a_projectile_has_the_error_of_semi_implicit_euler():
    world = World(midpoint=False)
    ball = world.add_sphere(0.1, position=(0, 0, 5), velocity=(1, 2, 3)).index
    world.advance(STEP, 120)
    error = -G * SUBSTEP * 2 / 2  # -g h t / 2
    assert world.position[ball] == pytest.approx([2, 4, 5 + 3 * 2 - G / 2 * 4 + error], abs=1e-12)
    assert abs(error) > 0.04


def test_bodies_that_fall_side_by_side_touching_follow_their_parabolas():
    world = World()
    for z in (0.0, 1.0, 2.0):
        world.add_box((1, 1, 1), position=(0, 0, z), velocity=(0.3, 0, 0))
    world.advance(STEP, 60)
    fallen = np.array([[0.3, 0, z - G / 2] for z in range(3)])
    assert world.position[1:] == pytest.approx(fallen, abs=1e-10)
    assert world.energy().total == pytest.approx(3 * 1000 * 0.5 * 0.3**2 + 1000 * G * 3, rel=1e-12)


def test_damping_is_implicit_decay():
    world = World(gravity=(0, 0, 0))
    options = {"damping": 0.5, "angular_damping": 0.3}
    world.add_sphere(0.1, velocity=(1, 0, 0), angular_velocity=(0, 0, 2), **options)
    world.advance(STEP, 60)
    assert world.velocity[1, 0] == pytest.approx((1 + 0.5 * SUBSTEP) ** -240, rel=1e-12)
    assert world.angular_velocity[1, 2] == pytest.approx(2 * (1 + 0.3 * SUBSTEP) ** -240, rel=1e-12)
    assert world.velocity[1, 0] == pytest.approx(math.exp(-0.5), rel=1e-3)


def test_spinning_boxes_keep_momentum_angular_momentum_and_energy():
    rng = np.random.default_rng(1)
    world = World(gravity=(0, 0, 0))
    for _ in range(4):
        motion = {"velocity": 0.1 * rng.normal(size=3), "angular_velocity": 3 * rng.normal(size=3)}
        world.add_box(
            rng.uniform(0.1, 1, 3), position=20 * rng.normal(size=3), orientation=rng.normal(size=4), **motion
        )
    p, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    # Angular momentum is a sum of |x| |p|: its roundings are measured by that.
    size = (np.linalg.norm(world.position[1:], axis=1) * np.linalg.norm(world.velocity[1:], axis=1)).sum() * 1000.0
    before = world.orientation[1].copy()
    world.advance(STEP, 1000)
    assert angle_between(before, world.orientation[1]) > 0.1
    assert world.momentum() == pytest.approx(p, rel=1e-12)
    assert np.abs(world.angular_momentum() - spin).max() < 1e-12 * size
    world.advance(STEP, 9000)
    assert world.energy().total == pytest.approx(energy, rel=1e-12)


def test_angular_momentum_of_a_tumbling_body_is_exact():
    world = free((0.2, 0.5, 0.4), (0.7, -0.5, 9.0))
    before = world.angular_momentum()
    world.advance(STEP, 10_000)
    assert np.abs(world.angular_momentum() - before).max() < 1e-12 * np.linalg.norm(before)
    assert world.energy().total == pytest.approx(0.5 * (0.2 * 0.7**2 + 0.5 * 0.5**2 + 0.4 * 81), rel=1e-12)


@pytest.mark.parametrize("speed", [400, 800, 3000, 2e5])
def test_the_energy_of_a_tumbling_body_is_exact_at_any_speed(speed):
    """At 800 rad/s it turns by 3 radians in a substep."""
    world = free((0.2, 0.5, 0.4), speed * np.array((0.6, -0.48, 0.64)))
    energy, before = world.energy().total, world.angular_momentum()
    world.advance(STEP, 30)
    assert world.energy().total == pytest.approx(energy, rel=1e-11)
    assert np.abs(world.angular_momentum() - before).max() < 1e-11 * np.linalg.norm(before)


def test_the_energy_of_slender_bodies_is_exact_too():
    """Sticks and plates of up to 1:100 that turn by up to ten radians in a substep, about axes drawn at random."""
    random, world, bodies = np.random.default_rng(5), World(gravity=(0.0, 0.0, 0.0), margin=1e-3), []
    for k in range(100):
        thin = 10.0 ** -random.uniform(0.0, 2.0)
        size = (random.uniform(0.5, 1.1) * thin, thin, 1.0) if k % 2 else (1.0, random.uniform(0.8, 1.2), thin)
        axis = random.normal(size=3)
        spin = 10.0 ** random.uniform(1.0, 3.4) * axis / np.linalg.norm(axis)
        bodies.append(
            world.add_box(size, position=(5.0 * k, 0, 0), orientation=random.normal(size=4), angular_velocity=spin)
        )

    def energies():
        spins = [rotation(body.orientation).inv().apply(body.angular_velocity) for body in bodies]
        return [0.5 * spin @ body.inertia @ spin for body, spin in zip(bodies, spins, strict=True)]

    before = energies()
    world.advance(STEP, 60)
    np.testing.assert_allclose(energies(), before, rtol=1e-11)


def test_torque_free_precession_is_of_second_order():
    inertia, w, time = (0.2, 0.5, 0.4), (0.7, -0.5, 0.9), 2.0
    exact = exact_orientation(inertia, w, time)
    errors = []
    for count in (20, 40, 80):
        world = free(inertia, w)
        world.advance(time / count, count)
        errors.append(angle_between(world.orientation[1], exact))
    assert errors[0] < 1e-4
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2, 2], abs=0.1)


def test_a_symmetric_top_turns_as_the_exact_one():
    inertia, w, time = (0.3, 0.3, 0.5), np.array([1.0, 0.4, 6.0]), 1.0
    nutation = Rotation.from_rotvec(time * np.array(inertia) * w / inertia[0])
    spin = Rotation.from_rotvec([0, 0, time * w[2] * (1 - inertia[2] / inertia[0])])
    errors = []
    for count in (60, 120):
        world = free(inertia, w)
        world.advance(time / count, count)
        errors.append((rotation(world.orientation[1]).inv() * nutation * spin).magnitude())
    assert errors[0] < 2e-5
    assert errors[0] / errors[1] == pytest.approx(4, abs=0.1)


def flip_period(inertia, w):
    """Landau and Lifshitz, Mechanics, section 37; moments in ascending order."""
    i1, i2, i3 = inertia
    energy = 0.5 * np.dot(inertia, np.square(w))
    square = np.square(np.multiply(inertia, w)).sum()
    if square < 2 * energy * i2:
        i1, i3 = i3, i1
    k2 = (i2 - i1) * (2 * energy * i3 - square) / ((i3 - i2) * (square - 2 * energy * i1))
    return 4 * ellipk(k2) * math.sqrt(i1 * i2 * i3 / ((i3 - i2) * (square - 2 * energy * i1)))


@pytest.mark.parametrize("w", [(0.01, 10.0, 0.01), (0.3, 8.0, -0.1)])
def test_a_wing_nut_flips_with_the_period_of_the_elliptic_integral(w):
    inertia = (0.2, 0.3, 0.4)
    world = free(inertia, w)
    turned, before = [], 0.0
    for step in range(2400):
        world.step(STEP)
        about = rotation(world.orientation[1]).inv().apply(world.angular_velocity[1])[1]
        if step and (about < 0) != (before < 0):
            turned.append((step + before / (before - about)) * STEP)
        before = about
    assert len(turned) >= 6
    assert 2 * np.diff(turned) == pytest.approx(flip_period(inertia, w), rel=1e-3)
    assert world.energy().total == pytest.approx(0.5 * np.dot(inertia, np.square(w)), rel=1e-12)


def test_a_heavy_top_precesses_at_the_slow_root():
    i1, i3, mass, arm, tilt, spin = 0.2, 0.1, 1.0, 0.3, math.radians(15), 75.0
    root = math.sqrt((i3 * spin) ** 2 - 4 * i1 * math.cos(tilt) * mass * G * arm)
    rate = (i3 * spin - root) / (2 * i1 * math.cos(tilt))

    def weight(orientation, torque):
        for body in range(1, len(torque)):
            w, x, y, z = orientation[body, 0], orientation[body, 1], orientation[body, 2], orientation[body, 3]
            torque[body, 0] -= arm * mass * G * 2 * (y * z - w * x)
            torque[body, 1] += arm * mass * G * 2 * (x * z + w * y)

    # About the fixed point, with the moments about it; the angular velocity of steady precession.
    axis = np.array([math.sin(tilt), 0, math.cos(tilt)])
    motion = rate * np.array([0, 0, 1]) + (spin - rate * math.cos(tilt)) * axis
    world = free((i1, i1, i3), motion, (math.cos(tilt / 2), 0, math.sin(tilt / 2), 0))
    world.add_force(weight)
    axes = []
    for _ in range(300):
        world.step(STEP)
        axes.append(rotation(world.orientation[1]).apply([0, 0, 1]))
    x, y, z = np.transpose(axes)
    measured = np.polyfit(STEP * np.arange(300), np.unwrap(np.arctan2(y, x)), 1)[0]
    assert measured == pytest.approx(rate, rel=1e-3)
    assert measured != pytest.approx(mass * G * arm / (i3 * spin), rel=1e-3)  # the usual approximation is not enough
    assert np.arccos(z) == pytest.approx(tilt, abs=math.radians(0.05))


def test_a_planar_world_stays_in_its_plane():
    world = World(plane_normal=(0, 1, 0))
    world.add_plane()
    turn = (math.cos(0.1), 0, math.sin(0.1), 0)
    world.add_box(
        (1, 0.3, 0.5), position=(0, 0.2, 2), orientation=turn, velocity=(1, 0, 0), angular_velocity=(0, 0.3, 0)
    )
    world.advance(STEP, 30)
    assert world.angular_velocity[2, 1] == pytest.approx(0.3, rel=1e-12)
    world.apply_force(world.bodies.handle(2), (0.0, 1e4, 0.0))
    world.apply_torque(world.bodies.handle(2), (1e4, 0.0, 1e4))
    world.advance(STEP, 120)
    assert world.position[2, 1] == 0.2
    assert world.velocity[2, 1] == 0.0
    assert not world.angular_velocity[2, [0, 2]].any()
    assert np.abs(world.orientation[2, [1, 3]]).max() < 1e-12
    assert world.position[2, 2] == pytest.approx(0.25, abs=1e-3)


def test_kinematic_bodies_move_with_their_velocities_and_mind_nothing():
    world = World()
    platform = world.add_box((4, 4, 1), kinematic=True, velocity=(1, 0, 2), angular_velocity=(0, 0, 0.5)).index
    world.add_box((1, 1, 1), position=(0, 0, 1.0), mass=1e6)
    world.advance(STEP, 60)
    assert world.position[platform] == pytest.approx([1, 0, 2], abs=1e-12)
    assert angle_between(world.orientation[platform], (math.cos(0.25), 0, 0, math.sin(0.25))) < 1e-7
    assert world.velocity[platform].tolist() == [1, 0, 2]


def test_forces_and_torques_act_for_one_step():
    world = World(gravity=(0, 0, 0))
    box = world.add_box((1, 2, 3), mass=2.0, inertia=(4.0, 4.0, 4.0))
    world.apply_force(box, (6.0, 0, 0), point=(0, 0.5, 0))
    world.apply_torque(box, (0, 0, 1.0))
    world.step(0.1)
    assert world.velocity[1] == pytest.approx([0.3, 0, 0], rel=1e-12)
    assert world.angular_velocity[1] == pytest.approx([0, 0, 0.1 * (1 - 3) / 4], rel=1e-12)
    world.step(0.1)
    assert world.velocity[1] == pytest.approx([0.3, 0, 0], rel=1e-12)


def test_a_ball_in_air_reaches_its_terminal_velocity():
    radius, density = 0.05, 500.0
    k = 0.5 * 1.2 * 0.47 * math.pi * radius**2

    def drag(velocity, force):
        for body in range(len(force)):
            speed = math.sqrt(velocity[body, 0] ** 2 + velocity[body, 1] ** 2 + velocity[body, 2] ** 2)
            for axis in range(3):
                force[body, axis] -= k * speed * velocity[body, axis]

    world = World()
    world.add_sphere(radius, density=density)
    world.add_force(drag)
    terminal = math.sqrt(4 / 3 * math.pi * radius**3 * density * G / k)
    world.advance(STEP, 120)
    assert world.velocity[1, 2] == pytest.approx(-terminal * math.tanh(G * 2 / terminal), rel=1e-3)
    assert world.position[1, 2] == pytest.approx(-(terminal**2) / G * math.log(math.cosh(G * 2 / terminal)), rel=1e-3)
    world.advance(STEP, 3600)
    assert world.velocity[1, 2] == pytest.approx(-terminal, rel=1e-6)


def test_a_ball_of_half_the_density_of_water_floats_half_under():
    radius = 0.5

    def buoyancy(position, velocity, force):
        for body in range(1, len(force)):
            depth = min(max(radius - position[body, 2], 0.0), 2 * radius)
            force[body, 2] += 1000 * G * math.pi * depth**2 * (3 * radius - depth) / 3
            for axis in range(3):
                force[body, axis] -= 500 * velocity[body, axis]

    world = World()
    world.add_sphere(radius, density=500.0, position=(0, 0, 1.0))
    world.add_force(buoyancy)
    world.advance(STEP, 1200)
    assert world.position[1, 2] == pytest.approx(0.0, abs=1e-4)


def test_forces_know_the_time_and_add_up():
    def early(t, force):
        if t < 0.5:
            force[1, 0] += 2.0

    def always(mass, force):
        force[1, 1] += 3.0 * mass[1]

    world = World(gravity=(0, 0, 0))
    world.add_sphere(0.1, mass=1.0)
    world.add_force(early)
    world.add_force(always)
    world.advance(STEP, 60)
    assert world.velocity[1] == pytest.approx([1.0, 3.0, 0.0], abs=2.0 * SUBSTEP)
    assert world.velocity[1, 1] == pytest.approx(3.0, rel=1e-12)


def springy(rate, substeps, joined, midpoint=True):
    """A world in which a function pulls a ball along x, free or on a slider, and the ball."""
    world, stiffness = World(gravity=(0, 0, 0), substeps=substeps, midpoint=midpoint), rate**2

    def pull(t, position, mass, force):
        for body in range(len(force)):
            force[body, 0] -= mass[body] * (stiffness * position[body, 0] + math.sin(t))

    ball = world.add_sphere(0.1, mass=2.0, position=(1.0, 0.0, 0.0))
    if joined:
        world.add_slider(world.ground, ball, anchor=(1.0, 0.0, 0.0), axis=(1.0, 0.0, 0.0))
    world.add_force(pull)
    return world, ball


@pytest.mark.parametrize("joined", [False, True])
@pytest.mark.parametrize("rate", [3.0, 10.0, 30.0])
def test_springs_that_are_functions_keep_their_amplitude(rate, joined):
    world, ball = springy(rate, 4, joined)
    energies = []
    for _ in range(600):
        world.step(STEP)
        energies.append(0.5 * ball.velocity[0] ** 2 + 0.5 * rate**2 * ball.position[0] ** 2)
    driven = 2.0 / abs(rate**2 - 1.0) * rate  # what the driving force adds to the speed, at most
    assert np.sqrt(2.0 * np.array(energies)) == pytest.approx(rate, abs=driven + 0.01 * rate)


@pytest.mark.parametrize("joined", [False, True])
def test_forces_that_are_functions_act_to_second_order(joined):
    rate, time = 5.0, 1.5
    driven = 1.0 / (rate**2 - 1.0)  # x'' = -rate^2 x - sin t: x = a cos(rate t) + b sin(rate t) - driven sin t
    exact = math.cos(rate * time) + driven / rate * math.sin(rate * time) - driven * math.sin(time)
    speed = -rate * math.sin(rate * time) + driven * (math.cos(rate * time) - math.cos(time))
    errors = {True: [], False: []}
    for midpoint in errors:
        for substeps in (2, 4, 8):
            world, ball = springy(rate, substeps, joined, midpoint)
            world.advance(STEP, 90)
            errors[midpoint].append((ball.position[0] - exact, ball.velocity[0] - speed))
    orders = {midpoint: np.log2(np.abs(np.array(e)[:-1] / np.array(e)[1:])) for midpoint, e in errors.items()}
    assert orders[True] == pytest.approx(np.full((2, 2), 2.0), abs=0.1)
    assert orders[False][:, 0] == pytest.approx(1.0, abs=0.1)

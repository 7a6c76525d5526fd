"""Spin of smooth balls, capsules, cylinders and cones: every normal of such a surface meets its axis."""

import numpy as np
import pytest

import kickdrift as kd

STEP = 1 / 60


def turned(q, v):
    """Rotate a vector by a unit quaternion."""
    w, u = q[0], np.asarray(q[1:])
    return v + 2.0 * np.cross(u, np.cross(u, v) + w * np.asarray(v))


def spin(body):
    """Angular velocity about the z axis of a body, rad/s."""
    return turned(body.orientation, np.array([0.0, 0.0, 1.0])) @ body.angular_velocity


def unit(rng):
    q = rng.normal(size=4)
    return q / np.linalg.norm(q)


def random_pair(rng, restitution, friction):
    """Two capsules, or a ball and a capsule, of which the second flies at the first."""
    world, bodies = kd.World(gravity=(0, 0, 0)), []
    for k in range(2):
        q = unit(rng)
        if k == 1 and rng.random() < 0.4:  # nearly side by side
            q = bodies[0].orientation + rng.choice([0.0, 1e-3, 0.02]) * rng.normal(size=4)
        place = {
            "mass": 10 ** rng.uniform(-1, 1), "friction": friction, "restitution": restitution,
            "position": rng.normal(size=3) * 0.05 + (1.2 * k, 0, 0), "orientation": q / np.linalg.norm(q),
            "velocity": (-k * rng.uniform(1, 5), *(0.3 * rng.normal(size=2))), "angular_velocity": 2.0 * rng.normal(size=3),
        }  # fmt: skip
        radius = rng.uniform(0.05, 0.2)
        if k == 1 or rng.random() < 0.75:
            bodies.append(world.add_capsule(radius, rng.uniform(0.1, 1.0), **place))
        else:
            bodies.append(world.add_sphere(radius, **place))
    return world, bodies


# Capsules without restitution that meet side by side, at an angle below 0.02, touch at two points with one normal.
@pytest.mark.parametrize(("restitution", "most"), [(0.0, 0.02), (0.5, 1e-9), (1.0, 1e-9)])
def test_frictionless_capsules_that_hit_each_other_keep_their_spins_and_the_angular_momentum(restitution, most):
    hits = 0
    for seed in range(60):
        world, bodies = random_pair(np.random.default_rng(seed), restitution, friction=0.0)
        before, started, momentum = bodies[0].velocity.copy(), [spin(b) for b in bodies], world.angular_momentum()
        world.advance(STEP, 60)
        if np.array_equal(bodies[0].velocity, before):
            continue
        hits += 1
        assert [spin(b) for b in bodies] == pytest.approx(started, abs=most)
        assert np.abs(world.angular_momentum() - momentum).max() < 1e-12 * np.linalg.norm(momentum)
    assert hits > 30


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_frictionless_balls_that_hit_each_other_keep_their_spins_and_the_angular_momentum(restitution):
    hits = 0
    for seed in range(60):
        rng, world, balls = np.random.default_rng(seed), kd.World(gravity=(0, 0, 0)), []
        for k in range(2):
            ball = world.add_sphere(
                rng.uniform(0.05, 0.2), mass=10 ** rng.uniform(-1, 1), friction=0.0, restitution=restitution,
                position=rng.normal(size=3) * 0.05 + (1.2 * k, 0, 0), angular_velocity=2.0 * rng.normal(size=3),
                velocity=(-k * rng.uniform(0.5, 8), *(0.3 * rng.normal(size=2))),
            )  # fmt: skip
            balls.append(ball)
        before, spins, momentum = (
            balls[0].velocity.copy(),
            [b.angular_velocity.copy() for b in balls],
            world.angular_momentum(),
        )
        world.advance(STEP, 60)
        hits += not np.array_equal(balls[0].velocity, before)
        for ball, started in zip(balls, spins, strict=True):
            assert ball.angular_velocity == pytest.approx(started, abs=1e-11)
        assert np.abs(world.angular_momentum() - momentum).max() < 1e-10 * np.linalg.norm(momentum)
    assert hits > 30


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_capsules_with_friction_keep_the_angular_momentum_of_all(restitution):
    for seed in range(30):
        world, _ = random_pair(np.random.default_rng(seed), restitution, friction=0.5)
        momentum = world.angular_momentum()
        world.advance(STEP, 60)
        assert np.abs(world.angular_momentum() - momentum).max() < 1e-10 * np.linalg.norm(momentum), seed


def test_capsules_with_friction_change_their_spins():
    world, bodies = random_pair(np.random.default_rng(0), 1.0, friction=0.5)
    started = [spin(b) for b in bodies]
    world.advance(STEP, 60)
    assert max(abs(spin(b) - s) for b, s in zip(bodies, started, strict=True)) > 1e-3


@pytest.mark.parametrize("kind", ["cylinder", "cone"])
@pytest.mark.parametrize(("restitution", "most"), [(1.0, 1e-9), (0.5, 0.02), (0.0, 0.02)])
def test_frictionless_cylinders_and_cones_that_land_near_upright_keep_their_spin(kind, restitution, most):
    """Points of a flat end, fixed in the body, are beside the true contact: with their torque it changed by 36 rad/s."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        world = kd.World()
        world.add_plane(friction=0.0, restitution=restitution)
        tilt, azimuth, radius, length = (
            rng.uniform(0, 0.2),
            rng.uniform(0, 2 * np.pi),
            rng.uniform(0.03, 0.3),
            rng.uniform(0.1, 1),
        )
        axis = np.sin(tilt / 2) * np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        body = getattr(world, f"add_{kind}")(
            radius, length, position=(0, 0, length + radius), orientation=(np.cos(tilt / 2), *axis), friction=0.0,
            restitution=restitution, angular_velocity=10.0 * rng.normal(size=3),
        )  # fmt: skip
        started, energy = spin(body), world.energy().total
        for _ in range(6):
            world.advance(STEP, 15)
            assert spin(body) == pytest.approx(started, abs=most)
            assert world.energy().total < (1 + 1e-9) * energy


@pytest.mark.parametrize("kind", ["cylinder", "cone"])
@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_cylinders_and_cones_that_land_on_a_free_box_keep_the_angular_momentum(kind, restitution):
    for seed in range(15):
        rng = np.random.default_rng(seed)
        world = kd.World(gravity=(0, 0, 0))
        world.add_box((1, 1, 0.2), mass=1.0, friction=0.0, restitution=restitution)
        tilt = rng.uniform(-0.1, 0.1, size=2)
        body = getattr(world, f"add_{kind}")(
            0.15, 0.3, mass=1.0, position=(0.05, 0.02, 0.5), orientation=(1, *tilt, 0) / np.linalg.norm((1, *tilt)),
            velocity=(0, 0, -2), friction=0.0, restitution=restitution,
        )  # fmt: skip
        momentum = world.angular_momentum()
        world.advance(STEP, 40)
        assert body.velocity[2] > -1.99
        assert np.abs(world.angular_momentum() - momentum).max() < 1e-12


@pytest.mark.parametrize(("slope", "tilt"), [(0.3, 0.4), (0.3, 0.8), (0.6, 0.8)])
def test_a_cylinder_that_leans_out_of_the_plane_bounces_off_a_slope_as_the_theory_of_impacts_predicts(slope, tilt):
    """The normal within the plane does not meet its axis, and has a torque about it."""
    world = kd.World(gravity=(0, 0, 0), plane_normal=(0, 1, 0))
    world.add_plane(normal=(0, slope, 1), friction=0.0, restitution=1.0)
    q = np.array([np.cos(tilt / 2) * np.cos(0.15), np.sin(tilt / 2) * np.cos(0.15), np.cos(tilt / 2) * np.sin(0.15),
                  -np.sin(tilt / 2) * np.sin(0.15)])  # fmt: skip
    body = world.add_cylinder(0.1, 0.6, mass=1.0, position=(0, 0, 0.6), orientation=q, velocity=(0, 0, -2),
                              friction=0.0, restitution=1.0)  # fmt: skip
    axes = np.array([turned(q, axis) for axis in np.eye(3)]).T
    down = axes.T @ (-np.array([0.0, slope, 1.0]) / np.hypot(slope, 1.0))
    lowest = axes @ [*(0.1 * down[:2] / np.hypot(*down[:2])), np.sign(down[2]) * 0.3]
    moment = (axes @ np.diag([(3 * 0.1**2 + 0.6**2) / 12] * 2 + [0.1**2 / 2]) @ axes.T)[1, 1]
    lever = np.cross(lowest, [0.0, 0.0, 1.0])[1]
    impulse = 4.0 / (1.0 + lever**2 / moment)
    world.advance(STEP, 40)
    assert body.velocity[2] == pytest.approx(impulse - 2.0, abs=1e-9)
    assert body.angular_velocity[1] == pytest.approx(impulse * lever / moment, abs=1e-9)

"""Articulations that spin, and that are carried along: they keep what they have."""

import numpy as np
import pytest

from kickdrift.world.shapes.mass import rotation_matrix
from kickdrift.world.world import World

STEP = 1 / 60


def pair(joint, spin):
    """Two rods on a line that float, joined in the middle, and spin as one."""
    world = World(gravity=(0, 0, 0))
    rods = [world.add_box((0.4, 0.1, 0.1), position=(x, 0, 0), mass=1.0) for x in (-0.2, 0.2)]
    if joint == "fixed":
        world.add_fixed_joint(*rods, anchor=(0, 0, 0))
    else:
        world.add_hinge(*rods, anchor=(0, 0, 0), axis=(0, 1, 0))
    for rod in rods:
        world.angular_velocity[rod.index] = (0, spin, 0)
        world.velocity[rod.index] = np.cross((0, spin, 0), world.position[rod.index])
    return world


@pytest.mark.parametrize("joint", ["fixed", "hinge"])
@pytest.mark.parametrize("spin", [10.0, 30.0, 60.0, 120.0])
def test_what_spins_keeps_its_energy_and_its_angular_momentum(joint, spin):
    """Up to half a radian in a substep."""
    world = pair(joint, spin)
    energy, momentum = world.energy().total, world.angular_momentum()[1]
    world.advance(STEP, 300)
    assert world.angular_momentum()[1] == pytest.approx(momentum, rel=1e-11)
    assert world.energy().total == pytest.approx(energy, rel=1e-4)


@pytest.mark.parametrize("speed", [1.0, 3.0, 10.0])
def test_a_pendulum_on_a_base_that_moves_swings_as_on_one_at_rest(speed):
    angles = []
    for v in (0.0, speed):
        world = World()
        base = world.add_box((0.2, 0.2, 0.2), kinematic=True, velocity=(v, 0, 0))
        rod = world.add_box((1.0, 0.1, 0.1), position=(0.5, 0, 0), velocity=(v, 0, 0), mass=1.0)
        hinge = world.add_hinge(rod, base, anchor=(0, 0, 0), axis=(0, 1, 0))
        world.advance(STEP, 40)
        angles.append(hinge.angle)
    assert abs(angles[0]) > 0.5
    assert angles[1] == pytest.approx(angles[0], abs=1e-10)


def test_a_base_that_starts_to_move_takes_along_what_hangs_on_it():
    world = World(gravity=(0, 0, 0))
    base = world.add_box((0.2, 0.2, 0.2), kinematic=True)
    rod = world.add_box((0.1, 0.1, 1.0), position=(0, 0, -0.5), mass=1.0)
    world.add_fixed_joint(rod, base, anchor=(0, 0, 0))
    world.velocity[base.index] = (1, 0, 0)
    world.advance(STEP, 60)
    assert world.velocity[rod.index] == pytest.approx([1, 0, 0], abs=1e-9)
    assert world.position[rod.index] - world.position[base.index] == pytest.approx([0, 0, -0.5], abs=1e-6)


@pytest.mark.parametrize("rate", [100.0, -700.0, 1000.0, 5000.0])
def test_turns_are_counted_where_a_substep_is_more_than_half_a_turn(rate):
    world = World(gravity=(0, 0, 0))
    wheel = world.add_cylinder(0.3, 0.1, mass=2.0, angular_velocity=(0, 0, rate))
    hinge = world.add_hinge(None, wheel, anchor=(0, 0, 0), axis=(0, 0, 1))
    world.advance(STEP, 60)
    assert hinge.angle == pytest.approx(rate, rel=1e-9)


def test_turns_of_a_universal_joint_are_counted_alike():
    world = World(gravity=(0, 0, 0))
    wheel = world.add_cylinder(0.3, 0.1, mass=2.0, angular_velocity=(0, 0, -1000.0))
    joint = world.add_universal_joint(None, wheel, anchor=(0, 0, 0), axis_a=(1, 0, 0), axis_b=(0, 0, 1))
    world.advance(STEP, 60)
    assert joint.angles == pytest.approx([0, -1000.0, 0], abs=1e-6)


@pytest.mark.filterwarnings("ignore::kickdrift.UnsolvedWarning")
@pytest.mark.parametrize(("joint", "seed"), [("fixed", 10), ("fixed", 19), ("ball", 1), ("ball", 8)])
def test_linked_bodies_without_restitution_do_not_turn_through_a_thin_wall(joint, seed):
    """Three boxes in a row that turn hit it at 200 m/s, 0.8 m in a substep."""
    rng, world = np.random.default_rng(seed), World(gravity=(0, 0, 0))
    world.add_box((0.02, 40, 40), static=True, friction=0.3)
    q = rng.normal(size=4)
    q /= np.linalg.norm(q)
    along, spin = rotation_matrix(q)[:, 2], 5.0 * rng.normal(size=3)
    velocity = 200.0 * np.array([1.0, *(0.3 * rng.normal(size=2))])
    centre = np.array([-1.5 - rng.random(), 0, 0])
    rods = [
        world.add_box(
            (0.1, 0.1, 0.28),
            position=centre + arm,
            orientation=q,
            velocity=velocity + np.cross(spin, arm),
            angular_velocity=spin,
            friction=0.3,
        )
        for arm in np.outer((-0.3, 0.0, 0.3), along)
    ]
    add = world.add_fixed_joint if joint == "fixed" else world.add_ball_joint
    for rod, other, z in zip(rods, rods[1:], (-0.15, 0.15), strict=False):
        add(rod, other, anchor=centre + z * along)
    world.advance(STEP, 60)
    assert world.position[rods[0].index :, 0].max() < 0.0

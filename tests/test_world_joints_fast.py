"""Articulations that spin, and that are carried along: they keep what they have."""

import numpy as np
import pytest

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

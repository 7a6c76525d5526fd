"""Contacts of links: what stands on feet that are far lighter than itself."""

import numpy as np
import pytest

from kickdrift.scenes import worlds
from kickdrift.world.joints.limits_motors_options import Drive
from kickdrift.world.tables import INERTIA
from kickdrift.world.world import World

STEP = 1 / 60


def one_who_stands(mass, joint, feet, height=1.0):
    """A block on feet of 1 kg, held by fixed joints or by balls with springs; the feet are its last bodies."""
    world = World()
    world.add_plane(friction=0.8)
    block = world.add_box((0.3, 0.4, 0.3), position=(0, 0, height), mass=mass)
    for y in np.linspace(-0.1, 0.1, feet) if feet > 1 else [0.0]:
        foot = world.add_box((0.26, 0.1, 0.06), position=(0, y, 0.03), mass=1.0, friction=0.8)
        if joint == "fixed":
            world.add_fixed_joint(block, foot, anchor=(0, y, 0.08))
        else:
            world.add_ball_joint(block, foot, anchor=(0, y, 0.08), drive=Drive(3000.0, 150.0))
    return world


@pytest.mark.parametrize("joint", ["fixed", "ball"])
@pytest.mark.parametrize("feet", [1, 2])
@pytest.mark.parametrize("mass", [1.0, 10.0, 75.0, 300.0])
def test_light_feet_carry_what_is_heavy_and_come_to_rest(mass, feet, joint):
    world = one_who_stands(mass, joint, feet)
    energy = world.energy().total
    for _ in range(12):
        world.advance(STEP, 10)
        assert world.energy().total <= energy + 1e-5 * energy
    assert world.position[-feet:, 2] == pytest.approx(0.03, abs=2e-4)
    assert np.abs(world.velocity).max() < 2e-3


def test_the_ground_carries_all_of_it():
    world = one_who_stands(75.0, "fixed", 2)
    world.advance(STEP, 120)
    before = world.momentum()
    world.advance(STEP, 1)
    assert world.momentum() - before == pytest.approx(0.0, abs=0.01 * 77 * 9.81 * STEP)


@pytest.mark.parametrize(("stiffness", "stands"), [(1000.0, True), (300.0, False)])
def test_ankles_that_are_stiff_enough_hold_a_person_who_is_pushed(stiffness, stands):
    """An inverted pendulum on two springs falls where 2 k < m g h = 75 x 9.81 x 1.0, that is below 370 N m/rad."""
    person = worlds.humanoid(stiffness=stiffness, damping=stiffness / 20)
    person.world.velocity[person.bodies["chest"].index, 0] = 0.3
    person.world.advance(STEP, 360)
    assert (person.world.position[person.bodies["head"].index, 2] > 1.55) == stands


@pytest.mark.parametrize("mass", [0.1, 1.0, 30.0])
def test_links_that_hit_something_free_keep_momentum_and_gain_no_energy(mass):
    world = World(gravity=(0, 0, 0))
    chain = [world.add_capsule(0.1, 0.8, position=(0, 0, k), mass=1.0) for k in range(5)]
    for k in range(4):
        world.add_ball_joint(chain[k], chain[k + 1], anchor=(0, 0, k + 0.5))
    world.add_box((0.5, 0.5, 0.5), position=(2.0, 0.1, 0.2), velocity=(-4, 0, 0), mass=mass)
    p, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    size = 4.0 * mass + 1.0
    turned = 0.0
    for _ in range(20):
        world.advance(STEP, 3)
        turned = max(turned, np.abs(world.angular_velocity[1]).max())
        assert world.momentum() == pytest.approx(p, abs=1e-12 * size)
        assert world.angular_momentum() == pytest.approx(spin, abs=0.01 * size)
        assert world.energy().total <= 1.0001 * energy
    assert turned > 0.1


def test_contacts_that_joints_leave_no_freedom_do_nothing():
    world = World()
    post = world.add_box((0.2, 0.2, 2.0), position=(0, 0, 0.99), mass=1.0)
    world.add_fixed_joint(post, None, anchor=(0, 0, 0))
    arm = world.add_box((0.2, 0.2, 0.2), position=(0.15, 0, 1.5), mass=1.0)
    tip = world.add_box((0.2, 0.2, 0.2), position=(0.28, 0, 1.55), mass=1.0)
    world.add_fixed_joint(post, arm, anchor=(0.1, 0, 1.5))
    world.add_fixed_joint(arm, tip, anchor=(0.2, 0, 1.5))
    world.add_plane(friction=0.5)
    before = world.position.copy()
    world.advance(STEP, 60)
    assert world.position == pytest.approx(before, abs=1e-6)


def test_limp_humanoids_in_a_heap_gain_no_energy_and_joints_hold():
    world = worlds.ragdolls(count=4)
    energy = world.energy().total
    for _ in range(9):
        world.advance(STEP, 20)
        assert world.energy().total < energy + 1.0
        energy = world.energy().total
    assert np.abs(world.velocity).max() < 3.0


def test_humanoids_in_free_fall_fall_as_everything_does():
    world = World()
    person = worlds.add_person(world, position=(0, 0, 100.0))
    rows = [body.index for body in person.values()]
    mass = world.tables.array(INERTIA)[rows, 0]
    world.angular_velocity[rows[0]] = (1, 2, 3)
    place = mass @ world.position[rows] / mass.sum()
    world.advance(STEP, 120)
    fallen = mass @ world.position[rows] / mass.sum() - place
    assert fallen == pytest.approx([0, 0, -0.5 * 9.81 * 2.0**2], abs=1e-11)
    world.apply_force(person["head"], (0, 0, 1.0))  # no longer alone with gravity: the step is Euler's again
    world.step(STEP)
    assert world.momentum()[2] == pytest.approx(-9.81 * mass.sum() * (2.0 + STEP) + STEP, rel=1e-12)


@pytest.mark.parametrize("step", [1 / 60, 1 / 240])
@pytest.mark.parametrize("masses", [(1.0, 1.0), (1.0, 10.0), (1.0, 100.0), (100.0, 1.0)])
def test_what_joints_hold_together_bounces_as_one(masses, step):
    world = World()
    world.add_plane(restitution=0.5)
    foot = world.add_box((0.3, 0.3, 0.1), position=(0, 0, 1.05), mass=masses[0], restitution=0.5)
    block = world.add_box((0.3, 0.3, 0.3), position=(0, 0, 1.3), mass=masses[1], restitution=0.5)
    world.add_fixed_joint(foot, block, anchor=(0, 0, 1.1))
    heights = []
    while world.time < 0.75:
        world.step(step)
        heights.append(world.position[foot.index, 2] - 0.05 if world.time > 0.5 else 0.0)
    assert max(heights) == pytest.approx(0.25, rel=0.06)


@pytest.mark.parametrize("x", [0.0, 0.1, 0.175])
@pytest.mark.parametrize(("restitution", "most"), [(1.0, 1.005), (0.9, 1.0)])
def test_a_bounce_on_two_links_at_once_gains_no_energy(restitution, most, x):
    world, before = World(gravity=(0, 0, 0)), None
    for k in range(4):
        link = world.add_box((0.3, 0.1, 0.1), position=(0.35 * k, 0, 0), mass=1, restitution=restitution, friction=0)
        if before is not None:
            world.add_hinge(link, before, anchor=(0.35 * k - 0.175, 0, 0), axis=(0, 1, 0))
        before = link
    box = world.add_box((0.2, 0.2, 0.2), position=(x, 0, 1), mass=0.7, restitution=restitution, friction=0)
    world.velocity[box.index] = (0, 0, -6)
    energy = world.energy().total
    for _ in range(25):
        world.step(1 / 60)
        assert world.energy().total <= most * energy * (1 + 1e-12)
    assert world.velocity[box.index, 2] > -1  # it has bounced

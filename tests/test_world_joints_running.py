"""Joints while a world runs: what they bear, what they count, how they break, come and go, and go on from a file."""

import numba
import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.scenes import worlds
from kickdrift.world.joints.limits_motors_options import Motor
from kickdrift.world.tables import JOINT_NUMBERS, MOTION, POSE
from kickdrift.world.world import World

G = 9.81
STEP = 1 / 60


def add(world, **options):
    """Add a body that touches nothing."""
    return world.add_box((0.1, 0.1, 0.1), **{"mass": 1.0, "collides_with": (), **options})


def bits(world):
    return [world.tables.array(table).tobytes() for table in (POSE, MOTION, JOINT_NUMBERS)]


def test_forces_and_torques_are_those_of_statics():
    world = World()
    parts = [add(world, mass=1.0 + k, position=(k + 0.5, 0, 0)) for k in range(3)]
    before = [world.ground, *parts]
    joints = [world.add_fixed_joint(before[k], parts[k], anchor=(k, 0, 0)) for k in range(3)]
    world.advance(STEP, 30)
    for k, joint in enumerate(joints):
        beyond = np.arange(k, 3)
        assert joint.force == pytest.approx([0, 0, G * (1 + beyond).sum()], rel=1e-9, abs=1e-9)
        assert joint.torque == pytest.approx([0, -G * ((1 + beyond) * (beyond + 0.5 - k)).sum(), 0], rel=1e-9, abs=1e-9)
    assert world.position[parts[2].index] == pytest.approx([2.5, 0, 0], abs=1e-9)


@pytest.mark.parametrize(("limits", "breaks"), [
    ({"breaking_force": 2 * G + 0.01}, False), ({"breaking_force": 2 * G - 0.01}, True),
    ({"breaking_torque": 2 * G + 0.01}, False), ({"breaking_torque": 2 * G - 0.01}, True),
])  # fmt: skip
def test_joints_break_where_they_bear_more_than_they_can(limits, breaks):
    world = World()
    body = add(world, mass=2.0, position=(1, 0, 0))
    joint = world.add_fixed_joint(world.ground, body, anchor=(0, 0, 0), **limits)
    world.step(STEP)
    assert world.broken == [joint] * breaks
    world.advance(STEP, 30)
    assert world.broken == []
    assert len(world.joints) == 1 - breaks
    assert world.velocity[body.index, 2] == pytest.approx(-G * 0.5 if breaks else 0.0, rel=1e-9, abs=1e-9)
    if breaks:
        with pytest.raises(ArgumentError, match="has broken"):
            _ = joint.force


def test_joints_come_and_go_while_a_world_runs():
    world = World()
    parts = [add(world, position=(k + 0.5, 0, 0)) for k in range(4)]
    before = [world.ground, *parts]
    joints = [world.add_ball_joint(before[k], parts[k], anchor=(k, 0, 0)) for k in range(4)]
    world.advance(STEP, 20)
    velocity = world.velocity[2:].mean(axis=0)
    world.remove_joint(joints[1])
    world.advance(STEP, 20)
    assert world.velocity[2:].mean(axis=0) - velocity == pytest.approx([0, 0, -G / 3], abs=1e-9)
    world.remove(parts[2])
    assert len(world.joints) == 1
    world.add_fixed_joint(parts[1], parts[3], anchor=(0, 0, 0))
    spin, momentum = world.angular_momentum(), world.momentum()
    world.advance(STEP, 20)
    assert np.isfinite(spin).all()
    assert np.isfinite(momentum).all()
    relative = world.position[parts[3].index] - world.position[parts[1].index]
    distance = np.linalg.norm(relative)
    world.advance(STEP, 60)
    relative = world.position[parts[3].index] - world.position[parts[1].index]
    assert np.linalg.norm(relative) == pytest.approx(distance, abs=1e-6)


def test_hinges_and_universal_joints_count_turns():
    world = World((0, 0, 0))
    wheel, cross = add(world), add(world, position=(0, 2, 0))
    hinge = world.add_hinge(world.ground, wheel, anchor=(0, 0, 0), axis=(1, 2, 2), motor=Motor(-7.0))
    axes = {"axis_a": (0, 0, 1), "axis_b": (1, 0, 0)}
    universal = world.add_universal_joint(
        world.ground, cross, anchor=(0, 2, 0), about_b=kd.Axis(motor=Motor(5.0)), **axes
    )
    world.advance(STEP, 600)
    assert hinge.angle == pytest.approx(-70.0, rel=1e-9)
    assert universal.angles[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert universal.angles[1] == pytest.approx(50.0, rel=1e-9)


def test_a_world_goes_on_from_a_file_and_from_a_snapshot_with_the_same_bits(tmp_path):
    world = worlds.arm().world
    world.advance(STEP, 20)
    kept, path = world.snapshot(), world.save(tmp_path / "arm")
    world.advance(STEP, 20)
    wanted = bits(world)
    world.restore(kept)
    world.advance(STEP, 20)
    assert bits(world) == wanted
    other = kd.load_world(path)
    for _ in range(20):
        other.step(STEP)
    assert bits(other) == wanted


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_threads_do_not_change_a_bit(threads):
    def ran(**options):
        world = World(**options)
        world.add_plane()
        before = world.ground
        for k in range(6):
            box = world.add_box((0.4, 0.2, 0.2), position=(0.5 * k + 0.25, 0, 1 + 0.1 * k))
            world.add_hinge(before, box, anchor=(0.5 * k, 0, 1), axis=(0, 1, 0.2))
            before = box
        world.advance(STEP, 60)
        return bits(world)

    most = numba.config.NUMBA_NUM_THREADS
    if threads > most:
        pytest.skip(f"Numba has {most} threads")
    numba.set_num_threads(threads)
    try:
        assert ran(threads=True) == ran()
    finally:
        numba.set_num_threads(most)

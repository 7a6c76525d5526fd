"""What may be changed between the steps of a world: the next step goes by it."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError

STEP = 1 / 60


def stack(**settings):
    """Three boxes on the floor, and a fast ball among them."""
    world = kd.World(**settings)
    world.add_plane()
    for k in range(3):
        world.add_box((1, 1, 1), position=(0, 0, k + 0.5))
    world.add_sphere(0.2, position=(3, 0, 0.5), velocity=(-4, 0, 0))
    return world


def test_substeps_changed_between_steps_are_those_of_a_world_made_with_them():
    changed, made = stack(substeps=4), stack(substeps=7)
    made.substeps = 4
    changed.advance(STEP, 10)
    made.advance(STEP, 10)
    changed.substeps = made.substeps = 7
    changed.advance(STEP, 40)
    made.advance(STEP, 40)
    kept = stack(substeps=4)
    kept.advance(STEP, 50)
    assert changed.substeps == 7
    assert np.array_equal(changed.position, made.position)
    assert not np.array_equal(changed.position, kept.position)


@pytest.mark.parametrize("substeps", [0, -1, 2.5, True, "4", None, 10_001, 2**70])
def test_substeps_that_cannot_be_are_refused(substeps):
    world = stack()
    with pytest.raises(ArgumentError, match="substeps="):
        world.substeps = substeps
    assert world.substeps == 4


def test_gravity_changed_between_steps_pulls_the_other_way():
    world = kd.World()
    ball = world.add_sphere(0.1)
    world.advance(STEP, 60)
    world.gravity = (0, 0, 9.81)
    world.advance(STEP, 60)
    assert world.velocity[ball.index] == pytest.approx([0, 0, 0], abs=1e-12)
    assert world.gravity.tolist() == [0, 0, 9.81]
    with pytest.raises(ArgumentError, match="gravity="):
        world.gravity = (0, 0, np.nan)


def test_gravity_wakes_what_sleeps():
    world = stack(sleeping=True)
    world.advance(STEP, 600)
    assert not world.velocity[2:5].any()
    world.gravity = (0, 0, 1)
    world.advance(STEP, 1)
    assert (world.velocity[2:5, 2] > 0).all()


def test_what_has_rested_for_a_while_does_not_fall_asleep_in_the_air():
    world = kd.World(sleeping=True)
    world.add_plane()
    box = world.add_box((1, 1, 1), position=(0, 0, 0.5))
    world.advance(STEP, 29)
    world.gravity = (0, 0, 1)
    world.advance(STEP, 60)
    assert world.velocity[box.index, 2] == pytest.approx(1.0, rel=1e-3)


def test_time_rested_does_not_outlast_sleep_that_was_turned_off():
    world = kd.World(sleeping=True)
    world.add_plane()
    box = world.add_box((1, 1, 1), position=(0, 0, 0.5))
    world.advance(STEP, 29)
    world.sleeping = False
    world.velocity[box.index] = (0, 0, 9.81)
    world.advance(STEP, 59)
    world.sleeping = True
    world.advance(STEP, 5)
    assert world.velocity[box.index, 2] == pytest.approx(9.81 * (1 - 64 / 60), rel=1e-3)


def test_gravity_cannot_be_written_into_in_vain():
    world = kd.World()
    with pytest.raises(ValueError, match="read-only"):
        world.gravity[2] = 0


def test_sleeping_may_begin_and_end():
    world = stack()
    world.advance(STEP, 600)
    assert world.velocity[2:5].any()
    world.sleeping = True
    world.advance(STEP, 60)
    assert not world.velocity[2:5].any()
    world.sleeping = False
    world.advance(STEP, 1)
    assert world.velocity[2:5].any()


def test_what_lies_next_to_each_other_without_touching_sleeps():
    world = kd.World(sleeping=True)
    world.add_plane(friction=0.5)
    for k in range(2):
        world.add_box((1, 1, 1), position=(1.01 * k, 0, 0.5 + 0.3 * k), friction=0.5)
    world.advance(STEP, 300)
    assert not world.velocity.any()

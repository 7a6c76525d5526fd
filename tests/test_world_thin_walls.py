"""Slender bodies that are thrown at thin walls with spin: none of their ends comes through."""

import numpy as np
import pytest

from kickdrift import World
from kickdrift.core.vectors import matrix

STEP, COUNT, SIDE = 1 / 60, 60, 2.0


def beyond(body, size, at):
    """Return how far a box is above x = at, m."""
    first, _, _ = matrix(tuple(body.orientation))
    return body.position[0] - at + np.abs(first) @ np.array(size) / 2


def test_a_plate_that_tumbles_as_it_flies_does_not_dip_into_a_wall():
    """About one axis, as it began, it would not reach the wall within the step."""
    world, size = World(gravity=(0, 0, 0)), (0.0126, 0.2237, 0.4514)
    world.add_box((0.02, 4, 4), position=(0.41, 0, 0), static=True)
    turn = (0.2, 0.2, 2.1, -1.1)
    motion = {"velocity": (13.5, 7.7, 2.7), "angular_velocity": (68.1, 32.7, 103.1)}
    plate = world.add_box(size, orientation=turn, **motion)
    for _ in range(3):
        world.step(STEP)
        assert beyond(plate, size, 0.4) < 2e-3


@pytest.mark.parametrize("seed", [0, 2])
def test_sticks_and_plates_that_spin_do_not_come_through_a_thin_wall(seed):
    """At 1400 rad/s the way of an end in a step is ten times its distance from the wall."""
    random = np.random.default_rng(seed)
    world, thrown = World(gravity=(0, 0, 0)), []
    world.add_box((0.02, SIDE * (COUNT + 1), 4), position=(0.01, SIDE * (COUNT - 1) / 2, 0), static=True)
    for k in range(COUNT):
        length = random.uniform(0.1, 0.5)
        thin = length / random.uniform(5, 40)
        size = (length, thin if k % 2 else length * random.uniform(0.4, 1), thin)
        motion = {"orientation": random.normal(size=4), "velocity": (random.uniform(2, 10), *random.normal(size=2))}
        spin, restitution = 800 * random.normal(size=3), random.choice([0.0, 0.5])
        place = (-0.4, SIDE * k, 0)
        body = world.add_box(size, position=place, angular_velocity=spin, restitution=restitution, **motion)
        thrown.append((body, size))
    for _ in range(12):
        world.step(STEP)
        assert max(beyond(body, size, 0.0) for body, size in thrown) < 3e-3

"""Cloths that have come to rest sleep, and wake."""

import copy

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.world.deformables.layout import IS_ASLEEP

STEP = 1 / 60


def sleeps(world):
    """Whether the cloths of a world are left alone."""
    return bool(world.tables.array(kd.world.tables.CLOTH)[0, IS_ASLEEP])


def draped(steps=420, **options):
    """A sheet that has fallen over a ball, and has been left to rest."""
    world = kd.World(sleeping=True)
    world.add_plane()
    ball = world.add_sphere(0.2, position=(0, 0, 0.2), density=500.0)
    sheet = world.add_cloth_grid(
        (0.7, 0.7),
        (12, 12),
        position=(0.01, 0.02, 0.42),
        damping=2e-3,
        linear_damping=3.0,
        bending_stiffness=1e-4,
        **options,
    )
    world.advance(STEP, steps)
    return world, ball, sheet


def test_a_draped_sheet_sleeps_and_stays_where_it_is():
    world, ball, sheet = draped()
    assert sleeps(world)
    before = sheet.position.copy()
    snapshot, other = world.snapshot(), copy.copy(world)
    world.advance(STEP, 30)
    assert np.array_equal(sheet.position, before)
    assert not sheet.velocity.any()
    assert np.linalg.norm(sheet.position - ball.position, axis=1).min() > 0.2
    world.restore(snapshot)
    for again in (world, other):
        again.advance(STEP, 2)
        assert sleeps(again)
    world.sleeping = False
    world.advance(STEP, 1)
    assert not sleeps(world)


def test_a_sheet_that_still_falls_does_not_sleep():
    world, _, _ = draped(30)
    assert not sleeps(world)


@pytest.mark.parametrize("stirred", ["velocity", "position", "wind", "ball", "unpin"])
def test_a_sheet_that_sleeps_wakes(stirred):
    world, _, sheet = draped(drag=1.0)
    assert sleeps(world)
    before = sheet.position.copy()
    if stirred == "velocity":
        sheet.velocity[3] = (0, 0, 1.0)
    elif stirred == "position":
        sheet.position[3, 2] += 0.01
    elif stirred == "wind":
        sheet.wind = (4.0, 0, 0)
    elif stirred == "ball":
        world.add_sphere(0.05, position=(0.05, 0, 0.7), density=200.0)
    else:
        sheet.pin([0])
        sheet.unpin([0])
    world.advance(STEP, 25)
    assert not sleeps(world)
    assert stirred == "unpin" or np.abs(sheet.position - before).max() > 1e-3


def test_a_ball_on_a_sheet_that_moves_stays_awake_and_sleeps_with_it():
    world = kd.World(sleeping=True)
    sheet = world.add_cloth_grid((0.6, 0.6), (9, 9), damping=5e-3, linear_damping=3.0, density=0.5)
    index = np.arange(81).reshape(9, 9)
    sheet.pin(np.concatenate((index[0], index[-1], index[:, 0], index[:, -1])))
    ball = world.add_sphere(0.1, position=(0, 0, 0.12), mass=0.2, damping=1.0, angular_damping=5.0)
    world.advance(STEP, 600)
    assert sleeps(world)
    height = ball.position[2]
    world.advance(STEP, 60)
    assert ball.position[2] == height
    sheet.unpin(index[0])
    lowest = height
    for _ in range(30):
        world.step(STEP)
        lowest = min(lowest, ball.position[2])
    assert lowest < height - 0.01


def test_a_pinned_vertex_that_moves_slowly_keeps_a_sheet_awake():
    world = kd.World(sleeping=True)
    sheet = world.add_cloth_grid(vertices=(6, 6), linear_damping=3.0, damping=1e-3)
    sheet.pin([0, 5])
    sheet.velocity[[0, 5]] = (0, 0, 0.04)
    before = sheet.position[0].copy()
    world.advance(STEP, 300)
    assert sheet.position[0] - before == pytest.approx([0, 0, 0.2], abs=1e-12)
    sheet.velocity[[0, 5]] = 0.0
    world.advance(STEP, 300)
    assert sleeps(world)

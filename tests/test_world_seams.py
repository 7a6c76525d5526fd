"""Floors of several shapes: bodies slide over their seams as on one shape."""

import math

import numpy as np
import pytest

import kickdrift as kd

STEP = 1 / 60
UPRIGHT, LYING = (1, 0, 0, 0), (math.sqrt(0.5), math.sqrt(0.5), 0, 0)
CORNERS = [(x, y, z) for x in (-1, 1) for y in (-15, 15) for z in (-0.5, 0.5)]


def floor(kind, friction):
    world = kd.World()
    for k in range(-2, 6):
        place = {"position": (2 * k, 0, -0.5), "static": True, "friction": friction}
        if kind == "boxes":
            world.add_box((2, 30, 1), **place)
        else:
            world.add_hull(CORNERS, **place)
    return world


def add(world, kind, velocity, friction=0.0):
    options = {"mass": 2.0, "velocity": velocity, "friction": friction}
    if kind == "box":
        return world.add_box((0.8, 0.8, 0.2), position=(0.13, 0, 0.1), **options)
    if kind == "hull":
        return world.add_hull(0.2 * np.array(CORNERS) / (1, 15, 1), position=(0.13, 0, 0.1), **options)
    if kind == "sphere":
        return world.add_sphere(0.3, position=(0.13, 0, 0.3), **options)
    if kind == "capsule":
        return world.add_capsule(0.2, 0.6, position=(0.13, 0, 0.2), orientation=LYING, **options)
    turn = LYING if kind == "lying cylinder" else UPRIGHT
    return world.add_cylinder(0.2, 0.4, position=(0.13, 0, 0.2), orientation=turn, **options)


@pytest.mark.parametrize("velocity", [(4, 0, 0), (3, 1.5, 0), (-3.3, 0.2, 0)])
@pytest.mark.parametrize("kind", ["box", "hull", "sphere", "capsule", "cylinder", "lying cylinder"])
@pytest.mark.parametrize("ground", ["boxes", "hulls"])
def test_bodies_without_friction_slide_over_seams_at_the_same_velocity(ground, kind, velocity):
    world = floor(ground, 0.0)
    body = add(world, kind, velocity)
    world.advance(STEP, 60)
    assert np.abs(body.velocity - velocity).max() < 2e-3 * np.linalg.norm(velocity)


def test_friction_stops_a_box_on_seams_where_it_does_on_one_floor():
    seams, whole = floor("boxes", 0.3), kd.World()
    whole.add_box((20, 30, 1), position=(3, 0, -0.5), static=True, friction=0.3)
    ways = []
    for world in (seams, whole):
        box = add(world, "box", (4, 0, 0), 0.3)
        world.advance(STEP, 120)
        ways.append(box.position[0] - 0.13)
    assert ways[0] == pytest.approx(ways[1], rel=0.015)


@pytest.mark.parametrize("height", [0.02, 0.5])
def test_a_step_up_in_the_floor_stops_a_box(height):
    world = floor("boxes", 0.0)
    world.add_box((1, 30, 1), position=(2.5, 0, height - 0.5), static=True, friction=0.0)
    box = add(world, "box", (4, 0, 0))
    world.advance(STEP, 60)
    assert box.position[0] < 1.61

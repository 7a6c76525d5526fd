"""Planar worlds: billiards between walls that are oblique to the plane, floors across it, joints between different depths."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.world.joints.limits_motors_options import Motor
from kickdrift.world.world import World

G = 9.81
STEP = 1 / 60
TILTED = np.array([[0.48, 0.6, -0.64], [-0.8, 0.6, 0.0], [0.384, 0.512, 0.768]]).T
TILTED = np.linalg.qr(TILTED)[0]  # axes of a plane that is none of the world's


@pytest.mark.parametrize("axes", [np.eye(3), TILTED])
def test_walls_oblique_to_the_plane_throw_back_as_their_traces_in_it(axes):
    radius, slopes = 0.1, (0.5, -0.9)
    world = World(gravity=(0, 0, 0), plane_normal=axes[:, 2])
    for side, slope in zip((-1, 1), slopes, strict=True):
        normal = axes @ (-side * math.cos(slope), 0.0, math.sin(slope))
        world.add_plane(normal=normal, point=axes @ (side, 0.0, 0.0), restitution=1.0, friction=0.5)
    ball = world.add_sphere(radius, mass=1.0, velocity=axes @ (3.7, 0.2, 0.0), restitution=1.0, friction=0.0)
    world.advance(STEP, 120)
    # A ball touches a wall with the part cos(slope) of its radius, at a distance of radius / cos(slope).
    left, right = -1 + radius / math.cos(slopes[0]), 1 - radius / math.cos(slopes[1])
    way = (7.4 - left) % (2 * (right - left))
    x = left + min(way, 2 * (right - left) - way)
    assert axes.T @ ball.position == pytest.approx([x, 0.4, 0.0], abs=1e-12)
    assert np.linalg.norm(ball.velocity) == pytest.approx(math.hypot(3.7, 0.2), rel=1e-12)


def test_balls_at_different_depths_touch_where_their_circles_in_the_plane_do():
    world = World(gravity=(0, 0, 0), plane_normal=(0, 0, 1))
    options = {"mass": 1.0, "restitution": 1.0, "friction": 0.0}
    one = world.add_sphere(0.5, position=(-1, 0, 0.6), velocity=(2, 0, 0), **options)
    other = world.add_sphere(0.5, **options)
    world.advance(STEP, 60)
    assert one.position == pytest.approx([-0.8, 0, 0.6], abs=1e-9)  # they are 0.8 m apart, and it stops there
    assert other.position == pytest.approx([2 * (1 - 0.1), 0, 0], abs=1e-9)


def test_oblique_walls_rub_as_a_wedge_does_in_its_groove():
    slope, friction = 0.8, 0.3
    world = World(gravity=(0, -G, 0), plane_normal=(0, 0, 1))
    world.add_plane(normal=(0, math.cos(slope), math.sin(slope)), friction=friction)
    turn = (math.cos(slope / 2), math.sin(slope / 2), 0, 0)
    at = (0, 0.1 / math.cos(slope), 0)
    box = world.add_box((1, 0.2, 0.5), position=at, orientation=turn, mass=1.0, friction=friction, velocity=(5, 0, 0))
    world.advance(STEP, 10)
    before = box.velocity[0]
    world.advance(STEP, 10)
    assert (before - box.velocity[0]) / (10 * STEP) == pytest.approx(friction * G / math.cos(slope), rel=1e-3)


def test_things_slide_over_a_floor_that_is_the_plane():
    world = World(plane_normal=(0, 0, 1))
    world.add_plane(friction=0.3)
    options = {"mass": 1.0, "friction": 0.3, "velocity": (3, 0, 0)}
    things = [world.add_box((0.4, 0.4, 0.1), position=(0, 0, 0.05), **options)]
    things.append(world.add_sphere(0.1, position=(0, 2, 0.09), **options))  # held below the floor's surface
    world.advance(STEP, 30)
    for thing in things:
        assert thing.velocity == pytest.approx([3 - 0.3 * G / 2, 0, 0], rel=1e-3, abs=1e-12)


@pytest.mark.parametrize("joint", ["add_distance_joint", "add_rope_joint"])
def test_lines_between_different_depths_hold_their_length_in_the_plane(joint):
    paths = []
    for depth in (0.0, 0.5):
        world = World(plane_normal=(0, 1, 0))
        ball = world.add_sphere(0.1, position=(1, depth, 0), mass=1.0)
        getattr(world, joint)(None, ball, anchor_a=(0, 0, 0), anchor_b=(1, depth, 0), length=math.hypot(1, depth))
        world.advance(STEP, 90)
        paths.append(ball.position * (1, 0, 1))
        assert np.linalg.norm(paths[-1]) == pytest.approx(1.0, abs=1e-4)
        assert ball.position[1] == depth
    assert paths[1] == pytest.approx(paths[0], abs=1e-9)


def test_joints_along_which_nothing_moves_in_the_plane_are_refused():
    world = World(plane_normal=(0, 1, 0))
    ball = world.add_sphere(0.1, mass=1.0)
    with pytest.raises(ArgumentError, match="oblique to the plane"):
        world.add_slider(None, ball, anchor=(0, 0, 0), axis=(1, 1, 0))
    with pytest.raises(ArgumentError, match="differ only along"):
        world.add_rope_joint(None, ball, anchor_a=(0, 1, 0), anchor_b=(0, 0, 0))
    with pytest.raises(ArgumentError, match=r"length=0\.5 is too short"):
        world.add_rope_joint(None, ball, anchor_a=(1, 1, 0), anchor_b=(0, 0, 0), length=0.5)
    world.add_slider(None, ball, anchor=(0, 0, 0), axis=(1, 0, 1))


def test_springs_between_different_depths_are_refused_in_a_plane():
    world = World(plane_normal=(0, 1, 0))
    ball = world.add_sphere(0.1, position=(1, 0, 0))
    with pytest.raises(ArgumentError, match="at the same distance"):
        world.add_spring(None, ball, anchor_a=(0, 1, 0), anchor_b=(1, 0, 0), hertz=2.0)
    world.add_spring(None, ball, anchor_a=(0, 0, 0), anchor_b=(1, 0, 0), hertz=2.0)


def test_oblique_capsules_that_nearly_lie_on_each_other_slide_alike_to_both_sides():
    ways = []
    for side in (1.0, -1.0):
        world = World(plane_normal=(0, 1, 0))
        lying = Rotation.from_euler("y", 90, degrees=True)
        oblique = Rotation.from_euler("z", 0.03 * side) * lying
        world.add_capsule(0.1, 6.0, static=True, orientation=lying.as_quat(scalar_first=True), friction=0.3)
        body = world.add_capsule(
            0.1,
            0.6,
            position=(0, 0.12, 0.162),
            orientation=oblique.as_quat(scalar_first=True),
            velocity=(side, 0, 0),
            friction=0.3,
        )
        world.advance(STEP, 20)
        ways.append(side * body.position[0])
    assert ways[0] == pytest.approx(ways[1], rel=0.02)


def test_a_torque_turns_a_body_by_its_moment_of_inertia_in_any_plane():
    moment = 2.0 * (1.0 + 0.09) / 12 + 2.0 * (0.3**2 + 0.1**2)
    for turn in Rotation.random(20, random_state=3):
        world = World(gravity=(0, 0, 0), plane_normal=turn.apply((0, 1, 0)))
        rod = world.add_box((1.0, 0.2, 0.3), orientation=turn.as_quat(scalar_first=True), mass=2.0)
        anchor, motor = turn.apply((0.3, 0, 0.1)), Motor(1e9, 5.0)
        hinge = world.add_hinge(None, rod, anchor=anchor, axis=turn.apply((0, 1, 0)), motor=motor)
        world.advance(STEP, 12)
        assert hinge.speed == pytest.approx(5.0 * 0.2 / moment, rel=1e-9)


@pytest.mark.parametrize("kind", ["box", "cylinder", "cone"])
def test_bodies_slide_over_the_triangles_of_a_mesh(kind):
    """Of the points that a body loses on a triangle, rounding may leave less than the impulse of the last."""
    x = np.arange(-30, 31.0)
    vertices = [(a, b, 0.0) for a in x for b in (-1.0, 0.0, 1.0)]
    corners = [3 * i + j for i in range(60) for j in (0, 1)]
    faces = [face for k in corners for face in ((k, k + 3, k + 4), (k, k + 4, k + 1))]
    for speed in np.linspace(2.0, 6.0, 12):
        world = kd.World(plane_normal=(0, 1, 0))
        world.add_mesh(vertices, faces, friction=0.3)
        start = {"position": (-5, 0, 0.1), "velocity": (speed, 0, 0), "friction": 0.3}
        if kind == "box":
            body = world.add_box((0.6, 0.5, 0.2), **start)
        else:
            body = (world.add_cone if kind == "cone" else world.add_cylinder)(0.3, 0.2, **start)
        world.advance(STEP, 150)
        assert body.position[0] + 5.0 == pytest.approx(speed**2 / (2.0 * 0.3 * 9.81), rel=0.015)

"""Bodies that move over the triangles of a flat mesh, against the same on a plane; tips and edges of meshes."""

import math

import numpy as np
import pytest

import kickdrift as kd

G, STEP = 9.81, 1 / 240
LYING = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)  # along y


def ground(world, kind):
    if kind == "plane":
        world.add_plane(friction=0.9)
        return
    x, y = np.meshgrid(0.7 * np.arange(-2, 6), 0.7 * np.arange(-2, 3), indexing="ij")
    corner = 5 * np.arange(7)[:, None] + np.arange(4)
    faces = [
        np.stack([corner, corner + 5, corner + 1], axis=-1),
        np.stack([corner + 1, corner + 5, corner + 6], axis=-1),
    ]
    world.add_mesh(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3), np.concatenate(faces).reshape(-1, 3), friction=0.9)


@pytest.mark.parametrize("speed", [0.3, 1.0])
def test_a_cylinder_that_rolls_over_the_edges_of_triangles_is_supported_in_each_step(speed):
    world = kd.World()
    ground(world, "mesh")
    body = world.add_cylinder(0.2, 0.2, position=(0, 0.1, 0.2), orientation=LYING, friction=0.9).index
    world.velocity[body], world.angular_velocity[body] = (speed, 0, 0), (0, speed / 0.2, 0)
    for _ in range(round(1.5 / speed / STEP)):
        world.step(STEP)
        assert abs(world.velocity[body, 2]) < 0.01 * G * STEP


def loads(kind):
    """Loads of the wheels of a cart after each step, as shares of a quarter of its weight."""
    world, radius = kd.World(), 0.2
    ground(world, kind)
    cart = world.add_box((1.2, 0.6, 0.1), position=(0, 0, radius), mass=3.0, collides_with=())
    hinges = []
    for x, y in ((-0.5, -0.4), (0.5, -0.4), (-0.5, 0.4), (0.5, 0.4)):
        wheel = world.add_cylinder(radius, 0.1, position=(x, y, radius), orientation=LYING, mass=0.1, friction=0.9)
        hinges.append(world.add_hinge(cart, wheel, anchor=(x, y, radius), axis=(0, 1, 0)))
        world.velocity[wheel.index], world.angular_velocity[wheel.index] = (1.5, 0, 0), (0, 1.5 / radius, 0)
    world.velocity[cart.index] = (1.5, 0, 0)
    found = []
    for _ in range(240):
        world.step(STEP)
        found.append([abs(hinge.force[2]) / (3.4 * G / 4) for hinge in hinges])
    return np.array(found)


def test_the_wheels_of_a_cart_keep_their_loads_from_triangle_to_triangle():
    """They are not determined by statics, but by those that the wheels have had."""
    assert loads("mesh") == pytest.approx(loads("plane"), abs=1e-6)


@pytest.mark.parametrize("turned", [0, 1, 2])
def test_a_plate_lies_on_the_tip_of_a_pyramid_with_whichever_corner_its_triangles_begin(turned):
    world, angles = kd.World(), np.arange(4) * 0.5 * np.pi
    corners = [*np.column_stack((np.cos(angles), np.sin(angles), np.zeros(4))), (0.0, 0.0, 1.0)]
    world.add_mesh(corners, [np.roll((k, (k + 1) % 4, 4), turned) for k in range(4)])
    plate = world.add_cylinder(1.0, 0.2, position=(0.05, 0, 1.15), mass=1.0)
    world.advance(1 / 60, 30)
    assert plate.position[2] > 1.0


@pytest.mark.parametrize("higher", [0.1, 0.0], ids=["its middle above the plate", "its middle beside it"])
@pytest.mark.parametrize("degrees", [10, 45, 75])
def test_a_pole_that_leans_past_the_edge_of_a_thin_plate_is_not_pushed(degrees, higher):
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.01, 0.01)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    world, angle = kd.World(gravity=(0, 0, 0)), math.radians(degrees)
    world.add_mesh(corners, [triangle for p, q, r, s in faces for triangle in ((p, q, r), (p, r, s))])
    along = np.array([math.sin(angle), 0.0, math.cos(angle)])
    middle = np.array([0.5 + 0.06 / math.cos(angle), 0.0, 0.0]) + higher * along
    turn = (math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0)
    pole = world.add_capsule(0.03, 1.0, position=middle, orientation=turn, mass=1.0)
    world.step(1 / 60)
    assert np.abs(pole.velocity).max() == 0.0


@pytest.mark.parametrize("kind", ["box", "cylinder", "hull"])
def test_bodies_slide_over_the_inner_corner_of_a_small_mesh(kind):
    """Edges of the border, opposite to the corner, do not push sideways there."""
    around = 2.0 * np.pi / 7.0 * np.arange(7)
    prism = [(0.3 * np.cos(a), 0.3 * np.sin(a), z) for a in around for z in (-0.1, 0.1)]
    for seed in range(25):
        rng = np.random.default_rng(seed)
        vertices = [(x, y, 0.0) for x in (-4.0, 0.0, 4.0) for y in (-4.0, 0.0, 4.0)]
        corners = [3 * i + j for i in (0, 1) for j in (0, 1)]
        both = [
            ((k, k + 3, k + 4), (k, k + 4, k + 1)) if rng.random() < 0.5 else ((k, k + 3, k + 1), (k + 1, k + 3, k + 4))
            for k in corners
        ]
        world, angle = kd.World(), rng.uniform(0.0, 2.0 * np.pi)
        world.add_mesh(vertices, [face for pair in both for face in pair], friction=0.3)
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        start = {"position": np.array([0.0, 0.0, 0.1]) - way, "velocity": 3.5 * way, "friction": 0.3}
        if kind == "box":
            body = world.add_box((0.6, 0.6, 0.2), **start)
        else:
            body = world.add_cylinder(0.3, 0.2, **start) if kind == "cylinder" else world.add_hull(prism, **start)
        world.advance(1 / 60, 90)
        assert np.linalg.norm(body.position[:2] + way[:2]) == pytest.approx(3.5**2 / (2.0 * 0.3 * 9.81), rel=0.02)

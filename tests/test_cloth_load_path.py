"""Bodies that lie on cloth and ropes that lie on other bodies: the load passes through, and friction on both sides holds."""

import numpy as np
import pytest

import kickdrift as kd

STEP = 1 / 60


def book_on_cloth(mass=1.0, vertices=21, ground="plane", thickness=0.005):
    """Return a world, its cloth, and a book on it; on a table of 5 kg its top is at 0.5 m."""
    world, top = kd.World(), 0.5 if ground == "table" else 0.0
    world.add_plane()
    if ground == "table":
        world.add_box((2, 2, 0.5), position=(0, 0, 0.25), mass=5.0)
    elif ground == "box":
        world.add_box((4, 4, 1), position=(0, 0, -0.5), static=True)
    at = top + 0.5 * thickness + 0.0005
    cloth = world.add_cloth_grid((1, 1), (vertices, vertices), position=(0, 0, at), thickness=thickness)
    book = world.add_box((0.12, 0.12, 0.1), position=(0, 0, at + 0.5 * thickness + 0.0505), mass=mass)
    return world, cloth, book


@pytest.mark.parametrize("vertices", [11, 21, 41])
@pytest.mark.parametrize("mass", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("ground", ["plane", "box", "table"])
def test_a_book_on_a_tablecloth_does_not_sink_through_it(mass, vertices, ground):
    world, _, book = book_on_cloth(mass, vertices, ground)
    world.advance(STEP, 120)
    top = world.position[2, 2] + 0.25 if ground == "table" else 0.0
    assert book.position[2] - 0.05 - top == pytest.approx(0.005, abs=1e-3 if ground == "table" else 2e-4)
    assert np.abs(book.velocity).max() < (
        0.03 if ground == "table" else 0.01
    )  # with 10 kg, it trembles on a loose table


def test_a_book_on_a_tablecloth_that_is_pulled_goes_with_it():
    world, cloth, book = book_on_cloth()
    world.advance(STEP, 60)
    edge = np.flatnonzero(cloth.position[:, 0] > 0.499)
    cloth.pin(edge)
    cloth.velocity[edge, 0] = 0.2
    world.advance(STEP, 180)
    assert book.position[0] > 0.1
    assert book.position[2] == pytest.approx(0.055, abs=2e-4)


@pytest.mark.parametrize("kind", ["box", "cylinder"])
@pytest.mark.parametrize("mass", [0.2, 1.0])
@pytest.mark.parametrize("steepness", [0.8, 0.95, 1.1])
def test_on_a_cloth_on_a_slope_a_body_slides_from_the_angle_of_friction_on(steepness, mass, kind):
    angle, world = np.arctan(0.6 * steepness), kd.World()
    up, along = np.array([-np.sin(angle), 0, np.cos(angle)]), np.array([np.cos(angle), 0, np.sin(angle)])
    world.add_plane(normal=up, friction=0.6)
    turn = (np.cos(angle / 2), 0, -np.sin(angle / 2), 0)
    fabric = {"friction": 0.6, "damping": 1e-3, "stretch_stiffness": 2000.0, "shear_stiffness": 400.0}
    cloth = world.add_cloth_grid((1, 1), (21, 21), position=0.0026 * up, orientation=turn, **fabric)
    cloth.pin(np.flatnonzero(cloth.position @ along > 0.499))
    start = {"position": 0.0551 * up, "orientation": turn, "mass": mass, "friction": 0.6}
    body = world.add_box((0.12, 0.12, 0.1), **start) if kind == "box" else world.add_cylinder(0.06, 0.1, **start)
    world.advance(STEP, 36)
    slides = 0.5 * 9.81 * max(np.sin(angle) - 0.6 * np.cos(angle), 0.0) * 0.6**2
    assert -(body.position - 0.0551 * up) @ along == pytest.approx(slides, rel=0.03, abs=5e-4)


def test_a_box_on_two_ropes_does_not_sink_through_them():
    world = kd.World()
    world.add_plane()
    for y in (-0.1, 0.1):
        world.add_rope([(x, y, 0.011) for x in np.linspace(-0.3, 0.3, 25)], radius=0.01)
    box = world.add_box((0.4, 0.4, 0.1), position=(0, 0, 0.072), mass=1.0)
    world.advance(STEP, 120)
    assert box.position[2] == pytest.approx(0.07, abs=2e-4)

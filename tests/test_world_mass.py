"""Mass of round shapes and of bodies, against integrals over points and against each other."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.kind_numbers import CAPSULE, PLANE, SPHERE
from kickdrift.world.shapes.mass_properties import Mass, checked_inertia, combined, placed, rotation_matrix
from kickdrift.world.shapes.plane import Plane
from kickdrift.world.shapes.sphere import Sphere


def integrated(width_at, low, high):
    """Volume and inertia of a body of revolution about z, by its radius at each height (Gauss, 200 slices a piece)."""
    x, weights = np.polynomial.legendre.leggauss(200)
    pieces = [(low, -high), (-high, high), (high, -low)]
    volume, along, across = 0.0, 0.0, 0.0
    for begin, end in pieces:
        z, w = 0.5 * (end + begin) + 0.5 * (end - begin) * x, 0.5 * (end - begin) * weights
        area = math.pi * width_at(z) ** 2
        volume += w @ area
        along += w @ (area * width_at(z) ** 2 / 2)
        across += w @ (area * (width_at(z) ** 2 / 4 + z**2))
    return volume, np.diag([across, across, along])


@pytest.mark.parametrize(("radius", "length"), [(1.0, 2.0), (0.001, 3.0), (50.0, 1e-3), (0.3, 0.4)])
def test_a_capsule_weighs_what_its_slices_do(radius, length):
    half = 0.5 * length

    def width(z):
        return np.sqrt(radius**2 - np.clip(np.abs(z) - half, 0.0, radius) ** 2)

    volume, inertia = integrated(width, -half - radius, half)
    found = Capsule(radius, length).mass_properties()
    assert found.volume == pytest.approx(volume, rel=1e-6)
    assert (found.centre == 0.0).all()
    assert found.inertia == pytest.approx(inertia, rel=1e-6)


def test_a_sphere_weighs_what_its_slices_do():
    volume, inertia = integrated(lambda z: np.sqrt(4.0 - z**2), -2.0, 1.0)
    found = Sphere(2.0).mass_properties()
    assert found.volume == pytest.approx(volume, rel=1e-6)
    assert found.inertia == pytest.approx(inertia, rel=1e-6)


def test_a_capsule_of_no_length_is_nearly_a_sphere():
    short, ball = Capsule(0.7, 1e-9).mass_properties(), Sphere(0.7).mass_properties()
    assert short.volume == pytest.approx(ball.volume, rel=1e-8)
    assert short.inertia == pytest.approx(ball.inertia, rel=1e-8, abs=1e-12)


def test_shapes_say_what_compiled_code_needs():
    assert (Sphere.kind, Capsule.kind, Plane.kind) == (SPHERE, CAPSULE, PLANE)
    assert Sphere(2).numbers.tolist() == [2.0]
    assert Capsule(0.5, 3).numbers.tolist() == [0.5, 1.5]
    assert Plane().numbers.shape == (0,)
    assert all(shape.numbers.dtype == np.float64 for shape in (Sphere(2), Capsule(1, 1), Plane()))
    assert Sphere(2) == Sphere(2.0)
    with pytest.raises(AttributeError):
        Sphere(1.0).radius = 2.0


@pytest.mark.parametrize("bad", [0.0, -1.0, float("nan"), float("inf"), "wide", None])
def test_sizes_that_are_none(bad):
    with pytest.raises(ArgumentError, match="radius"):
        Sphere(bad)
    with pytest.raises(ArgumentError, match="radius"):
        Capsule(bad, 1.0)
    with pytest.raises(ArgumentError, match="length"):
        Capsule(1.0, bad)


def test_a_plane_is_not_weighed():
    with pytest.raises(ArgumentError, match="static"):
        Plane().mass_properties()


# --- bodies of several shapes -----------------------------------------------------------------------------------------

numbers = st.floats(-2.0, 2.0)
poses = st.tuples(
    st.tuples(numbers, numbers, numbers),
    st.tuples(numbers, numbers, numbers, numbers).filter(lambda q: np.linalg.norm(q) > 0.1),
)


def of_points(points, masses):
    total = masses.sum()
    centre = masses @ points / total
    arms = points - centre
    inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, arms, strict=True))
    return total, centre, inertia


def as_points(part):
    """Six points with the mass, the centre and the inertia of a part."""
    moments, axes = np.linalg.eigh(part.inertia)
    arms = np.sqrt(np.maximum(3.0 * (moments.sum() / 2 - moments) / part.mass, 0.0))
    points = np.concatenate([part.centre + s * (axes * arms).T for s in (1.0, -1.0)])
    return points, np.full(6, part.mass / 6)


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.tuples(poses, st.floats(0.1, 10.0), st.floats(0.1, 2.0), st.floats(0.1, 2.0)), min_size=1, max_size=5)
)
def test_bodies_weigh_what_their_points_do(shapes):
    parts = [
        placed(Capsule(radius, length).mass_properties(), *pose, density=density)
        for pose, density, radius, length in shapes
    ]
    clouds = [as_points(part) for part in parts]
    points, masses = (np.concatenate(pieces) for pieces in zip(*clouds, strict=True))
    total, centre, inertia = of_points(points, masses)
    body = combined(parts)
    assert body.mass == pytest.approx(total)
    assert np.allclose(body.centre, centre, atol=1e-9)
    assert np.allclose(body.inertia, inertia, rtol=1e-9, atol=1e-9 * np.trace(inertia))


def test_a_placed_shape_turns_and_moves():
    quarter = (math.cos(math.pi / 4), math.sin(math.pi / 4), 0.0, 0.0)  # about x: z to -y
    shape = Capsule(0.5, 2.0).mass_properties()
    part = placed(shape, (1.0, 2.0, 3.0), quarter, mass=7.0)
    x, _, z = np.diag(shape.inertia) * 7.0 / shape.volume
    assert part.mass == 7.0
    assert part.centre == pytest.approx((1.0, 2.0, 3.0))
    assert part.inertia == pytest.approx(np.diag([x, z, x]), abs=1e-12)
    assert rotation_matrix(quarter) @ (0.0, 0.0, 1.0) == pytest.approx((0.0, -1.0, 0.0))
    assert rotation_matrix(np.multiply(quarter, -5.0)) == pytest.approx(rotation_matrix(quarter))


def test_density_and_mass_agree():
    shape = Sphere(0.3).mass_properties()
    by_density, by_mass = placed(shape, density=1000.0), placed(shape, mass=1000.0 * shape.volume)
    assert by_density.mass == pytest.approx(36.0 * math.pi)
    assert by_density.inertia == pytest.approx(by_mass.inertia)


BALL = Sphere(1.0).mass_properties()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({}, "exactly one of them"),
        ({"density": 1.0, "mass": 1.0}, "exactly one of them"),
        ({"density": 0.0}, "density=0"),
        ({"density": -1.0}, "density=-1"),
        ({"density": float("nan")}, "density=nan"),
        ({"mass": 0.0}, "mass=0"),
        ({"mass": float("inf")}, "mass=inf"),
        ({"mass": "heavy"}, "mass='heavy'"),
        ({"mass": 1.0, "position": (0.0, 0.0)}, "position"),
        ({"mass": 1.0, "position": (0.0, float("nan"), 0.0)}, "position"),
        ({"mass": 1.0, "orientation": (0.0, 0.0, 0.0, 0.0)}, "orientation"),
        ({"mass": 1.0, "orientation": (1.0, 0.0, 0.0, float("inf"))}, "orientation"),
        ({"mass": 1.0, "orientation": (1.0, 0.0, 0.0)}, "orientation"),
    ],
)
def test_weights_that_are_none(arguments, said):
    with pytest.raises(ArgumentError, match=said):
        placed(BALL, **arguments)


@pytest.mark.parametrize(
    ("inertia", "said"),
    [
        (np.zeros((3, 3)), "positive"),
        (np.diag([1.0, 1.0, 0.0]), "positive"),
        (np.diag([1.0, 1.0, -1.0]), "positive"),
        ((1.0, 1.0, 2.1), "sum of the other two"),
        (
            rotation_matrix((1.0, 2.0, 3.0, 4.0)) @ np.diag([1.0, 2.0, 3.1]) @ rotation_matrix((1.0, 2.0, 3.0, 4.0)).T,
            "sum",
        ),
        (np.full((3, 3), float("nan")), "finite"),
        ([[2.0, 0.1, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]], "symmetric"),
        ((1.0, 2.0), "shape"),
    ],
)
def test_inertias_that_no_body_has(inertia, said):
    with pytest.raises(ArgumentError, match=said):
        checked_inertia(inertia)


def test_inertias_at_the_border_are_taken():
    assert checked_inertia((1.0, 1.0, 2.0)).tolist() == np.diag([1.0, 1.0, 2.0]).tolist()  # a plate
    assert checked_inertia((1.0, 1.0, 1e-9)).tolist() == np.diag([1.0, 1.0, 1e-9]).tolist()  # a needle


def test_a_body_of_nothing_and_one_of_points():
    with pytest.raises(ArgumentError, match="without shapes"):
        combined([])
    with pytest.raises(ArgumentError, match="extent"):
        combined([Mass(1.0, np.zeros(3), np.zeros((3, 3)))])


def test_a_centre_of_mass_that_was_measured_is_where_the_body_balances():
    world = kd.World()
    world.add_plane(friction=0.0)
    mass, inertia, centre = 2.0, (0.02, 0.02, 0.01), (0.0, 0.0, -0.05)
    body = world.add_body(Sphere(0.1), position=(0, 0, 0.1), mass=mass, inertia=inertia, centre=centre, friction=0.0)
    assert world.position[body.index] == pytest.approx([0, 0, 0.05])
    angle = 0.05
    world.orientation[body.index] = (math.cos(angle / 2), 0, math.sin(angle / 2), 0)  # about the centre of mass
    world.position[body.index, 2] = 0.1 - 0.05 * math.cos(angle)
    crossings, before = [], 0.0
    for _ in range(480):
        world.step(1 / 240)
        now = world.orientation[body.index, 2]
        if now * before < 0.0:
            crossings.append(world.time)
        before = now
    # On ice it rocks about its centre of mass, which stays above one point: I w^2 = m g d.
    assert 2 * np.diff(crossings).mean() == pytest.approx(
        2 * math.pi * math.sqrt(0.02 / (mass * 9.81 * 0.05)), rel=0.02
    )


def test_parts_have_surfaces_of_their_own():
    world = kd.World()
    world.add_plane(friction=1.0)
    icy, rough = (
        kd.Part(kd.Box((0.2, 0.2, 0.1)), position=(x, 0, 0), friction=f) for x, f in ((-0.3, 0.0), (0.3, 0.8))
    )
    for y, parts in ((0.0, [icy, icy]), (5.0, [icy, kd.Part(rough.shape, rough.position)])):
        world.add_body(parts, position=(0, y, 0.05), velocity=(1.0, 0, 0), friction=0.25)
    world.advance(1 / 240, 120)
    assert world.velocity[2, 0] == pytest.approx(1.0, abs=1e-6)
    assert world.velocity[3, 0] < 0.8
    faces = [placed.surface for placed in world.shape_rows.shapes.values()]
    assert [face.friction for face in faces] == [1.0, 0.0, 0.0, 0.0, 0.25]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"centre": (0, 0, 1)}, "inertia"),
        ({"centre": (0, 0), "inertia": (1, 1, 1)}, "centre"),
        ({"centre": (0, 0, float("nan")), "inertia": (1, 1, 1)}, "centre"),
    ],
)
def test_centres_that_cannot_be(options, said):
    with pytest.raises(ArgumentError, match=said):
        kd.World().add_sphere(1.0, **options)


@pytest.mark.parametrize("options", [{"friction": -1.0}, {"restitution": 2.0}, {"colour": "red"}])
def test_surfaces_of_parts_that_cannot_be(options):
    with pytest.raises(ArgumentError, match=next(iter(options))):
        kd.Part(Sphere(1.0), **options)

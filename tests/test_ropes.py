"""Ropes: against the catenary, the elastica, waves, the capstan and conservation laws; contacts between vertices; bad input."""

import copy

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, UnknownNameError
from kickdrift.world.deformables.body_contacts.contact_rows import _curvature
from kickdrift.world.tables import CLOTH

STEP = 1 / 60
ALONG_Y = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)


@pytest.mark.parametrize(("n", "stiffness", "density"), [(10, 100.0, 0.3), (20, 60.0, 0.1), (40, 300.0, 0.5)])
def test_a_hanging_rope_stretches_by_its_own_weight(n, stiffness, density):
    world = kd.World(substeps=8)
    rope = world.add_rope(
        np.linspace((0, 0, 0), (0, 0, -1), n + 1), density=density, stretch_stiffness=stiffness, damping=1e-2,
        linear_damping=4.0,
    )  # fmt: skip
    rope.pin([0])
    world.advance(STEP, 400)
    assert -1.0 - rope.position[-1, 2] == pytest.approx(density * 9.81 / (2 * stiffness), rel=0.01)
    below = 1.0 - (np.arange(n) + 0.5) / n
    assert rope.tension == pytest.approx(density * 9.81 * below, abs=1e-3 * density * 9.81)


def test_a_rope_hangs_as_a_catenary():
    length, span = 1.0, 0.7
    world = kd.World(substeps=8)
    rope = world.add_rope(
        np.linspace((-0.5, 0, 0), (0.5, 0, 0), 41), density=0.05, stretch_stiffness=500.0, bending_stiffness=0.0,
        damping=1e-2, linear_damping=3.0,
    )  # fmt: skip
    rope.pin([0, 40])
    rope.velocity[[0, 40], 0] = np.array([1, -1]) * (length - span) / 4
    world.advance(STEP, 120)
    rope.velocity[[0, 40]] = 0.0
    world.advance(STEP, 400)
    a = brentq(lambda a: 2 * a * np.sinh(span / 2 / a) - length, 0.05, 5.0)
    assert -rope.position[:, 2].min() == pytest.approx(a * (np.cosh(span / 2 / a) - 1.0), rel=0.005)
    assert rope.tension[20] == pytest.approx(0.05 * 9.81 * a, rel=0.01)


def elastica(length, load, stiffness):
    """Where the tip of a clamped beam under its own weight is: B theta'' = w (L - s) cos theta."""

    def slope(s, y):
        return np.stack((y[1], load * (length - s) * np.cos(y[0]) / stiffness, np.cos(y[0]), np.sin(y[0])))

    s = np.linspace(0.0, length, 50)
    guess = np.stack((-s, -np.ones_like(s), s, -s * s))
    solved = solve_bvp(slope, lambda a, b: np.array([a[0], b[1], a[2], a[3]]), s, guess, tol=1e-8)
    assert solved.success
    return solved.y[2:, -1]


@pytest.mark.parametrize("n", [10, 20, 40])
@pytest.mark.parametrize(("length", "stiffness"), [(0.4, 0.01), (0.25, 0.004)])
def test_a_clamped_rope_bends_as_the_elastica(n, length, stiffness):
    assert clamped_tip(n, length, stiffness) == pytest.approx(
        elastica(length, 0.2 * 9.81, stiffness), abs=0.01 * length
    )


def test_the_elastica_tells_a_stiffness_that_is_off_by_a_tenth():
    tip = clamped_tip(20, 0.4, 0.011)
    assert np.abs(tip - elastica(0.4, 0.2 * 9.81, 0.01)).max() > 0.01 * 0.4


def clamped_tip(n, length, stiffness):
    world = kd.World(substeps=8)
    rope = world.add_rope(
        np.linspace((-length / n, 0, 0), (length, 0, 0), n + 2), radius=0.002, density=0.2, stretch_stiffness=300.0,
        bending_stiffness=stiffness, damping=1e-2, linear_damping=4.0,
    )  # fmt: skip
    rope.pin([0, 1])
    world.advance(STEP, 400)
    return rope.position[-1, [0, 2]]


@pytest.mark.parametrize("strain", [0.01, 0.04])
def test_waves_run_along_a_taut_rope(strain):
    length, stiffness, density, n = 2.0, 2000.0, 0.1, 60
    world = kd.World(gravity=(0, 0, 0), substeps=8)
    rope = world.add_rope(
        np.linspace((0, 0, 0), (length, 0, 0), n + 1),
        density=density,
        stretch_stiffness=stiffness,
        bending_stiffness=0.0,
    )
    rope.position[:, 0] *= 1 + strain
    rope.pin([0, n])
    rope.position[:, 2] = 1e-4 * np.sin(np.pi * np.arange(n + 1) / n)
    heights = []
    for _ in range(1500):
        world.advance(1 / 2000, 1)
        heights.append(rope.position[n // 2, 2])
    h = np.array(heights)
    k = np.flatnonzero((h[1:] > 0) & (h[:-1] <= 0))
    crossings = (k + h[k] / (h[k] - h[k + 1])) / 2000
    speed = np.sqrt(stiffness * strain / (density / (1 + strain)))
    assert np.diff(crossings).mean() == pytest.approx(2 * length * (1 + strain) / speed, rel=1e-3)


@pytest.mark.parametrize(("friction", "around", "substeps"), [(0.2, 64, 8), (0.4, 64, 8), (0.4, 24, 4), (0.4, 24, 16)])
def test_a_rope_round_a_cylinder_holds_as_a_capstan(friction, around, substeps):
    """T2 / T1 = exp(mu theta): a rope is pulled over half of a cylinder, with a load at its other end."""
    world, radius = kd.World(substeps=substeps), 0.105
    world.add_cylinder(0.1, 1.0, static=True, friction=friction, orientation=ALONG_Y)
    step = 2 * np.pi * radius / around
    arc = np.linspace(np.pi, 0.0, around // 2 + 1)
    before, after = around * 3 // 4, around * 15 // 32
    points = [(-radius, 0.0, -step * k) for k in range(before, 0, -1)]
    points += [(radius * np.cos(t), 0.0, radius * np.sin(t)) for t in arc]
    points += [(radius, 0.0, -step * k) for k in range(1, after)]
    rope = world.add_rope(
        points, radius=0.005, density=0.02, stretch_stiffness=2000.0, bending_stiffness=0.0, damping=5e-3,
        linear_damping=2.0, friction=friction,
    )  # fmt: skip
    load = world.add_sphere(0.03, position=points[-1], mass=0.5, collides_with=())
    rope.pin([len(points) - 1], load)
    rope.pin([0])
    world.advance(STEP, 30)
    rope.velocity[0] = (0.0, 0.0, -0.05)
    world.advance(STEP, 30)
    tensions = []
    for _ in range(60):
        world.advance(STEP, 1)
        tensions.append((rope.tension[: before * 5 // 6].mean(), rope.tension[-after // 4 :].mean()))
    pulled, loaded = np.mean(tensions, axis=0)
    assert loaded == pytest.approx(0.5 * 9.81, rel=0.02)  # the load hangs still
    assert pulled / loaded == pytest.approx(np.exp(friction * np.pi), rel=0.03)


def test_a_rope_drives_a_pulley_as_in_atwoods_machine():
    world, radius, around, masses = kd.World(), 0.104, 48, (1.0, 1.5)
    pulley = world.add_cylinder(0.1, 0.06, mass=1.0, friction=0.6, orientation=ALONG_Y)
    world.add_hinge(world.ground, pulley, anchor=(0, 0, 0), axis=(0, 1, 0))
    step = 2 * np.pi * radius / around
    arc = np.linspace(np.pi, 0.0, around // 2 + 1)
    points = [(-radius, 0.0, -step * k) for k in range(110, 0, -1)]
    points += [(radius * np.cos(t), 0.0, radius * np.sin(t)) for t in arc]
    points += [(radius, 0.0, -step * k) for k in range(1, 111)]
    rope = world.add_rope(points, radius=0.004, density=0.02, stretch_stiffness=2000.0, friction=0.6, damping=5e-3)
    loads = []
    for vertex, mass in zip((0, len(points) - 1), masses, strict=True):
        loads.append(world.add_sphere(0.03, position=points[vertex], mass=mass, collides_with=()))
        rope.pin([vertex], loads[-1])
    heights, speeds = [], []
    for _ in range(228):
        world.advance(1 / 240, 1)
        heights.append((loads[0].position[2] - loads[1].position[2]) / 2)
        speeds.append(radius * pulley.angular_velocity[1])
    t = np.arange(36, 228) / 240  # four oscillations of the rope, without the first
    moved = sum(masses) + rope.mass.sum() + 0.5 * 1.0 * 0.1**2 / radius**2
    exact = (masses[1] - masses[0]) * 9.81 / moved
    assert 2 * np.polyfit(t, heights[36:], 2)[0] == pytest.approx(exact, rel=0.03)
    assert np.polyfit(t, speeds[36:], 1)[0] == pytest.approx(exact, rel=0.04)


FLANK = np.array([10.0, 0.0, 1.0]) / np.sqrt(101.0)  # normal of a cone of radius 0.1 and height 1


@pytest.mark.parametrize(
    ("shape", "sizes", "point", "normal", "radius", "straight"),
    [
        ("sphere", (0.1,), (0.1, 0, 0), (1, 0, 0), 0.1, 0.0),
        ("capsule", (0.1, 1.0), (0.1, 0, 0.2), (1, 0, 0), 0.1, 1.0),
        ("capsule", (0.1, 1.0), (0, 0, 0.6), (0, 0, 1), 0.1, 0.0),
        ("cylinder", (0.1, 1.0), (0.1, 0, 0.2), (1, 0, 0), 0.1, 1.0),
        ("cylinder", (0.1, 1.0), (0.03, 0, 0.5), (0, 0, 1), 0.0, 0.0),
        ("cone", (0.1, 1.0), (0.03, 0, 0.2), FLANK, 0.03 / FLANK[0], 1.0),
        ("box", ((1, 1, 1),), (0.5, 0, 0), (1, 0, 0), 0.0, 0.0),
    ],
)
def test_the_radius_of_curvature_is_that_at_the_point(shape, sizes, point, normal, radius, straight):
    world = kd.World()
    getattr(world, f"add_{shape}")(*sizes, static=True)
    found, axis = _curvature(world.tables.address, 0, tuple(map(float, normal)), tuple(map(float, point)), 0.0)
    assert found == pytest.approx(radius)
    assert axis == (0.0, 0.0, straight)


@pytest.mark.parametrize("shape", ["capsule", "cylinder", "box", "sphere", "hull", "mesh"])
def test_thin_things_do_not_pass_between_vertices(shape):
    """A rope of ten times the spacing falls onto something of a tenth of it, in the middle between two vertices."""
    world = kd.World(substeps=8)
    if shape in ("capsule", "cylinder"):
        getattr(world, f"add_{shape}")(0.005, 1.0, orientation=ALONG_Y, static=True)
    elif shape == "box":
        world.add_box((0.01, 1.0, 0.01), orientation=(np.cos(0.3), 0, np.sin(0.3), 0), static=True)
    elif shape == "sphere":
        world.add_sphere(0.005, static=True)
    elif shape == "hull":
        world.add_hull([(-0.005, -0.5, -0.01), (0.005, -0.5, -0.01), (-0.005, 0.5, -0.01), (0.005, 0.5, -0.01),
                        (0, -0.5, 0), (0, 0.5, 0)], static=True)  # fmt: skip
    else:
        world.add_mesh([(-0.005, -0.5, 0), (0.005, -0.5, 0), (0.005, 0.5, 0), (-0.005, 0.5, 0)], [(0, 1, 2), (0, 2, 3)])
    rope = world.add_rope(
        np.linspace((-0.55, 0, 0.2), (0.55, 0, 0.2), 12),
        radius=0.01,
        bending_stiffness=1.0,
        damping=1e-2,
        linear_damping=1.0,
    )
    world.advance(STEP, 60)
    assert rope.position[5:7, 2] == pytest.approx(0.015, abs=0.006)


def test_ropes_cross_neither_each_other_nor_cloth():
    world = kd.World(substeps=8)
    below = world.add_rope(np.linspace((-0.5, 0, 0), (0.5, 0, 0), 12), radius=0.01)
    below.pin([0, 11])
    sheet = world.add_cloth_grid((0.4, 0.4), (7, 7), position=(1.0, 0, 0))
    sheet.pin([0, 6, 42, 48])
    above = [world.add_rope(np.linspace((x, -0.2, 0.1), (x, 0.2, 0.1), 8), radius=0.01) for x in (0.04, 1.0)]
    world.advance(STEP, 40)
    assert above[0].position[:, 2].max() > below.position[:, 2].min() + 0.015
    assert above[1].position[:, 2].min() > sheet.position[:, 2].min() + 0.005
    assert above[1].position[:, 2].min() > -0.3


def test_a_free_rope_keeps_momentum_and_angular_momentum():
    world, rng = kd.World(gravity=(0, 0, 0)), np.random.default_rng(0)
    rope = world.add_rope(0.1 * rng.normal(size=(12, 3)).cumsum(axis=0), bending_stiffness=1e-2, damping=1e-3)
    rope.velocity[:] = rng.normal(size=(12, 3))
    momentum, spin, energy = world.momentum(), world.angular_momentum(), world.energy().total
    world.advance(STEP, 1000)
    assert world.momentum() == pytest.approx(momentum, abs=1e-12)
    assert world.angular_momentum() == pytest.approx(spin, abs=1e-12)
    assert 0.0 < world.energy().total < energy  # which damping takes


def test_without_damping_energy_stays():
    world, rng = kd.World(gravity=(0, 0, 0), substeps=64), np.random.default_rng(0)
    rope = world.add_rope(0.1 * rng.normal(size=(12, 3)).cumsum(axis=0), bending_stiffness=1e-2)
    rope.velocity[:] = 0.3 * rng.normal(size=(12, 3))
    energy = world.energy().total
    assert [drift(world, energy) for _ in range(20)] == pytest.approx(np.zeros(20), abs=5e-3)


def drift(world, energy):
    world.advance(STEP, 50)
    return world.energy().total / energy - 1.0


def test_a_load_on_a_rope_swings_as_a_pendulum():
    world = kd.World(substeps=8)
    rope = world.add_rope(np.linspace((0, 0, 0), (0.1, 0, -1), 11), density=1e-3, stretch_stiffness=3000.0)
    rope.pin([0])
    load = world.add_sphere(0.05, position=rope.position[-1], mass=1.0, collides_with=())
    rope.pin([10], load)
    x = []
    for _ in range(500):
        world.advance(1 / 100, 1)
        x.append(load.position[0])
    k = np.flatnonzero((np.array(x)[1:] > 0) & (np.array(x)[:-1] <= 0))
    length = np.hypot(0.1, 1.0) + 9.81 / 3000
    assert np.diff(k).mean() / 100 == pytest.approx(2 * np.pi * np.sqrt(length / 9.81) * (1 + 0.1**2 / 16), rel=0.01)


def test_ropes_are_restored_and_saved_and_recorded(tmp_path):
    world = kd.World(sleeping=True)
    world.add_plane()
    world.add_capsule(0.05, 1.0, position=(0, 0, 0.5), orientation=ALONG_Y, static=True)
    rope = world.add_rope(np.linspace((-0.5, 0, 0.7), (0.4, 0, 0.7), 20), name="line", self_collision=True)
    recording = world.run(0.2, STEP)
    assert recording.about.system == "world of 2 bodies and 1 rope"
    before = world.snapshot()
    world.save(tmp_path / "world.npz")
    world.advance(STEP, 30)
    after = rope.position.copy()
    world.restore(before)
    world.advance(STEP, 30)
    assert np.array_equal(rope.position, after)
    loaded = kd.load_world(tmp_path / "world.npz")
    loaded.advance(STEP, 30)
    assert np.array_equal(loaded.rope("line").position, after)
    assert np.array_equal(copy.deepcopy(rope).position, after)
    recording.save(tmp_path / "recording.npz")
    drawn = kd.load(tmp_path / "recording.npz").appearance.cloths[0]
    assert (drawn.kind, drawn.radius, drawn.name) == ("rope", 0.01, "line")


def test_the_tube_of_a_rope_is_closed_and_faces_outward():
    world = kd.World()
    turns = np.linspace(0.0, 9.0, 60)
    rope = world.add_rope(np.stack((np.cos(turns), np.sin(turns), 0.1 * turns), axis=1), radius=0.05)
    drawn = world.run(STEP, STEP).appearance.cloths[0]
    vertices, triangles = drawn.surface(rope.position)
    ends = np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2)
    assert len(np.unique(ends, axis=0)) == len(ends)
    assert {tuple(end) for end in ends} == {tuple(end[::-1]) for end in ends}
    lengths = np.linalg.norm(np.diff(rope.position, axis=0), axis=1).sum()
    volume = np.linalg.det(vertices[triangles]).sum() / 6.0
    assert volume == pytest.approx(np.sin(np.pi / 4) / (np.pi / 4) * np.pi * 0.05**2 * lengths, rel=0.01)


def test_a_rope_too_stiff_for_the_step_is_softened_and_says_so():
    world = kd.World()
    rope = world.add_rope(np.linspace((0, 0, 0), (1, 0, 0), 200), stretch_stiffness=1e7, name="wire")
    with pytest.warns(kd.UnsolvedWarning, match="Of rope 'wire'"):
        recording = world.run(0.05, STEP)
    assert "Of rope 'wire'" in recording.message
    assert "stretch_stiffness" in recording.message
    assert "longer segments" in recording.message
    assert rope.stiffness[0] < 1e7


def test_handles_of_ropes():
    world = kd.World()
    rope, sheet = (
        world.add_rope([(0, 0, 0), (1, 0, 0)], name="line"),
        world.add_cloth_grid(vertices=(3, 3), name="sheet"),
    )
    assert world.rope("line") == rope
    assert rope.radius == 0.01
    assert rope.mass.sum() == pytest.approx(0.1)
    with pytest.raises(UnknownNameError, match="known: sheet"):
        world.cloth("line")
    world.remove_cloth(rope)
    assert sheet.index == 0
    with pytest.raises(ArgumentError, match="was removed"):
        rope.pin([0])


@pytest.mark.parametrize(
    ("points", "options", "words"),
    [
        ([(0, 0, 0)], {}, "has 1 row; a rope needs two or more"),
        ([], {}, "shape"),
        ([(0, 0), (1, 0)], {}, "shape"),
        ([(0, 0, 0), (np.nan, 0, 0)], {}, "point 1 is at .* not finite"),
        ([(0, 0, 0), (1e16, 0, 0)], {}, "point 1 is at .* farther"),
        ([(0, 0, 0), (1, 0, 0), (1, 0, 0)], {}, "points 1 and 2 are in one place"),
        ("rope", {}, "array of numbers"),
        (None, {"radius": 0.0}, "radius"),
        (None, {"radius": np.inf}, "radius"),
        (None, {"density": -1.0}, "density"),
        (None, {"stretch_stiffness": 0.0}, "stretch_stiffness"),
        (None, {"bending_stiffness": np.nan}, "bending_stiffness"),
        (None, {"bending_stiffness": 1e16}, "bending_stiffness"),
        (None, {"damping": "much"}, "damping"),
        (None, {"friction": -0.1}, "friction"),
        (None, {"thickness": 0.1}, "thickness= is not an option of a rope"),
        (None, {"self_collision": 1}, "self_collision"),
        (None, {"name": ""}, "name"),
    ],
)
def test_bad_ropes_are_refused(points, options, words):
    world = kd.World()
    with pytest.raises(ArgumentError, match=words):
        world.add_rope([(0, 0, 0), (1, 0, 0)] if points is None else points, **options)
    assert len(world.tables.array(CLOTH)) == 0


@pytest.mark.parametrize("seed", range(6))
def test_a_rope_pinned_at_the_surface_of_a_shape_is_not_thrown_off(seed):
    """A contact close to a pinned end would have a lever of any length. Pushing it out of 15 mm stretches it, 0.6 J."""
    world, rng = kd.World(substeps=4), np.random.default_rng(seed)
    world.add_sphere(0.1, static=True)
    out = rng.normal(size=3)
    out /= np.linalg.norm(out)
    along = np.cross(out, rng.normal(size=3))
    along /= np.linalg.norm(along)
    start = 0.1 * rng.uniform(0.95, 1.05) * out  # overlapping
    rope = world.add_rope(start + np.linspace(0, 1, 11)[:, None] * along, stretch_stiffness=500.0)
    rope.pin([0])
    energy = world.energy().total
    for _ in range(60):
        world.advance(STEP, 1)
        assert world.energy().total < energy + 0.6


@pytest.mark.parametrize("threads", [False, True])
def test_bits_are_the_same_for_any_number_of_threads(threads):
    world = kd.World(threads=threads)
    world.add_plane()
    for k in range(20):
        world.add_box((0.2, 0.2, 0.2), position=(2 + 0.25 * (k % 5), 0, 0.1 + 0.2 * (k // 5)))
    rope = world.add_rope(np.linspace((-0.5, 0, 0.9), (0.5, 0, 0.9), 20), self_collision=True)
    body = world.add_soft_box((0.3, 0.3, 0.3), (3, 3, 3), position=(0, 0, 0.3), young_modulus=2e4)
    world.advance(STEP, 40)
    state = rope.position.tobytes() + body.position.tobytes()
    assert BITS.setdefault("state", state) == state


BITS: dict[str, bytes] = {}

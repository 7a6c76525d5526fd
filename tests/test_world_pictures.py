"""Pictures and films of worlds: what is in them, to the pixel."""

import itertools
import os
import stat
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure
from PIL import Image

import kickdrift as kd
from kickdrift.core.colours import colour_of
from kickdrift.core.errors import ArgumentError, FileFormatError, MissingExtraError
from kickdrift.core.outcomes import Outcome
from kickdrift.core.rotations import product, turned
from kickdrift.engine.progress import told_of_steps
from kickdrift.plots import animation
from kickdrift.plots.camera import axes_of, showing
from kickdrift.plots.painter import AHEAD, Painter
from kickdrift.plots.scenery import Pose
from kickdrift.world.layout import DYNAMIC, STATIC
from kickdrift.world.recordings.appearance import Appearance, DrawnShape, Rod
from kickdrift.world.recordings.recording import Recording
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.cone import Cone
from kickdrift.world.shapes.cylinder import Cylinder
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.plane import Plane
from kickdrift.world.shapes.sphere import Sphere

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
ORIGIN = np.zeros(3)
PIXELS = 40_000
WHITE = np.array([255, 255, 255])


def recording(shapes, ways, *, turns=None, fixed=(), rods=(), times=None):
    """A recording in which body n + 1 is one shape on the way (T, 3) given; ground is a plane if there is one."""
    x = np.stack([np.zeros_like(ways[0], dtype=float), *(np.asarray(way, dtype=float) for way in ways)], axis=1)
    t = np.arange(len(x)) * 0.1 if times is None else np.asarray(times, dtype=float)
    q = np.broadcast_to(UPRIGHT, (*x.shape[:2], 4)).copy()
    for body, turn in (turns or {}).items():
        q[:, body] = turn
    still = [isinstance(shape, Plane | Mesh) or n in fixed for n, shape in enumerate(shapes)]
    kinds = np.array([STATIC, *(STATIC if fixed_ else DYNAMIC for fixed_ in still)])
    parts = tuple(DrawnShape(n + 1, shape, ORIGIN, UPRIGHT) for n, shape in enumerate(shapes))
    about = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.5, compile=False).about
    energy = np.linspace(1.0, 0.5, len(t))
    return Recording(
        t=t, x=x, v=np.zeros_like(x), invariants={"energy": energy}, status=Outcome.COMPLETED, message="done", step=0.1,
        n_steps=len(t) - 1, n_force_evaluations=0, wall_time=0.1, about=replace(about, system="test"),
        derived={"kinetic energy": energy - 0.5, "potential energy": 0.5 + 0 * energy},
        orientation=q, angular_velocity=np.zeros_like(x), particles=np.zeros((len(t), 0, 3)),
        contact_points=np.zeros((len(t), 0, 3)),
        appearance=Appearance(kinds, parts, tuple(rods), {}),
    )  # fmt: skip


def painted(made, row=0):
    painter = Painter(made, PIXELS)
    return painter, painter.paint(Pose(made.x[row], made.orientation[row], made.particles[row])).astype(int)


def pixel(painter, point):
    column, row, _ = painter.camera.project(np.asarray(point, dtype=float), painter.width, painter.height)
    return int(row), int(column)


def like(colours, body):
    """Whether colours (..., 3) are that of a body, brighter or darker."""
    wanted = colour_of(body)
    colours = np.asarray(colours, dtype=float)
    along = colours @ wanted > 0.99 * np.linalg.norm(colours, axis=-1) * np.linalg.norm(wanted)
    return along & (np.ptp(colours, axis=-1) > 30)


def at(*point):
    """A way that begins at a point, and leaves it aside: what stays in a vertical plane would be seen from its side."""
    return [*np.array([point, point], dtype=float), [0, 0, 0], [0, 0.1, 0]]


def still(*point):
    return np.array([point, point], dtype=float)


# Cameras


@given(
    st.integers(1, 20),
    st.integers(0, 10**6),
    st.floats(0.5, 3.0),
    st.booleans(),
    st.floats(-3.0, 3.0),
    st.floats(-0.9, 0.9),
)
@settings(max_examples=60, deadline=None)
def test_a_camera_sees_all_and_comes_as_near_as_it_can(count, seed, aspect, perspective, turn, rise):
    generator = np.random.default_rng(seed)
    points = generator.normal(size=(count, 3)) * (3.0, 1.0, 0.5) + (100.0, -20.0, 3.0)
    reaches = generator.uniform(0.1, 1.0, count)
    camera = showing(points, reaches, np.array([np.cos(turn), np.sin(turn), rise]), aspect, perspective=perspective)
    rim = generator.normal(size=(400, 1, 3))
    rim = points + reaches[:, None] * rim / np.linalg.norm(rim, axis=2, keepdims=True)
    columns, rows, depth = np.moveaxis(camera.project(rim, int(1000 * aspect), 1000), -1, 0)
    assert depth.min() > 0.0
    across, along = np.abs(columns / (500 * aspect) - 1.0).max(), np.abs(rows / 500 - 1.0).max()
    assert max(across, along) < 1.0 + 1e-3
    assert max(across, along) > 0.75  # 0.91 but for the points that miss the rims


def test_axes_of_a_camera_are_right_handed_even_straight_down():
    for ahead in ([0, 1, 0], [1, 2, -3], [0, 0, -1], [0, 0, 1]):
        right, up, forward = axes_of(np.array(ahead, dtype=float))
        assert np.allclose(np.cross(right, up), -forward, atol=1e-15)
        assert up[2] >= 0.0


def test_rotations_of_many_bodies_are_those_of_one():
    from scipy.spatial.transform import Rotation

    generator = np.random.default_rng(0)
    p, q = (Rotation.random(5, generator) for _ in range(2))
    a = generator.normal(size=(5, 3))
    ours = [r.as_quat()[:, [3, 0, 1, 2]] for r in (p, q, p * q)]
    assert np.allclose(turned(ours[0], a), p.apply(a), atol=1e-14)
    assert np.allclose(np.abs(np.sum(product(ours[0], ours[1]) * ours[2], axis=1)), 1.0, atol=1e-14)


# What is painted


def test_a_ball_is_as_large_as_it_looks_from_where_the_camera_stands():
    made = recording([Sphere(0.5), Sphere(0.01)], [at(0, 0, 0), at(2, 2, 0)])
    painter = Painter(made, 250_000)
    painter.paint(Pose(made.x[0], made.orientation[0], made.particles[0]))
    camera = painter.camera
    seen = np.count_nonzero(np.isfinite(painter.distance))
    # The outline of a ball at distance d is an ellipse of area pi f^2 r^2 d cos / (d^2 cos^2 - r^2)^(3/2) for focal
    # length f and the angle between the axis and its centre (cos d = depth z).
    f = 0.5 * len(painter.distance) / camera.scale
    areas = []
    for body, radius in ((1, 0.5), (2, 0.01)):
        z = (made.x[0, body] - camera.eye) @ camera.ahead
        d2 = np.sum((made.x[0, body] - camera.eye) ** 2)
        areas.append(np.pi * f**2 * radius**2 * np.sqrt(d2 - radius**2) / (z**2 - radius**2) ** 1.5)
    assert seen == pytest.approx(sum(areas), rel=0.01)


@pytest.mark.parametrize(
    "shape",
    [
        Sphere(0.5),
        Box((1.0, 0.8, 0.6)),
        Capsule(0.3, 0.6),
        Cylinder(0.4, 0.7),
        Cone(0.5, 0.9),
        Hull([[-0.5, -0.4, -0.3], [0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5], [-0.3, 0.1, 0.2]]),
    ],
    ids=lambda shape: type(shape).__name__,
)
def test_each_shape_is_seen_where_it_is_and_hides_what_is_behind(shape):
    ahead = axes_of(np.array(AHEAD))[2]
    for front, places in ((1, (-1.5 * ahead, 1.5 * ahead)), (2, (1.5 * ahead, -1.5 * ahead))):
        painter, picture = painted(recording([shape, shape], [at(*place) for place in places]))
        assert like(picture[pixel(painter, places[front - 1])], front)
        assert np.array_equal(picture[1, 1], WHITE)
        seen = [np.count_nonzero(like(picture, body)) for body in (front, 3 - front)]
        assert seen[0] > 500
        assert seen[1] < 0.05 * seen[0]


def test_boxes_in_each_other_hide_each_other_to_the_pixel():
    made = recording([Box((2, 0.2, 0.2)), Box((0.2, 2, 0.2))], [at(0, 0, 0), at(0, 0, 0.02)])
    painter, picture = painted(made)
    for point, body in (
        ((0.8, 0, 0.1), 1),
        ((-0.8, 0, 0.1), 1),
        ((0, 0.8, 0.12), 2),
        ((0, -0.8, 0.12), 2),
        ((0, 0, 0.12), 2),
    ):
        assert like(picture[pixel(painter, point)], body)


def test_a_mesh_is_seen_from_both_sides():
    mesh = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    for turn in (UPRIGHT, np.array([0.0, 1.0, 0.0, 0.0])):
        painter, picture = painted(recording([mesh], [at(0, 0, 0)], turns={1: turn}))
        colour = picture[pixel(painter, (0.3, 0.1, 0))]
        assert np.ptp(colour) < 20
        assert not np.array_equal(colour, WHITE)


def test_bodies_cast_shadows_on_the_ground_and_on_each_other():
    shapes = [Plane(), Box((1, 1, 1)), Box((0.2, 0.2, 0.2))]
    painter, picture = painted(recording(shapes, [at(0, 0, 0), at(0, 0, 1.5), at(1.5, 1.2, 0.1)]))
    away = -painter._setting[:3]  # where the lamp shines
    middle = np.array([0, 0, 1.5]) + 1.5 / -away[2] * away
    shadow, sun = (picture[pixel(painter, point)].mean() for point in (middle, (-1.0, 0.2, 0)))
    assert 1.1 < sun / shadow < 2.5
    without = recording([Plane(), Box((0.2, 0.2, 0.2))], [at(0, 0, 0), at(1.5, 1.2, 0.1)])
    assert np.ptp(painted(without)[1][:, :, 0]) > 20


def test_what_moves_in_the_vertical_plane_is_seen_from_the_side():
    ways = [still(0, 0, 0), np.array([[-1, 0, 0.5], [1, 0, 0.5]]), still(0, 0, 2.5)]
    flat = recording([Plane(), Box((1, 1, 1)), Box((1, 1, 1))], ways)
    painter, picture = painted(flat, 0)
    assert not painter.camera.perspective
    assert like(picture[pixel(painter, (-1, 0, 0.5))], 2)
    assert like(picture[pixel(painter, (-1.4, 0, 0.1))], 2)
    assert not like(picture[pixel(painter, (-1.6, 0, 0.1))], 2)
    # The ground is a band below z = 0, on the whole width.
    row, _ = pixel(painter, (0, 0, -0.05))
    assert (np.ptp(picture[row + 2 :], axis=2) < 8).all()
    assert (picture[row + 2 :] < 240).all()
    assert np.array_equal(picture[row - 6, 2], WHITE)
    for change in ("aside", "leaning"):
        other = recording([Plane(), Box((1, 1, 1)), Box((1, 1, 1))], ways)
        if change == "aside":
            other.x[1, 2, 1] += 0.2
        else:
            other.orientation[1, 2] = np.cos(0.1), np.sin(0.1), 0, 0
        assert Painter(other, PIXELS).camera.perspective


def test_balls_have_marks_that_show_how_they_turn():
    half = np.array([np.cos(np.pi / 8), 0, np.sin(np.pi / 8), 0])
    pictures = [painted(recording([Sphere(1.0)], [at(0, 0, 0)], turns={1: turn}))[1] for turn in (UPRIGHT, half)]
    assert np.abs(pictures[0] - pictures[1]).max() > 15


def test_planes_are_not_seen_from_behind():
    walls = [DrawnShape(1, Plane(), ORIGIN, turn) for turn in (UPRIGHT, np.array([np.sqrt(0.5), np.sqrt(0.5), 0, 0]))]
    made = recording([Box((1, 1, 1))], [at(0, -3, 0.5)])
    ball = made.appearance.parts[0]
    looks = Appearance(made.appearance.kinds, (*(wall._replace(body=0) for wall in walls), ball), (), {})
    painter, picture = painted(replace(made, appearance=looks))
    assert painter.scenery.n_planes == 2  # floor, and a wall at y = 0 that looks to -y, towards the camera
    turned_away = walls[1]._replace(body=0, orientation=np.array([np.sqrt(0.5), -np.sqrt(0.5), 0, 0]))
    looks = Appearance(made.appearance.kinds, (walls[0]._replace(body=0), turned_away, ball), (), {})
    painter, picture = painted(replace(made, appearance=looks))
    assert painter.scenery.n_planes == 1
    assert like(picture[pixel(painter, made.x[0, 1])], 1)


def test_joints_are_drawn_as_rods_where_shapes_do_not_hide_them():
    rod = Rod(1, ORIGIN, 0, np.array([0.0, 0.0, 2.0]))
    made = recording([Sphere(0.2)], [still(0, 0, 0)], rods=[rod])
    painter, picture = painted(made)
    dark = picture[pixel(painter, (0, 0, 1.2))]
    assert dark.max() < 200
    assert like(picture[pixel(painter, (0.0, -0.05, 0.1))], 1)


def test_a_stray_does_not_make_everything_small():
    shapes = [Box((1, 1, 1))] * 30
    ways = [at(0.1 * n, 0.1 * n, n % 3) for n in range(30)]
    near = Painter(recording(shapes, ways), PIXELS).camera
    ways[7] = np.linspace((0, 0, 0), (1e5, 0, 0), 4)
    camera = Painter(recording(shapes, ways), PIXELS).camera
    assert np.linalg.norm(camera.eye - near.eye) < 2.0


def test_a_short_journey_of_one_of_many_parts_stays_in_the_picture():
    way = np.zeros((500, 3))
    way[:3, 2] = 2.0
    ways = [way * 0, way, way + np.array((1, 1, 0)), way * 0 + np.array((0, 1, 0))]
    made = recording([Box((0.2, 0.3, 0.4))] * 4, ways)
    painter = Painter(made, PIXELS)
    row, _ = pixel(painter, (0, 0, 2.2))
    assert row > 0


def test_an_empty_world_has_a_picture():
    _, picture = painted(recording([Plane()], [at(0, 0, 0)]))
    assert (picture < 250).any()


# Pictures and films


@pytest.fixture(scope="module")
def falling():
    """Three bodies that fall, over 0.5 s, and a floor."""
    times = np.linspace(0, 0.5, 6)
    fall = -4.905 * times[:, None] ** 2 * np.array([0, 0, 1.0])
    ways = [np.zeros((6, 3)), *(fall + np.array(start) for start in ((0, 0, 2), (1, 1, 2.5), (-1, 0.5, 3)))]
    return recording([Plane(), Box((0.5, 0.5, 0.5)), Sphere(0.3), Capsule(0.2, 0.5)], ways, times=times)


def test_what_stands_still_has_its_energy_in_a_unit_that_fits(falling, small_pictures):
    """The last bits of a potential, microjoules of a person, would have a factor of 1e-5 on the title of the axes otherwise."""
    still = {"kinetic energy": np.zeros(6), "potential energy": 500.0 + 9.3e-5 * np.array([0, 1, 1, 1, 1, 1])}
    energy = replace(falling, derived=still).plot().axes[1]
    assert energy.get_ylabel().startswith("energy (µJ)")
    assert energy.lines[2].get_ydata().max() == pytest.approx(93.0, rel=1e-6)


def test_no_rays_are_cast_at_what_has_been_removed(monkeypatch):
    world = kd.World()
    world.add_sphere(radius=0.1, position=(0, 0, 1), mass=1.0)
    sheet = world.add_cloth_grid((1.0, 1.0), (3, 3))
    with world.record() as recording:
        world.step(0.01)
        world.remove_cloth(sheet)
        world.step(0.01)
    painter, looked_at = Painter(recording, PIXELS), []
    monkeypatch.setattr("kickdrift.plots.painter.cast", lambda camera, order, *others: looked_at.append(order.size))
    for row in (0, -1):
        painter.paint(Pose(recording.x[row], recording.orientation[row], recording.particles[row]))
    assert looked_at == [9, 9, 1, 1]  # for the camera and for the lamp: the sheet has eight triangles


def test_a_plot_shows_the_last_state_with_trails_and_the_energy(falling, tmp_path):
    figure = falling.plot(tmp_path / "falling.png")
    scene, energy = figure.axes
    assert figure.get_suptitle() == "test: 0.5 s in 5 steps of 100 ms"
    assert scene.get_title("left") == "t = 0.5 s"
    assert len(scene.collections) == 3
    assert [line.get_label() for line in energy.lines] == ["kinetic", "potential", "sum"]
    assert energy.get_ylabel().startswith("energy (mJ)")
    assert np.allclose(1e-3 * energy.lines[0].get_ydata(), falling.derived["kinetic energy"])
    assert energy.lines[1].get_ydata().min() == 0.0
    with Image.open(tmp_path / "falling.png") as image:
        picture = np.asarray(image.convert("RGB"), dtype=int)
    assert picture.shape[0] > 800
    for body in (2, 3, 4):
        wanted = colour_of(body)
        cosines = picture @ wanted / np.maximum(np.linalg.norm(picture, axis=2), 1) / np.linalg.norm(wanted)
        assert np.count_nonzero((cosines > 0.995) & (np.ptp(picture, axis=2) > 40)) > 2000


def test_a_scene_goes_into_axes_of_ones_own(falling, small_pictures):
    ax = Figure().add_subplot()
    assert falling.plot(ax=ax) is ax.figure
    assert (len(ax.images), len(ax.collections), len(ax.figure.axes)) == (1, 3, 1)


def test_trails_are_hidden_behind_bodies(small_pictures):
    right, _, ahead = axes_of(np.array(AHEAD))
    along = np.linspace(-2.5, 2.5, 50)[:, None] * right
    wall = np.zeros((50, 3))
    for depth, hides in ((2.0, True), (-2.0, False)):
        scene = recording([Sphere(0.1), Box((0.8, 0.8, 0.8))], [along + depth * ahead, wall]).plot().axes[0]
        (trail,) = scene.collections
        seen = np.array([np.isfinite(path.vertices).all() for path in trail.get_paths()])
        assert seen[:10].all()
        assert seen[20:29].any() == (not hides)


def test_wide_scenes_have_the_energy_below(small_pictures):
    ways = [np.array([[n, 0, 0], [n, 0, 0.5]]) for n in range(12)]
    scene, energy = recording([Box((0.5, 0.5, 0.5))] * 12, ways).plot().axes
    assert scene.get_position().y0 > energy.get_position().y1


def frames_of(path):
    """Pictures of a GIF, and how long each stays, in ms."""
    frames, delays = [], []
    with Image.open(path) as film:
        assert film.info.get("loop", 0) == 0
        for k in range(film.n_frames):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB"), dtype=int))
            delays.append(film.info.get("duration", 0))
    return frames, delays


def test_a_gif_runs_in_real_time(falling, tmp_path, small_pictures):
    path = falling.animate(tmp_path / "falling.gif")
    assert path == tmp_path / "falling.gif"
    frames, delays = frames_of(path)
    assert delays == [40] * 12 + [1000]
    changes = [np.abs(b - a).max() for a, b in itertools.pairwise(frames)]
    assert min(changes) > 50
    painter = Painter(falling, animation._PIXELS)
    for k, frame in ((0, frames[0]), (12, frames[12])):
        place = falling.x[0, 2] + (0, 0, -4.905 * (0.04 * k) ** 2)
        assert like(frame[pixel(painter, place)], 2)
    assert np.array_equal(frames[0][2, frames[0].shape[1] // 2], WHITE)


def test_progress_of_a_film_includes_the_pictures_that_its_colours_are_chosen_from(
    falling, tmp_path, small_pictures, monkeypatch
):
    told, chosen = [], []

    def choose(samples, palette=animation._palette):
        colours = palette(samples)
        chosen.append(len(told))
        return colours

    monkeypatch.setattr(animation, "_palette", choose)
    with told_of_steps(told.append):
        falling.animate(tmp_path / "film.gif")
    assert chosen == [animation._SAMPLES]
    assert told == list(range(1, 14))


def test_pictures_of_a_film_have_some_three_hundred_thousand_pixels(falling, tmp_path):
    (frame,), _ = frames_of(falling.animate(tmp_path / "film.gif", speed=100.0))
    assert 200_000 < frame.shape[0] * frame.shape[1] < 400_000
    for body in (2, 3, 4):
        assert np.count_nonzero(like(frame, body)) > 500


@pytest.mark.parametrize(
    ("options", "count", "delays"),
    [
        ({"speed": 0.5}, 26, 40),
        ({"speed": 2.0}, 7, 40),
        ({"rate": 10}, 6, 100),
        ({"rate": 30}, 16, None),
        ({"speed": 100.0}, 1, None),
    ],
)
def test_speed_and_rate_of_a_film(falling, tmp_path, small_pictures, options, count, delays):
    frames, durations = frames_of(falling.animate(tmp_path / "film.gif", **options))
    assert len(frames) == count
    if delays is not None:
        assert set(durations[:-1]) == {delays}
    if options == {"rate": 30}:
        assert set(durations[:-1]) == {30, 40}
        assert sum(durations[:-1]) == 500


def test_bodies_are_between_the_states_where_a_film_needs_them(falling):
    from kickdrift.plots.animation import _Film

    made = recording([Box((1, 1, 1))], [np.array([[0, 0, 0], [1, 0, 0.0]])], times=[0.0, 1.0])
    quarter = np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    made.orientation[1, 1] = -quarter  # the same rotation as quarter
    film = _Film(made, 1.0, 4, False)
    assert film.times.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    pose = film.pose(0.5)
    assert pose.position[1].tolist() == [0.5, 0, 0]
    assert np.allclose(pose.orientation[1], [np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)])
    assert np.array_equal(film.pose(1.0).position, made.x[1])


def test_each_picture_of_a_film_is_painted_once(falling, tmp_path, small_pictures, monkeypatch):
    painted, paint = [], Painter.paint
    monkeypatch.setattr(Painter, "paint", lambda self, pose: painted.append(pose) or paint(self, pose))
    frames, _ = frames_of(falling.animate(tmp_path / "film.gif", rate=10))
    assert len(painted) == len(frames) > 1


def test_the_same_film_has_the_same_bits(falling, tmp_path, small_pictures):
    first, second = (falling.animate(tmp_path / f"{n}.gif").read_bytes() for n in range(2))
    assert first == second


@pytest.mark.parametrize("speed", [0, -1.0, np.nan, np.inf, "fast", None, 1j])
def test_speeds_that_cannot_be(falling, tmp_path, speed):
    with pytest.raises(ArgumentError, match=r"speed=.* must be positive and finite"):
        falling.animate(tmp_path / "film.gif", speed=speed)


@pytest.mark.parametrize("rate", [0, -5, 51, 2.5, "fast", None])
def test_rates_that_cannot_be(falling, tmp_path, rate):
    with pytest.raises(ArgumentError, match=r"rate=.* must be a whole number of frames"):
        falling.animate(tmp_path / "film.gif", rate=rate)


def test_films_that_cannot_be_written(falling, tmp_path, small_pictures, monkeypatch):
    for name in ("film", "film.avi", "film.png"):
        with pytest.raises(FileFormatError, match=r"animations end in \.gif or \.mp4"):
            falling.animate(tmp_path / name)
    with pytest.raises(ArgumentError, match=r"path=5 is not a path; give a string such as 'run\.gif'"):
        falling.animate(5)
    with pytest.raises(FileFormatError, match="cannot be written: No such file or directory"):
        falling.animate(tmp_path / "missing" / "film.gif")
    with pytest.raises(FileFormatError, match="cannot be written"):
        falling.plot(tmp_path / "missing" / "film.png")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(
        FileFormatError, match=r"[/\\]film\.mp4' needs the program ffmpeg, which was not found; install it"
    ):
        falling.animate(tmp_path / "film.mp4")
    assert list(tmp_path.iterdir()) == []


def test_an_mp4_is_handed_to_ffmpeg(falling, tmp_path, small_pictures, monkeypatch):
    """A stand-in for ffmpeg, which writes what it is given."""
    ffmpeg = tmp_path / "ffmpeg"
    ffmpeg.write_text(f"#!{sys.executable}\nimport sys\nopen(sys.argv[-1], 'wb').write(sys.stdin.buffer.read())\n")
    ffmpeg.chmod(ffmpeg.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    path = falling.animate(tmp_path / "film.mp4")
    painter = Painter(falling, animation._PIXELS)
    raw = np.frombuffer(path.read_bytes(), dtype=np.uint8)
    assert raw.size == 13 * painter.width * painter.height * 4
    frames = raw.reshape(13, painter.height, painter.width, 4).astype(int)
    assert like(frames[0][pixel(painter, falling.x[0, 2])][:3], 2)
    assert painter.width % 2 == painter.height % 2 == 0


def test_without_matplotlib_the_extra_is_named(falling, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    for draw in (falling.plot, lambda: falling.animate(tmp_path / "film.gif")):
        with pytest.raises(MissingExtraError, match=r"kickdrift\[cli\]"):
            draw()

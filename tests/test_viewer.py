"""Pages for the browser: what they hold, read back as the browser reads it."""

import base64
import json
import re
import sys
import threading
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest
import viser
import zstandard
from test_world_pictures import ORIGIN, UPRIGHT, recording

import kickdrift as kd
from kickdrift.core.colours import colour_of
from kickdrift.core.errors import ArgumentError, FileFormatError, KickdriftError, MissingExtraError
from kickdrift.core.rotations import about, turned
from kickdrift.viewer.recording import rows_shown
from kickdrift.viewer.surfaces import SURFACES, halves_of_ball, surface_of
from kickdrift.world.recordings.appearance import DrawnShape, Rod
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.cone import Cone
from kickdrift.world.shapes.cylinder import Cylinder
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.plane import Plane
from kickdrift.world.shapes.record import SOLID, SURFACE
from kickdrift.world.shapes.shape_kinds import KINDS, kind_of
from kickdrift.world.shapes.sphere import Sphere

CLIENT = (Path(viser.__file__).parent / "client" / "build" / "index.html").stat().st_size
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3], [1, 2, 0]])
SOLIDS = (Sphere(0.3), Capsule(0.2, 0.7), Box((0.2, 0.4, 0.9)), Hull(CORNERS), Cylinder(0.4, 0.6), Cone(0.4, 0.6))
GROUND = (
    Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
    HeightField([[0.0, 0.1, 0.0], [0.2, 0.0, 0.1]], 0.5),
    Plane(),
)


class Page:
    """A page, unpacked: its nodes by name, and what became of them, (time, name, property, value)."""

    def __init__(self, path):
        self.text = path.read_text(encoding="utf-8")
        packed = base64.b64decode(re.search(r'__VISER_EMBED_DATA__="([^"]*)"', self.text)[1])
        inner = zstandard.ZstdDecompressor().decompress(packed[8:], int.from_bytes(packed[:8], "little"))
        length = int.from_bytes(inner[:8], "little")
        content = msgspec.msgpack.decode(inner[8 : 8 + length])
        self._buffers, place = [], 8 + length
        for size in content["binaryBufferLengths"]:
            place += -place % 8
            self._buffers.append(inner[place : place + size])
            place += size
        self.seconds = content["durationSeconds"]
        self.messages = content["messages"]
        self.nodes = {m["name"]: m for _, m in self.messages if "props" in m}
        self.updates = [
            (time, m["name"], what, self.array(value))
            for time, m in self.messages
            if m["type"] == "SceneNodeUpdateMessage"
            for what, value in m["updates"].items()
        ]

    def array(self, value):
        if isinstance(value, dict) and "__binary_index" in value:
            return np.frombuffer(self._buffers[value["__binary_index"]], dtype=value["dtype"])
        return value

    def of(self, name, what):
        (found,) = [node for node in self.nodes if node.startswith(f"/{name}") and not node.endswith("_light")]
        return found, self.array(self.nodes[found]["props"][what])

    def course(self, name, what, times):
        """The property of a node at each time: what it was last."""
        found, value = self.of(name, what)
        course, changes = [], [(t, v) for t, node, key, v in self.updates if (node, key) == (found, what)]
        for time in times:
            value = next((v for t, v in reversed(changes) if t <= time + 1e-9), value)
            course.append(value)
        return np.array(course)


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """One body of each shape on a way of its own, that turns, and the page of it."""
    t = np.arange(31) / 60
    ways = [np.column_stack((np.full(31, n), t * n, 1.0 - t**2)) for n in range(len(SOLIDS))]
    turns = {n + 1: np.array([about((0.6, 0.0, 0.8), 0.3 * n + a) for a in t]) for n in range(len(SOLIDS))}
    still = [np.zeros((31, 3))] * len(GROUND)
    rods = (Rod(1, ORIGIN, 2, np.array([0.0, 0.0, 0.1])),)
    made = recording((*SOLIDS, *GROUND), [*ways, *still], turns=turns, times=t, rods=rods)
    threads = threading.active_count()
    page = made.to_html(tmp_path_factory.mktemp("pages") / "all.html")
    assert threading.active_count() == threads, "a server still runs"
    return made, page


def volume(surface):
    a, b, c = (surface.vertices * surface.scale)[surface.faces].transpose(1, 0, 2)
    return np.einsum("ni,ni->", a, np.cross(b, c)) / 6.0


@pytest.mark.parametrize("shape", SOLIDS, ids=lambda shape: kind_of(shape).name)
def test_triangles_hold_the_volume_of_the_shape_and_look_outwards(shape):
    surface, exact = surface_of(shape), shape.mass_properties().volume
    # Of a circle of 24 corners 1.1 % are missing, of a ball and its twelve rings another 1 %.
    assert volume(surface) == pytest.approx(exact, rel=1e-12 if surface.flat else 0.03)
    assert volume(surface) <= exact * (1.0 + 1e-12)
    steps = np.stack((surface.faces, np.roll(surface.faces, -1, axis=1)), axis=2)
    places = np.unique(surface.vertices.round(9) + 0.0, axis=0, return_inverse=True)[1].reshape(-1)
    edges = {(int(a), int(b)) for a, b in places[steps].reshape(-1, 2)}
    assert all((b, a) in edges for a, b in edges), "it has a hole"


def test_every_kind_has_triangles():
    assert set(SURFACES) == {number for number, kind in KINDS.items() if kind.sort in (SOLID, SURFACE)}


def test_a_ball_is_cut_into_octants():
    ball = surface_of(Sphere(1.0))
    dark, light = halves_of_ball(ball)
    assert len(dark.faces) == len(light.faces) == len(ball.faces) / 2
    for half in (dark, light):
        assert volume(half) == pytest.approx(volume(ball) / 2, rel=1e-12)


def test_bodies_are_where_the_recording_has_them(shown):
    made, path = shown
    page, rows = Page(path), rows_shown(made.t)
    assert rows == list(range(0, 31, 2))
    assert page.seconds == pytest.approx(made.t[-1] + 1 / 30)
    times = made.t[rows]
    for number, shape in enumerate(SOLIDS):
        name = kind_of(shape).name
        course = page.course(name, "batched_positions", times)
        np.testing.assert_allclose(course, made.x[rows, number + 1], atol=0.5 * shape.reach / 512 + 1e-7)
        assert np.ptp(course, axis=0).max() > 0.1
        turns = page.course(name, "batched_wxyzs", times)
        np.testing.assert_allclose(turns, made.orientation[rows, number + 1], atol=0.5 / 1024 + 1e-7)
        colour = page.of(name, "batched_colors")[1]
        on_screen = 1.055 * (np.asarray(colour) / 255) ** (1 / 2.4) - 0.055  # as the browser shows it: sRGB
        np.testing.assert_allclose(on_screen, colour_of(number + 1), atol=0.01)
        size = np.abs(page.of(name, "vertices")[1].reshape(-1, 3) * page.of(name, "batched_scales")[1]).max(axis=0)
        surface = surface_of(shape)
        np.testing.assert_allclose(size, np.abs(surface.vertices * surface.scale).max(axis=0), rtol=1e-6)
    points = page.course("joints", "points", times).reshape(-1, 2, 3)
    ends = made.x[rows, 2] + turned(made.orientation[rows, 2], [0.0, 0.0, 0.1])
    np.testing.assert_allclose(points, np.stack((made.x[rows, 1], ends), axis=1), atol=1e-6)


def test_what_does_not_move_is_sent_once(shown):
    _, path = shown
    page = Page(path)
    moved = {name for _, name, _, _ in page.updates}
    assert {"mesh", "height", "plane"}.isdisjoint(name[1:].split("_")[0] for name in moved)
    assert page.of("mesh", "batched_positions")[1].size == page.of("height_field", "batched_positions")[1].size == 3
    assert page.nodes["/plane_0"]["props"]["infinite_grid"] is True


def test_the_page_needs_no_network_and_says_its_name(shown):
    _, path = shown
    text = Page(path).text
    assert "<title>test</title>" in text
    assert set(re.findall(r"https?://[^'\"\s)]*", text)) <= {"http://www.w3.org/2000/svg"}
    assert not re.search(r"<(?:script|link|img)[^>]*\b(?:src|href)=\s*[\"'](?!data:)", text)


def test_what_rests_takes_no_room_and_nothing_is_printed(tmp_path, capsys):
    rng = np.random.default_rng(7)
    places = rng.uniform(-5, 5, (200, 1, 3)) + 1e-6 * rng.standard_normal((200, 300, 3))  # trembles
    made = recording([Box((1, 1, 1))] * 200, places, times=np.arange(300) / 30)
    path = made.to_html(tmp_path / "still.html")
    assert path.stat().st_size < CLIENT + 40_000
    # Counter-check: the same bodies take more room where they move.
    path = replace(made, x=made.x + np.arange(300)[:, None, None] / 300).to_html(path)
    assert path.stat().st_size > CLIENT + 150_000
    assert capsys.readouterr() == ("", "")


def test_parts_of_a_body_go_with_it(tmp_path):
    turn = about((0.0, 0.0, 1.0), np.pi / 2)
    made = recording([Box((1, 1, 1))], [np.array([[0, 0, 0], [0, 0, 1.0]])], turns={1: turn})
    part = DrawnShape(1, Box((1, 1, 1)), np.array([2.0, 0.0, 0.0]), UPRIGHT)
    made = replace(made, appearance=made.appearance._replace(parts=(part,)))
    course = Page(made.to_html(tmp_path / "part.html")).course("box", "batched_positions", made.t)
    np.testing.assert_allclose(course, [[0, 2, 0], [0, 2, 1]], atol=1e-3)


def test_rows_are_shown_thirty_times_a_second():
    for rate in (30, 60, 100, 240, 1000):
        t = np.arange(3 * rate + 1) / rate
        rows = rows_shown(t)
        assert (rows[0], rows[-1]) == (0, t.size - 1)
        assert np.diff(t[rows]).max() <= 1 / 30 + 1e-9
        assert len(rows) <= 1.4 * 90 + 2
    assert rows_shown(np.array([0.0, 1.0, 1.001, 1.002, 3.0])) == [0, 1, 3, 4]


def test_a_recording_that_cannot_be_shown_says_why(tmp_path, monkeypatch):
    made = recording([Box((1, 1, 1))], [np.zeros((2, 3))])
    bare = replace(made, appearance=made.appearance._replace(parts=()))
    with pytest.raises(KickdriftError, match="no shapes, and so there is nothing to show"):
        bare.to_html(tmp_path / "a.html")
    with pytest.raises(KickdriftError, match=r"the states are on disk, in 'x\.zarr'"):
        replace(made, saved_to="x.zarr").to_html(tmp_path / "a.html")
    with pytest.raises(FileFormatError, match=r"a\.htm'? cannot be written: pages for the browser end in \.html"):
        made.to_html(tmp_path / "a.htm")
    with pytest.raises(ArgumentError, match=r"path=5 is not a path; give a string such as 'run\.html'"):
        made.to_html(5)
    with pytest.raises(FileFormatError, match=r"cannot be written: No such file or directory; choose another folder"):
        made.to_html(tmp_path / "nowhere" / "a.html")
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(MissingExtraError, match=r"needs the package 'viser'.* pip install 'kickdrift\[viewer\]'"):
        made.to_html(tmp_path / "a.html")
    assert list(tmp_path.iterdir()) == []


def test_what_never_rests_is_sent_less_often(tmp_path, monkeypatch):
    t = np.arange(61) / 60
    made = recording([Box((1, 1, 1))] * 2, [np.outer(t, (1, 0, 0)), np.outer(t, (0, 1, 0))], times=t)

    def sent():
        page = Page(made.to_html(tmp_path / "moving.html"))
        assert page.seconds == pytest.approx(1.0 + 1 / 30)
        return len([what for _, _, what, _ in page.updates if what == "batched_positions"])

    assert sent() == 30
    monkeypatch.setattr("kickdrift.viewer.recording._MOST_POSES", 40)  # of 60 that two bodies have
    assert sent() == 15


def test_energies_beside_the_scene_end_with_the_run(shown):
    made, path = shown
    about = json.loads(re.search(r"const about = (\{.*?\}),", Page(path).text)[1])
    assert about == {"seconds": made.t[-1], "width": 260, "first": 0.0, "last": made.t[-1], "unit": "s"}
    curves = re.findall(r'<polyline points="([^"]*)"', path.read_text())
    total, kinetic, potential = (np.array([p.split(",") for p in curve.split()], dtype=float) for curve in curves)
    for curve in (total, kinetic, potential):
        np.testing.assert_allclose(curve[:, 0], 260 * made.t / made.t[-1], atol=0.06)
    assert re.search(r"[\d.]+ to [\d.]+ J</div>", path.read_text())
    # From the lowest value to the highest, downwards: the kinetic energy falls from 0.5 to 0.
    np.testing.assert_allclose(kinetic[:, 1], np.linspace(0.0, 90.0, 31), atol=0.06)
    assert np.all(potential[:, 1] == 90.0)


def test_the_vertices_of_a_cloth_are_where_the_recording_has_them(tmp_path):
    world = kd.World()
    sheet = world.add_cloth_grid((1.0, 1.0), (6, 5))
    sheet.pin([0, 4])
    made = world.run(duration=0.5, step=1 / 60, progress=False)
    page = Page(made.to_html(tmp_path / "cloth.html"))
    course = page.course("cloth_0", "vertices", np.linspace(0.0, 0.5, 16)).reshape(16, 30, 3)
    np.testing.assert_allclose(course, made.cloth(0)[::2], atol=1e-3)  # 30 states a second
    assert np.ptp(course[:, -1, 2]) > 0.1


def test_points_of_contacts_are_shown_where_they_were_recorded(tmp_path):
    world = kd.World()
    world.add_plane()
    world.add_box((1.0, 1.0, 1.0), position=(0.0, 0.0, 0.5), mass=1.0)
    made = world.run(duration=0.5, step=1 / 60, progress=False, contact_points=True)
    page = Page(made.to_html(tmp_path / "box.html"))
    seen = [m["visible"] for _, m in page.messages if m.get("name") == "/contacts" and "visible" in m]
    assert seen == [False, True], "it does not press at once"
    (last,) = page.course("contacts", "points", [0.5])
    corners = [[x, y, 0.0] for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    np.testing.assert_allclose(sorted(last.reshape(-1, 3).tolist()), corners, atol=0.01)
    left_out = Page(replace(made, contact_points=made.contact_points[:, :0]).to_html(tmp_path / "bare.html"))
    assert not any(name.startswith("/contacts") for name in left_out.nodes)


def test_names_cannot_bring_scripts_into_the_page(tmp_path):
    made = recording([Box((1, 1, 1))], [np.zeros((2, 3))])
    evil = "<script>alert(1)</script>"
    text = replace(made, about=replace(made.about, system=evil)).to_html(tmp_path / "a.html").read_text()
    assert evil not in text
    assert "<title>&lt;script&gt;alert(1)&lt;/script&gt;</title>" in text


@pytest.fixture(scope="module")
def planets():
    return kd.solve(kd.systems.outer_solar_system(), t_span=(0.0, 4000.0), step=100.0, method="leapfrog", compile=False)


def test_bodies_move_on_their_orbits(planets, tmp_path):
    page = Page(planets.to_html(tmp_path / "planets.html"))
    texts = [node["props"]["text"] for node in page.nodes.values() if "text" in node["props"]]
    assert texts == list(planets.about.coordinates["body"])
    count = planets.t.size
    times = np.linspace(0.0, page.seconds - 1 / 30, count)
    course = page.course("bodies", "batched_positions", times).reshape(count, -1, 3)
    # The browser's units are others, and so is its origin.
    exact, drawn = (x - x[:, :1] for x in (planets.x, course))
    np.testing.assert_allclose(drawn / np.abs(drawn).max(), exact / np.abs(exact).max(), atol=1e-3)
    assert {"/orbits", "/tails"} <= set(page.nodes)


def test_names_of_bodies_close_to_each_other_are_small_and_states_too_far_apart_have_no_tail(tmp_path):
    near, far = [1.0, 0.0, 0.0], [60.0, 0.0, 0.0]
    orbits = kd.systems.nbody([1.0, 0.0, 0.0], [[0, 0, 0], near, far], [[0, 0, 0], [0, 1, 0], [0, 60**-0.5, 0]])
    sol = kd.solve(orbits, (0.0, 300.0), step=0.1, save_every=30, method="leapfrog", compile=False)
    page = Page(sol.to_html(tmp_path / "planets.html"))
    heights = [node["props"]["font_scene_height"] for node in page.nodes.values() if "text" in node["props"]]
    assert heights[0] == heights[1] < 0.2 * heights[2]
    tail = page.of("tails", "points")[1].reshape(24, -1, 2, 3)
    assert tail.shape[1] == 1  # of the slow body: the heavy one does not move


def test_orbits_in_the_plane_backwards_and_of_a_single_state_are_shown(tmp_path):
    for end in (3.0, -3.0):
        sol = kd.solve(lambda x: -x, (0.0, end), [1.0, 0.0], [0.0, 1.0], step=0.05, compile=False)
        page = Page(sol.to_html(tmp_path / "orbit.html"))
        course = page.course("bodies", "batched_positions", np.linspace(0, page.seconds, sol.t.size))
        assert np.all(course[:, 2] == 0.0)
        way = course - course[0]
        assert np.linalg.norm(way[-1]) / 10 == pytest.approx(
            np.linalg.norm(sol.x[-1] - sol.x[0]) / np.linalg.norm(sol.x - sol.x.mean(axis=0), axis=1).max(), rel=0.02
        )
    sol = kd.solve(lambda x: -x, (0.0, 1.0), [1.0, 0.0], [0.0, 1.0], step=0.5, t_eval=[1.0], compile=False)
    assert Page(sol.to_html(tmp_path / "one.html")).seconds == pytest.approx(1 / 30)


def test_two_thousand_bodies_fit(tmp_path):
    angle = np.linspace(0.0, 6.0, 2000)
    start = np.column_stack((np.cos(angle), np.sin(angle))) * np.linspace(1.0, 3.0, 2000)[:, None]
    sol = kd.solve(lambda x: -x, (0.0, 3.0), start, 0 * start, step=0.1, compile=False)
    page = Page(sol.to_html(tmp_path / "crowd.html"))
    assert "/tails" not in page.nodes
    assert "/orbits" not in page.nodes
    assert page.of("bodies", "points")[1].size == 6000
    assert "2000 bodies without their orbits" in page.text
    assert len(page.text) < CLIENT + 3_000_000


def test_states_that_are_no_places_are_refused(tmp_path):
    sol = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.5, compile=False)
    with pytest.raises(ArgumentError, match=r"x has the shape \(\) at each time"):
        sol.to_html(tmp_path / "a.html")
    assert list(tmp_path.iterdir()) == []

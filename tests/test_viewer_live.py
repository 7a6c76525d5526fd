"""Worlds on live pages: they run by the clock, are paused, reset and pulled at, and other sites are refused."""

import http.client
import math
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import tomllib
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
import viser
from live_pages import WAIT, Browser, until
from packaging.requirements import Requirement
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, KickdriftError, MissingExtraError
from kickdrift.scenes import worlds
from kickdrift.viewer.bodies import on_planes
from kickdrift.viewer.controls import driven_axes, motor_axes
from kickdrift.viewer.grip import Grip
from kickdrift.viewer.live_world import LiveWorld
from kickdrift.viewer.server import local_server
from kickdrift.world.recordings.appearance import appearance

STEP = 1 / 128  # a power of two: sums of steps are exact


class Clock:
    """One that stands still but when it is told to go on, and while steps are done, if those take time."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def falling(**options):
    world = kd.World(**options)
    world.add_plane()
    ball = world.add_sphere(0.1, position=(0, 0, 100.0), mass=2.0)
    return world, ball


def live(slow=0.0):
    """A world on a clock, whose steps take a while."""
    world, _ = falling()
    clock = Clock()
    lives = LiveWorld(world, STEP, clock=clock)
    do, lives._do_step = lives._do_step, lambda: (do(), setattr(clock, "now", clock.now + slow))
    return lives, clock


# The world by the clock


def test_it_plays_in_real_time_and_pauses():
    lives, clock = live()
    lives.catch_up(1.0)
    assert lives.world.time == 0.0, "it waits to be played"
    lives.play()
    for _ in range(64):
        clock.now += 1 / 64
        lives.catch_up(1.0)
    assert lives.world.time == 1.0
    assert lives.reached == pytest.approx(1.0, abs=0.02)
    assert lives.words() == "t = 1.00 s, 1.00 times real time"
    lives.pause()
    clock.now += 10.0
    lives.catch_up(1.0)
    assert lives.world.time == 1.0
    assert lives.words() == "t = 1.00 s, paused"
    lives.play()
    clock.now += 1 / 64
    lives.catch_up(1.0)
    assert lives.world.time == 1.0 + 1 / 64, "what went by while it was paused is not made up for"


@pytest.mark.parametrize("speed", [0.25, 3.0])
def test_it_runs_at_the_speed_asked_for(speed):
    lives, clock = live()
    lives.speed = speed
    lives.play()
    for _ in range(128):
        clock.now += 1 / 64
        lives.catch_up(1.0)
    assert lives.world.time == 2.0 * speed
    assert lives.reached == pytest.approx(speed, rel=0.05)


def test_slow_steps_are_done_as_they_can_and_said_so():
    lives, clock = live(slow=1.25 * STEP)
    lives.play()
    for _ in range(200):
        clock.now += 1e-4
        lives.catch_up(1 / 60)
    assert 0.7 < lives.reached < 0.81
    assert f"{lives.reached:.2f} times real time" in lives.words()
    # What is due and left out is not made up for, once steps are faster.
    before = lives.world.time
    lives._do_step = lambda: lives.world.step(STEP)
    clock.now += 4 * STEP
    lives.catch_up(1.0)
    assert lives.world.time - before <= 8 * STEP


def test_a_single_step_pauses():
    lives, _ = live()
    lives.play()
    lives.do_step()
    assert (lives.world.time, lives.playing) == (STEP, False)


def test_a_controller_is_called_before_each_step():
    world = kd.World((0, 0, 0))
    ball = world.add_sphere(0.1, mass=2.0)
    times = []

    def control():
        times.append(world.time)
        world.apply_force(ball, (3.0, 0.0, 0.0))

    lives = LiveWorld(world, STEP, control)
    for _ in range(5):
        lives.do_step()
    assert times == [k * STEP for k in range(5)]
    assert ball.velocity[0] == pytest.approx(1.5 * 5 * STEP, rel=1e-12)


def test_reset_goes_back_to_the_same_bits_and_lets_go():
    lives, clock = live()
    lives.play()
    courses = []
    for _ in range(2):
        for _ in range(20):
            clock.now += 1 / 60
            lives.catch_up(1.0)
        courses.append(lives.state().position.tobytes())
        lives.grab(0, 2, np.array([0.0, 0.0, 99.0]))
        assert lives.grips
        lives.reset()
        assert (lives.world.time, lives.grips, lives.playing) == (0.0, {}, True)
    assert courses[0] == courses[1]


def test_what_cannot_be_done_pauses_and_is_said():
    lives, _ = live()
    lives.play()
    with lives.world.record():
        lives.reset()
    assert not lives.playing
    assert lives.words().startswith("the world is being recorded")
    lives.play()
    assert lives.trouble == ""
    lives.world.velocity[2] = np.nan
    lives.do_step()
    assert "body 2" in lives.words()


# The grip


def settled(body, grip, world, step, seconds=6.0):
    for _ in range(round(seconds / step)):
        grip.pull()
        world.step(step)


@pytest.mark.parametrize("mass", [0.01, 2.0, 5000.0])
def test_what_is_held_hangs_as_low_as_the_spring_says(mass):
    world = kd.World()
    ball = world.add_sphere(0.1, position=(0, 0, 1.0), mass=mass)
    grip = Grip(world, ball, ball.position.copy(), 1 / 120)
    grip.target = np.array([0.3, 0.0, 2.0])
    settled(ball, grip, world, 1 / 120)
    np.testing.assert_allclose(ball.position, [0.3, 0.0, 2.0 - 9.81 / (6 * np.pi) ** 2], atol=1e-6)


def test_the_spring_is_critically_damped_and_follows_in_its_time():
    step = 1 / 2000
    world = kd.World((0, 0, 0))
    box = world.add_box((1, 2, 3), mass=4.0)
    grip = Grip(world, box, np.zeros(3), step)
    grip.target = np.array([0.01, 0.0, 0.0])
    way = []
    for _ in range(600):
        grip.pull()
        world.step(step)
        way.append(box.position[0])
    t, rate = step * np.arange(1, 601), 6 * np.pi
    np.testing.assert_allclose(way, 0.01 * (1 - (1 + rate * t) * np.exp(-rate * t)), atol=1e-4)


@pytest.mark.parametrize("step", [1 / 30, 1 / 60, 1 / 240])
@pytest.mark.parametrize("shape", ["needle", "plate", "free corner"])
def test_a_grip_at_the_end_of_anything_comes_to_rest(step, shape):
    world = kd.World()
    size = {"needle": (2.0, 0.02, 0.02), "plate": (1.0, 1.0, 0.01), "free corner": (1.0, 0.7, 0.4)}[shape]
    box = world.add_box(size, mass=3.0, damping=1.0, angular_damping=1.0)
    grip = Grip(world, box, 0.5 * np.array(size), step)
    grip.target = np.array([2.0, 1.0, 1.0])
    settled(box, grip, world, step, 20.0)
    np.testing.assert_allclose(grip.point[:2], grip.target[:2], atol=0.01)
    assert 0.0 < grip.target[2] - grip.point[2] < 0.2  # by which it hangs lower; 0.04 but for the largest step
    assert np.linalg.norm(box.velocity) < 0.05


def test_a_grip_lifts_what_joints_hold_to_a_body_of_little_mass():
    world = kd.World()
    trunk = world.add_box((0.3, 0.3, 0.6), position=(0, 0, 1.0), mass=60.0)
    hand = world.add_sphere(0.05, position=(0.5, 0, 1.2), mass=0.5)
    world.add_ball_joint(trunk, hand, anchor=(0.2, 0, 1.2))
    step = 1 / 240
    grip = Grip(world, hand, hand.position.copy(), step)
    grip.target = np.array([0.5, 0.0, 3.0])
    settled(hand, grip, world, step, 10.0)
    assert np.linalg.norm(grip.point - grip.target) < 0.4
    assert trunk.position[2] > 1.5


def test_a_grip_wakes_what_sleeps():
    world = kd.World(sleeping=True)
    world.add_plane()
    box = world.add_box((1, 1, 1), position=(0, 0, 0.5), mass=1.0)
    world.run(2.0, 1 / 60, progress=False)
    lives = LiveWorld(world, 1 / 60)
    lives.grab(7, box.index, box.position.copy())
    lives.pull_to(7, np.array([0.0, 0.0, 2.0]))
    for _ in range(120):
        lives.do_step()
    assert box.position[2] > 1.8
    lives.let_go(7)
    for _ in range(120):
        lives.do_step()
    assert box.position[2] == pytest.approx(0.5, abs=0.02), "it fell when it was let go"


def test_what_no_force_moves_is_not_grabbed():
    world, _ = falling()
    wall = world.add_box((1, 1, 1), static=True)
    lives = LiveWorld(world, STEP)
    lives.grab(0, wall.index, np.zeros(3))
    lives.grab(0, 0, np.zeros(3))
    assert lives.grips == {}


# The server


@pytest.fixture(scope="module")
def server():
    with local_server(0) as server:
        yield server


def answer(port, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=WAIT)
    try:
        connection.request("GET", "/", headers=headers)
        response = connection.getresponse()
        return response.status, response.read().decode()
    finally:
        connection.close()


def test_the_page_is_there_under_the_names_of_this_machine(server):
    port = server.get_port()
    for host in (f"127.0.0.1:{port}", f"localhost:{port}", "localhost:1234"):  # the last through a tunnel
        status, text = answer(port, Host=host)
        assert status == 200
        assert text.startswith("<!doctype html>")


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1.evil.example", "192.168.0.7", "", "localhost.evil.example:80"]
)
def test_a_foreign_host_is_refused(server, host):
    status, text = answer(server.get_port(), Host=host)
    assert status == 403
    assert "for this machine alone" in text


@pytest.mark.parametrize(
    "origin", [None, "null", "http://evil.example", "https://127.0.0.1:{port}", "http://127.0.0.1:1"]
)
def test_a_socket_of_another_origin_is_refused(server, origin):
    port = server.get_port()
    asked = {"subprotocols": [f"viser-v{viser.__version__}"], "open_timeout": 10}
    with pytest.raises(InvalidStatus, match="403"):
        connect(f"ws://127.0.0.1:{port}", origin=origin and origin.format(port=port), **asked).close()
    # Counter-check: its own is not.
    for name in ("127.0.0.1", "localhost"):
        connect(f"ws://{name}:{port}", origin=f"http://{name}:{port}", **asked).close()


def test_it_listens_on_the_loopback_address_alone(server):
    assert server.get_host() == "127.0.0.1"
    name = socket.gethostbyname(socket.gethostname())
    if not name.startswith("127."):
        with pytest.raises(OSError), socket.create_connection((name, server.get_port()), timeout=2):  # noqa: PT011
            pass


def test_it_is_not_passed_on_to_a_public_relay(server):
    assert server.request_share_url() is None


def test_a_connection_without_a_request_is_closed(monkeypatch):
    """A server that stops waits for it, and browsers open such connections."""
    monkeypatch.setattr("kickdrift.viewer.server._PATIENCE", 0.1)
    with local_server(0) as started, socket.create_connection(("127.0.0.1", started.get_port()), timeout=5.0) as idle:
        assert idle.recv(1) == b""


def test_the_version_of_viser_is_bound_to_those_that_it_was_looked_at_in():
    # How viser starts its server and what it sends a browser is not promised by it: raise the bound after a look at both.
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (bound,) = map(Requirement, project["optional-dependencies"]["viewer"])
    assert viser.__version__ in bound.specifier
    assert "1.2.0" not in bound.specifier


def test_a_server_that_is_started_in_another_way_is_refused(monkeypatch):
    monkeypatch.setattr("kickdrift.viewer.server._VISERS", "elsewhere")
    threads = threading.active_count()
    with pytest.raises(KickdriftError, match="starts its server in another way"), local_server(0):
        pass
    until(lambda: threading.active_count() <= threads, "the server to end")


@pytest.mark.parametrize("port", [-1, 65536, True, "8080", 80.0])
def test_a_port_that_cannot_be_is_refused(port):
    with pytest.raises(ArgumentError, match=r"must be a whole number from 0 to 65535"), local_server(port):
        pass


# The page


@pytest.fixture
def page():
    world = kd.World()
    world.add_plane()
    ball = world.add_sphere(0.5, position=(0, 0, 50.0), mass=1.0, name="ball")
    arm = world.add_box((1, 0.2, 0.2), position=(5, 0, 1), mass=1.0, name="arm")
    world.add_hinge(
        None,
        arm,
        anchor=(4.5, 0, 1),
        axis=(0, 0, 1),
        drive=kd.Drive(100.0, 10.0, target=0.3),
        limits=(-1, 2),
        name="elbow",
    )
    threads = threading.active_count()
    with world.view(1 / 100, port=0) as page:
        yield world, ball, page
    until(lambda: threading.active_count() <= threads, "threads to end")


@pytest.mark.parametrize("aspect", [2.0, 1.0, 0.5, 0.25])
def test_a_page_that_is_higher_than_wide_is_seen_from_farther_away(page, aspect):
    _, _, page = page
    with Browser(page.url, width=40, height=round(40 / aspect)) as browser:
        until(lambda: sees_all(page, browser, aspect), "the camera to be moved")


def test_a_camera_follows_the_shape_of_its_page_until_its_user_moves_it(page):
    _, _, page = page
    with Browser(page.url, width=40, height=40) as browser:
        until(lambda: browser.camera, "the camera to be placed")
        for width in (20, 10, 30):  # docked, a panel takes a part of a page that has connected
            browser.look(browser.camera[-1], width, 40)
            until(lambda width=width: sees_all(page, browser, width / 40), "the camera to be moved")
        turned, sent = browser.camera[-1] * (-1, 1, 1), len(browser.camera)
        for width in (30, 10):
            browser.look(turned, width, 40)
        time.sleep(0.3)
        assert len(browser.camera) == sent


def sees_all(page, browser, aspect):
    """Whether the last place of a camera is as far away as a picture of an aspect, width over height, asks for."""
    half = math.atan(min(aspect, 1.0) * math.tan(math.radians(17.0)))  # of what is seen, across the smaller side
    wanted = page._picture._radius / math.sin(half)
    away = np.linalg.norm(browser.camera[-1] - page._picture._centre) if browser.camera else 0.0
    return abs(away / wanted - 1) < 1e-6


def test_the_page_plays_pauses_steps_and_resets(page, capsys):
    world, ball, page = page
    time.sleep(0.2)
    assert world.time == 0.0, "it waits for somebody to see it"
    with Browser(page.url) as browser:
        until(lambda: world.time > 0.2, "the world to run")
        browser.press("Pause")
        until(lambda: "paused" in browser.words, "the pause")
        at, steps = world.time, world.n_steps
        browser.press("Step")
        until(lambda: world.n_steps == steps + 1, "a step")
        shown = browser.nodes["/sphere_0"]
        until(lambda: abs(shown["batched_positions"][2] - ball.position[2]) < 0.01, "the ball to be shown where it is")
        assert world.time == at + 1 / 100
        browser.press("Reset")
        until(lambda: world.time == 0.0, "the reset")
        until(lambda: abs(shown["batched_positions"][2] - 50.0) < 0.01, "the ball to be shown")
        browser.press("Play")
        until(lambda: world.time > 0.1, "the world to run")
        until(lambda: "times real time" in browser.words, "its pace")
    with Browser(page.url) as browser:  # the page was reloaded
        until(lambda: "Pause" in {m["props"].get("label") for m in browser.gui.values()}, "the controls")
        until(lambda: "/sphere_0" in browser.nodes and "/box_1" in browser.nodes, "the bodies")
    page.close()
    at = world.time
    time.sleep(0.1)
    assert world.time == at
    assert page._repr_html_().startswith(f'<iframe src="{page.url}"')
    assert repr(page) == f"<LivePage {page.url}, closed>"
    with pytest.raises(OSError):  # noqa: PT011
        answer(int(page.url.rsplit(":", 1)[1]))


def test_the_mouse_pulls_at_a_body_and_lets_go(page):
    world, ball, page = page
    world.gravity = (0.0, 0.0, 0.0)
    with Browser(page.url) as browser:
        until(lambda: "/sphere_0" in browser.nodes and world.time > 0.0, "the ball")
        browser.drag("/sphere_0", 0, "start", (0, 0, 50.5), (0, 0, 50.5))
        browser.drag("/sphere_0", 0, "update", (0, 0, 50.5), (3.0, 0, 50.5))
        until(lambda: browser.nodes["/springs"].get("visible"), "the spring to be drawn")
        until(lambda: ball.position[0] > 2.5, "the ball to come")
        browser.drag("/sphere_0", 0, "end", (3.0, 0, 50.5), (3.0, 0, 50.5))
        until(lambda: not browser.nodes["/springs"]["visible"], "the spring to go")
        # A page that is closed lets go, too.
        browser.drag("/sphere_0", 0, "start", (0, 0, 50.0), (0, 0, 50.0))
        until(lambda: browser.nodes["/springs"]["visible"], "the spring to be drawn")
    with Browser(page.url) as browser:
        until(lambda: browser.nodes.get("/springs", {}).get("visible") is False, "the spring to go")


def test_sliders_set_targets_and_settings_and_go_back(page):
    world, _, page = page
    elbow = world.joint("elbow")
    with Browser(page.url) as browser:
        until(lambda: browser.has("elbow"), "a slider")
        props = browser.gui[browser.find("elbow")]["props"]
        assert (props["min"], props["max"], browser.value("elbow")) == (-1.0, 2.0, 0.3)
        browser.set("elbow", 1.2)
        until(lambda: elbow.drive().target == 1.2, "the target")
        assert elbow.drive() == kd.Drive(100.0, 10.0, target=1.2)
        until(lambda: abs(elbow.angle - 1.2) < 0.05, "the arm to turn")
        browser.set("Gravity", (0.0, 0.0, -1.6))
        until(lambda: world.gravity[2] == -1.6, "gravity")
        browser.set("Substeps", 8)
        until(lambda: world.substeps == 8, "substeps")
        browser.set("Sleeping", True)
        until(lambda: world.sleeping, "sleep")
        browser.set("Speed", 0.5)
        time.sleep(1.5)
        until(lambda: re.search(r"0\.[45]\d times real time", browser.words), "half of real time")
        browser.press("Reset")
        until(lambda: elbow.drive().target == 0.3 and world.gravity[2] == -9.81, "the reset")
        shown = {"elbow": 0.3, "Substeps": 4, "Sleeping": False, "Speed": 0.5}
        until(lambda: all(browser.value(label) == value for label, value in shown.items()), "the sliders to go back")


def test_points_of_contact_are_drawn_on_request():
    world = kd.World()
    world.add_plane()
    world.add_box((1, 1, 1), position=(0, 0, 0.5), mass=1.0)
    with world.view(1 / 60, port=0) as page, Browser(page.url) as browser:
        until(lambda: "/contacts" in browser.nodes and world.time > 0.1, "the box")
        assert browser.nodes["/contacts"]["visible"] is False
        browser.set("Contact points", True)
        until(lambda: browser.nodes["/contacts"]["visible"], "the points to be drawn")
        browser.set("Contact points", False)
        until(lambda: not browser.nodes["/contacts"]["visible"], "the points to go")


def test_sliders_are_there_for_drives_that_pull_to_a_target():
    assert driven_axes(worlds.ragdolls()) == []
    names = [name for name, _, _ in driven_axes(worlds.arm().world)]
    assert names == [f"joint {k}" for k in range(7)]
    world = kd.World()
    box = world.add_box((1, 1, 1), mass=1.0)
    spring = kd.Axis(drive=kd.Drive(10.0, 1.0))
    joint = world.add_six_dof_joint(None, box, anchor=(0, 0, 0), linear=(spring, kd.Axis(), spring), name="table")
    assert driven_axes(world) == [("table, axis 0", joint, 0), ("table, axis 2", joint, 2)]
    for _, found, axis in driven_axes(world):
        found.set_drive(None, axis)
    assert driven_axes(world) == []


def test_sliders_set_the_speeds_of_motors():
    world = kd.World(gravity=(0, 0, 0))
    wheel = world.add_cylinder(0.2, 0.1, mass=1.0)
    hinge = world.add_hinge(None, wheel, (0, 0, 0), (0, 0, 1), motor=kd.Motor(speed=8.0, maximum=5.0), name="wheel")
    assert motor_axes(world) == [("wheel", hinge, 5)]
    assert driven_axes(world) == []
    with world.view(1 / 60, port=0) as page, Browser(page.url) as browser:
        until(lambda: browser.has("wheel"), "a slider")
        props = browser.gui[browser.find("wheel")]["props"]
        assert (props["min"], props["max"], browser.value("wheel")) == (-16.0, 16.0, 8.0)
        browser.set("wheel", -3.0)
        until(lambda: hinge.motor() == kd.Motor(speed=-3.0, maximum=5.0), "the motor")
        until(lambda: abs(hinge.speed + 3.0) < 1e-6, "the wheel to turn")


def test_the_camera_sees_where_things_fall():
    world, _ = falling()
    looks, state = appearance(world), LiveWorld(world, STEP).state()
    (floor,) = on_planes(looks, state, state.position)
    np.testing.assert_allclose(floor[2], [0, 0, 0], atol=1e-12)
    tilted = kd.World()
    tilted.add_plane(normal=(0, 3, 4), point=(0, 0, 1))
    ball = tilted.add_sphere(0.1, position=(2, 0, 6), mass=1.0)
    (floor,) = on_planes(appearance(tilted), LiveWorld(tilted, STEP).state(), np.array([ball.position]))
    np.testing.assert_allclose(floor, [[2.0, -2.4, 2.8]], atol=1e-12)


def test_bodies_that_come_and_go_are_seen(page):
    world, ball, page = page
    with Browser(page.url) as browser:

        def balls():
            found = [n for name, n in list(browser.nodes.items()) if name.startswith("/sphere") and "light" not in name]
            return found[0]["batched_positions"].reshape(-1, 3) if found else ()

        until(lambda: len(balls()) == 1, "a ball")
        new = world.add_sphere(0.2, position=(1, 1, 60.0), mass=1.0)
        until(lambda: len(balls()) == 2, "another ball")
        world.remove(ball)
        until(lambda: len(balls()) == 1, "one ball")
        until(lambda: abs(balls()[0, 0] - new.position[0]) < 0.01, "the new one")
        assert "/joints" in browser.nodes
        world.remove_joint(world.joint("elbow"))
        until(lambda: "/joints" not in browser.nodes, "the joint to go")
        browser.press("Reset")
        until(lambda: "/joints" in browser.nodes, "the joint to come back")
        until(lambda: abs(balls()[0, 0]) < 0.01, "the first ball to come back")


def test_ten_pages_see_the_same(page):
    world, ball, page = page
    with ExitStack() as stack:
        browsers = [stack.enter_context(Browser(page.url)) for _ in range(10)]
        until(lambda: world.time > 0.3, "the world to run")
        browsers[3].press("Pause")
        for browser in browsers:
            until(lambda browser=browser: "paused" in browser.words, "the pause")
        at = ball.position[2]
        for browser in browsers:
            until(lambda b=browser: abs(b.nodes["/sphere_0"]["batched_positions"][2] - at) < 0.01, "the ball")


def test_two_worlds_have_a_page_each_and_a_port_that_is_taken_is_refused(page):
    _, _, first = page
    world, _ = falling()
    port = int(first.url.rsplit(":", 1)[1])
    with pytest.raises(ArgumentError, match=rf"port={port} is in use .* give another port, or 0 for a free one"):
        world.view(STEP, port=port)
    with world.view(STEP, port=0) as second, Browser(second.url) as browser:
        assert second.url != first.url
        until(lambda: world.time > 0.1 and "times real time" in browser.words, "the second world to run")


def test_what_cannot_be_seen_is_refused(monkeypatch):
    with pytest.raises(KickdriftError, match="the world has no shapes, and so there is nothing to show"):
        kd.World().view(STEP, port=0)
    world, _ = falling()
    for step in (0.0, -1.0, np.nan, "fast"):
        with pytest.raises(ArgumentError, match="step="):
            world.view(step, port=0)
    with pytest.raises(ArgumentError, match="control=3 must be a function without arguments"):
        world.view(STEP, control=3, port=0)
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(MissingExtraError, match=r"needs the package 'viser'.* pip install 'kickdrift\[viewer\]'"):
        world.view(STEP, port=0)


def test_what_ends_the_loop_is_raised_where_one_waits():
    def fail():
        raise ZeroDivisionError("on purpose")

    world, _ = falling()
    page = world.view(STEP, control=fail, port=0)
    with Browser(page.url), pytest.raises(ZeroDivisionError, match="on purpose"):  # it plays for the first who comes
        page.wait()


SCRIPT = """
import signal, kickdrift as kd
signal.signal(signal.SIGINT, signal.default_int_handler)  # which a parent may have had ignored
world = kd.World()
world.add_sphere(0.5, mass=1.0)
page = world.view(1 / 60, port=0)
{end}
print("after", world.time)
"""

WAITING = """
wait = page._ended.wait

def waiting(seconds):
    page._ended.wait = wait
    print("waiting", flush=True)
    return wait(seconds)

page._ended.wait = waiting
page.wait()
"""


@pytest.mark.parametrize("interrupted", [True, False])
def test_the_server_ends_with_the_script(interrupted):
    source = SCRIPT.format(end=WAITING if interrupted else "")
    piped = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen([sys.executable, "-c", source], **piped) as process:
        try:
            url = next(line for line in process.stdout if line.startswith("open ")).removeprefix("open ").strip()
            if interrupted:
                assert process.stdout.readline() == "waiting\n"  # before, Ctrl-C would end the script
                assert answer(int(url.rsplit(":", 1)[1]))[0] == 200
                process.send_signal(signal.SIGINT)
            rest = process.stdout.read()
            assert process.wait(60) == 0, rest
        finally:
            process.kill()
    assert rest.strip() == "after 0.0"

"""Pages in a browser: Chromium plays, drags and reconnects, and is refused under other names and from other sites."""

import io
import re
import subprocess
import sys
import threading
from contextlib import closing
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import chromium
import numpy as np
import pytest
import viser
from live_pages import until
from matplotlib.image import imread

import kickdrift as kd
from kickdrift.scenes import worlds

pytestmark = pytest.mark.skipif(
    chromium.PATH is None, reason=f"there is no browser here: none of {', '.join(chromium.NAMES)}"
)
PLAYING = "times real time"
NOW = "document.querySelector('[role=slider]')?.getAttribute('aria-valuenow')"  # where the time line is


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with chromium.Chromium(tmp_path_factory.mktemp("chromium")) as browser:
        yield browser


@pytest.fixture
def floating():
    """A world of a ball without weight in the middle of the picture, on a page."""
    world = kd.World((0, 0, 0))
    ball = world.add_sphere(0.5, mass=1.0)
    with world.view(1 / 60, port=0) as page:
        yield world, ball, page


def contrast(tab):
    """By how much colours differ in the middle of the picture, where no words are, from 0 to 255."""
    pixels = imread(io.BytesIO(tab.screenshot()), format="png")[250:500, 200:480, :3]
    return 255 * np.ptp(pixels.reshape(-1, 3), axis=0).max()


def test_a_page_plays_pauses_steps_and_resets(browser, floating):
    world, ball, page = floating
    ball.velocity = (0.05, 0.0, 0.0)
    with closing(browser.open(page.url)) as tab:
        tab.until(lambda tab: PLAYING in tab.text, "the world to run")
        tab.press("Pause")
        tab.until(lambda tab: "paused" in tab.text, "the pause")
        at, steps = world.time, world.n_steps
        tab.press("Step")
        until(lambda: world.n_steps == steps + 1, "a step")
        assert world.time > at
        tab.press("Reset")
        until(lambda: world.time == 0.0, "the reset")
        tab.until(lambda tab: "t = 0.00 s" in tab.text, "the time")
        tab.until(lambda tab: contrast(tab) > 30, "the ball to be seen")
        tab.press("Play")
        tab.until(lambda tab: PLAYING in tab.text, "the world to run again")
        assert tab.errors == []


def test_the_controls_hide_nothing_of_the_world(browser, floating):
    *_, page = floating
    with closing(browser.open(page.url)) as tab:
        tab.until(lambda tab: PLAYING in tab.text, "the world to run")
        ends = "document.querySelector('canvas').getBoundingClientRect().right"
        pause = "[...document.querySelectorAll('button')].find(b => b.innerText.trim() === 'Pause')"
        begins = f"{pause}.getBoundingClientRect().left"
        assert tab.run(ends) <= tab.run(begins)


def slide(tab, number, part):
    """Move the slider with a number, from the top, to a part of its length."""
    left, right, y = tab.run(
        f"(({{left, right, top, bottom}}) => [left, right, 0.5 * (top + bottom)])"
        f"(document.querySelectorAll('.mantine-Slider-track')[{number}].getBoundingClientRect())"
    )
    tab.drag((0.5 * (left + right), y), (left + part * (right - left), y))


def shown(tab):
    return tab.run(
        "[...document.querySelectorAll('[role=slider]')].map(slider => slider.getAttribute('aria-valuenow'))"
    )


def test_the_mouse_moves_sliders_and_a_reset_moves_those_of_the_world_back(browser, floating):
    world, _, page = floating
    with closing(browser.open(page.url)) as tab:
        tab.until(lambda tab: PLAYING in tab.text, "the world to run")
        assert shown(tab) == ["1", "4"], "speed and substeps"
        slide(tab, 0, 1.0)
        tab.until(lambda tab: re.search(r"[234]\.\d\d times real time", tab.text), "four times real time, if it can")
        slide(tab, 1, 0.0)
        until(lambda: world.substeps == 1, "a single substep")
        tab.run("[...document.querySelectorAll('input[type=checkbox]')].at(-1).click()")
        until(lambda: world.sleeping, "sleep")
        assert shown(tab) == ["4", "1"]
        tab.press("Reset")
        until(lambda: (world.substeps, world.sleeping) == (4, False), "the reset")
        tab.until(lambda tab: shown(tab) == ["4", "4"], "the slider of the world to go back")
        assert tab.errors == []


def test_the_command_line_shows_a_scene(browser):
    command = [sys.executable, "-m", "kickdrift", "view", "pyramid", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        try:
            url = next(line for line in process.stdout if line.startswith("open ")).removeprefix("open ").strip()
            with closing(browser.open(url)) as tab:
                tab.until(lambda tab: PLAYING in tab.text, "the pyramid to stand")
                tab.until(lambda tab: contrast(tab) > 30, "it to be seen")
                assert tab.errors == []
        finally:
            process.kill()


def test_the_mouse_drags_a_body(browser, floating):
    _, ball, page = floating
    with closing(browser.open(page.url)) as tab:
        tab.until(lambda tab: PLAYING in tab.text, "the world to run")
        assert np.all(ball.position == 0.0)
        tab.drag((340, 350), (440, 350), release=False)
        until(lambda: ball.position[0] > 0.04, "the ball to follow")  # it turns, too, as its surface is pulled
        tab.release((440, 350))
        until(lambda: not page._live.grips, "the spring to go")
        # Where nothing is, the mouse turns the camera, and pulls at no body.
        ball.velocity = (0, 0, 0)
        at = ball.position.copy()
        tab.drag((100, 600), (250, 600))
        np.testing.assert_array_equal(ball.position, at)


def test_ten_pages_at_once_and_a_reload(browser, floating):
    world, _, page = floating
    tabs = [browser.open(page.url, 250, 175) for _ in range(10)]  # small, as the processor draws them
    for tab in tabs:
        tab.until(lambda tab: PLAYING in tab.text, "the world to run on each page")
    tabs[7].press("Pause")
    for tab in tabs:
        tab.until(lambda tab: "paused" in tab.text, "the pause on each page")
    tabs[2].call("Page.reload")
    tabs[2].until(lambda tab: "paused" in tab.text and "Connected" in tab.text, "the page to be there again")
    tabs[2].press("Play")
    at = world.time
    until(lambda: world.time > at, "the world to run")
    for tab in tabs:
        tab.close()


SOCKET = """new Promise(done => {{
    const socket = new WebSocket("ws://127.0.0.1:{port}", ["viser-v{version}"]);
    socket.onopen = () => {{ socket.close(); done("open"); }};
    socket.onerror = () => done("refused");
}})"""


class _OtherSite(BaseHTTPRequestHandler):
    def do_GET(self):
        self.send_response(200)
        self.end_headers()
        self.wfile.write(b"<!doctype html><p>another site")

    def log_message(self, *_):
        pass


def test_other_names_and_other_sites_are_refused(browser, floating):
    world, _, page = floating
    port = int(page.url.rsplit(":", 1)[1])
    script = SOCKET.format(port=port, version=viser.__version__)
    with closing(browser.open(f"http://{chromium.EVIL}:{port}/")) as tab:
        tab.until(lambda tab: "for this machine alone" in tab.text, "the refusal")
        assert tab.run(script) == "refused"
    with ThreadingHTTPServer(("127.0.0.1", 0), _OtherSite) as other:
        thread = threading.Thread(target=other.serve_forever)
        thread.start()
        try:
            with closing(browser.open(f"http://127.0.0.1:{other.server_port}/")) as tab:
                tab.until(lambda tab: "another site" in tab.text, "the other site")
                assert tab.run(script) == "refused"
        finally:
            other.shutdown()
            thread.join()
    assert world.time == 0.0, "nobody has come"
    with closing(browser.open(page.url)) as tab:  # counter-check
        tab.until(lambda tab: "Connected" in tab.text, "the page")
        assert tab.run(script) == "open"


def test_a_recording_plays_from_its_file(browser, tmp_path):
    world = worlds.pyramid(base=4)
    world.velocity[1] = (0.0, 0.0, 2.0)
    path = world.run(1.0, 1 / 60, progress=False).to_html(tmp_path / "pyramid.html")
    blank = tmp_path / "blank.html"
    blank.write_text("<!doctype html><p>blank")
    with closing(browser.open(blank.as_uri())) as tab:
        tab.until(lambda tab: tab.text == "blank", "a page")
        assert contrast(tab) == 0.0
        tab.call("Network.enable")
        nothing = {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
        tab.call("Network.emulateNetworkConditions", **nothing)
        tab.go(path.as_uri())
        tab.until(lambda tab: tab.run(NOW) is not None, "the time line")
        first = tab.run(NOW)
        tab.until(lambda tab: tab.run(NOW) != first, "the time line to move")
        tab.until(lambda tab: contrast(tab) > 30, "a picture")
        assert tab.errors == []


def test_a_recording_is_seen_whole_on_a_phone(browser, tmp_path):
    across = np.array([0.98, 0.5, 0.0])  # from left to right, as the camera looks
    world = kd.World((0, 0, 0))
    for place in range(-4, 5):
        world.add_sphere(0.5, position=place * across, mass=1.0)
    path = world.run(1.0, 1 / 60, progress=False).to_html(tmp_path / "row.html")
    with closing(browser.open("about:blank")) as tab:
        tab.call("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
        tab.go(path.as_uri())
        tab.until(lambda tab: tab.run(NOW) is not None, "the time line")
        tab.until(lambda tab: coloured(tab)[190:200].all(), "the balls to be seen")
        seen = np.flatnonzero(coloured(tab))
        assert 0 < seen[0] < 60, "cut off at the left, or too small"
        assert 330 < seen[-1] < 389, "cut off at the right, or too small"


def coloured(tab):
    """Which columns of pixels have colours halfway up, where no words are."""
    pixels = imread(io.BytesIO(tab.screenshot()), format="png")[300:500, :, :3]
    return (np.ptp(pixels, axis=2) > 0.1).any(axis=0)

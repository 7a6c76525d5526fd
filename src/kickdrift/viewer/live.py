"""Worlds that run on pages of the browser."""

import atexit
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from html import escape
from queue import SimpleQueue
from types import TracebackType
from typing import Any, Self

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.engine.announcing import compiling_announced
from kickdrift.viewer.bodies import DrawnBodies, check_can_be_seen, extent, on_planes
from kickdrift.viewer.contacts import ContactPoints
from kickdrift.viewer.controls import Controls
from kickdrift.viewer.fit import Fit
from kickdrift.viewer.live_world import LiveWorld
from kickdrift.viewer.meshes import Drag, State
from kickdrift.viewer.page import Stage
from kickdrift.viewer.server import ADDRESS, local_server
from kickdrift.world.argument_checks import number
from kickdrift.world.layout import DYNAMIC
from kickdrift.world.recordings.appearance import Appearance, appearance
from kickdrift.world.tables import CLOTH, SHAPE
from kickdrift.world.world import World

_FRAME = 1 / 60  # seconds between states that are sent
_WORDS = 0.2  # and between lines that are
_SPRING = (230, 60, 40)


def view_world(
    world: World, step: float, *, control: Callable[[], object] | None = None, port: int = 8080
) -> "LivePage":
    """Show a world on a page of the browser, on which it plays, pauses, steps, and is pulled with the mouse.

    Parameters
    ----------
    world : World
        It runs in a background thread once the page is first opened, in real time if steps are fast enough.
    step : float
        s.
    control : callable, optional
        Called without arguments before each step.
    port : int
        Port on this machine, accessible only from it; 0 chooses a free one.

    Returns
    -------
    LivePage
        Any number of browsers may show it, until it is closed, at the latest when Python ends.

    Raises
    ------
    ArgumentError
        For a step that is not positive and finite, a control that cannot be called, and a port that is in use.
    KickdriftError
        If there is nothing to show.
    MissingExtraError
        If viser is not installed.
    """
    step = number("step", step, "s; 1/60 is usual", zero=False)
    check_can_be_seen(appearance(world), "the world")
    if not (control is None or callable(control)):
        raise ArgumentError(
            f"control={control!r} must be a function without arguments, which is called before each step."
        )
    page = LivePage(world, step, control, port)
    print(f"open {page.url}", flush=True)
    return page


class LivePage:
    """A page that shows a running world, see `World.view`.

    Attributes
    ----------
    url : str
        Its address.
    """

    def __init__(self, world: World, step: float, control: Callable[[], object] | None, port: int) -> None:
        self._held = ExitStack()
        self._server = self._held.enter_context(local_server(port))
        self.url = f"http://{ADDRESS}:{self._server.get_port()}"
        try:
            with compiling_announced():
                world.advance(step, 0)
            self._live = LiveWorld(world, step, control)
            self._ended = threading.Event()
            self._asked: SimpleQueue[Callable[[], None]] = SimpleQueue()
            self._set_up()
        except BaseException:
            self._held.close()
            raise
        self._failed: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="kickdrift page", daemon=True)
        atexit.register(self.close)
        self._thread.start()

    def wait(self) -> None:
        """Wait until Ctrl-C, which closes the page, or until it is closed elsewhere."""
        try:
            while not self._ended.wait(0.5):  # on Windows Ctrl-C does not end a wait without an end
                pass
        except KeyboardInterrupt:
            print()
        self.close()

    def close(self) -> None:
        """Stop the world and the server; an error that ended the page earlier is raised."""
        atexit.unregister(self.close)
        self._ended.set()
        self._thread.join()
        self._held.close()
        failed, self._failed = self._failed, None
        if failed is not None:
            raise failed

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<LivePage {self.url}{', closed' if self._ended.is_set() else ''}>"

    def _repr_html_(self) -> str:
        return f'<iframe src="{escape(self.url)}" width="100%" height="480" style="border:0"></iframe>'

    def _set_up(self) -> None:
        """Draw the world, and its controls; have it begin to run when the page is first opened."""
        server, live, opened = self._server, self._live, threading.Event()
        server.gui.configure_theme(show_logo=False, show_share_button=False)
        server.gui.main_panel.dock_right()  # a floating one hides part of the world
        self._picture = _Picture(server.scene, server.initial_camera, live, self._hear)
        self._controls = Controls(server.gui, live, self._asked.put)

        def begin(page: Any) -> None:
            self._picture.fit(page.camera)
            if not opened.is_set():
                opened.set()
                self._asked.put(live.play)

        server.on_client_connect(begin)

    def _hear(self, drag: Drag) -> None:
        """Pass on what the mouse does; called in the thread of the server."""
        live = self._live
        if drag.phase == "start":
            self._asked.put(lambda: live.grab(drag.page, drag.body, drag.grabbed))
        if drag.phase == "end":
            self._asked.put(lambda: live.let_go(drag.page))
        else:
            self._asked.put(lambda: live.pull_to(drag.page, drag.pulled_to))

    def _run(self) -> None:
        """Do what pages ask for, do the steps that are due, and send what has changed, until the page is closed."""
        said = 0.0
        try:
            while not self._ended.is_set():
                began = time.perf_counter()
                for _ in range(self._asked.qsize()):
                    self._live.attempt(self._asked.get())
                self._live.catch_up(_FRAME)
                with self._server.atomic():
                    self._picture.show()
                    if began - said >= _WORDS:
                        said = began
                        self._controls.show()
                self._ended.wait(max(0.001, began + _FRAME - time.perf_counter()))
        except BaseException as error:
            self._failed = error
            self._ended.set()


class _Picture:
    """A world in a scene of viser, with the springs that pull at it."""

    def __init__(self, scene: Any, camera: Any, live: LiveWorld, hear: Callable[[Drag], None]) -> None:
        self._scene, self._live, self._hear = scene, live, hear
        with live.world.tables.lock:
            state, self._looks, self._made_of = live.state(), appearance(live.world), _made_of(live.world)
        # What falls onto a plane is to be seen there, too.
        bodies, vertices = (
            [places, *on_planes(self._looks, state, places)] for places in (state.position, state.particles)
        )
        self._centre, self._radius = extent(self._looks, np.array(bodies), np.array(vertices))
        Stage(scene, camera, time.sleep).look(self._centre, self._radius)
        self._drawn = self._draw(state)
        self._springs = scene.add_line_segments(
            "/springs", np.zeros((1, 2, 3)), _SPRING, thickness=3.0, thickness_units="screen", visible=False
        )
        self._contacts = ContactPoints(scene, self._radius)

    def fit(self, camera: Any) -> None:
        """Move the camera of a page that is higher than wide back, as far as needed to see all."""
        Fit(camera, self._centre, self._radius)

    def show(self) -> None:
        """Send what has changed."""
        live, before = self._live, self._looks
        with live.world.tables.lock:  # bodies may come and go in other threads
            state, made_of = live.state(), _made_of(live.world)
            points = live.world.contact_points if live.shows_contacts else np.zeros((0, 3))
            if made_of != self._made_of:
                self._made_of, self._looks = made_of, appearance(live.world)
        if self._looks is not before and not _alike(before, self._looks):
            self._drawn.remove()
            self._drawn = self._draw(state)
        self._drawn.show(state)
        self._contacts.show(points)
        if live.grips:
            self._springs.points = np.array([(grip.point, grip.target) for grip in live.grips.values()])
        if self._springs.visible != bool(live.grips):
            self._springs.visible = bool(live.grips)

    def _draw(self, state: State) -> DrawnBodies:
        drawn = DrawnBodies(self._scene, self._looks, state, self._looks.kinds == DYNAMIC, self._radius)
        drawn.on_drag(self._hear)
        return drawn


def _made_of(world: World) -> tuple[int, ...]:
    """Return numbers that change when bodies, shapes, joints or cloths come or go, and sometimes otherwise."""
    tables = world.tables
    return tables.version, world.bodies.n_made, world.joints.n_made, tables.count(SHAPE), tables.count(CLOTH)


def _alike(a: Appearance, b: Appearance) -> bool:
    """Whether two worlds look alike, wherever their bodies are."""
    same = np.array_equal(a.kinds, b.kinds) and len(a.parts) == len(b.parts) and len(a.rods) == len(b.rods)
    return (
        same
        and all(p.body == q.body and p.shape is q.shape for p, q in zip(a.parts, b.parts, strict=True))
        and all(np.array_equal(np.hstack(r), np.hstack(s)) for r, s in zip(a.rods, b.rods, strict=True))
        and [cloth[:3] for cloth in a.cloths] == [cloth[:3] for cloth in b.cloths]
    )

"""A world that runs in real time: it is played, paused and reset, and its bodies are pulled."""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import KickdriftError
from kickdrift.viewer.grip import Grip
from kickdrift.viewer.meshes import State
from kickdrift.world.layout import BODY_KIND, DYNAMIC
from kickdrift.world.tables import BODY, PARTICLE
from kickdrift.world.world import World

Floats = NDArray[np.float64]
_MEASURED = 0.5  # seconds, over which it is measured how much of real time is reached


class LiveWorld:
    """A world whose steps follow a clock.

    Parameters
    ----------
    world : World
    step : float
        s.
    control : callable, optional
        Called before each step.
    clock : callable
        Returns seconds.

    Attributes
    ----------
    playing : bool
    reached : float or None
        Seconds of the world in a second, as measured lately; None before.
    trouble : str
        A sentence about what could not be done, and has paused it; empty if there is none.
    grips : dict of int to Grip
        By the page that holds the body.
    shows_contacts : bool
        Whether the points at which bodies press on each other are drawn.
    """

    def __init__(
        self,
        world: World,
        step: float,
        control: Callable[[], object] | None = None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.world, self.step, self._control = world, step, control
        self.playing, self.trouble, self.shows_contacts = False, "", False
        self.reached: float | None = None
        self.grips: dict[int, Grip] = {}
        self._start, self._clock, self._speed = world.snapshot(), clock, 1.0
        self._seen, self._owed = 0.0, 0.0
        self._begin_anew()

    @property
    def speed(self) -> float:
        """Seconds of the world in a second, if steps are fast enough; can be set."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._speed = speed
        self._begin_anew()

    def play(self) -> None:
        """Let it run from now on."""
        self.playing, self.trouble = True, ""
        self._begin_anew()

    def pause(self) -> None:
        """Stop it where it is."""
        self.playing = False

    def do_step(self) -> None:
        """Pause it, and do one step."""
        self.playing, self.trouble = False, ""
        self.attempt(self._do_step)

    def reset(self) -> None:
        """Go back to the state at the beginning, and let go of all bodies; if it plays, it goes on from there."""
        self.grips.clear()
        self.trouble = ""
        self.attempt(lambda: self.world.restore(self._start))
        self._begin_anew()

    def catch_up(self, seconds: float) -> None:
        """Do the steps that are due by the clock, for about so many seconds; those still due then are left out."""
        now = began = self._clock()
        if not self.playing:
            return
        self._owed += self._speed * (now - self._seen)
        self._seen = now
        while self.playing and self._owed >= 0.5 * self.step:
            if now - began >= seconds:
                self._owed = 0.0
                break
            self.attempt(self._do_step)
            self._owed -= self.step
            now = self._clock()
        self._measure(now)

    def grab(self, page: int, body: int, point: Floats) -> None:
        """Take hold of a body, given by its row, at a point in the world, if forces move it."""
        if self.world.tables.array(BODY)[body, BODY_KIND] == DYNAMIC:
            self.grips[page] = Grip(self.world, self.world.bodies.handle(body), point, self.step)

    def pull_to(self, page: int, target: Floats) -> None:
        """Move the end of a spring, if the page holds on to one."""
        if page in self.grips:
            self.grips[page].target = target

    def let_go(self, page: int) -> None:
        """Remove the spring of a page."""
        if self.grips.pop(page, None) is not None:
            self.world.bodies.wake()  # what had come to rest on the spring would sleep in mid-air

    def attempt(self, do: Callable[[], None]) -> None:
        """Do something, or pause and keep the sentence that says why not."""
        try:
            do()
        except KickdriftError as error:
            self.grips.clear()
            self.playing, self.trouble = False, str(error)

    def state(self) -> State:
        """Return where everything is, copied."""
        world = self.world
        with world.tables.lock:
            particles = world.tables.array(PARTICLE)[:, :3].copy()
            return State(world.position.copy(), world.orientation.copy(), particles)

    def words(self) -> str:
        """Return the time, and the multiple of real time that is reached."""
        if self.trouble:
            return self.trouble
        pace = "paused" if not self.playing else "" if self.reached is None else f"{self.reached:.2f} times real time"
        return f"t = {self.world.time:.2f} s" + (f", {pace}" if pace else "")

    def _do_step(self) -> None:
        for grip in self.grips.values():
            grip.pull()
        if self._control is not None:
            self._control()
        self.world.step(self.step)

    def _begin_anew(self) -> None:
        """Owe nothing, and measure from now on."""
        self._seen, self._owed, self.reached = self._clock(), 0.0, None
        self._measured_from = self._seen, self.world.time

    def _measure(self, now: float) -> None:
        since, time_then = self._measured_from
        if now - since >= _MEASURED:
            self.reached = (self.world.time - time_then) / (now - since)
            self._measured_from = now, self.world.time

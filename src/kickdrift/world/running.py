"""Runs of a world that are recorded."""

import math
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from types import FrameType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, LostBodyError
from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.grid import Grid, lay_grid
from kickdrift.engine.progress import Bar, announcements
from kickdrift.engine.solution import Description, Invariants
from kickdrift.world.flaws import deepest_overlap, widest_gap
from kickdrift.world.recording import Recording, appearance

if TYPE_CHECKING:
    from kickdrift.world.world import World

Floats = NDArray[np.float64]
_CHUNK_SECONDS = 0.1
_MOST_BYTES = 2 << 30  # what a recording may take in memory unless the caller says which steps to keep
_BYTES_PER_BODY = 13 * 8  # of a row
_UNITS = {
    "t": "s", "x": "m", "v": "m/s", "orientation": "1", "angular velocity": "rad/s",
    "energy": "J", "momentum": "kg m/s", "angular momentum": "kg m^2/s",
}  # fmt: skip


def run(world: "World", duration: float, step: float, save_every: int | None, progress: bool | None) -> Recording:
    """Run a world and record it; see `World.run`."""
    grid = _lay(duration, step, save_every, len(world.position))
    with announcements(progress):
        world.advance(grid.step, 0)
    keeper = _Keeper(world, grid)
    outcome, cause, seconds = Outcome.COMPLETED, "", 0.0
    done, chunk, bar = 0, 1, Bar(grid.n_steps, progress)
    keeper.keep(0)
    with closing(bar), _interruption_noted() as interrupted:
        while done < grid.n_steps and not interrupted.is_set():
            count = min(chunk, keeper.next_step - done)
            before, started = world.n_steps, time.perf_counter()
            try:
                world.advance(grid.step, count)
            except LostBodyError as error:
                outcome, cause = Outcome.NOT_FINITE, f" {error}"
            took = time.perf_counter() - started
            done, seconds = done + world.n_steps - before, seconds + took
            if outcome is not Outcome.COMPLETED:
                break
            if done == keeper.next_step:
                keeper.keep(done)
            chunk = max(1, min(10 * count, int(count * _CHUNK_SECONDS / max(took, 1e-9))))
            bar.show(done, seconds)
    if outcome is Outcome.COMPLETED and done < grid.n_steps:
        outcome = Outcome.INTERRUPTED
    keeper.keep_last(done)
    return keeper.recording(outcome, _message(outcome, cause, world, done, grid), done, seconds)


def _lay(duration: float, step: float, save_every: int | None, n_bodies: int) -> Grid:
    for name, value in (("duration", duration), ("step", step)):
        if not (isinstance(value, int | float | np.integer | np.floating) and 0.0 < float(value) < math.inf):
            raise ArgumentError(f"{name}={value!r} has to be positive and finite, in s.")
    if step > duration * (1.0 + 1e-12):
        raise ArgumentError(f"step={step!r} is larger than duration={duration!r}; give a smaller one.")
    needed = (duration / step + 2.0) * n_bodies * _BYTES_PER_BODY
    if save_every is None and needed > _MOST_BYTES:
        raise ArgumentError(
            f"save_every=None keeps every step, {needed / 2**30:.3g} GiB; give"
            f" save_every={math.ceil(needed / _MOST_BYTES)} or more."
        )
    return lay_grid((0.0, duration), step, None, 1 if save_every is None else save_every, 0)


@contextmanager
def _interruption_noted() -> Iterator[threading.Event]:
    """Note Ctrl-C instead of raising KeyboardInterrupt, which would leave a step half done."""
    interrupted = threading.Event()
    main = threading.current_thread() is threading.main_thread()
    if not main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield interrupted  # Ctrl-C goes to another thread, or somebody else minds it
        return

    def note(number: int, frame: FrameType | None) -> None:
        interrupted.set()

    signal.signal(signal.SIGINT, note)
    try:
        yield interrupted
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _message(outcome: Outcome, cause: str, world: "World", done: int, grid: Grid) -> str:
    if outcome is Outcome.COMPLETED:
        return "The end of the duration was reached."
    return f"{outcome.value} It ends at t={world.time!r}, after {done} of {grid.n_steps} steps.{cause}"


class _Keeper:
    """The rows of a recording, filled as the world goes on."""

    def __init__(self, world: "World", grid: Grid) -> None:
        self._world, self._grid, self._t0 = world, grid, world.time
        self._saved = 0
        rows, bodies = len(grid.save_steps) + 1, len(world.position)  # one more for the end of a run that ends early
        self._t = np.zeros(rows)
        self._x, self._v, self._w = (np.zeros((rows, bodies, 3)) for _ in range(3))
        self._q = np.zeros((rows, bodies, 4))
        self._conserved = {name: np.zeros((rows, 3)) for name in ("momentum", "angular momentum")}
        self._energy, self._flaws = np.zeros((rows, 2)), np.zeros((rows, 2))

    @property
    def next_step(self) -> int:
        """The step after which a row is to be kept."""
        return int(self._grid.save_steps[self._saved])

    def keep(self, step: int) -> None:
        """Add a row."""
        world, row = self._world, self._saved
        self._t[row] = self._t0 + (self._grid.times[row] if self._is_on_grid(step) else step * self._grid.step)
        self._x[row], self._v[row] = world.position, world.velocity
        self._q[row], self._w[row] = world.orientation, world.angular_velocity
        energy = world.energy()
        self._energy[row] = energy.kinetic, energy.potential
        self._flaws[row] = deepest_overlap(world.tables), widest_gap(world.tables)
        self._conserved["momentum"][row] = world.momentum()
        self._conserved["angular momentum"][row] = world.angular_momentum()
        self._saved += 1

    def keep_last(self, step: int) -> None:
        """Add a row for the state reached, if the run has ended between two rows."""
        if step != self._grid.save_steps[self._saved - 1]:
            self.keep(step)

    def _is_on_grid(self, step: int) -> bool:
        steps = self._grid.save_steps
        return self._saved < len(steps) and bool(steps[self._saved] == step)

    def recording(self, outcome: Outcome, message: str, n_steps: int, seconds: float) -> Recording:
        """Return what was kept."""
        world, rows = self._world, slice(self._saved)
        (kinetic, potential), (overlap, gap) = self._energy[rows].T.copy(), self._flaws[rows].T.copy()
        kept = {"energy": kinetic + potential, **{name: values[rows] for name, values in self._conserved.items()}}
        looks = appearance(world)
        return Recording(
            t=self._t[rows],
            x=self._x[rows],
            v=self._v[rows],
            invariants=Invariants(tuple(kept), kept.__getitem__),
            status=outcome,
            message=message,
            step=self._grid.step,
            n_steps=n_steps,
            n_force_evaluations=n_steps * world.substeps,
            wall_time=seconds,
            about=Description(
                system=f"world of {np.count_nonzero(looks.kinds) - 1} bodies",
                method="soft steps",
                kind=Kind.VELOCITY_DEPENDENT.name,
                order=1,
                word=str(world.word),
                compensated=False,
                dimensions=("body", "space"),
                coordinates={"body": list(range(self._x.shape[1])), "space": ["x", "y", "z"]},
                units=_UNITS,
            ),
            derived={"kinetic energy": kinetic, "potential energy": potential, "overlap": overlap, "joint gap": gap},
            orientation=self._q[rows],
            angular_velocity=self._w[rows],
            appearance=looks,
        )

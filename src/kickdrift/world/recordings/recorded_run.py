"""Recorded runs of a world, and recordings of users' loops."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager, nullcontext
from functools import partial
from typing import TYPE_CHECKING

from kickdrift.core.arguments import choice, is_whole
from kickdrift.core.errors import ArgumentError, FileFormatError, LostBodyError
from kickdrift.core.interruption import InterruptionNoted, next_chunk
from kickdrift.core.outcomes import Outcome
from kickdrift.core.room import check_kept
from kickdrift.engine.announcing import compiling_announced
from kickdrift.engine.grid import Grid, lay_grid
from kickdrift.engine.progress import Bar
from kickdrift.engine.zarr_store import ZarrStore
from kickdrift.world.joints.limits_motors_options import is_number
from kickdrift.world.recordings.checkpoints import NOT_KEPT, Keeper, Kept, step_of_row
from kickdrift.world.recordings.recording import Recording
from kickdrift.world.recordings.recording_rows import Recorder, RecordingRows
from kickdrift.world.recordings.streaming import StreamedRecordingRows
from kickdrift.world.tables import PARTICLE

if TYPE_CHECKING:
    from kickdrift.world.world import World

_BYTES_PER_BODY, _BYTES_PER_PARTICLE, _BYTES_PER_ROW = 13 * 8, 3 * 8, 16 * 8
_BYTES_OF_CONTACTS = 8 * 3 * 8  # of a body: a box in a pile has eight points or fewer


def run(
    world: "World", duration: float, step: float, save_every: int | None, progress: bool | None, kept: Kept = NOT_KEPT
) -> Recording:
    """Run a world and record it; see `World.run`."""
    progress = None if progress is None else choice("progress", progress)
    kept.check()
    per_body = _BYTES_PER_BODY + (_BYTES_OF_CONTACTS if kept.contact_points else 0)
    per_row = len(world.position) * per_body + world.tables.count(PARTICLE) * _BYTES_PER_PARTICLE + _BYTES_PER_ROW
    grid = _lay(duration, step, save_every, per_row, kept.save_to is not None)
    with ExitStack() as held:
        keeper = kept.keeper(world)
        if keeper is not None:
            held.callback(keeper.close)
        store = kept.store(world, grid)
        if store is not None:
            held.callback(store.close)
        room = len(grid.save_steps) + 1  # one row more for a run that ends early
        rows = RecordingRows(world, room, kept.contact_points) if store is None else StreamedRecordingRows(world, store)
        return _run(world, grid, progress, keeper, rows)


def _run(world: "World", grid: Grid, progress: bool | None, keeper: Keeper | None, rows: RecordingRows) -> Recording:
    """Do the steps of a grid, and record rows."""
    with compiling_announced(progress):
        world.advance(grid.step, 0)
    t0 = world.time
    found = None if keeper is None else keeper.find(grid, rows)
    done, grid, seconds, said = found or (0, grid, 0.0, "")
    if found is None:
        rows.begin()
        rows.keep(t0)
    outcome, cause = Outcome.COMPLETED, ""
    chunk, bar = 1, Bar(grid.n_steps, progress)
    with closing(bar), InterruptionNoted(passed_on=False) as interruption:
        while done < grid.n_steps and not interruption.noted and outcome is Outcome.COMPLETED:
            until = grid.n_steps if keeper is None else keeper.until(done, grid.n_steps)
            count = min(chunk, step_of_row(grid, rows.count) - done, until - done)
            before, started = world.n_steps, time.perf_counter() - world.compile_time
            try:
                world.advance_from(t0, done, grid.step, count)
            except LostBodyError as error:
                outcome, cause = Outcome.NOT_FINITE, f" {error}"
            took = time.perf_counter() - world.compile_time - started
            done, seconds = done + world.n_steps - before, seconds + took
            if outcome is Outcome.COMPLETED and done == step_of_row(grid, rows.count):
                rows.keep(t0 + (grid.t1 if done == grid.n_steps else done * grid.step))
                if done < grid.n_steps:
                    outcome, cause = _written(rows.drain, outcome, cause)
            if keeper is not None and (done == until or interruption.noted or outcome is not Outcome.COMPLETED):
                outcome, cause = _written(partial(keeper.keep, done, grid, rows, seconds), outcome, cause)
            chunk = next_chunk(count, took)
            bar.show(max(done, 1), seconds)
    if outcome is Outcome.COMPLETED and done < grid.n_steps:
        outcome = Outcome.INTERRUPTED
    if done != step_of_row(grid, rows.count - 1):
        rows.keep(t0 + done * grid.step)
    if outcome is not Outcome.NOT_WRITTEN:
        outcome, cause = _written(partial(rows.close, outcome), outcome, cause)
    message = _message(outcome, cause, world, done, grid) + said + world.cloths.notes()
    return rows.recording(outcome, message, grid.step, done, done * world.substeps, seconds)


@contextmanager
def record(world: "World", save_every: int, kept: Kept) -> Iterator[Recording]:
    """Record the steps done in a block; see `World.record`."""
    if not is_whole(save_every, 1):
        raise ArgumentError(f"save_every={save_every!r} must be a whole number of steps, one or more.")
    if world.recorder is not None:
        raise ArgumentError("the world is already being recorded; end that recording first, or keep more of its steps.")
    kept.check()
    store = None if kept.save_to is None else ZarrStore(kept.save_to, "a recorded loop")
    with nullcontext() if store is None else closing(store):
        if store is not None:
            store.check(again=False)
        rows = RecordingRows(world, 64, kept.contact_points) if store is None else StreamedRecordingRows(world, store)
        yield from _recorded(world, Recorder(world, save_every, rows))


def _recorded(world: "World", recorder: Recorder) -> Iterator[Recording]:
    recording = Recording.__new__(Recording)
    world.recorder = recorder
    outcome, message = Outcome.COMPLETED, "The recording was completed."
    try:
        yield recording
    except BaseException as error:
        ends = {LostBodyError: Outcome.NOT_FINITE, KeyboardInterrupt: Outcome.INTERRUPTED}
        outcome = ends.get(type(error), Outcome.FAILED)
        message = f"{outcome.value} It ends at t={world.time!r}, after {recorder.n_steps} steps. {error}".rstrip()
        raise
    finally:
        world.recorder = None
        vars(recording).update(vars(recorder.recording(outcome, message + world.cloths.notes())))


def _written(write: Callable[[], None], outcome: Outcome, cause: str) -> tuple[Outcome, str]:
    """Call `write`, and return outcome and cause of the run, which change if it fails."""
    try:
        write()
    except FileFormatError as error:
        return (Outcome.NOT_WRITTEN if outcome is Outcome.COMPLETED else outcome), f"{cause} {error}"
    return outcome, cause


def _lay(duration: float, step: float, save_every: int | None, per_row: int, streamed: bool) -> Grid:
    for name, value in (("duration", duration), ("step", step)):
        if not (is_number(value) and 0.0 < value < math.inf):
            raise ArgumentError(f"{name}={value!r} must be positive and finite, in s.")
    if step > duration * (1.0 + 1e-12):
        raise ArgumentError(f"step={step!r} is larger than duration={duration!r}; give a smaller one.")
    if not duration / step < 2**53:
        raise ArgumentError(
            f"step={step!r} cuts duration={duration!r} into more steps than float64 can count; give a larger step."
        )
    # `lay_grid` refuses other values of save_every.
    if not streamed and (save_every is None or (is_number(save_every) and save_every >= 1)):
        check_kept(save_every, math.ceil(duration / step), per_row)
    return lay_grid((0.0, duration), step, None, 1 if save_every is None else save_every, 0, streamed)


def _message(outcome: Outcome, cause: str, world: "World", done: int, grid: Grid) -> str:
    if outcome is Outcome.COMPLETED:
        return "The end of the duration was reached."
    return f"{outcome.value} It ends at t={world.time!r}, after {done} of {grid.n_steps} steps.{cause}"

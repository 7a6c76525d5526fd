"""Steps of a world: compiling their stages, running the compiled loop, and serving the requests of stages."""

import time
import warnings

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.calls import address_of
from kickdrift.core.errors import KickdriftError, UnsolvedWarning, depth_of_caller
from kickdrift.core.interruption import next_chunk
from kickdrift.core.threads import present
from kickdrift.world import settings
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.bodies.shape_rows import ShapeRows
from kickdrift.world.collision.broad_phase.search_state import TRIES
from kickdrift.world.contacts.batch_division import FEW
from kickdrift.world.contacts.layout import LANE_COUNT, WIDTH
from kickdrift.world.deformables.registry import Cloths
from kickdrift.world.deformables.wind_functions import WINDS
from kickdrift.world.force_functions import FORCES, Force, put_numbers
from kickdrift.world.joints.handle import Joint
from kickdrift.world.joints.registry import Joints
from kickdrift.world.recordings.recording_rows import Recorder
from kickdrift.world.step import status as step_status
from kickdrift.world.step.compiling import compile_step
from kickdrift.world.step.kernels import kernels_of
from kickdrift.world.step.lost_bodies import find_lost_body, find_lost_vertex, lost_body_error, lost_cloth_error
from kickdrift.world.step.rollback import roll_back
from kickdrift.world.step.stage_loop import run
from kickdrift.world.step.stage_order import Program, Uses, Word, addresses, compose, word
from kickdrift.world.step.subdivision import do_parts
from kickdrift.world.tables import (
    BODY,
    CLOTH,
    EVENTS,
    KERNEL_ADDRESSES,
    LOAD,
    PREDICTED,
    SEARCH,
    SETTINGS,
    STEP_STATUS,
    Table,
    Tables,
)


class DoesSteps:
    """The methods of a world that do steps."""

    tables: Tables
    bodies: Bodies
    joints: Joints
    cloths: Cloths
    shape_rows: ShapeRows
    forces: list[Force]
    recorder: Recorder | None
    time: float
    n_steps: int
    sleeping: bool
    substeps: int
    planar: bool
    threads: bool
    _program: Program
    _program_step: float
    _breakable: bool
    broken: list[Joint]
    _threaded: bool
    _addresses: NDArray[np.intp]
    _composition: tuple[object, ...] | None
    compile_time: float  # s, of all steps so far
    _softened: set[str]  # cloths that a warning has named
    # Time from which equal steps are counted, s, their length, s, and the number of the next one: the times of steps do not
    # depend on how many are done by one call.
    counted: tuple[float, float, int]

    def do_steps(self, t0: float, first: int, step: float, count: int) -> int:
        """Do `count` steps, the first of them number `first` from t0; return the set of warnings to be issued."""
        if self.tables.count(EVENTS):
            self.tables.resize(EVENTS, 0)
        program, recorder = self._ready(step), self.recorder
        status = self.tables.row(STEP_STATUS, 0)
        status[step_status.REACHED], status[step_status.MIDWAY], self.counted = first, 0, (t0, step, first)
        done, at, found, chunk, halved = 0, 0, 0, 1, step_status.OK
        try:
            while done < count:
                before, until = done, min(count, done + chunk)
                if self._breakable:  # joints that break and cloths that tear in a step change before the next
                    until = done + 1
                if recorder is not None:
                    until = min(until, done + recorder.steps_to_row)
                began = time.perf_counter()
                try:
                    if halved != step_status.OK or status[step_status.EXPECTED_HALVINGS] > 0:
                        at = self._do_parts(t0, first + done, step, halved)
                        program = self._ready(step)  # a part may have asked for stages
                        reached, halved = first + done + 1, step_status.OK
                    else:
                        reached, at = self._run(program, t0, step, first + done, first + until, at)
                    done = reached - first
                finally:
                    if recorder is not None:
                        reached = int(status[step_status.REACHED])
                        recorder.note(reached - first - before, step, t0 + reached * step, time.perf_counter() - began)
                if status.item(step_status.STATUS) != step_status.OK:
                    halved = step_status.halving(status)
                    at = self._help(step, at)
                    program = self._ready(step)
                else:
                    found, at = found | at, 0
                    if self._breakable and self._breaks():
                        program = self._ready(step)
                    if done < count:
                        chunk = next_chunk(done - before, time.perf_counter() - began)
        except BaseException:  # Ctrl-C may come between any two lines; compiled code has stored its progress
            self._go_back()
            raise
        self.counted = t0, step, first + count
        self.time = t0 + (first + count) * step
        self.n_steps += count
        return found

    def _run(self, program: Program, t0: float, step: float, first: int, last: int, at: int) -> tuple[int, int]:
        """Run steps, and report an exception of a user's function."""
        try:
            return run(*program, t0, step, first, last, at, self.tables.address)
        except Exception as error:
            self._go_back(LOAD)
            raise KickdriftError(
                f"a force or wind raised {type(error).__name__}: {error} in step {self.n_steps}; "
                "all bodies are where they were before it."
            ) from error

    def _do_parts(self, t0: float, number: int, step: float, cause: int) -> int:
        """Do a step in parts, for the `cause` of `do_parts`; return the set of warnings to be issued."""
        substeps, found = self.substeps, 0

        def do_part(part: int, parts: int) -> int:
            nonlocal found
            reached, at = number, 0
            while reached == number:
                self._set_lengths(step, substeps)
                self._ready(step)
                own = -(-substeps // parts)
                self._set_lengths(step / parts, own)
                program = compose(self.word, self._addresses, step / parts, own, part)
                reached, at = self._run(program, t0, step, number, number + 1, at)
                if reached == number:
                    halved = step_status.halving(self.tables.row(STEP_STATUS, 0))
                    at = self._help(step, at)
                    if halved != step_status.OK:
                        return halved
            found |= at
            return step_status.OK

        try:
            do_parts(do_part, self.tables, cause)
        finally:
            self._set_lengths(step, substeps)
        return found

    def _set_lengths(self, step: float, substeps: int) -> None:
        """Tell the stages the length of the step, or of a part of it, and its number of substeps."""
        self.tables.array(SETTINGS)[0, [settings.STEP, settings.SUBSTEPS]] = step, substeps

    @property
    def word(self) -> Word:
        """The step as a word: its stages in their order."""
        self.joints.arrange()
        fast, direct = self.tables.array(SETTINGS)[0, [settings.HAS_FAST, settings.HAS_DIRECT]].astype(bool).tolist()
        return word(
            Uses(
                forces=tuple(force.stage for force in self.forces if force.sort == FORCES),
                winds=tuple(force.stage for force in self.forces if force.sort == WINDS),
                bounces=self.shape_rows.bouncing,
                is_fast=fast,
                direct=direct,
                joints=self.joints.present,
                sequential=self.joints.sequential,
                sleeps=self.sleeping,
                planar=self.planar,
                threads=self.threads and present(),
                many=self.tables.count(BODY) > FEW,
                cloths=self.tables.count(CLOTH) > 0,
            )
        )

    def _ready(self, step: float) -> Program:
        """Return the program of a step, compiling missing stages; it is reused until something that it depends on changes.

        The flag `altered` shows it: comparing everything would take as long as a step of a small world.
        """
        threaded = self.threads and present()
        same = step == self._program_step and threaded == self._threaded
        if same and self.joints.arranged and not self.tables.altered:
            return self._program
        spelt, pairs, shapes = self.word, self.shape_rows.pairs(), self.shape_rows
        composition = spelt, self.substeps, shapes.kinds
        if composition != self._composition:
            began = time.perf_counter()
            compile_step(spelt, shapes.kinds, pairs)
            self.compile_time += time.perf_counter() - began
            kernels = self.tables.array(KERNEL_ADDRESSES)[0]
            kernels[:] = 0
            for kernel in kernels_of(spelt):
                kernels[kernel.column] = address_of(kernel.function, kernel.signature)
            kernels[LANE_COUNT] = WIDTH
            shapes.find_functions()
            self._program_step = 0.0  # of no program: it is composed again below
            self._addresses, self._composition = addresses(spelt, self.substeps), composition
        put_numbers(self.tables, self.forces)
        self.cloths.tune(step / self.substeps)
        self._tell_of_softening()
        self.tables.array(SETTINGS)[0, settings.STEP] = step
        if step != self._program_step:
            self._program = compose(spelt, self._addresses, step, self.substeps)
        self._program_step, self._threaded, self._breakable = (
            step,
            threaded,
            self.joints.breakable or self.cloths.tearable,
        )
        self.tables.altered = False
        return self._program

    def _tell_of_softening(self) -> None:
        """Warn, once for each, of cloths that the step makes far softer than their material."""
        for words, note in self.cloths.far_softer().items():
            if words not in self._softened:
                self._softened.add(words)
                warnings.warn(note.strip(), UnsolvedWarning, stacklevel=depth_of_caller())

    def _breaks(self) -> bool:
        """Remove joints that broke, tear cloths, and return whether there were any."""
        broken = self.joints.take_broken()
        self.broken += broken
        return self.cloths.tear() or bool(broken)

    def _help(self, step: float, stage: int) -> int:
        """Serve the request of a stage, and return the index of the stage to resume at; raise an error if it reports one."""
        kind, table, wanted, body = step_status.take_request(self.tables)
        if kind in (step_status.NEEDS_TIME_OF_IMPACT, step_status.NEEDS_DIRECT_SOLVER):
            needed = settings.HAS_DIRECT if kind == step_status.NEEDS_DIRECT_SOLVER else settings.HAS_FAST
            self.tables.array(SETTINGS)[0, needed] = 1.0
            self.tables.altered = True
        elif kind == step_status.FULL:
            self.tables.make_room(table, wanted)
        elif kind in (step_status.BEGIN_AGAIN, *step_status.HALVED):
            roll_back(self.tables)
            return 0
        elif kind == step_status.LOST_CLOTH:
            vertex = find_lost_vertex(self.tables, body)
            self._go_back(LOAD)
            raise lost_cloth_error(self.cloths.words(body), vertex, self.n_steps)
        else:
            body = find_lost_body(self.tables, step, body)
            self._go_back(LOAD)
            raise lost_body_error(self.tables, body, self.bodies.words(body), self.n_steps)
        return stage

    def _go_back(self, *without: Table) -> None:
        """Roll back a step in progress, set the time to the end of the last complete one, and zero the given tables."""
        status = self.tables.row(STEP_STATUS, 0)
        if status[step_status.MIDWAY]:
            roll_back(self.tables)
            status[[step_status.STATUS, step_status.REPEATED]] = step_status.OK, 0
            self.tables.array(PREDICTED)[:], self.tables.array(SEARCH)[:, TRIES] = 0.0, 0
        for table in without:
            self.tables.array(table)[:] = 0.0
        t0, step, first = self.counted
        reached, status[step_status.MIDWAY] = int(status[step_status.REACHED]), 0
        self.counted = t0, step, reached
        self.time = t0 + reached * step
        self.n_steps += reached - first

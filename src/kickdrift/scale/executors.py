"""Members run by an executor: chunks of them as tasks of worker processes, on this machine or others."""

import pickle
import pydoc
import queue
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

from kickdrift.core.errors import ArgumentError, depth_of_caller
from kickdrift.engine.lane_letters import LANES
from kickdrift.scale.members import Members
from kickdrift.scale.prepared import Prepared, Settings, prepare
from kickdrift.scale.results import Results
from kickdrift.scale.running import Runs
from kickdrift.systems.system import System

_TASKS_OF_A_WORKER = 8  # so that one that is slow, or dies, does not keep the others waiting
_VERSION = "kickdrift.__version__"
_WORKERS = 8  # where an executor does not say how many it has


@dataclass(frozen=True)
class Chunk:
    """A task: some members, and the first of all, which says what they have in common."""

    members: Members
    lead: Members
    settings: Settings


def run_chunk(chunk: Chunk) -> Results:
    """Run the members of a chunk, in whatever process this is."""
    runs = Runs(prepare(chunk.members, chunk.settings, False, chunk.lead), 1, False)
    runs.go(lambda done: None)
    return runs.results


def run_on(executor: Any, prepared: Prepared, results: Results, tell: Callable[[int], None]) -> None:
    """Run members as tasks of an executor, and tell how many steps of members are done.

    What a worker leaves undone that dies, and the executor does not repeat, is done here. A KeyboardInterrupt keeps the chunks
    that are done.

    Raises
    ------
    ArgumentError
        Where the workers lack kickdrift, or the problem cannot be sent to them.
    """
    _check(executor)
    done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
    waiting: dict[int, tuple[Chunk, Any]] = {}
    steps, left = 0, False
    try:
        for first, chunk in _chunks(executor, prepared):
            if results.done[first : first + chunk.members.count].all():
                continue
            if not waiting:
                _check_sent(executor, chunk)
            future = _submitted(executor, chunk)
            waiting[first] = chunk, future
            future.add_done_callback(lambda future, first=first: done.put((first, future)))
        while waiting:
            first, future = done.get()
            chunk, _ = waiting[first]
            try:
                part = future.result()
            except Exception as error:
                if not _is_death(error):
                    raise _explained(error) from error
                left = left or _warn(error)
                part = run_chunk(chunk)
            results.put(first, part)
            del waiting[first]
            steps += int(part.n_steps.sum())
            tell(steps)
    finally:
        for _, future in waiting.values():
            future.cancel()
        results.fill()


def _submitted(executor: Any, chunk: Chunk) -> Any:
    """Return the future of a chunk; a pool that broke meanwhile takes none, which is the end of this one, too."""
    try:
        return executor.submit(run_chunk, chunk)
    except BrokenExecutor as error:
        future: Future[Results] = Future()
        future.set_exception(error)
        return future


def _check(executor: Any) -> None:
    """Refuse what is no executor, and one whose workers do not have this version of kickdrift."""
    if not callable(getattr(executor, "submit", None)):
        raise ArgumentError(
            f"executor={executor!r} has no method submit; give one of concurrent.futures, or a client of Dask."
        )
    own, found, why = pydoc.locate(_VERSION), None, ""
    try:
        found = executor.submit(pydoc.locate, _VERSION).result()  # which every Python can be asked
    except pydoc.ErrorDuringImport as error:
        why = f" ({error})"
    if found != own:
        has = f"do not have it{why}" if found is None else f"have kickdrift {found}"
        raise ArgumentError(
            f"executor={executor!r}: here is kickdrift {own}, but its workers {has}; install this version"
            " where they run."
        )


def _check_sent(executor: Any, chunk: Chunk) -> None:
    """Refuse what the standard library cannot send to other processes; Dask can send more."""
    if isinstance(executor, ProcessPoolExecutor):
        try:
            pickle.dumps(chunk)
        except Exception as error:
            raise _explained(error) from error


def _explained(error: Exception) -> Exception:
    unsent = isinstance(error, pickle.PicklingError) or "pickle" in str(error)
    if not unsent:
        return error
    return ArgumentError(
        f"the problem cannot be sent to other processes ({error}); define its functions in a module, at the top level, or"
        " give a client of Dask, which sends others, too."
    )


def _is_death(error: Exception) -> bool:
    """Whether a worker died: of a pool, which is broken then, or so many of Dask's that it gave up."""
    return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"


def _warn(error: Exception) -> bool:
    warnings.warn(
        f"a worker of the executor died ({type(error).__name__}); what is left of the ensemble runs in this process.",
        RuntimeWarning,
        stacklevel=depth_of_caller(),
    )
    return True


def _chunks(executor: Any, prepared: Prepared) -> Iterator[tuple[int, Chunk]]:
    """Cut the members into tasks, with the number of the first member of each."""
    members = prepared.members
    settings = replace(prepared.settings, method=prepared.chosen.method, order=None)
    size = -(-members.count // (_TASKS_OF_A_WORKER * _workers(executor)))
    if size > LANES // 2:
        size = -(-size // LANES) * LANES
    lead = _sent(members.part(0, 1))
    for first in range(0, members.count, size):
        part = _sent(members.part(first, min(first + size, members.count)))
        yield first, Chunk(part, lead, settings)


def _sent(members: Members) -> Members:
    """Leave behind what no run needs: closures cannot be sent."""
    if not isinstance(members.problem, System):
        return members
    return replace(members, problem=replace(members.problem, exact=None))


def _workers(executor: Any) -> int:
    own = getattr(executor, "_max_workers", None)
    if own is None and callable(getattr(executor, "ncores", None)):
        own = sum(executor.ncores().values())
    return own or _WORKERS

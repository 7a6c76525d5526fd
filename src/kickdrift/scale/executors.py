"""Members run by an executor: chunks of them as tasks of worker processes, on this machine or others."""

import pickle
import pydoc
import queue
import time
import warnings
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from contextlib import suppress
from typing import Any, TypeVar

from kickdrift.core.errors import ArgumentError, KickdriftError, depth_of_caller
from kickdrift.scale.chunks import Chunk, chunks_of, members_of_chunk, run_chunk
from kickdrift.scale.member_store import MemberStore
from kickdrift.scale.prepared import Prepared
from kickdrift.scale.results import Results

T = TypeVar("T")

_VERSION = "kickdrift.__version__"
_WORKERS = 8  # assumed if an executor does not tell its number
_LOOK_SECONDS = 1.0  # s between two checks for workers
_PATIENCE = "distributed.comm.timeouts.connect"  # of Dask's settings: how long it waits for others, 30 s by default


class NoWorkerError(KickdriftError):
    """An executor has no workers left, and none has joined in time."""


def run_on(
    executor: Any, prepared: Prepared, results: Results, store: MemberStore | None, tell: Callable[[int], None]
) -> None:
    """Run members as tasks of an executor, which write to the store, if there is one, and report the steps done.

    Chunks of a worker that dies, unless the executor repeats them, are done in this process. A KeyboardInterrupt keeps the
    finished chunks.

    Raises
    ------
    ArgumentError
        Where there are no workers, they lack kickdrift, or the problem cannot be sent to them.
    NoWorkerError
        If no worker is left.
    """
    size = members_of_chunk(prepared, workers_of(executor), False) if store is None else store.members_of_chunk
    if callable(getattr(executor, "get_executor", None)):
        executor = executor.get_executor()  # of Dask: else the tasks of one call would be those of the next one, too
    _check(executor)
    done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
    waiting: dict[int, tuple[Chunk, Any]] = {}
    steps, left = 0, False
    try:
        for chunk in chunks_of(prepared, size, results, store):
            if not waiting:
                _check_sent(executor, chunk)
            future = _submitted(executor, chunk)
            waiting[chunk.first] = chunk, future
            future.add_done_callback(lambda future, first=chunk.first: done.put((first, future)))
        while waiting:
            first, future = _next(done, executor)
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
    """Submit a chunk; a pool that has broken refuses it, which counts as the death of a worker."""
    try:
        return executor.submit(run_chunk, chunk)
    except BrokenExecutor as error:
        future: Future[Results] = Future()
        future.set_exception(error)
        return future


def _check(executor: Any) -> None:
    """Refuse objects that are not executors, and executors whose workers do not have this version of kickdrift."""
    if not callable(getattr(executor, "submit", None)):
        raise ArgumentError(
            f"executor={executor!r} has no method submit; give an executor of concurrent.futures, or a Dask client."
        )
    own, found, why = pydoc.locate(_VERSION), None, ""
    try:
        asked: queue.SimpleQueue[Any] = queue.SimpleQueue()
        executor.submit(pydoc.locate, _VERSION).add_done_callback(asked.put)  # which is available in every Python
        found = _next(asked, executor).result()
    except NoWorkerError as error:
        raise ArgumentError(str(error)) from None
    except pydoc.ErrorDuringImport as error:
        why = f" ({error})"
    except Exception as error:
        if _is_death(error):  # which the chunks will find
            return
        raise
    if found != own:
        has = f"do not have it{why}" if found is None else f"have kickdrift {found}"
        raise ArgumentError(
            f"executor={executor!r}: this process runs kickdrift {own}, but its workers {has}; install this version"
            " where they run."
        )


def _check_sent(executor: Any, chunk: Chunk) -> None:
    """Refuse problems that the standard library cannot pickle; Dask can send more."""
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
        f"the problem cannot be sent to other processes ({error}); define its functions at the top level of a module,"
        " or use a Dask client, which can send others, too."
    )


def _is_death(error: Exception) -> bool:
    """Whether a worker died: of a pool, which is broken then, or so many of Dask's that it gave up."""
    return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"


def _warn(error: Exception) -> bool:
    warnings.warn(
        f"a worker of the executor died ({type(error).__name__}); the rest of the ensemble runs in this process.",
        RuntimeWarning,
        stacklevel=depth_of_caller(),
    )
    return True


def workers_of(executor: Any) -> int:
    """Return the number of workers of an executor, or its maximum."""
    own = getattr(executor, "_max_workers", None)
    if own is None and callable(getattr(executor, "ncores", None)):
        own = sum(executor.ncores().values())
    return own or _WORKERS


def _next(done: "queue.SimpleQueue[T]", executor: Any) -> T:
    """Return the chunks that are done next.

    Raises
    ------
    NoWorkerError
        Where the scheduler of Dask has no worker for as long as Dask waits for others: those that died are started again, or
        not. A pool is broken then, and all is done.
    """
    client, since = getattr(executor, "_client", None), time.monotonic()
    while True:
        with suppress(queue.Empty):
            return done.get(timeout=None if client is None else _LOOK_SECONDS)
        if client is None or _has_workers(client):
            since = time.monotonic()
        elif time.monotonic() - since > (patience := _patience()):
            raise NoWorkerError(
                f"executor={client!r} has no workers left, and none has joined for {patience:g} s; start some, and"
                " call again (save_to and checkpoint keep the finished members)."
            )


def _has_workers(client: Any) -> bool:
    try:
        return bool(client.ncores())
    except Exception:  # of a scheduler that has gone
        return False


def _patience() -> float:
    import dask

    return float(dask.utils.parse_timedelta(dask.config.get(_PATIENCE)))

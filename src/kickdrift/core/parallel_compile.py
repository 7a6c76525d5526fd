"""Compilation of several functions at once, in processes that store the compiled code on disk, from where this one loads it.

Numba compiles one function at a time in a process. On two cores, two processes compile a world of boxes in two thirds of
the time that one takes. If a process does not start, or the folder cannot be written to, the remaining functions are compiled
in this process.
"""

import os
import pickle
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from numba.core.serialize import dumps

from kickdrift.core.cache import reached
from kickdrift.core.compilation import Function, is_on_disk
from kickdrift.core.dispatcher import no_collector

_MOST_PROCESSES = 4  # each takes 0.4 GB
_FEWEST_JOBS = 4  # to start a process takes as long as compiling one or two functions

Job = tuple[Function, Any]  # a function and a signature
Place = tuple[
    Callable[..., Function], tuple[Any, ...]
]  # a function and arguments that find or make one in another process

_WORKER = (
    "import sys, pickle; sys.path[:] = pickle.load(sys.stdin.buffer);"
    "from kickdrift.core.parallel_compile import work; work()"
)


def missing(jobs: Iterable[Job]) -> list[Job]:
    """Return the jobs, each once, whose functions have not been compiled yet for their signatures."""
    unknown = [(function, signature) for function, signature in jobs if not is_on_disk(function, signature)]
    return list({(id(function), repr(signature)): (function, signature) for function, signature in unknown}.values())


def compile_together(jobs: list[Job], done: Callable[[], object] = lambda: None) -> None:
    """Compile functions for signatures; those that share most of their code are compiled in one process.

    Parameters
    ----------
    jobs : list of tuples
        As `missing` returns them.
    done : callable
        Called after each of them, in any thread.
    """
    places = _places(jobs)
    waiting = deque(_families([job for job in jobs if id(job[0]) in places]))
    own = [
        job for job in jobs if id(job[0]) not in places
    ]  # no other process finds them, or they are not stored on disk
    with no_collector(), _workers(processes_for(len(waiting)) - 1, waiting, places, done), suppress(IndexError):
        while True:
            for function, signature in own or waiting.popleft():
                function.compile(signature)  # type: ignore[attr-defined]
                done()
            own = []
    for function, signature in missing(jobs):  # jobs of processes that have died
        function.compile(signature)  # type: ignore[attr-defined]
        done()


def _families(jobs: list[Job]) -> list[list[Job]]:
    """Sort jobs into families, the largest first, whose members share most of their code with a larger member.

    A process compiles shared code once: the three stages that solve the equations of joints share nine tenths.
    """
    families: list[tuple[list[Job], list[set[Function]]]] = []
    for job in sorted(jobs, key=lambda job: _size([job]), reverse=True):
        needed = _needed([job])
        for members, needs in families:
            if any(2 * _bytes(needed & other) > _bytes(needed) for other in needs):
                members.append(job)
                needs.append(needed)
                break
        else:
            families.append(([job], [needed]))
    return sorted((members for members, _ in families), key=_size, reverse=True)


@contextmanager
def _workers(
    count: int, waiting: deque[list[Job]], places: dict[int, Place], done: Callable[[], object]
) -> Iterator[None]:
    """Start worker processes that take families of jobs, and wait for them at the end."""
    processes = []
    for _ in range(count):
        with suppress(OSError):
            command = [sys.executable, "-c", _WORKER]
            pipe = subprocess.PIPE
            processes.append(subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL))  # noqa: S603
    threads = [
        threading.Thread(target=_feed, args=(process, waiting, places, done), daemon=True) for process in processes
    ]
    for thread in threads:
        thread.start()
    try:
        yield
        for thread in threads:
            thread.join()
    finally:
        for process in processes:
            process.kill()
            process.communicate()


def _feed(process: Any, waiting: deque[list[Job]], places: dict[int, Place], done: Callable[[], object]) -> None:
    """Send one job after the other to a process, as long as it answers."""
    family: deque[Job] = deque()
    with suppress(OSError, ValueError, IndexError):  # it has died, or nothing is left to do
        process.stdin.write(dumps(sys.path))
        process.stdin.flush()
        process.stdout.readline()
        while True:
            if not family:
                family.extend(waiting.popleft())
            function, signature = family.popleft()
            process.stdin.write(dumps((places[id(function)], signature)))
            process.stdin.flush()
            if not process.stdout.readline():
                return  # it has died
            done()


def work() -> None:
    """Compile the functions named on standard input, and report each on standard output: the main loop of a worker."""
    answers, sys.stdout = sys.stdout, sys.stderr
    with no_collector(), suppress(EOFError, KeyboardInterrupt):
        while True:
            answers.write("ready\n")
            answers.flush()
            (make, given), signature = pickle.load(sys.stdin.buffer)  # noqa: S301 - from the process that started this one
            make(*given).compile(signature)


def _found(module: str, name: str) -> Any:
    __import__(module)
    return getattr(sys.modules[module], name)


def _places(jobs: list[Job]) -> dict[int, Place]:
    """Return where another process finds the functions that can be stored on disk, by their identities."""
    functions: list[Any] = [function for function, _ in jobs]
    made = {id(function): function.recipe for function in functions if getattr(function, "recipe", None)}
    return made | {
        id(value): (_found, (module.__name__, name))
        for module in list(sys.modules.values())
        if getattr(module, "__name__", "").startswith("kickdrift.")
        for name, value in list(vars(module).items())
        if hasattr(value, "py_func") and value.stats.cache_path is not None
    }


def processes_for(jobs: int) -> int:
    """Return the number of processes that pays for a number of jobs."""
    if jobs < _FEWEST_JOBS:
        return 1
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(cores, _MOST_PROCESSES)


def _size(jobs: list[Job]) -> int:
    """Bytes of the bytecode of all functions that the jobs need, each counted once."""
    return _bytes(_needed(jobs))


def _needed(jobs: list[Job]) -> set[Function]:
    functions: list[Any] = [function for function, _ in jobs]
    return {used for function in functions for used in reached(function.py_func)}


def _bytes(functions: set[Function]) -> int:
    return sum(len(function.__code__.co_code) for function in functions)

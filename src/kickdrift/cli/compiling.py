"""``kickdrift compile``: all that may be run later is compiled once on a machine."""

import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import closing
from multiprocessing import get_context
from threading import Lock

from kickdrift.cli import DONE, first_calls
from kickdrift.cli.output import say
from kickdrift.core.parallel_compile import compile_together, missing, processes_for
from kickdrift.engine import letters
from kickdrift.engine.announcing import compiling_announced
from kickdrift.engine.progress import Bar
from kickdrift.world.step.compiling import all_jobs


def compile_all(quiet: bool) -> int:
    """Compile the functions of worlds and of the systems of the catalogue, in several processes, and return the exit code."""
    jobs, started = missing([*all_jobs(), *letters.shared()]), time.perf_counter()
    finished, lock, wanted = 0, Lock(), False if quiet else None
    with (
        compiling_announced(wanted, f"{len(jobs)} functions" if jobs else ""),
        closing(Bar(len(jobs) + len(first_calls.ALL), wanted, unit="function", alike=False)) as bar,
    ):

        def count() -> None:
            nonlocal finished
            with lock:
                finished += 1
                bar.show(finished, time.perf_counter() - started)

        compile_together(jobs, count)
        with ProcessPoolExecutor(processes_for(len(first_calls.ALL)), get_context("spawn")) as pool:
            for call in as_completed([pool.submit(call) for call in first_calls.ALL]):
                call.result()
                count()
    if not (jobs or quiet):
        say("everything is already compiled.")
    return DONE

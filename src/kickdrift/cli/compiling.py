"""The first run on a machine compiles, and says so; or all is compiled ahead."""

import sys
import threading
import time

from tqdm import tqdm

from kickdrift.cli.output import say
from kickdrift.core.together import compile_together, missing, seconds_for
from kickdrift.engine import letters
from kickdrift.engine.loop import advance
from kickdrift.engine.progress import is_cached
from kickdrift.engine.solve import solve
from kickdrift.methods import Method
from kickdrift.systems import System, get
from kickdrift.world.compiling import jobs_of_all_worlds

_SECONDS = 6  # with an empty cache on two cores; reading the cache takes 0.3 s


def compile_ahead(system: System, step: float, method: Method, quiet: bool) -> None:
    """Compile what a run needs by one step of it, if nothing was compiled before; say how long that takes and took."""
    if is_cached(advance):
        return
    if not quiet:
        say(f"compiling once on this machine, about {_SECONDS} s ...")
    started = time.perf_counter()
    solve(system, (0.0, step), step=step, method=method, progress=False).report()
    if not quiet:
        say(f"compiled in {time.perf_counter() - started:.1f} s.")


def compile_all(quiet: bool) -> None:
    """Compile whatever runs and worlds may need, in several processes, unless it is on disk."""
    jobs = missing([*jobs_of_all_worlds(), *letters.shared()])
    if not jobs:
        say("everything is compiled.")
        return
    if not quiet:
        say(f"compiling {len(jobs)} functions once on this machine, about {seconds_for(jobs) / 60:.0f} minutes ...")
    started, lock = time.perf_counter(), threading.Lock()
    with tqdm(total=len(jobs), unit="function", leave=False, file=sys.stderr, disable=quiet) as bar:

        def done() -> None:
            with lock:
                bar.update()

        compile_together(jobs, done)
        solve(get("kepler"), (0.0, 0.01), step=0.01, progress=False).report()
    if not quiet:
        say(f"compiled in {time.perf_counter() - started:.0f} s.")

"""The first run on a machine compiles, and says so."""

import time

from kickdrift.cli.output import say
from kickdrift.engine.loop import advance
from kickdrift.engine.progress import is_cached
from kickdrift.engine.solve import solve
from kickdrift.methods import Method
from kickdrift.systems import System

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

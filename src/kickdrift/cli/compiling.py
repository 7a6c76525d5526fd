"""The first run on a machine compiles, and says so; ``kickdrift compile`` does it for all that may be run later."""

import time
from contextlib import closing
from threading import Lock

from kickdrift.cli import DONE
from kickdrift.cli.output import say
from kickdrift.core.parallel_compile import compile_together, missing, seconds_for
from kickdrift.engine import letters
from kickdrift.engine.loop import advance
from kickdrift.engine.progress import Bar, is_cached
from kickdrift.engine.solve import solve
from kickdrift.methods import Method
from kickdrift.scenes import DEFAULTS, FIRST_METHODS, Defaults
from kickdrift.systems import System, catalogue
from kickdrift.world.compiling import all_jobs
from kickdrift.world.world import World

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


def compile_all(quiet: bool) -> int:
    """Compile what worlds and the systems of the catalogue need, in several processes, and return the exit code."""
    jobs, started = missing([*all_jobs(), *letters.shared()]), time.perf_counter()
    if jobs and not quiet:
        say(f"compiling {len(jobs)} functions once on this machine, about {seconds_for(jobs):.0f} s ...")
    finished, lock = 0, Lock()
    with closing(Bar(len(jobs), False if quiet else None, unit="function")) as bar:

        def count() -> None:
            nonlocal finished
            with lock:
                finished += 1
                bar.show(finished, time.perf_counter() - started)

        compile_together(jobs, count)
    _call_from_python()
    if not quiet:
        say(f"compiled in {time.perf_counter() - started:.1f} s.")
    return DONE


def _call_from_python() -> None:
    """Compile what the interpreter calls, by calling it."""
    world = World()
    world.add_plane()
    world.add_hinge(
        world.ground, world.add_sphere(1.0, position=(0.0, 0.0, 2.0)), anchor=(0.0, 0.0, 4.0), axis=(0.0, 1.0, 0.0)
    )
    world.step(0.01)
    world.ray_cast((0.0, 0.0, 9.0), (0.0, 0.0, -1.0))
    for name, make in catalogue().items():
        own = DEFAULTS.get(name, Defaults())
        for method in (own.method, *FIRST_METHODS):
            solve(make(), (0.0, own.step), step=own.step, method=method, progress=False).report()

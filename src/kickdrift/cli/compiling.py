"""``kickdrift compile``: all that may be run later is compiled once on a machine."""

import time
from contextlib import closing
from threading import Lock

from kickdrift.cli import DONE
from kickdrift.cli.output import say
from kickdrift.core.parallel_compile import compile_together, missing, seconds_for
from kickdrift.engine import letters
from kickdrift.engine.announcing import compiling_announced
from kickdrift.engine.progress import Bar
from kickdrift.engine.solve import solve
from kickdrift.scenes import DEFAULTS, FIRST_METHODS, Defaults
from kickdrift.systems import catalogue
from kickdrift.world.compiling import all_jobs
from kickdrift.world.world import World


def compile_all(quiet: bool) -> int:
    """Compile what worlds and the systems of the catalogue need, in several processes, and return the exit code."""
    jobs, started = missing([*all_jobs(), *letters.shared()]), time.perf_counter()
    finished, lock, wanted = 0, Lock(), False if quiet else None
    with (
        compiling_announced(wanted, f"{len(jobs)} functions", seconds_for(jobs)),
        closing(Bar(len(jobs), wanted, unit="function")) as bar,
    ):

        def count() -> None:
            nonlocal finished
            with lock:
                finished += 1
                bar.show(finished, time.perf_counter() - started)

        compile_together(jobs, count)
        _call_from_python()
    if not (jobs or quiet):
        say("all that runs may need is compiled already.")
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

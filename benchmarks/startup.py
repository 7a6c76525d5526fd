"""What a user waits for before the first step: import, and the first run of the main job, cold and warm."""

import contextlib
import importlib.util
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import kickdrift as kd
from benchmarks.environment import environment
from benchmarks.table import Row, at_most, measured, skipped

JOB = [sys.executable, "-m", "kickdrift", "run", "solar-system"]
_IMPORT = """
import time
started = time.perf_counter()
import numpy, numba
between = time.perf_counter()
import kickdrift
print(between - started, time.perf_counter() - between)
"""


def compare(rounds: int) -> list[Row]:
    """Seconds to import, to first results, to the end of the main job, and to the first step of two worlds."""
    few = min(rounds, 3)
    worlds = (*_first_step("boxes", _BOXES, few), *_first_step("boxes and a hinge", _BOXES + _HINGE, few))
    return [*_import(rounds), *_users_functions(few), *_set_up(rounds), *_first_run(few), *worlds]


_BOXES = """
import time
started = time.perf_counter()
import kickdrift as kd
world = kd.World()
world.add_plane()
for k in range(5):
    world.add_box((1, 1, 1), position=(0, 0, k + 0.5))
"""
_HINGE = "world.add_hinge(None, world.add_box((1, 0.1, 0.1), position=(3.5, 0, 5)), anchor=(3, 0, 5), axis=(0, 1, 0))\n"
_STEP = "world.step(1 / 60)\nprint(time.perf_counter() - started)\n"


def _first_step(title: str, world: str, rounds: int) -> list[Row]:
    cold, warm = [], []
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            for samples in (cold, warm):
                command, own = [sys.executable, "-c", world + _STEP], environment(NUMBA_CACHE_DIR=folder)
                printed = subprocess.run(command, check=True, capture_output=True, text=True, env=own).stdout
                samples.append(float(printed))
    return [
        measured(f"import and first step of a world of {title}, cold", cold, at_most(15, "s")),
        measured("the same, warm", warm, at_most(1, "s")),
    ]


def _import(rounds: int) -> list[Row]:
    samples = []
    for _ in range(rounds + 1):
        command, own = [sys.executable, "-c", _IMPORT], environment()
        printed = subprocess.run(command, check=True, capture_output=True, text=True, env=own).stdout
        samples.append([float(part) for part in printed.split()])
    below, ours = zip(*samples[1:], strict=True)  # the first fills the file cache
    return [
        measured("import kickdrift, after numpy and numba", ours, at_most(0.4, "s")),
        measured("the same / import numpy, numba", [a / b for a, b in zip(ours, below, strict=True)]),
    ]


_FORCE = """
import time
import numpy as np, numba
started = time.perf_counter()
import kickdrift as kd

def force(x):
    {body}

sol = kd.solve(force, t_span=(0.0, {end}), x0={x0}, v0={v0}, method="semi-implicit-euler", step=0.01, progress=False)
print(time.perf_counter() - started, sol.wall_time)
"""
_BROADCAST = """d = x[:, None, :] - x[None, :, :]
    r2 = (d**2).sum(axis=2) + np.eye(x.shape[0])
    i6 = 1 / r2**3
    return np.sum((24 * i6 * (2 * i6 - 1) / r2).reshape(x.shape[0], x.shape[0], 1) * d, axis=1)"""
_GRID = "1.2 * np.stack(np.meshgrid(*[np.arange(5.0)] * 3), -1).reshape(-1, 3)"
_USERS = {
    "README's gravity": (
        {"body": "return -x / np.linalg.norm(x)**3", "end": 100.0, "x0": [1, 0], "v0": [0, 1.1]},
        3,
        0.5,
    ),
    "Lennard-Jones by broadcasting": ({"body": _BROADCAST, "end": 0.1, "x0": _GRID, "v0": "np.zeros((125, 3))"}, 10, 1),
}


def _users_functions(rounds: int) -> list[Row]:
    """Seconds from `import kickdrift` to the first result of a user's function, the first time and in a second process."""
    rows = []
    for title, (parts, most_cold, most_warm) in _USERS.items():
        cold, warm = [], []
        for _ in range(rounds):
            with tempfile.TemporaryDirectory() as folder:
                for samples in (cold, warm):
                    command, own = ([sys.executable, "-c", _FORCE.format(**parts)], environment(NUMBA_CACHE_DIR=folder))
                    printed = subprocess.run(command, check=True, capture_output=True, text=True, env=own).stdout
                    samples.append(float(printed.split()[0]))
        rows.append(measured(f"{title}: import and first result, the first time", cold, at_most(most_cold, "s")))
        rows.append(measured("the same, in another process", warm, at_most(most_warm, "s")))
    return rows


def _set_up(rounds: int) -> list[Row]:
    """Microseconds of a warm solve of ten steps: of one function, and of a thousand with other stiffnesses."""
    table = np.ones(3)

    def closure(stiffness: float) -> Callable[[float], float]:
        return lambda x: -stiffness * x - x * x * x

    def looked_up(stiffness: float) -> Callable[[float], float]:
        table[1] = stiffness
        return from_table

    def from_table(x: float) -> float:
        return float(-table[1] * x - x * x * x)

    def looked_up_globally(stiffness: float) -> Callable[[float], float]:
        _TABLE[1] = stiffness
        return _from_global_table

    same = closure(1.0)
    makers = {
        "a function": lambda stiffness: same,
        "a new closure each": closure,
        "a changed array each": looked_up,
        "a changed global array each": looked_up_globally,
    }
    rows = []
    for title, make in makers.items():
        samples = [[_microseconds(make(1.0 + i)) for i in range(_SOLVES)] for _ in range(rounds + 1)][1:]
        rows.append(measured(f"ten steps, warm: {title}", np.median(samples, axis=1), at_most(200, "us")))
    return rows


_SOLVES = 1000
_TABLE = np.ones(3)


def _from_global_table(x: float) -> float:
    return float(-_TABLE[1] * x - x * x * x)


def _microseconds(force: Callable[[float], float]) -> float:
    started = time.perf_counter()
    kd.solve(force, (0.0, 0.1), 1.5, 0.0, step=0.01, progress=False)
    return 1e6 * (time.perf_counter() - started)


def _first_run(rounds: int) -> list[Row]:
    if importlib.util.find_spec("kickdrift.__main__") is None:
        return [skipped("first run", "this kickdrift has no command line")]
    if os.name != "posix":
        return [skipped("first run", "timed on a pseudo-terminal, which this system does not have")]
    cold, warm = [], []
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            cold.append(_timed_job(Path(folder)))
            warm.append(_timed_job(Path(folder)))
    if not all(done for _, _, done in cold + warm):
        return [skipped("first run", f"{' '.join(JOB[1:])} failed")]
    return [
        measured("main job, cold: first output", [first for first, _, _ in cold], at_most(2, "s")),
        measured("main job, cold: done", [end for _, end, _ in cold], at_most(15, "s")),
        measured("main job, warm: done", [end for _, end, _ in warm], at_most(3, "s")),
        measured("main job, cold / warm", [c[1] / w[1] for c, w in zip(cold, warm, strict=True)]),
    ]


def _timed_job(folder: Path) -> tuple[float, float, bool]:
    """Seconds to the first output and to the end of the main job, in a folder that is also Numba's cache.

    On a pseudo-terminal, as a person runs it: into a pipe, Python would keep its first lines back.
    """
    import pty

    ours, theirs = pty.openpty()
    own = environment(NUMBA_CACHE_DIR=str(folder / "numba"))
    outputs: list[float] = []
    started = time.perf_counter()
    with subprocess.Popen(JOB, cwd=folder, env=own, stdin=theirs, stdout=theirs, stderr=theirs) as job:
        os.close(theirs)
        with contextlib.suppress(OSError):  # how Linux says that the other end is closed
            while os.read(ours, 65536):
                outputs.append(time.perf_counter() - started)
    end = time.perf_counter() - started
    os.close(ours)
    return min(outputs, default=end), end, job.returncode == 0

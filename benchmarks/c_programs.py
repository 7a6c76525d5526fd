"""The C programs: built from ``benchmarks/c`` into ``benchmarks/build``, and run."""

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from benchmarks.table import Missing

_HERE = Path(__file__).parent
# -fno-math-errno lets the compiler use the square-root instruction without a branch to the library; -ffast-math
# implies it. The fastest of the three is what a C programmer would ship.
FLAGS = {"C": [], "C -fno-math-errno": ["-fno-math-errno"], "C -ffast-math": ["-ffast-math"]}


@dataclass(frozen=True)
class Outcome:
    """What a program printed: its results, and nanoseconds per step of its loop."""

    results: tuple[float, ...]
    ns_per_step: float


def build(program: str) -> dict[str, Path]:
    """Compile a program with each of FLAGS on top of ``-O3 -march=native``.

    Raises
    ------
    Missing
        Without gcc.
    """
    gcc = shutil.which("gcc")
    if gcc is None:
        raise Missing("install gcc")
    folder = _HERE / "build"
    folder.mkdir(exist_ok=True)
    paths = {}
    for name, flags in FLAGS.items():
        path = folder / f"{program}{''.join(flags)}"
        source = str(_HERE / "c" / f"{program}.c")
        subprocess.run([gcc, "-O3", "-march=native", *flags, source, "-o", str(path), "-lm"], check=True)
        paths[name] = path
    return paths


def run(path: Path, *arguments: int) -> Outcome:
    """Run a built program."""
    printed = subprocess.run([str(path), *map(str, arguments)], check=True, capture_output=True, text=True).stdout
    *results, ns_per_step = (float(line) for line in printed.split())
    return Outcome(tuple(results), ns_per_step)


def ns_per_step(path: Path, steps: int) -> float:
    """Run a built program for its time alone."""
    return run(path, steps).ns_per_step

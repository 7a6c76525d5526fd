"""The command: run the comparisons and write the table."""

import argparse
import os
import platform
import sys
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import llvmlite.binding

from benchmarks import against_c, gravity, implicit_euler, kepler, startup
from benchmarks.table import Missing, Row, markdown, skipped

COMPARISONS: dict[str, tuple[str, Callable[[int], list[Row]]]] = {
    "c": ("Benchmarks Game: a step", against_c.compare),
    "kepler": ("Kepler, a user's function: a step", kepler.compare),
    "gravity": ("Direct N-body: an interaction", gravity.compare),
    "implicit": ("Implicit against semi-implicit Euler", implicit_euler.compare),
    "startup": ("Before the first step", startup.compare),
}
_PACKAGES = ("kickdrift", "numpy", "numba", "rebound", "diffrax", "jax", "symplecta")


def main() -> None:
    """Read the arguments, run, and write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--only", choices=COMPARISONS, action="append", help="run this comparison; may be repeated")
    parser.add_argument("--rounds", type=int, default=9, help="how often each contestant comes (default: 9)")
    parser.add_argument("--output", type=Path, help="write the table to this file instead of the terminal")
    arguments = parser.parse_args()
    if arguments.rounds < 1:
        parser.error("--rounds must be at least 1")
    sections = []
    for name in arguments.only or COMPARISONS:
        started = time.perf_counter()
        title, compare = COMPARISONS[name]
        try:
            rows = compare(arguments.rounds)
        except Missing as missing:
            rows = [skipped(title, str(missing))]
        sections.append((title, rows))
        print(f"{title}: {time.perf_counter() - started:.0f} s", file=sys.stderr)
    text = f"{_circumstances(arguments.rounds)}\n\n{markdown(sections)}"
    if arguments.output is None:
        print(text, end="")
    else:
        arguments.output.write_text(text, encoding="utf-8")


def _circumstances(rounds: int) -> str:
    features = llvmlite.binding.get_host_cpu_features()
    vectors = next((name for name in ("avx512f", "avx2") if features.get(name)), "neither avx2 nor avx512f")
    versions = [f"{name} {found}" for name in _PACKAGES if (found := _version(name))]
    return (
        f"{rounds} rounds in turns. {platform.machine()}, {vectors}, {os.cpu_count()} cores;"
        f" Python {platform.python_version()}, {', '.join(versions)}."
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


if __name__ == "__main__":
    main()

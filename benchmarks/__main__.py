"""The command: run the comparisons and write the table."""

import argparse
import os
import platform
import sys
import time
from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import llvmlite.binding

from benchmarks import (
    advice,
    against_c,
    auto,
    cloth,
    encounters,
    ensemble,
    events,
    gravity,
    implicit_euler,
    kepler,
    lab,
    precision,
    readme,
    rl,
    startup,
    steps,
    wisdom_holman,
    world,
    world_scale,
)
from benchmarks.table import Missing, Row, markdown, skipped

COMPARISONS: dict[str, tuple[str, Callable[[int], list[Row]]]] = {
    "c": ("Benchmarks Game: a step", against_c.compare),
    "kepler": ("Kepler, a user's function: a step", kepler.compare),
    "wisdom-holman": ("Outer solar system by Wisdom-Holman: a step", wisdom_holman.compare),
    "gravity": ("Direct N-body: an interaction", gravity.compare),
    "encounters": ("Planets that scatter each other, for 100,000 periods", encounters.compare),
    "events": ("Events: a passage of a pendulum", events.compare),
    "implicit": ("Implicit against semi-implicit Euler", implicit_euler.compare),
    "ensemble": ("Ensembles of Kepler orbits: a step of a member, and turns to an error", ensemble.compare),
    "auto": ("What auto takes: time to an error, over that of the fastest", auto.compare),
    "advice": ("What `kd.advise` recommends, against the best by brute force", advice.compare),
    "steps": ("Against the same step by hand", steps.compare),
    "startup": ("Before the first step", startup.compare),
    "readme": ("The README's statements in order, in a fresh environment", readme.compare),
    "scale": ("Boxes at rest: a body's part of a step", world_scale.compare),
    "cloth": ("Cloth on a ball: a frame of 1/60 s", cloth.compare),
    "rl": ("Reading, acting, stepping: a cart with a pole", rl.compare),
}
_WORLD = "world"
_PRECISION = "precision"
_LAB = "lab"
NAMES = (*COMPARISONS, _WORLD, _PRECISION)
_PACKAGES = (
    "kickdrift",
    "numpy",
    "numba",
    "scipy",
    "rebound",
    "diffrax",
    "jax",
    "heyoka",
    "pyhamsys",
    "symplecta",
    "desolver",
    "rapier3d",
    "robox3d",
    "mujoco",
    "pybullet",
    "pypbd",
)


def main() -> None:
    """Read the arguments, run, and write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--only", choices=(*NAMES, _LAB), action="append", help="run this comparison; may be repeated")
    parser.add_argument("--rounds", type=int, default=9, help="how often each contestant comes (default: 9)")
    parser.add_argument("--output", type=Path, help="write the table to this file instead of the terminal")
    parser.add_argument("--pictures", type=Path, help="draw those of work and precision into this folder")
    parser.add_argument("--engines", choices=lab.ENGINES, nargs="+", default=(), help="of the lab; all by default")
    parser.add_argument(
        "--scenes", nargs="+", default=(), help="of the lab and of worlds: those with one of these texts in their names"
    )
    arguments = parser.parse_args()
    if arguments.rounds < 1:
        parser.error("--rounds must be at least 1")
    if _LAB in (arguments.only or ()) and arguments.only != [_LAB]:
        parser.error("--only lab writes a table of its own; run it alone")
    if arguments.only == [_LAB]:
        _write(f"{_circumstances()}\n\n{lab.report(arguments.engines, arguments.scenes)}", arguments.output)
        return
    sections: list[tuple[str, list[Row]]] = []
    for name in arguments.only or NAMES:
        started = time.perf_counter()
        sections.extend(_sections(name, arguments.rounds, arguments.pictures, arguments.scenes))
        print(f"{name}: {time.perf_counter() - started:.0f} s", file=sys.stderr)
    circumstances = f"{arguments.rounds} rounds in turns. {_circumstances()}"
    _write(f"{circumstances}\n\n{markdown(sections)}", arguments.output)


def _write(text: str, output: Path | None) -> None:
    if output is None:
        print(text, end="")
    else:
        output.write_text(text, encoding="utf-8")


def _sections(name: str, rounds: int, pictures: Path | None, scenes: Sequence[str]) -> list[tuple[str, list[Row]]]:
    if name == _PRECISION:
        return precision.sections(rounds, pictures)
    if name == _WORLD:
        return world.sections(rounds, scenes)
    title, compare = COMPARISONS[name]
    try:
        return [(title, compare(rounds))]
    except Missing as missing:
        return [(title, [skipped(title, str(missing))])]


def _circumstances() -> str:
    features = llvmlite.binding.get_host_cpu_features()
    vectors = next((name for name in ("avx512f", "avx2") if features.get(name)), "neither avx2 nor avx512f")
    versions = [f"{name} {found}" for name in _PACKAGES if (found := _version(name))]
    return (
        f"{platform.machine()}, {vectors}, {os.cpu_count()} cores;"
        f" Python {platform.python_version()}, {', '.join(versions)}."
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


if __name__ == "__main__":
    main()

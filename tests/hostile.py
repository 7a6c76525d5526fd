"""Hostile inputs: many cases, each tried in a process that may die or hang, and what became of them.

A fuzzer is a module here with a function ``attempt(seed)`` that tries one case and returns None, or in words what is wrong.
``python tests/fuzz_world_files.py --count 400`` tries so many and says which ones failed, and how; the tests try a few.
"""

import argparse
import multiprocessing
import os
import queue
import subprocess
import sys
import threading
import traceback
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

TESTS = Path(__file__).parent


def work(module, seeds):
    """Try cases one after the other, and say on standard output which one begins and what came of it."""
    attempt = __import__(module).attempt
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    for seed in seeds:
        print(f"{seed} begins", file=answers)
        try:
            verdict = attempt(seed)
        except BaseException as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            verdict = f"raw {type(error).__name__}: {error} ({Path(place.filename).name}, line {place.lineno})"
        print(f"{seed} " + ("held" if verdict is None else "failed " + verdict.replace("\n", " ")), file=answers)


def forked(function, *arguments):
    """Start a function in a copy of this process, which has imported kickdrift and run nothing of it; return the process."""
    process = multiprocessing.get_context("fork").Process(target=function, args=arguments)
    process.start()
    return process


def tried(module, seeds, patience=120.0):
    """Try cases in a process of their own, another one after each that dies or takes too long; return who failed and how."""
    left, failed = list(seeds), {}
    while left:
        for seed, verdict in _until_it_dies(module, left, patience):
            left.remove(seed)
            if verdict is not None:
                failed[seed] = verdict
    return failed


def _until_it_dies(module, seeds, patience):
    """Yield seeds with what came of them, for as long as the process lives and answers."""
    command = f"import hostile; hostile.work({module!r}, {seeds!r})"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path])}
    with TemporaryDirectory() as folder, subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", command], env=environment, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=folder,
    ) as process:  # fmt: skip
        lines = queue.SimpleQueue()
        threading.Thread(target=lambda: [*map(lines.put, process.stdout), lines.put(None)], daemon=True).start()
        begun = None
        while True:
            try:
                line = lines.get(timeout=patience)
            except queue.Empty:
                process.kill()
                if begun is None:
                    raise RuntimeError(f"{module} does not begin within {patience:g} s") from None
                yield begun, f"hangs for {patience:g} s"
                return
            if line is None:
                break
            seed, what, *verdict = line.strip().split(" ", 2)
            begun = int(seed) if what == "begins" else None
            if what != "begins":
                yield int(seed), None if what == "held" else verdict[0]
        process.wait()
        if begun is not None:
            yield begun, f"the process died with {process.returncode}"
        elif process.returncode:
            raise RuntimeError(f"{module} cannot be run: the process died with {process.returncode}")


def main(module, doc):
    """Try as many cases as the command line says, print who failed, and return how many."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=400)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--patience", type=float, default=120.0, help="seconds for one case")
    arguments = parser.parse_args()
    seeds = range(arguments.first, arguments.first + arguments.count)
    failed = tried(module, seeds, arguments.patience)
    for seed, verdict in failed.items():
        print(f"{seed}: {verdict}")
    print(f"{len(seeds) - len(failed)} of {len(seeds)} held; {dict(Counter(v.split(':')[0] for v in failed.values()))}")
    return len(failed)

"""Compiled code on disk of which one bit is another, or the end is missing: it is compiled again, and the numbers are the same.

``python tests/fuzz_cache.py --count 60`` tries so many.
"""

import atexit
import functools
import shutil
import sys
import tempfile
from pathlib import Path

import hostile
import numba
import numpy as np

import kickdrift as kd


def solved(folder, path):
    """Solve something with the cache in a folder, and write where it went."""
    numba.config.CACHE_DIR = str(folder)
    sol = kd.solve(kd.systems.get("harmonic-oscillator"), (0.0, 3.0), step=0.1, progress=False)
    path.write_bytes(sol.x.tobytes())


def run(folder):
    """Do so in a process of its own; return what it has written, and its exit status."""
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "x"
        process = hostile.forked(solved, folder, path)
        process.join()
        return path.read_bytes() if path.exists() else b"", process.exitcode


@functools.cache
def original():
    """Return a folder that a run has filled, and what the run has printed."""
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder, run(folder)


def attempt(seed):
    """Damage one file, run again, and once more."""
    rng = np.random.default_rng(seed)
    whole, want = original()
    if want[1] != 0:
        return f"the run without damage ends with {want[1]}"
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "cache"
        shutil.copytree(whole, folder)
        files = sorted(folder.rglob("*.nbc"))
        path = files[rng.integers(len(files))]
        content = bytearray(path.read_bytes())
        if rng.random() < 0.2:
            content = content[: rng.integers(len(content))]
        else:
            content[rng.integers(len(content))] ^= 1 << int(rng.integers(8))
        path.write_bytes(content)
        if (found := run(folder)) != want:
            return f"{path.name}: exit status {found[1]}, or other numbers"
        if path.read_bytes() == content:
            return f"{path.name} was not written anew"
    return None


if __name__ == "__main__":
    sys.exit(hostile.main("fuzz_cache", __doc__))

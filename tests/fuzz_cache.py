"""Compiled code on disk of which one bit is another, or the end is missing: it is compiled again, and the numbers are the same.

``python tests/fuzz_cache.py --count 60`` tries so many.
"""

import atexit
import functools
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import hostile
import numpy as np

RUN = (
    "import kickdrift as kd; s = kd.systems.get('harmonic-oscillator');"
    " print(kd.solve(s, (0.0, 3.0), step=0.1, progress=False).x.tobytes().hex())"
)


def run(folder):
    """Solve something in a process of its own with the cache in a folder; return what it prints, and its exit status."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder), "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-W", "ignore", "-c", RUN]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    return done.stdout.strip(), done.returncode


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

"""Checkpoints that are damaged: a run goes on from one that is whole, with the same bits, or says what is wrong.

``python tests/fuzz_checkpoints.py --count 400`` tries so many.
"""

import functools
import shutil
import sys
import tempfile
from pathlib import Path

import hostile
import numpy as np

import kickdrift as kd
from kickdrift.core.errors import KickdriftError


def solve(folder):
    return kd.solve(
        kd.systems.kepler(0.6),
        (0.0, 10.0),
        step=1 / 32,
        method="stormer-verlet",
        save_every=5,
        events=crossing,
        checkpoint=folder,
        checkpoint_every=100,
    )


def crossing(x):
    return x[1]


@functools.cache
def original():
    """Return a folder with a checkpoint of the middle of a run, and what the run gives."""
    folder = Path(tempfile.mkdtemp())
    whole = solve(folder / "whole")
    (folder / "whole" / "step-000000000000320.npz").unlink()
    return folder / "whole", whole


def cut(content, rng):
    return content[: rng.integers(len(content))]


def flipped(content, rng):
    changed = bytearray(content)
    for _ in range(rng.integers(1, 4)):
        changed[rng.integers(len(changed))] ^= 1 << rng.integers(8)
    return bytes(changed)


def overwritten(content, rng):
    start, size = rng.integers(len(content)), int(rng.integers(1, 400))
    return content[:start] + rng.bytes(size) + content[start + size :]


def doubled(content, rng):
    return content + content


DAMAGES = cut, flipped, overwritten, doubled


def attempt(seed):
    """Damage a checkpoint, or both, and go on."""
    rng, (source, whole) = np.random.default_rng(seed), original()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "run"
        shutil.copytree(source, folder)
        newest = folder / "step-000000000000310.npz"
        (first,) = folder.iterdir()
        shutil.copy(first, newest)
        for path in (newest, first)[: rng.integers(1, 3)]:
            path.write_bytes(DAMAGES[seed % len(DAMAGES)](path.read_bytes(), rng))
        try:
            on = solve(folder)
        except KickdriftError as error:
            return None if "checkpoint" in str(error) else f"says {error}"
    if not np.array_equal(on.x, whole.x) or not np.array_equal(on.t_events[0], whole.t_events[0]):
        return f"{DAMAGES[seed % len(DAMAGES)].__name__}: other bits"
    return None


if __name__ == "__main__":
    sys.exit(hostile.main("fuzz_checkpoints", __doc__))

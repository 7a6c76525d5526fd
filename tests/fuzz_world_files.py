"""World files of strangers: numbers, tables and words of a file changed, with a digest that fits.

``python tests/fuzz_world_files.py --count 400`` tries so many: each is refused by a sentence, or read and run.
"""

import atexit
import functools
import json
import shutil
import sys
import tempfile
from pathlib import Path

import hostile
import numpy as np
from random_worlds import random_world

import kickdrift as kd
from kickdrift.core import archive
from kickdrift.core.errors import KickdriftError

STEP = 1 / 60
WHOLE = (-(2**63), -(2**31), -100, -2, -1, 0, 1, 2, 3, 4, 5, 7, 8, 63, 64, 1000, 2**31, 2**40, 2**62)
FLOATS = (np.nan, np.inf, -np.inf, 0.0, -0.0, -1.0, 1.0, 0.5, 5e-324, 1e-300, 1e30, 1e300, -1e300, 2.0**63, -3.0)
WORDS = (None, -1, 0, 1, 2**80, 1.5, "x", [], {}, [1, 2], True, float("nan"))


@functools.cache
def folder():
    """Where the files of this process lie."""
    path = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    return path


def pile():
    """Boxes and balls that rest on each other and sleep, one gone, one a sensor, with a robot of sorts, a gear and
    two cloths, a rope and a soft body."""
    world = kd.World(sleeping=True, sleep_time=0.1)
    world.add_plane()
    for k in range(12):
        world.add_box((0.5, 0.5, 0.5), position=(0.5 * (k % 3), 0, 0.25 + 0.5 * (k // 3)))
    world.remove(world.add_sphere(0.2, position=(9, 0, 9)))
    world.add_sphere(0.3, position=(0, 0, 3), restitution=0.5, name="ball")
    world.add_sphere(0.5, position=(0, 0.3, 0.3), static=True, sensor=True)
    rods = [world.add_capsule(0.05, 0.5, position=(3 + k, 0, 3)) for k in range(3)]
    hinges = [world.add_hinge(None, rod, anchor=rod.position, axis=(0, 1, 0)) for rod in rods]
    world.add_gear(hinges[0], hinges[1], -2.0)
    hinges[2].set_drive(kd.Drive(10.0, 1.0))
    world.exclude(rods[0], rods[1])
    sheet = world.add_cloth_grid((1.0, 1.0), (5, 4), position=(0, 0, 4), name="sheet")
    sheet.pin([0], rods[2])
    world.add_cloth_grid((0.5, 0.5), (3, 3), position=(2, 0, 1))
    world.add_rope([(3, 0, 1), (3.2, 0, 1), (3.4, 0, 1), (3.5, 0, 1)], name="line").pin([0])
    world.add_soft_box((0.5, 0.5, 0.5), (2, 1, 1), position=(4, 0, 1), name="jelly")
    return world


@functools.cache
def original(which):
    """Return header and arrays of a world that has run for a while."""
    world = pile() if which == 0 else random_world(which)[0]
    world.advance(STEP, 40)
    path = world.save(folder() / f"{which}.npz")
    with np.load(path, allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    return json.loads(str(arrays.pop("header"))), arrays


def changed(rng, which):
    """Return header and arrays with one to four changes."""
    header, arrays = original(which)
    header = json.loads(json.dumps(header))
    arrays = {name: rows.copy() for name, rows in arrays.items()}
    header.pop("digest")
    for _ in range(rng.integers(1, 5)):
        if rng.random() < 0.15:
            name = str(rng.choice([name for name in header if name != "format"]))
            header[name] = WORDS[rng.integers(len(WORDS))]
            continue
        name = str(rng.choice([name for name in arrays if arrays[name].size]))
        rows = arrays[name]
        change = rng.random()
        if change < 0.04:
            arrays[name] = rows[: rng.integers(len(rows) + 1)]
        elif change < 0.08:
            arrays[name] = np.concatenate([rows, rows[: rng.integers(1, len(rows) + 1)]])
        elif change < 0.1:
            arrays[name] = rows[::-1].copy()
        else:
            values = WHOLE if rows.dtype.kind == "i" else FLOATS
            flat = rows.reshape(-1)
            places = rng.integers(flat.size, size=1 if rng.random() < 0.7 else rng.integers(1, 20))
            flat[places] = [values[k] for k in rng.integers(len(values), size=len(places))]
            if rows.dtype.kind == "i" and rng.random() < 0.4:
                flat[places[0]] = flat[rng.integers(flat.size)]
    return header, arrays


def attempt(seed):
    """Read a file that was changed, run what it holds, and ask it this and that."""
    rng = np.random.default_rng(seed)
    header, arrays = changed(rng, int(rng.integers(5)))
    path = folder() / "changed.npz"
    archive.write(path, header, arrays)
    try:
        world = kd.load_world(path)
        world.touching, world.events, world.energy()
        world.ray_cast((0, 0, 50), (0, 0, -1))
        world.advance(STEP, 5)
        world.overlap_sphere(3.0)
        for row in range(1, min(len(world.position), 4)):
            if world.bodies.knows(row, world.bodies.handle(row).generation):
                world.remove(world.bodies.handle(row))
        world.add_box((1, 1, 1), position=(0, 0, 2))
        world.advance(STEP, 5)
        world.save(folder() / "again.npz")
    except KickdriftError:
        pass
    return


if __name__ == "__main__":
    sys.exit(hostile.main("fuzz_world_files", __doc__))

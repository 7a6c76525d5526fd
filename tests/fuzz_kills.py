"""Runs that are killed (kill -9) at random instants, and go on: with the bits of one that was left alone.

``python tests/fuzz_kills.py --count 50`` tries so many, of each kind of run in turn.
"""

import functools
import shutil
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import hostile
import numpy as np
import xarray as xr
from forking import forked

import kickdrift as kd

MOST_KILLS = 3
LONGEST = 0.4  # s until a run is killed, about as long as it takes


def pulled(t, x):
    return -x + 0.1 * np.cos(t)


def crossing(x):
    return x[0]


def plain(folder):
    """Run planets whose checkpoints take about as long as their steps."""
    options = {} if folder is None else {"checkpoint": folder / "run", "checkpoint_every": 8000}
    sol = kd.solve(
        kd.systems.outer_solar_system(), (0.0, 1.6e6), step=2.0, method="wisdom-holman", save_every=4000, **options
    )
    return sol.t, sol.x, sol.v


def events(folder):
    """Run a forced oscillator whose events are kept, too."""
    options = {} if folder is None else {"checkpoint": folder / "run", "checkpoint_every": 2000}
    sol = kd.solve(
        pulled,
        (0.0, 10_000.0),
        [1.0],
        [0.0],
        step=1 / 32,
        method="velocity-verlet",
        save_every=100,
        events=crossing,
        **options,
    )
    return sol.t, sol.x, sol.v, *sol.t_events


def adaptive(folder):
    """Run a comet whose steps vary."""
    options = {} if folder is None else {"checkpoint": folder / "run", "checkpoint_every": 20_000}
    sol = kd.solve(
        kd.systems.kepler(0.9),
        (0.0, 5e5),
        step=0.01,
        step_control="distance",
        method="stormer-verlet",
        save_every=1000,
        **options,
    )
    return sol.t, sol.x, sol.v


def toppled(**options):
    """Run a pile of boxes that topples."""
    made = kd.World()
    made.add_plane(normal=(0, 0, 1), friction=0.5)
    for k in range(8):
        made.add_box(size=(0.5, 0.5, 0.5), position=(0.1 * k, 0, 0.3 + 0.7 * k), mass=1.0)
    return made.run(60.0, 1 / 120, save_every=10, **options), made.position


def world(folder):
    """Run a world."""
    recording, position = toppled(**({} if folder is None else {"checkpoint": folder / "run", "checkpoint_every": 60}))
    return recording.t, recording.x, recording.v, recording.orientation, position


@contextmanager
def to_disk(folder, **kept):
    """Give what sends rows to a folder, and a function that reads what is there."""
    with tempfile.TemporaryDirectory() as elsewhere:
        path = Path(elsewhere if folder is None else folder) / "run.zarr"
        kept = (
            {} if folder is None else {name: folder / "run" if name == "checkpoint" else n for name, n in kept.items()}
        )
        yield {"save_to": path, **kept}, lambda: tuple(array for _, array in sorted(xr.open_zarr(path).load().items()))


def streamed_world(folder):
    """Run a world whose rows go to disk."""
    with to_disk(folder, checkpoint=..., checkpoint_every=60) as (options, read):
        _, position = toppled(**options)
        return *read(), position


def streamed_adaptive(folder):
    """Run a comet whose steps vary, and whose rows go to disk."""
    with to_disk(folder, checkpoint=..., checkpoint_every=20_000) as (options, read):
        control = {"step": 0.01, "step_control": "distance", "method": "stormer-verlet"}
        kd.solve(kd.systems.kepler(0.9), (0.0, 2e5), save_every=5, **control, **options)
        return read()


def stored(folder):
    """Run members that go to disk as they are done."""
    kepler = kd.systems.kepler()
    x0 = kepler.x0 + 0.01 * np.random.default_rng(0).normal(size=(3000, 2))
    with to_disk(folder) as (options, read):
        kd.solve_ensemble(kepler, (0.0, 500.0), x0, step=1e-3, save_every=50_000, **options)
        return read()


def streamed(folder):
    """Run planets whose rows go to disk."""
    with tempfile.TemporaryDirectory() as elsewhere:
        path = Path(elsewhere if folder is None else folder) / "run.zarr"
        options = {} if folder is None else {"checkpoint": folder / "run", "checkpoint_every": 12_000}
        system = kd.systems.outer_solar_system()
        kd.solve(system, (0.0, 8e5), step=2.0, method="wisdom-holman", save_every=10, save_to=path, **options)
        data = xr.open_zarr(path).load()
    return data.time, data.x, data.v, data.energy


def ensemble(folder):
    """Run members of which some are done before others."""
    options = {} if folder is None else {"checkpoint": folder / "run", "checkpoint_every": 100}
    kepler = kd.systems.kepler()
    x0 = kepler.x0 + 0.01 * np.random.default_rng(0).normal(size=(3000, 2))
    sol = kd.solve_ensemble(kepler, (0.0, 500.0), x0, step=1e-3, save_every=50_000, **options)
    return sol.t, sol.x, sol.v


def streamed_events(folder):
    """Run a comet whose steps vary, whose crossings are kept, and whose rows go to disk."""
    with to_disk(folder, checkpoint=..., checkpoint_every=10_000) as (options, read):
        control = {"step": 0.01, "step_control": "distance", "method": "stormer-verlet"}
        sol = kd.solve(kd.systems.kepler(0.9), (0.0, 1e5), save_every=5, events=crossing, **control, **options)
        return *read(), *sol.t_events, *sol.x_events


def bouncing(folder):
    """Run a ball on a shaken table, with its crests."""
    options = {} if folder is None else {"checkpoint": folder / "run", "checkpoint_every": 2000}
    sol = kd.solve(
        lambda x: 0 * x - 9.81,
        (0.0, 400.0),
        [1.0],
        [0.0],
        step=0.01,
        impacts=kd.Impacts(lambda t, x: x[0] - 0.1 * np.sin(9.0 * t), restitution=0.8),
        events=lambda v: v[0],
        **options,
    )
    return sol.t, sol.x, sol.v, *sol.t_events


def ensemble_with_events(folder):
    """Run members that end at a zero of their own, one after the other."""

    def far(x):
        return x[0] + 0.9

    far.terminal = 60
    options = {} if folder is None else {"checkpoint": folder / "run", "checkpoint_every": 20}
    kepler = kd.systems.kepler()
    x0 = kepler.x0 + 0.1 * np.random.default_rng(0).normal(size=(400, 2))
    sol = kd.solve_ensemble(kepler, (0.0, 300.0), x0, step=0.01, save_every=100, events=far, **options)
    rows = sol.x.view(np.int64), sol.v.view(np.int64)  # with NaN after their ends
    return sol.t, *rows, np.concatenate(sol.t_last), np.concatenate([own[0] for own in sol.t_events])


KINDS = {
    "streamed events": streamed_events,
    "bouncing": bouncing,
    "ensemble with events": ensemble_with_events,
    "plain": plain,
    "streamed": streamed,
    "events": events,
    "adaptive": adaptive,
    "ensemble": ensemble,
    "world": world,
    "streamed world": streamed_world,
    "streamed adaptive": streamed_adaptive,
    "stored ensemble": stored,
}


def written(kind, folder, path):
    """Do a run, and write what it gives."""
    np.savez(path, *map(np.asarray, KINDS[kind](folder)))


def given(kind, folder):
    """Return what a run gives, in a process of its own: this one starts others, and runs nothing itself."""
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "arrays.npz"
        process = forked(written, kind, folder, path)
        process.join()
        if process.exitcode:
            raise RuntimeError(f"{kind}: the process ended with {process.exitcode}")
        with np.load(path) as arrays:
            return [arrays[name] for name in arrays.files]


@functools.cache
def whole(kind):
    """Return what a run gives that is left alone."""
    return given(kind, None)


def newest(folder):
    """Return the name of the newest checkpoint that there is."""
    return max((path.name for path in (folder / "run").glob("step-*.npz")), default="")


def attempt(seed):
    """Kill a run one to three times before its end, and let it come there."""
    rng, kind = np.random.default_rng(seed), list(KINDS)[seed % len(KINDS)]
    expected, killed, wanted, longest = whole(kind), 0, rng.integers(1, MOST_KILLS + 1), LONGEST
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        while killed < wanted:
            before = newest(folder) if (folder / "run").exists() else ""
            process = forked(KINDS[kind], folder)
            time.sleep(rng.uniform(0.0, longest))
            done_before = not process.is_alive()
            process.kill()
            process.join()
            if done_before:  # it begins anew, and is killed sooner
                killed, longest = 0, longest / 2
                for path in folder.iterdir():
                    shutil.rmtree(path)
                continue
            killed += 1
            if newest(folder) < before:
                return f"{kind}: checkpoints up to {before} are lost"
        done = given(kind, folder)
        if not all(np.array_equal(one, other) for one, other in zip(done, expected, strict=True)):
            return f"{kind}: other bits after {killed} kills"
        if left := [path.name for path in [*folder.glob(".*"), *(folder / "run").glob(".*")]]:
            return f"{kind}: {left} are left"
    return None


if __name__ == "__main__":
    sys.exit(hostile.main("fuzz_kills", __doc__))

"""Workers of ensembles that are killed (kill -9) at random instants of the run: the same bits, and no chunk written twice.

``python tests/fuzz_workers.py --count 20`` kills one of two workers so often, of a pool of processes and of a cluster of Dask
in turn.
"""

import functools
import importlib
import importlib.util
import multiprocessing
import os
import random
import signal
import sys
import tempfile
import threading
import time
import warnings
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import counting_writes
import hostile
import numpy as np

import kickdrift as kd

LABELS = {"time/c/0", "space/c/0"}


def ensemble(**options):
    """Run members for some seconds."""
    kepler = kd.systems.kepler()
    x0 = kepler.x0 + 0.01 * np.random.default_rng(0).normal(size=(3000, 2))
    return kd.solve_ensemble(kepler, (0.0, 500.0), x0, step=5e-4, save_every=100_000, **options)


@functools.cache
def whole():
    """Return what an ensemble gives whose workers live."""
    return ensemble()


@contextmanager
def pool(log):
    """Give a pool of two processes, and a function that returns their numbers."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, context, counting_writes.count_writes, (log,)) as workers:
        [future.result() for future in [workers.submit(time.sleep, 0.5) for _ in range(2)]]
        yield workers, lambda: list(workers._processes)


@contextmanager
def cluster(log):
    """Give a client of a cluster of two, and a function that returns the numbers of its processes."""
    import distributed

    class Plugin(counting_writes.Counting, distributed.WorkerPlugin):
        pass

    options = {"threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
    with distributed.LocalCluster(n_workers=2, **options) as made, distributed.Client(made) as client:
        client.register_plugin(Plugin(log))
        client.run(importlib.import_module, "kickdrift")
        yield client, lambda: list(client.run(os.getpid).values())


KINDS = {"pool": pool, "cluster": cluster}


@functools.cache
def seconds(kind):
    """Return how long a run takes whose workers live, after one that has compiled and imported what there is."""
    took = []
    with tempfile.TemporaryDirectory() as folder, KINDS[kind](Path(folder) / "log") as (workers, _):
        for number in range(2):
            began = time.perf_counter()
            ensemble(executor=workers, save_to=Path(folder) / f"{number}.zarr")
            took.append(time.perf_counter() - began)
    return took[1]


def attempt(seed):
    """Kill a worker while an ensemble runs, and look at what is on disk."""
    kind = list(KINDS)[seed % 2]
    if kind == "cluster" and importlib.util.find_spec("distributed") is None:
        return None
    warnings.simplefilter("ignore")
    chance = random.Random(seed)
    when = chance.uniform(0.0, 1.0) * seconds(kind)
    while (verdict := killed_after(when, kind, chance)) == "too late":  # the machine is faster than it was
        when /= 2
    return verdict


def killed_after(when, kind, chance):
    """Kill a worker so many seconds after the start of an ensemble, and say what is wrong then, or that it was too late."""
    died = threading.Event()
    with tempfile.TemporaryDirectory() as name, KINDS[kind](Path(name) / "log") as (workers, numbers):
        folder, victim = Path(name), chance.choice(numbers())
        ensemble_is_done = threading.Event()

        def kill():
            time.sleep(when)
            if not ensemble_is_done.is_set():
                os.kill(victim, signal.SIGKILL)
                died.set()

        killer = threading.Thread(target=kill)
        killer.start()
        sol = ensemble(executor=workers, save_to=folder / "run.zarr")
        ensemble_is_done.set()
        killer.join()
        counts = counting_writes.chunks_written(folder / "log")
        there = counting_writes.chunks_there(folder / "run.zarr") - LABELS
        if not died.is_set():
            return "too late"
        if not (np.array_equal(sol.x[:], whole().x) and np.array_equal(sol.energy[:], whole().energy)):
            return f"{kind}: other bits after a kill at {when:.2f} s"
        if (twice := [key for key, count in counts.items() if count > 1]) or not there:
            return f"{kind}: {twice} are written twice after a kill at {when:.2f} s"
        if kind == "cluster" and (unseen := there - set(counts)):
            return f"{kind}: {unseen} were written by nobody who counts"
    return None


if __name__ == "__main__":
    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path)
    sys.exit(hostile.main("fuzz_workers", __doc__))

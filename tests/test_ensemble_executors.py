"""Ensembles on executors: the bits of threads, whatever becomes of the workers."""

import multiprocessing
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError

SPAN = (0.0, 3.0)
OPTIONS = {"step": 0.01, "save_every": 100}


def starts(count=150):
    noise = np.random.default_rng(3).normal(size=(2, count, 2))
    return [1.0, 0.0] + 0.1 * noise[0], [0.0, 1.0] + 0.1 * noise[1]


def pool(method):
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context(method))


def same(one, other):
    assert one.messages == other.messages
    for name in ("x", "v", "step", "n_steps", "n_force_evaluations", "energy"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
    return one.status == other.status


class Deadly:
    """An executor whose workers die as a task is submitted: of a pool, or of a cluster of Dask."""

    def __init__(self, inner, at, kill):
        self.inner, self.at, self.kill, self.submitted = inner, at, kill, 0

    def submit(self, function, *arguments):
        self.submitted += 1
        if self.submitted == self.at:
            self.kill(self.inner)
        return self.inner.submit(function, *arguments)


def test_workers_give_the_bits_of_threads():
    x, v = starts()
    kepler, planets = kd.systems.kepler(), kd.systems.outer_solar_system()
    with pool("spawn") as workers:
        sol = kd.solve_ensemble(kepler, SPAN, x, v, **OPTIONS, executor=workers)
        assert same(sol, kd.solve_ensemble(kepler, SPAN, x, v, **OPTIONS))
        far = planets.x0 + 1e-6 * np.arange(3)[:, None, None]
        options = {"t_span": (0.0, 1000.0), "x0": far, "step": 10.0, "method": "wisdom-holman"}
        assert same(kd.solve_ensemble(planets, **options, executor=workers), kd.solve_ensemble(planets, **options))
        swept = {"eccentricity": np.linspace(0, 0.9, 5), "mu": [1.0, 2.0]}
        made = kd.solve_ensemble(kd.systems.kepler, SPAN, args=swept, **OPTIONS, executor=workers)
        assert same(made, kd.solve_ensemble(kd.systems.kepler, SPAN, args=swept, **OPTIONS))
        with pytest.raises(ArgumentError, match="cannot be sent"):
            kd.solve_ensemble(lambda x: -x, SPAN, x, v, **OPTIONS, executor=workers)


@pytest.mark.filterwarnings("ignore:a worker of the executor died:RuntimeWarning")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # of Python 3.12, where there are threads
@pytest.mark.parametrize("at", [2, 5, 17])
def test_a_pool_that_breaks_changes_no_bit(at):
    x, v = starts()
    with pool("fork") as workers:
        broken = Deadly(workers, at, lambda workers: (workers.submit(os._exit, 1), time.sleep(0.3)))
        sol = kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **OPTIONS, executor=broken)
    assert same(sol, kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **OPTIONS))


class _Nothing:
    """Finds no kickdrift, as where it is not installed."""

    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "kickdrift":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def _without_kickdrift():
    for name in [name for name in sys.modules if name.partition(".")[0] == "kickdrift"]:
        del sys.modules[name]
    sys.meta_path.insert(0, _Nothing())


def test_workers_that_lack_the_package_are_refused_at_once():
    x, v = starts(10)
    fork = multiprocessing.get_context("fork")
    lacking = ProcessPoolExecutor(1, mp_context=fork, initializer=_without_kickdrift)
    with lacking as workers, pytest.raises(ArgumentError, match="its workers do not have it"):
        kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **OPTIONS, executor=workers)
    with pytest.raises(ArgumentError, match="no method submit"):
        kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **OPTIONS, executor=3)
    with ThreadPoolExecutor(1) as workers, pytest.raises(ArgumentError, match="both given"):
        kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **OPTIONS, executor=workers, threads=2)


def test_a_member_that_fails_is_marked_and_the_others_finish():
    x, v = starts(20)
    x[7] = 1e-160, 0.0
    with ThreadPoolExecutor(2) as workers:
        sol = kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **OPTIONS, executor=workers)
    assert np.flatnonzero(~sol.success).tolist() == [7]
    assert same(sol, kd.solve_ensemble(kd.systems.kepler(), SPAN, x, v, **OPTIONS))


@pytest.mark.filterwarnings("ignore")
def test_a_cluster_that_loses_a_worker_gives_the_same_bits():
    distributed = pytest.importorskip("distributed")
    x, v = starts()

    def attracted(x):  # which the standard library cannot send
        return -x / (x[0] * x[0] + x[1] * x[1]) ** 1.5

    problem = kd.SecondOrder(attracted, energy=lambda x, v: 0.5 * (v @ v) - 1 / np.sqrt(x @ x))
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        distributed.Client(cluster) as client,
    ):
        victim = next(iter(client.run(os.getpid).values()))
        deadly = Deadly(client.get_executor(), 9, lambda executor: os.kill(victim, 9))
        sol = kd.solve_ensemble(problem, SPAN, x, v, **OPTIONS, executor=deadly)
        again = kd.solve_ensemble(problem, SPAN, x, v, **OPTIONS, executor=client)
    alone = kd.solve_ensemble(problem, SPAN, x, v, **OPTIONS)
    assert same(sol, alone)
    assert same(again, alone)

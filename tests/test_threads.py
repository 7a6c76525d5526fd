"""Threads of Python that share a world, and processes that are forked from one that has threads."""

import copy
import multiprocessing
import os
import threading

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.world import tables

STEP = 1 / 60
TOGETHER = 60  # seconds, after which a pool hangs


def balls(threads=False):
    world = kd.World(threads=threads)
    world.add_plane()
    for k in range(60):
        world.add_sphere(0.1, position=(k % 6 * 0.25, k // 6 * 0.25, 0.1))
    return world


def forked(function, *arguments):
    """Call a function in processes that are forked, and return what they return."""
    with multiprocessing.get_context("fork").Pool(2) as pool:
        return pool.starmap_async(function, [arguments] * 4).get(TOGETHER)


def here(world):
    world.advance(STEP, 5)
    return np.concatenate((world.position, world.tables.array(tables.PARTICLE)[:, :3]))


def anew(scene):
    return here(scene(threads=True))


def solved(system):
    return kd.solve(system, t_span=(0, 1), step=0.1).x


needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")


def sheet(threads=False):
    world = kd.World(threads=threads)
    world.add_sphere(0.5, static=True)
    world.add_cloth_grid((2.0, 2.0), (96, 96), position=(0, 0, 0.51))
    return world


@needs_fork
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of forks in processes that have threads
@pytest.mark.parametrize("scene", [balls, sheet])
def test_forked_processes_do_without_threads_and_give_the_same_bits(scene):
    world = scene(threads=True)
    world.advance(STEP, 2)
    for positions in forked(anew, scene):
        assert np.array_equal(positions, anew(scene))
    _inherited[:] = [world]
    for positions in forked(_of_the_parent):
        assert np.array_equal(positions, here(copy_of(world)))


_inherited = []


def _of_the_parent():
    world = _inherited[0]
    before = world.snapshot()
    found = here(world)
    world.restore(before)
    return found


def copy_of(world):
    again = kd.World()
    again.restore(world.snapshot())
    return again


@needs_fork
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forked_processes_solve_systems_of_threads():
    rng = np.random.default_rng(0)
    system = kd.systems.nbody(np.ones(100), rng.normal(size=(100, 3)), rng.normal(size=(100, 3)), threads=True)
    want = solved(system)
    _systems.append(system)
    for x in forked(_solved_of_the_parent):
        assert np.array_equal(x, want)


_systems = []


def _solved_of_the_parent():
    return solved(_systems[0])


def test_threads_wait_for_each_other_at_a_world():
    world = balls()
    errors = []

    def guarded(work):
        try:
            for _ in range(20):
                work()
        except Exception as error:
            errors.append(error)

    def grow():
        ball = world.add_sphere(0.1, position=(0, 0, 50))
        world.remove(ball)

    works = [
        lambda: world.advance(STEP, 5),
        lambda: world.advance(STEP, 5),
        lambda: world.ray_cast((0, 0, 9), (0, 0, -1)),
        lambda: here(copy.copy(world)),
        grow,
    ]
    threads = [threading.Thread(target=guarded, args=(work,)) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors
    assert np.isfinite(world.position[:61]).all()

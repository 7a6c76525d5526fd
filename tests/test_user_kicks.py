"""Kicks that add up a force where it is written: which forces have one, and that the bits are those of a loop in NumPy."""

import math

import numpy as np
import pytest
from numba import njit

import kickdrift as kd
from kickdrift.engine import problem_adapter
from kickdrift.engine.problem_adapter import describe
from kickdrift.engine.start import Start

STIFFNESS = 0.7


@pytest.fixture(autouse=True)
def _small_is_large(monkeypatch):
    monkeypatch.setattr(problem_adapter, "LARGE", 10)


def springs(x, out):
    for i in range(x.size):
        out[i] = -STIFFNESS * x[i]


def chain(t, x, params, out):
    n = len(x)
    for i in range(n):
        left = x[i - 1] if i > 0 else 0.0
        right = x[i + 1] if i < n - 1 else math.sin(t)
        out[i] = params[0] * (left - 2.0 * x[i] + right) - x[i] * x[i] * x[i]


def membrane(x, out):
    rows, columns = out.shape
    for j in range(columns):
        out[0, j] = out[rows - 1, j] = 0
    for i in range(1, rows - 1):
        out[i, 0] = out[i, -1] = 0
        for j in range(1, columns - 1):
            out[i, j] = x[i - 1, j] + x[i + 1, j] + x[i, j - 1] + x[i, j + 1] - 4.0 * x[i, j]


@njit
def cube(number):
    return number * number * number


def with_a_callee(x, out):
    i = 0
    while i < out.size:
        out[i] = -cube(x[i])
        i += 1


def by_hand(force, x, v, h, steps, args, compensated):
    x, v, a, lost_x, lost_v = x.copy(), v.copy(), np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
    given = {"t": 0.0, "x": x, "params": np.array(args), "out": a}
    names = force.__code__.co_varnames[: force.__code__.co_argcount]

    def add(y, rate, lost):
        increment = h * rate - lost
        total = y + increment
        if compensated:
            lost[:] = (total - y) - increment
        y[:] = total

    for step in range(steps):
        given["t"] = step * h
        force(*(given[name] for name in names))
        add(v, a, lost_v)
        add(x, v, lost_x)
    return x, v


FORCES = {"springs": springs, "chain": chain, "membrane": membrane, "with_a_callee": with_a_callee}
START = np.cos(np.arange(35.0)).reshape(5, 7)


def solved(force, shape, compensated, steps=20, **more):
    x0 = START.reshape(shape)
    span = {"t_span": (0.0, 0.125 * steps), "step": 0.125, "args": (1.5,) if force is chain else ()}
    return kd.solve(force, x0=x0, v0=0.1 * x0, compensated=compensated, progress=False, **span, **more)


def system_of(force, shape=(-1,), check_bounds=True):
    x0 = START.reshape(shape)
    args = np.array([1.5] if force is chain else [])
    return describe(force, 0.0, Start(x0, 0.1 * x0), args, True, check_bounds)


@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("name", FORCES)
def test_bits_are_those_of_a_loop(name, compensated):
    shape = (5, 7) if name == "membrane" else (-1,)
    assert system_of(FORCES[name], shape).kick is not None
    solution = solved(FORCES[name], shape, compensated)
    x0 = START.reshape(shape)
    x, v = by_hand(FORCES[name], x0, 0.1 * x0, 0.125, 20, (1.5,), compensated)
    assert np.array_equal(solution.x[-1], x)
    assert np.array_equal(solution.v[-1], v)


@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("shape", [(-1,), (7, 5)])
def test_masses(compensated, shape, monkeypatch):
    x0 = START.reshape(shape)
    problem = kd.Newtonian(membrane if len(shape) > 1 else springs, mass=np.linspace(1.0, 3.0, len(x0)))
    assert describe(problem, 0.0, Start(x0, 0.1 * x0), np.zeros(0), True).kick is not None
    own = solved(problem, shape, compensated)
    monkeypatch.setattr(problem_adapter, "LARGE", 1000)
    assert describe(problem, 0.0, Start(x0, 0.1 * x0), np.zeros(0), True).kick is None
    filled = solved(problem, shape, compensated)
    assert np.array_equal(own.x, filled.x)
    assert np.array_equal(own.v, filled.v)
    assert not np.array_equal(own.x, solved(springs, (-1,), compensated).x.reshape(own.x.shape))


@pytest.mark.parametrize("method", ["leapfrog", "velocity-verlet", "mclachlan-atela-4"])
def test_whatever_the_word(method, monkeypatch):
    own = solved(springs, (-1,), True, method=method)
    monkeypatch.setattr(problem_adapter, "LARGE", 1000)
    assert np.array_equal(own.x, solved(springs, (-1,), True, method=method).x)


def test_numbers_of_a_closure_are_its_own():
    def spring_of(stiffness):
        def force(x, out):
            for i in range(x.size):
                out[i] = -stiffness * x[i]

        return force

    ends = [solved(spring_of(stiffness), (-1,), False).x[-1] for stiffness in (0.5, 0.7)]
    assert np.array_equal(ends[1], solved(springs, (-1,), False).x[-1])
    assert not np.array_equal(*ends)


def branching(x, out):
    for i in range(x.size):
        if x[i] > 0.0:
            out[i] = -x[i]
        else:
            out[i] = -2.0 * x[i]


def writing_twice(x, out):
    for i in range(x.size):
        out[i] = 0.0
    for i in range(x.size):
        out[i] = -x[i]


def reading(x, out):
    for i in range(x.size):
        out[i] = -x[i]
    out[0] = out[0] * 2.0


def adding(x, out):
    for i in range(x.size):
        out[i] = -x[i]
    out[0] += 1.0


def by_slices(x, out):
    out[:] = -x


def scattering(x, out):
    for i in range(x.size):
        out[(i + 5 * int(x[0] > 5.0)) % x.size] = -x[i]


def sorting(x, out):
    order = np.argsort(x)
    for i in range(x.size):
        out[order[i]] = -x[i]


@njit
def fill(x, out):
    for i in range(x.size):
        out[i] = -x[i]


def passing_on(x, out):
    fill(x, out)


def renaming(x, out):
    other = out
    for i in range(x.size):
        other[i] = -x[i]
    out[3] = other[3] + 0.0


def drawing(x, out):
    for i in range(x.size):
        out[i] = -x[i]
        if np.random.random() < 0.0:  # noqa: NPY002 - what Numba knows
            out[i] = 1.0


OTHERS = [branching, writing_twice, reading, adding, by_slices, scattering, sorting, passing_on, renaming, drawing]


@pytest.mark.parametrize("force", OTHERS)
def test_what_may_write_otherwise_fills_an_array(force):
    assert system_of(force).kick is None
    assert solved(force, (-1,), False).success


@njit(fastmath=True)
def reordered(x, out):
    for i in range(x.size):
        out[i] = -x[i]


def test_sums_are_not_reordered():
    assert system_of(reordered).kick is None


def test_a_large_state_has_the_bits_of_numpy():
    x0 = np.linspace(1.0, 2.0, 100_000)
    solution = kd.solve(springs, (0.0, 1.0), x0, 0 * x0, step=0.1, compensated=False, progress=False, save_every=10)
    x, v = x0.copy(), 0 * x0
    for _ in range(10):
        v += 0.1 * (-STIFFNESS * x)
        x += 0.1 * v
    assert np.array_equal(solution.x[-1], x)
    assert np.array_equal(solution.v[-1], v)


def test_small_states_need_no_kick(monkeypatch):
    monkeypatch.setattr(problem_adapter, "LARGE", 36)
    assert system_of(springs).kick is None


def looking_up(x, out):
    for i in range(x.size):
        out[i] = 1.0 + 0.0 * x[int(x[i] * 20.0)]


def test_an_index_that_depends_on_numbers_stays_checked():
    x0 = np.linspace(0.0, 0.5, 35)
    assert describe(looking_up, 0.0, Start(x0, 0 * x0), np.zeros(0), True).kick is not None
    solution = kd.solve(looking_up, (0.0, 30.0), x0, 0 * x0, step=0.5, progress=False)
    assert not solution.success
    assert "IndexError" in solution.message
    assert 0 < solution.n_steps < 60

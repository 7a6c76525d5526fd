"""The same function is compiled once, and a changed one again."""

import math

import numpy as np
import pytest
from numba import njit

import kickdrift as kd
from kickdrift.engine import user_functions
from kickdrift.engine.frozen import frozen

STIFFNESS = 1.0
TABLE = np.ones(3)
SPAN = {"t_span": (0.0, 1.0), "x0": 1.0, "v0": 0.0, "step": 0.1}


def pulled(x):
    return -STIFFNESS * x


def helped(x):
    return pulled(x)


def uses_table(x):
    return -TABLE[0] * x


def uses_module(x):
    return -user_functions.STIFFNESS * x


def closed_over(k):
    return lambda x: -k * x


@njit
def jitted(x):
    return -x


def test_equal_functions_have_equal_keys():
    assert frozen(pulled) == frozen(pulled)
    assert frozen(closed_over(1.0)) == frozen(closed_over(1.0))
    assert frozen(jitted) == frozen(jitted)
    assert len({frozen(pulled), frozen(helped), frozen(closed_over(1.0)), frozen(closed_over(2.0))}) == 4


def test_numbers_of_another_type_make_another_function():
    assert frozen(closed_over(1)) != frozen(closed_over(1.0))


def test_a_changed_global_makes_another_key(monkeypatch):
    before, inner = frozen(pulled), frozen(helped)
    monkeypatch.setitem(globals(), "STIFFNESS", 4.0)
    assert frozen(pulled) != before
    assert frozen(helped) != inner  # through the function that it calls


@pytest.mark.parametrize("function", [uses_table, uses_module, closed_over([1.0]), lambda x: sum(-y for y in [x])])
def test_what_may_change_unnoticed_has_no_key(function):
    assert frozen(function) is None
    assert frozen(lambda x: -math.sin(x)) is not None


def test_a_second_run_compiles_nothing_and_a_changed_global_is_seen(monkeypatch):
    first = kd.solve(pulled, **SPAN)
    compiled = user_functions._compiled.cache_info().misses
    assert np.array_equal(kd.solve(pulled, **SPAN).x, first.x)
    assert user_functions._compiled.cache_info().misses == compiled
    monkeypatch.setitem(globals(), "STIFFNESS", 4.0)
    assert np.array_equal(kd.solve(pulled, **SPAN).x, kd.solve(kd.systems.harmonic_oscillator(2.0), (0, 1), step=0.1).x)


def test_a_changed_array_is_seen(monkeypatch):
    first = kd.solve(uses_table, **SPAN)
    monkeypatch.setitem(globals(), "TABLE", np.full(3, 4.0))
    assert not np.array_equal(kd.solve(uses_table, **SPAN).x, first.x)

"""Compiled functions that others call, which are written for LLVM in words of our own, do what Python's do."""

import math

import numpy as np
import pytest

from kickdrift.core.compilation import compiled

WORLD = "kickdrift.world.written_so"


def as_part(function, module=WORLD):
    """Have compiled code call a function, and the interpreter that code; of worlds alone it is written in words of our own."""
    function.__module__ = module
    part = compiled(cached=False)(function)

    def call(a, b):
        return part(a, b)

    return compiled(cached=False)(call)


def up_and_down(a, b):
    total = 0.0
    for i in range(int(b)):
        for j in range(i, -3, -2):
            for k in range(j, i + 7, 3):
                total = 3.0 * total + a[0] * i + j + k
    for _ in range(5, 5):
        total = math.nan
    for _ in range(5, 6, -1):
        total = math.nan
    return total % 1e6


def from_the_end(a, b):
    a[-1] += 1.0
    table = a.reshape(2, -1)
    index = -int(b)
    table[index, -2] = table[1, index] + table[-1, 0]
    return table[0, 0] + a[index]


def replaced(a, b):
    first = a
    if b > 0.0:
        first = a + b
    kept = first
    first = np.zeros(3)
    first[0] = kept[0]
    first = first * 2.0
    return first[0] + kept[1] + a[2]


def walked(a, b):
    view, made, total = a, np.zeros(a.size + 1), 0.0
    for i in range(a.size):
        view = a[i:]
        total = 2.0 * total + view[0]
        if total > b:
            made[i] = view[0]
            view = made
        total += view[0]
    return total + view[0] + made.sum()


def swapped(a, b):
    low, high = 0.0, b
    for i in range(a.size):
        low, high = high, low + a[i]
        pair = ((low, high), i)
        low = pair[0][1]
    return low + high


def least_and_most(a, b):
    return min(a[0], b, 2.0) + 10.0 * max(a[1], b) + 100.0 * max(int(b), 2) + min(1, 2, int(b))


def comprehended(a, b):
    return sum([b * x for x in a]) + np.array([x + b for x in a])[1]


def left_early(a, b):
    i = 0
    while True:
        i += 1
        if a[i % a.size] + i > 20.0 * b:
            return i
        if i % 2:
            continue
        a[i % a.size] -= 1.0


@pytest.mark.parametrize(
    ("function", "module"),
    [
        *(
            (f, WORLD)
            for f in (up_and_down, from_the_end, replaced, walked, swapped, least_and_most, comprehended, left_early)
        ),
        *((f, "kickdrift.engine.flows.written_so") for f in (from_the_end, replaced, walked)),
    ],
)
def test_parts_do_what_python_does(function, module):
    part = as_part(function, module)
    for a, b in ((np.array([1.5, -2.0, 3.0, 0.25]), 2.0), (np.array([0.5, 4.0, -1.0, 8.0]), 1.0)):
        want_of, got_of = a.copy(), a.copy()
        want = function(want_of, b)
        assert part(got_of, b) == want
        assert np.array_equal(got_of, want_of)


def test_the_least_of_what_is_no_number_is_that_of_numba():
    part = as_part(least_and_most)
    alone = compiled(cached=False)(least_and_most)
    for a in (np.array([math.nan, 1.0]), np.array([1.0, math.nan]), np.array([-0.0, 0.0])):
        assert np.float64(part(a, 0.0)).tobytes() == np.float64(alone(a, 0.0)).tobytes()


def refused(a, b):
    if b > a[0]:
        raise ValueError("too much")
    return 2.0 * b


def test_errors_of_parts_reach_their_callers():
    part = compiled(cached=False)(refused)
    other = compiled(cached=False)(lambda a, b: part(a, b) + 1.0)
    outer = compiled(cached=False)(lambda a, b: other(a, b) + 1.0)
    assert outer(np.array([3.0]), 2.0) == 6.0
    with pytest.raises(ValueError, match="too much"):
        outer(np.array([1.0]), 2.0)


def test_arrays_of_parts_live_as_long_as_they_are_used():
    make = compiled(cached=False)(lambda n: np.full(n, 7.0))
    half = compiled(cached=False)(lambda a: a[: a.size // 2])
    outer = compiled(cached=False)(lambda n: half(half(make(n))))
    kept = [outer(4000) for _ in range(50)]
    [outer(4000) for _ in range(50)]
    assert all(np.array_equal(array, np.full(1000, 7.0)) for array in kept)


def test_slices_of_an_array_are_assigned_to_others_of_it():
    def moved(a, b):
        a[1:] = a[:-1]
        a[::2] = a[1::2]
        a[:] = a[::-1]

    ours, python = np.arange(8.0), np.arange(8.0)
    as_part(moved)(ours, 0.0)
    moved(python, 0.0)
    np.testing.assert_array_equal(ours, python)


def test_slices_of_another_shape_are_refused_without_making_texts():
    def filled(a, b):
        a[1:] = b

    caller = as_part(filled)
    with pytest.raises(ValueError, match="array of another shape"):
        caller(np.zeros(4), np.ones(2))
    given = np.zeros(4)
    caller(given, np.arange(3.0))
    assert given.tolist() == [0.0, 0.0, 1.0, 2.0]
    [part] = caller.py_func.__closure__[0].cell_contents.overloads.values()
    assert not any("unicode" in function.name for function in part.library.own_module().functions)

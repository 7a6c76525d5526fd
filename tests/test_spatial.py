"""Spatial vectors: six numbers in a vector register do what NumPy does with them."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import types
from vector_instructions import needs_wide_vectors, packed

from kickdrift.core.compilation import compiled
from kickdrift.core.spatial import (
    inner,
    moved,
    plus_scaled,
    put_spatial,
    put_spatial_of,
    scaled,
    spatial_at,
    spatial_of,
)
from kickdrift.world.direct.factorisation import factor

NUMBERS = st.lists(st.floats(-1e3, 1e3), min_size=24, max_size=24).map(np.array)


@compiled
def combine(table: Any, factor: float, s: Any) -> float:
    """Write into row 2 of a table of ten columns what is made of rows 0 and 1, from different columns on."""
    a, b = spatial_at(table, 0, 1), spatial_at(table, 1, 3)
    put_spatial(table, 2, 0, plus_scaled(a, factor, b))
    put_spatial(table, 3, 2, moved(scaled(factor, a), (s[0], s[1], s[2])))
    return float(inner(a, b))


@compiled
def reverse_halves(numbers: Any) -> None:
    """Exchange the halves of twelve numbers."""
    first, second = spatial_of(numbers, 0), spatial_of(numbers, 6)
    put_spatial_of(numbers, 0, second)
    put_spatial_of(numbers, 6, first)


@given(NUMBERS, st.floats(-10.0, 10.0))
@settings(max_examples=50, deadline=None)
def test_arithmetic_is_that_of_numpy(numbers, factor):
    table = np.full((4, 10), 7.0)
    table[0, 1:7], table[1, 3:9] = numbers[:6], numbers[6:12]
    a, b, s = numbers[:6].copy(), numbers[6:12].copy(), numbers[12:15]

    product = combine(table, factor, s)

    scale = 1e-14 * (1.0 + abs(numbers).max() ** 2) * (1.0 + abs(factor))
    assert product == pytest.approx(a @ b, abs=6 * scale)
    np.testing.assert_allclose(table[2, :6], a + factor * b, atol=scale)
    turned = factor * np.concatenate([a[:3], a[3:] + np.cross(s, a[:3])])
    np.testing.assert_allclose(table[3, 2:8], turned, atol=4 * scale)
    assert (table[2, 6:] == 7.0).all()
    assert (table[3, [0, 1, 8, 9]] == 7.0).all()


def test_what_is_read_and_written_is_six_numbers():
    numbers = np.arange(12.0)
    reverse_halves(numbers)
    assert numbers.tolist() == [*range(6, 12), *range(6)]


def packed_multiplications(function: Any, *arguments: Any) -> int:
    fresh = compiled(cached=False, fast=True)(function.py_func)
    assembly = fresh.get_compile_result(types.none(*arguments)).library.get_asm_str()
    return packed(assembly, r"v(?:mul|fn?m(?:add|sub)\d+)")


@compiled(fast=True)
def add_scaled_number_by_number(table: Any, factor: float) -> None:
    """Add to six numbers a multiple of others, in a loop."""
    for k in range(6):
        table[1, k] += factor * table[0, k]


@needs_wide_vectors
def test_blocks_are_eliminated_in_vector_registers():
    assert packed_multiplications(factor, types.int64, types.int64, types.int64) >= 100
    table = types.Array(types.float64, 2, "C")
    assert packed_multiplications(add_scaled_number_by_number, table, types.float64) == 0

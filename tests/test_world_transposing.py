"""Rows of tables become fields of lanes, and come back."""

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts.layout import WIDTH
from kickdrift.world.contacts.simd_transpose import gather_rows, scatter_rows

ROWS = np.array([99, 5, 0, 7, 7, 1, 3, 0, 6])  # the first is none of those that are asked for


@compiled(cached=False)
def _gather(table, lanes):
    gather_rows(table, 1, ROWS, 1, lanes, 2)


@compiled(cached=False)
def _scatter(table, lanes):
    scatter_rows(table, ROWS, 1, lanes, 1)


def test_rows_become_fields():
    table = np.random.default_rng(0).normal(size=(8, 8))
    lanes = np.full(10 * WIDTH, -1.0)
    _gather(table, lanes)
    fields = lanes.reshape(10, WIDTH)
    assert np.array_equal(fields[2:8], table[ROWS[1:], 1:7].T)
    assert np.all(fields[:2] == -1.0)
    assert np.all(fields[8:] == -1.0)


def test_fields_become_rows():
    lanes = np.random.default_rng(1).normal(size=(7, WIDTH))
    lanes[:, [3, 6]] = lanes[:, [2, 1]]  # rows 7 and 0 are there twice
    table = np.ones((8, 8))
    _scatter(table, lanes.ravel())
    assert np.array_equal(table[ROWS[1:], :6], lanes[1:].T)
    assert np.all(table[np.unique(ROWS[1:]), 6:] == 0.0)
    assert np.all(table[[2, 4]] == 1.0)

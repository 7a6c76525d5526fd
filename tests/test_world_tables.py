"""Tables of worlds: where they lie, and what they keep when they grow."""

import gc

import numpy as np
import pytest

from kickdrift.world import tables as t


@pytest.mark.parametrize("count", [1, 100, 1023, 1024, 20_000])
def test_tables_of_any_size_begin_where_a_cache_line_does_and_keep_their_rows(count):
    tables = t.Tables()
    rows = tables.resize(t.MANIFOLD, count)
    assert rows.ctypes.data % 64 == 0
    assert not rows.any()
    rows[:] = np.arange(count)[:, None]
    more = tables.resize(t.MANIFOLD, 2 * count)
    del rows
    gc.collect()
    assert more.ctypes.data % 64 == 0
    assert (more[:count] == np.arange(count)[:, None]).all()
    assert not more[count:].any()


def test_rows_outlive_their_tables():
    tables = t.Tables()
    rows = tables.resize(t.CONTACT, 20_000)
    rows[:] = 3
    del tables
    gc.collect()
    assert (rows == 3).all()


def test_systems_without_huge_pages_get_usual_ones(monkeypatch):
    monkeypatch.setattr(t, "_HUGE_PAGES", None)
    rows = t.Tables().resize(t.MANIFOLD, 5000)
    assert rows.ctypes.data % 64 == 0
    assert not rows.any()

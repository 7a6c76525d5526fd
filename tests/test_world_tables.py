"""Tables of worlds: where they lie, what they keep when they grow, and which columns they have."""

import gc
from importlib import import_module

import numpy as np
import pytest

from kickdrift.core.errors import ArgumentError
from kickdrift.world import tables as t
from kickdrift.world.columns import DECLARED, Columns, column


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


def declared():
    """Columns of all tables, once the modules that declare them are imported."""
    for module in (
        "world",
        "layout",
        "settings",
        "sleeping",
        "collision.search",
        "collision.dispatch",
        "events",
        "step_status",
    ):
        import_module(f"kickdrift.world.{module}")
    tables = {table.place: (name, table) for name, table in vars(t).items() if isinstance(table, t.Table)}
    return [(*tables[place], columns) for place, columns in DECLARED.items()]


def test_declared_columns_follow_each_other_and_fit_their_tables():
    names = {name for name, _, _ in declared()}
    assert {
        "POSE",
        "MOTION",
        "BODY",
        "SHAPE",
        "PLACE",
        "BOUNDS",
        "SEARCH",
        "SETTINGS",
        "EVENTS",
        "STEP_STATUS",
        "RESTED",
    } <= names
    for name, table, columns in declared():
        taken = [number for c in columns for number in range(c.first, c.first + c.size)]
        assert taken == list(range(len(taken))), name
        assert len(taken) <= table.width, name
        assert len({c.module for c in columns}) == 1, name


def test_tables_have_places_of_their_own():
    places = [table.place for table in vars(t).values() if isinstance(table, t.Table)]
    assert len(places) == len(set(places))


def test_columns_that_do_not_fit_are_refused(monkeypatch):
    table = t.Table(10**6, 8)
    monkeypatch.setitem(DECLARED, table.place, [])
    assert [column(table, 3, "m"), column(table), column(table, 4)] == [0, 3, 4]
    assert [c.unit for c in DECLARED[table.place]] == ["m", "", ""]
    with pytest.raises(ArgumentError, match="has 8 columns, and 9 are declared"):
        column(table)


def test_columns_of_one_table_are_declared_in_one_module(monkeypatch):
    table = t.Table(10**6, 8)
    monkeypatch.setitem(DECLARED, table.place, [Columns(0, 1, "m", "elsewhere")])
    with pytest.raises(ArgumentError, match="are declared in elsewhere"):
        column(table)

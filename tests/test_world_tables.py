"""Tables of worlds: where they lie, what they keep when they grow, and which columns they have."""

import gc
from importlib import import_module

import numpy as np
import pytest

from kickdrift.core import aligned_arrays
from kickdrift.core.errors import ArgumentError
from kickdrift.world import layout
from kickdrift.world import tables as t
from kickdrift.world.columns import DECLARED, Columns, Fields, column
from kickdrift.world.contacts import layout as contacts
from kickdrift.world.joints.layout import ANGULAR_PART, LINEAR_PART
from kickdrift.world.layout import KICKED_ANGULAR_VELOCITY, KICKED_VELOCITY


@pytest.mark.parametrize("count", [1, 100, 1023, 1024, 20_000])
def test_tables_of_any_size_begin_where_a_cache_line_does_and_keep_their_rows(count):
    tables = t.Tables()
    rows = tables.resize(t.MANIFOLD, count)
    assert rows.ctypes.data % 64 == 0
    assert not rows.any()
    rows[:] = np.arange(count)[:, None]
    more = tables.resize(t.MANIFOLD, 2 * count)
    del rows
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
    monkeypatch.setattr(aligned_arrays, "_HUGE_PAGES", None)
    rows = t.Tables().resize(t.MANIFOLD, 5000)
    assert rows.ctypes.data % 64 == 0
    assert not rows.any()


def declared():
    """Columns of all tables, once the modules that declare them are imported."""
    import_module("kickdrift.world.world")
    tables = {table.place: (name, table) for name, table in vars(t).items() if isinstance(table, t.Table)}
    return [(*tables[place], columns) for place, columns in DECLARED.items() if place in tables]


def test_declared_columns_follow_each_other_and_fit_their_tables():
    for name, table, columns in declared():
        own = [c for c in columns if not c.over]
        taken = [number for c in own for number in range(c.first, c.first + c.size)]
        assert taken == list(range(len(taken))), name
        assert table.width - 8 < len(taken) <= table.width, name
        assert len({c.module for c in columns}) == 1, name


def test_all_tables_have_declared_columns():
    names = {name for name, _, _ in declared()}
    as_another = {
        "NOTED",
        "STARTED_POSE",
        "STARTED_MOTION",
        "STARTED_JOINTS",
        "STARTED_PAIR",
        "STARTED_PAIR_NUMBERS",
        "STARTED_PARTICLE",
        "STARTED_PATH",
        "STARTED_SEARCH",
        "STATIC_TREE",
        "TRIANGLE_TREE",
        "ASKED_APART",
        "CLOTH_TREE",
        "NORMAL_TREE",
        "FOUND_PAIR",
        "FOUND_PAIR_NUMBERS",
    }
    without = {name for name, table in vars(t).items() if isinstance(table, t.Table) and table.width > 1} - names
    assert without == {*as_another, "COLLIDERS", "VIEW"}  # whose columns are kinds of shapes, and words of the block


def test_what_every_step_writes_of_a_manifold_is_one_cache_line():
    written = (contacts.NORMAL_IMPULSE, contacts.FRICTION_IMPULSE, contacts.TWIST_IMPULSE)
    assert {column // 8 for column in written} == {contacts.NORMAL_IMPULSE // 8}
    assert contacts.NORMAL_IMPULSE % 8 == 0
    assert t.MANIFOLD.width % 8 == 0


def test_fields_that_sweeps_read_come_before_what_they_are_made_of():
    read = (
        contacts.N,
        contacts.T,
        contacts.CENTRE,
        contacts.BETWEEN,
        contacts.FRICTION_MASS,
        contacts.TANGENT_IMPULSE,
        contacts.P,
    )
    made_of = (contacts.ANCHORS, contacts.AXES, contacts.SHARE, contacts.COUNT)
    assert max(read) < min(made_of)
    assert contacts.P + 4 * contacts.POINT_FIELDS == contacts.ANCHORS


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


def test_columns_over_others_are_said_to_be(monkeypatch):
    table = t.Table(10**6, 8)
    monkeypatch.setitem(DECLARED, table.place, [])
    first, second = column(table, 2), column(table, 3)
    assert column(table, 2, "N", over=second) == second
    assert column(table) == 5  # after what is declared over another thing, the next ones are as before
    assert [c.over for c in DECLARED[table.place]] == [False, False, True, False]
    with pytest.raises(ArgumentError, match=r"3 columns .* over those at 0, which are 2"):
        column(table, 3, over=first)
    with pytest.raises(ArgumentError, match="over those at 3, which are 0"):
        column(table, 1, over=3)


def test_fields_follow_each_other_until_their_number_is_known():
    fields = Fields()
    assert [fields.field(3, "m"), fields.field(), fields.field(2)] == [0, 3, 4]
    assert [c.unit for c in fields.declared] == ["m", "", ""]
    assert fields.close() == 6
    with pytest.raises(ArgumentError, match="after `close`"):
        fields.field()


def test_what_has_a_linear_and_an_angular_part_has_both_where_all_others_have_them():
    linear = [
        layout.POSITION,
        layout.VELOCITY,
        layout.DISPLACEMENT,
        layout.LOAD_FORCE,
        layout.SUBSTEP_FORCE,
        KICKED_VELOCITY,
    ]
    angular = [
        layout.ORIENTATION,
        layout.ANGULAR_VELOCITY,
        layout.ROTATION,
        layout.LOAD_TORQUE,
        layout.SUBSTEP_TORQUE,
        KICKED_ANGULAR_VELOCITY,
    ]
    assert set(linear) == {LINEAR_PART}
    assert set(angular) == {ANGULAR_PART}

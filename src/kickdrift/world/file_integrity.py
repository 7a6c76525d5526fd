"""Checks of the tables read from a file, since compiled code trusts every index in them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.world import settings as s
from kickdrift.world.collision.broad_phase.filters_and_sensors import HIGH_BODY, LOW_BODY
from kickdrift.world.collision.broad_phase.search_state import NEW, SOUGHT_ANEW
from kickdrift.world.collision.narrow_phase.pair_dispatch import PAIRS
from kickdrift.world.contacts import layout as c
from kickdrift.world.deformables.integrity import check_cloths
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.joint_kinds import KINDS as JOINT_KINDS
from kickdrift.world.layout import (
    AWAKE,
    BEGINS,
    BODY_KIND,
    BODY_ROW,
    DYNAMIC,
    FIRST_BODY,
    FROM_SENSOR,
    HEAP,
    HEAP_SIZE,
    IN_HEAP,
    REMOVED,
    SEARCH_STATE,
    SECOND_BODY,
    SHAPE_KIND,
    SIZE,
    SLEEP_ISLAND,
    STATIC,
)
from kickdrift.world.shapes.record import SOLID, SURFACE
from kickdrift.world.shapes.shape_kinds import KINDS, met_as
from kickdrift.world.shapes.triangle import triangles_of
from kickdrift.world.solver_settings import MOST_SUBSTEPS
from kickdrift.world.step.status import EXPECTED_HALVINGS, MOST_HALVINGS, OK, STATUS
from kickdrift.world.table_checks import FileTables

_OF_BODIES = ("MOTION", "INVERSE_MASS", "INERTIA", "LOAD", "RESTED", "KICKED", "PREDICTED", "BODY")
_STATES = c.TOUCHING | c.SENSOR | c.BOUNCED | c.FAST | c.MOVING | c.JUST_LANDED | c.JUST_FOUND
_SETTINGS = s.RESIDUAL  # columns before this one are settings


def check(tables: Mapping[str, NDArray[Any]]) -> None:
    """Check the tables of a world.

    Parameters
    ----------
    tables : mapping of str to array
        As in `kickdrift.world.snapshot.Snapshot`: those of shapes are already made from the records of the file, those of
        articulations are not made yet.

    Raises
    ------
    ValueError
        If an index in them is out of range, or a number is invalid or inconsistent with others.
    """
    rows = FileTables(tables)
    _check_bodies(rows)
    _check_shapes(rows)
    _check_contacts(rows)
    _check_joints(rows)
    _check_settings(rows)
    check_cloths(rows)


def _check_bodies(rows: FileTables) -> None:
    count = len(rows["POSE"])
    for name in _OF_BODIES:
        rows.count(name, count)
    if count == 0:
        raise ValueError("table POSE has no row for the ground")
    rows.within("BODY", BODY_KIND, REMOVED, DYNAMIC)
    rows.within("BODY", BODY_KIND, STATIC, STATIC, of=slice(1))
    rows.within("BODY", AWAKE, 0, 1)
    rows.within("BODY", IN_HEAP, 0, 1)
    rows.within("BODY", SLEEP_ISLAND, 0, count - 1)
    rows.within("BODY", HEAP, 0, count - 1)
    rows.within("BODY", HEAP_SIZE, 0, count)
    rows.within("INVERSE_MASS", 0, 0, 0, size=7, of=rows["BODY"][:, BODY_KIND] != DYNAMIC)


def _check_shapes(rows: FileTables) -> None:
    shapes, kinds = rows["SHAPE"], rows["BODY"][:, BODY_KIND]
    rows.count("PLACED", len(shapes))
    rows.count("BOUNDS", len(shapes))
    rows.within("SHAPE", BODY_ROW, 0, len(kinds) - 1)
    rows.within("SHAPE", SEARCH_STATE, NEW, SOUGHT_ANEW)
    there = shapes[:, SHAPE_KIND] >= 0
    rows.holds("SHAPE", BODY_ROW, kinds[shapes[there, BODY_ROW]] != REMOVED)
    sorts = np.array([KINDS[kind].sort for kind in shapes[there, SHAPE_KIND].tolist()], dtype=np.int64)
    rows.holds("SHAPE", BODY_ROW, (sorts == SOLID) | (kinds[shapes[there, BODY_ROW]] != DYNAMIC))
    known = there & (shapes[:, SEARCH_STATE] != NEW)
    with np.errstate(over="ignore"):
        finite = np.isfinite(np.abs(rows["BOUNDS"][known, :6]).sum(axis=1))
    rows.holds("BOUNDS", 0, finite)


def _check_contacts(rows: FileTables) -> None:
    contacts, shapes, n_bodies = rows["CONTACT"], rows["SHAPE"], len(rows["BODY"])
    rows.count("MANIFOLD", len(contacts))
    for column in (c.SHAPE_A, c.SHAPE_B):
        rows.within("CONTACT", column, 0, len(shapes) - 1)
    for column in (c.BODY_A, c.BODY_B):
        rows.within("CONTACT", column, 0, n_bodies - 1)
    rows.within("CONTACT", c.POINTS, 0, 4)
    rows.within("CONTACT", c.CONTACT_STATE, 0, _STATES)
    for name, columns in (("EVENTS", (FIRST_BODY, SECOND_BODY)), ("EXCLUDED", (LOW_BODY, HIGH_BODY))):
        for column in columns:
            rows.within(name, column, 0, n_bodies - 1)
    rows.within("ASKED_APART", LOW_BODY, 0, n_bodies - 1, size=2)
    rows.within("EVENTS", BEGINS, 0, 1)
    rows.within("EVENTS", FROM_SENSOR, 0, 1)
    # Contacts with a shape that is new or gone are removed by the next step before it uses them.
    one, two = shapes[contacts[:, c.SHAPE_A]], shapes[contacts[:, c.SHAPE_B]]
    stays = (one[:, [SHAPE_KIND, SEARCH_STATE]] >= (0, SOUGHT_ANEW - 1)).all(axis=1)
    stays &= (two[:, [SHAPE_KIND, SEARCH_STATE]] >= (0, SOUGHT_ANEW - 1)).all(axis=1)
    contacts, one, two = contacts[stays], one[stays], two[stays]
    rows.holds("CONTACT", c.BODY_A, contacts[:, c.BODY_A] == one[:, BODY_ROW])
    rows.holds("CONTACT", c.BODY_B, contacts[:, c.BODY_B] == two[:, BODY_ROW])
    rows.holds("CONTACT", c.BODY_B, contacts[:, c.BODY_A] != contacts[:, c.BODY_B])
    kinds = zip(one[:, SHAPE_KIND].tolist(), two[:, SHAPE_KIND].tolist(), strict=True)
    rows.holds("CONTACT", c.SHAPE_B, [(met_as(a), b) in PAIRS for a, b in kinds])
    surface = np.array([KINDS[kind].sort == SURFACE for kind in one[:, SHAPE_KIND].tolist()], dtype=np.bool_)
    triangle = contacts[surface, c.TRIANGLE_INDEX]
    rows.holds("CONTACT", c.TRIANGLE_INDEX, (triangle >= 0) & (triangle < triangles_of(one[surface, SIZE])))


def _check_joints(rows: FileTables) -> None:
    joints, kinds = rows["JOINT"], rows["BODY"][:, BODY_KIND]
    rows.count("JOINT_NUMBERS", len(joints))
    rows.count("JOINT_AXES", 6 * len(joints))
    rows.within("JOINT", j.JOINT_KIND, j.REMOVED_JOINT, len(JOINT_KINDS) - 1)
    rows.within("JOINT", j.LINEAR, j.FRAME, j.GEARED)
    rows.within("JOINT", j.ANGULAR, j.RIGID, j.SWING_TWIST)
    rows.within("JOINT", j.PIVOT, 0, 2)
    rows.within("JOINT", j.LOCKED, 0, 63)
    rows.within("JOINT", j.LAWS, 0, 63)
    rows.within("JOINT", j.PRINCIPAL, j.NONE, 5)
    rows.within("JOINT", j.GEARED_JOINTS, 0, max(len(joints) - 1, 0), size=2)
    rows.within("JOINT", j.GEARED_AXES, 0, 5, size=2)
    for column in (j.BODY_A, j.BODY_B):
        rows.within("JOINT", column, 0, len(kinds) - 1)
    there = joints[joints[:, j.JOINT_KIND] != j.REMOVED_JOINT]
    rows.holds("JOINT", j.BODY_B, there[:, j.BODY_A] != there[:, j.BODY_B])
    rows.holds("JOINT", j.BODY_A, kinds[there[:, [j.BODY_A, j.BODY_B]]] != REMOVED)
    rows.holds("JOINT", j.LAWS, there[:, j.LAWS] & there[:, j.LOCKED] == 0)
    rows.holds("JOINT", j.LOCKED, _angles_fit(there))
    gears = there[there[:, j.LINEAR] == j.GEARED]
    geared = joints[gears[:, j.GEARED_JOINTS : j.GEARED_JOINTS + 2]]
    rows.holds("JOINT", j.PRINCIPAL, gears[:, j.PRINCIPAL] >= 0)
    rows.holds("JOINT", j.GEARED_JOINTS, geared[..., j.JOINT_KIND] != j.REMOVED_JOINT)
    rows.holds("JOINT", j.GEARED_JOINTS, geared[..., j.LINEAR] != j.GEARED)


def _angles_fit(joints: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether each joint has as many free angular axes as its measure of angles requires."""
    n_open = sum(1 - (joints[:, j.LOCKED] >> k & 1) for k in range(3, 6))
    fit: NDArray[np.bool_] = np.array([0, 1, 2, 3, 3, 3])[joints[:, j.ANGULAR]] == n_open
    return fit


def _check_settings(rows: FileTables) -> None:
    rows.count("SETTINGS", 1)
    rows.count("STEP_STATUS", 1)
    rows.within("STEP_STATUS", STATUS, OK, OK)
    rows.within("STEP_STATUS", EXPECTED_HALVINGS, 0, MOST_HALVINGS)
    rows.holds("SETTINGS", 0, np.isfinite(rows["SETTINGS"][:, :_SETTINGS]))
    rows.within("SETTINGS", s.SUBSTEPS, 1, MOST_SUBSTEPS)
    rows.holds("SETTINGS", s.SUBSTEPS, rows["SETTINGS"][0, s.SUBSTEPS] % 1.0 == 0.0)
    rows.holds("SETTINGS", s.MARGIN, rows["SETTINGS"][0, [s.MARGIN, s.SLOP]] > 0.0)
    pressed = rows["MANIFOLD"][:, c.NORMAL_IMPULSE : c.NORMAL_IMPULSE + 4].any()
    rows.holds("SETTINGS", s.LAST_SUBSTEP, 0.0 < rows["SETTINGS"][0, s.LAST_SUBSTEP] < np.inf or not pressed)
    for column in (s.UNSOLVED_BODY, s.FAST_BODY, s.MISSED_BODY):
        rows.within("SETTINGS", column, 0, len(rows["BODY"]) - 1)

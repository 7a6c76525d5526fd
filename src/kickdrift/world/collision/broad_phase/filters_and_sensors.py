"""Which shapes may touch: by bodies, layers, joints and pairs that users exclude; sensors touch without being solid."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.broad_phase.search_state import filters_changed
from kickdrift.world.columns import column
from kickdrift.world.contacts.layout import CONTACT_STATE, POINTS, SENSOR
from kickdrift.world.joints import layout
from kickdrift.world.layout import BODY_KIND, BODY_ROW, DYNAMIC, IS_SENSOR, LAYER, MASK
from kickdrift.world.tables import ASKED_APART, BODY, EXCLUDED, JOINT, SHAPE, Tables, integers, rows

# Columns of EXCLUDED and ASKED_APART: pairs of bodies
LOW_BODY = column(EXCLUDED)  # the one whose row is lower
HIGH_BODY = column(EXCLUDED)


@compiled
def may_touch(world: int, a: int, b: int) -> bool:
    """Whether two shapes may touch: one body is dynamic, not excluded, layers collide, and not both are sensors."""
    shapes, bodies = integers(world, SHAPE), integers(world, BODY)
    i, j = shapes[a, BODY_ROW], shapes[b, BODY_ROW]
    if i == j or (bodies[i, BODY_KIND] != DYNAMIC and bodies[j, BODY_KIND] != DYNAMIC):
        return False
    if shapes[a, LAYER] & shapes[b, MASK] == 0 or shapes[b, LAYER] & shapes[a, MASK] == 0:
        return False
    if shapes[a, IS_SENSOR] != 0 and shapes[b, IS_SENSOR] != 0:
        return False
    return rows(world, EXCLUDED) == 0 or not is_excluded(world, min(i, j), max(i, j))


@compiled(inline=True)
def is_solid(contact: Any, row: int) -> bool:
    """Whether the shapes of a contact push each other: they have points, and neither is a sensor."""
    solid: bool = contact[row, POINTS] != 0 and contact[row, CONTACT_STATE] & SENSOR == 0
    return solid


@compiled
def is_excluded(world: int, i: int, j: int) -> bool:
    """Whether a pair of bodies, the lower row first, is in the sorted table EXCLUDED."""
    pairs = integers(world, EXCLUDED)
    low, high = 0, rows(world, EXCLUDED)
    while low < high:
        middle = (low + high) // 2
        if pairs[middle, LOW_BODY] < i or (pairs[middle, LOW_BODY] == i and pairs[middle, HIGH_BODY] < j):
            low = middle + 1
        else:
            high = middle
    return low < rows(world, EXCLUDED) and pairs[low, LOW_BODY] == i and pairs[low, HIGH_BODY] == j


def exclude(tables: Tables, pairs: ArrayLike) -> None:
    """Exclude pairs of bodies from touching.

    Parameters
    ----------
    tables : Tables
        Of the world.
    pairs : (N, 2) array_like of int
        Rows of bodies, in any order, possibly repeated; they replace all pairs given before.
    """
    given = np.sort(np.asarray(pairs, dtype=np.int64).reshape(-1, 2), axis=1)
    asked = np.unique(given, axis=0)
    tables.resize(ASKED_APART, len(asked))[:] = asked
    part_joined(tables)


def forget(tables: Tables, body: int) -> None:
    """Remove the excluded pairs of a body that is removed, since its row is reused."""
    asked = tables.array(ASKED_APART)
    if (asked == body).any():
        exclude(tables, asked[(asked != body).all(axis=1)].copy())


def part_joined(tables: Tables) -> None:
    """Update EXCLUDED to the pairs of bodies that joints connect or users exclude."""
    joint = tables.array(JOINT)
    held = joint[joint[:, layout.JOINT_KIND] != layout.REMOVED_JOINT][:, [layout.BODY_A, layout.BODY_B]]
    now = {(min(pair), max(pair)) for pair in [*held.tolist(), *tables.array(ASKED_APART).tolist()]}
    before = set(map(tuple, tables.array(EXCLUDED).tolist()))
    if now != before:
        tables.resize(EXCLUDED, len(now))[:] = np.array(sorted(now), dtype=np.int64).reshape(-1, 2)
        filters_changed(tables, [body for pair in before ^ now for body in pair])

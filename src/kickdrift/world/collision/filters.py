"""Which shapes may touch at all: by their bodies, layers, and joints that exclude it."""

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.compilation import compiled
from kickdrift.world.collision.search import filters_changed
from kickdrift.world.flight import DYNAMIC, KIND
from kickdrift.world.joints import layout
from kickdrift.world.tables import BODY, EXCLUDED, JOINT, SHAPE, Tables, integers, rows


@compiled
def may_touch(world: int, a: int, b: int) -> bool:
    """Whether two shapes are on layers that meet, of two bodies one of which forces move, and not both sensors."""
    shapes, bodies = integers(world, SHAPE), integers(world, BODY)
    i, j = shapes[a, 1], shapes[b, 1]
    if i == j or (bodies[i, KIND] != DYNAMIC and bodies[j, KIND] != DYNAMIC):
        return False
    if shapes[a, 4] & shapes[b, 5] == 0 or shapes[b, 4] & shapes[a, 5] == 0:
        return False
    if shapes[a, 6] != 0 and shapes[b, 6] != 0:
        return False
    return rows(world, EXCLUDED) == 0 or not _excluded(world, min(i, j), max(i, j))


@compiled
def _excluded(world: int, i: int, j: int) -> bool:
    """Whether a pair of bodies, the lower one first, is in the sorted table."""
    pairs = integers(world, EXCLUDED)
    low, high = 0, rows(world, EXCLUDED)
    while low < high:
        middle = (low + high) // 2
        if pairs[middle, 0] < i or (pairs[middle, 0] == i and pairs[middle, 1] < j):
            low = middle + 1
        else:
            high = middle
    return low < rows(world, EXCLUDED) and pairs[low, 0] == i and pairs[low, 1] == j


def exclude(tables: Tables, pairs: ArrayLike) -> None:
    """Say which bodies never touch each other.

    Parameters
    ----------
    tables : Tables
        Of the world.
    pairs : (N, 2) array_like of int
        Rows of bodies, in any order and more than once if need be; they replace all that were given before.
    """
    before = {(int(i), int(j)) for i, j in tables.array(EXCLUDED)}
    given = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
    now = {(int(min(pair)), int(max(pair))) for pair in given}
    tables.resize(EXCLUDED, 0)
    if now:
        tables.resize(EXCLUDED, len(now))[:] = sorted(now)
    filters_changed(tables, [body for pair in before ^ now for body in pair])


def part_joined(tables: Tables, before: set[tuple[int, int]]) -> set[tuple[int, int]]:
    """Let bodies that joints hold together pass through each other, and those that none holds any more touch.

    Parameters
    ----------
    tables : Tables
        Of the world.
    before : set of (int, int)
        Rows of bodies that were held together when this was last done, the lower one first.

    Returns
    -------
    set of (int, int)
        Those that are now.
    """
    joint = tables.array(JOINT)
    pairs = joint[joint[:, layout.KIND] != layout.REMOVED][:, [layout.BODY_A, layout.BODY_B]]
    joined = {(min(pair), max(pair)) for pair in pairs.tolist()}
    if joined != before:
        others = {(int(i), int(j)) for i, j in tables.array(EXCLUDED)} - before
        exclude(tables, sorted(others | joined))
    return joined

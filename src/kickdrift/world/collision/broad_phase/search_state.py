"""State of the search for pairs: columns of the one row of `kickdrift.world.tables.SEARCH`, and states of shapes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.world.columns import column
from kickdrift.world.layout import BODY_ROW, SEARCH_STATE
from kickdrift.world.tables import (
    CONTACT,
    FIXTURES,
    MOVERS,
    PLANES,
    SEARCH,
    SHAPE,
    SOUGHT,
    STATIC_TREE,
    TREE,
    TRIANGLE_TREE,
    Tables,
)

# Columns of SEARCH
CHANGED = column(SEARCH)  # whether shapes were added, removed or changed, so that the lists of shapes must be rebuilt
STATIC_CHANGED = column(SEARCH)  # the tree over immovable shapes must be rebuilt
PARTS_CHANGED = column(SEARCH)  # the trees over the triangles of meshes must be rebuilt
MOVERS_CHANGED = column(SEARCH)  # the tree over movable shapes must be rebuilt
LEFT = column(SEARCH)  # how often shapes have left their fat bounds since that tree was built
FITTED = column(SEARCH)  # LEFT at its last refit
REVIEW = column(SEARCH)  # contacts must be checked although no shape has left its fat bounds
VISITS = column(SEARCH)  # tree nodes visited so far
SLOTS = column(SEARCH)  # size of the hash table of contacts, with which SCRATCH begins
SHAPES_AT = column(SEARCH)  # where in SCRATCH the results of tree queries begin
PARTS_AT = column(SEARCH)  # those of queries for the triangles of a mesh
PAIRS_AT = column(SEARCH)  # the new pairs
FOUND = column(SEARCH)  # number of new pairs
TRIES = column(SEARCH)  # how often this step has been repeated: see `missed_contacts`
CONTACTS = column(SEARCH)  # number of contacts at the end of the last search

# Values of CHANGED besides 0
UNSEEN = 1
SEEN = 2  # but the trees are up to date, for queries

# Values of SEARCH_STATE
NEW = 0  # without valid bounds and pairs
AT_HOME = 1  # within its fat bounds, with known pairs
SOUGHT_ANEW = 2  # with new fat bounds, for which pairs must be sought


def shapes_changed(tables: Tables, rows: ArrayLike = ()) -> None:
    """Note that shapes were added or removed, and mark some as new.

    Parameters
    ----------
    tables : Tables
        Of the world.
    rows : array_like of int
        Shapes that were moved other than by a step, whose geometry has changed, or whose body has become movable or immovable.
        Rows of zeros are new already.
    """
    tables.resize(SEARCH, 1)[0, CHANGED] = UNSEEN
    tables.array(SHAPE)[np.asarray(rows, dtype=np.intp), SEARCH_STATE] = NEW


def shapes_new(tables: Tables) -> None:
    """Have all lists and trees of shapes rebuilt from the present shapes and contacts."""
    for table in (MOVERS, FIXTURES, PLANES, SOUGHT, TREE, STATIC_TREE, TRIANGLE_TREE):
        tables.resize(table, 0)
    search = tables.resize(SEARCH, 1)[0]
    search[:] = 0
    search[[CHANGED, STATIC_CHANGED, PARTS_CHANGED, MOVERS_CHANGED]] = UNSEEN
    search[CONTACTS] = tables.count(CONTACT)


def filters_changed(tables: Tables, bodies: ArrayLike) -> None:
    """Note that the filters of some bodies have changed: contacts of their shapes are filtered, and sought again.

    Parameters
    ----------
    tables : Tables
        Of the world.
    bodies : array_like of int
        Rows of bodies.
    """
    tables.resize(SEARCH, 1)[0, CHANGED] = UNSEEN
    shapes = tables.array(SHAPE)
    known = np.isin(shapes[:, BODY_ROW], np.asarray(bodies, dtype=np.intp)) & (shapes[:, SEARCH_STATE] != NEW)
    shapes[known, SEARCH_STATE] = SOUGHT_ANEW

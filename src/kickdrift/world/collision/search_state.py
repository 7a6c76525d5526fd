"""What the search for pairs remembers: columns of the row of `kickdrift.world.tables.SEARCH`, and states of shapes."""

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
CHANGED = column(SEARCH)  # whether shapes have come, gone or changed, so that the lists of them are made again
STATIC_CHANGED = column(SEARCH)  # the tree over those that may not move is built again
PARTS_CHANGED = column(SEARCH)  # the trees over the triangles of meshes are built again
MOVERS_CHANGED = column(SEARCH)  # the tree over those that may move is built again
LEFT = column(SEARCH)  # how often a shape has left its fat bounds since that tree was built
FITTED = column(SEARCH)  # of them, those that its boxes have been drawn around
REVIEW = column(SEARCH)  # contacts are to be looked through although no shape has left its fat bounds
VISITS = column(SEARCH)  # nodes of trees that have been looked at
SLOTS = column(SEARCH)  # of the table of known contacts, with which SCRATCH begins
SHAPES_AT = column(SEARCH)  # where in SCRATCH there is room for the shapes that a tree finds
PARTS_AT = column(SEARCH)  # for the parts of a mesh
PAIRS_AT = column(SEARCH)  # for the pairs that are new
FOUND = column(SEARCH)  # how many of them there are
TRIES = column(SEARCH)  # how often this step has been begun again: see `missed`
CONTACTS = column(SEARCH)  # how many contacts there were at the end of the last search

# Values of CHANGED besides 0
UNSEEN = 1
SEEN = 2  # the trees hold them, for queries

# Values of SEARCH_STATE
NEW = 0  # nothing is known of it
AT_HOME = 1  # in its fat bounds, and its pairs are known
SOUGHT_ANEW = 2  # in fat bounds that are new


def shapes_changed(tables: Tables, rows: ArrayLike = ()) -> None:
    """Note that shapes have come or gone, and which ones count as new.

    Parameters
    ----------
    tables : Tables
        Of the world.
    rows : array_like of int
        Shapes that are in another place than their bodies have brought them to, that have other geometry, or whose
        body may move now and might not before, or the other way round. Rows of zeros need not be named.
    """
    tables.resize(SEARCH, 1)[0, CHANGED] = UNSEEN
    tables.array(SHAPE)[np.asarray(rows, dtype=np.intp), SEARCH_STATE] = NEW


def shapes_new(tables: Tables) -> None:
    """Have all lists and trees of shapes built again from the present shapes and contacts."""
    for table in (MOVERS, FIXTURES, PLANES, SOUGHT, TREE, STATIC_TREE, TRIANGLE_TREE):
        tables.resize(table, 0)
    search = tables.resize(SEARCH, 1)[0]
    search[:] = 0
    search[[CHANGED, STATIC_CHANGED, PARTS_CHANGED, MOVERS_CHANGED]] = UNSEEN
    search[CONTACTS] = tables.count(CONTACT)


def filters_changed(tables: Tables, bodies: ArrayLike) -> None:
    """Note that the shapes of some bodies meet others than before: their contacts are filtered, and searched again.

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

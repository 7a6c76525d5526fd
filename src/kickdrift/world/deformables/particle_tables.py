"""Tables of cloths that a step fills anew: their sizes, and the trees and groups of triangles in them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kickdrift.world import tables as t
from kickdrift.world.collision.broad_phase.bvh import ITEM, SKIP
from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.face_groups import face_groups
from kickdrift.world.deformables.mesh import ClothMesh
from kickdrift.world.deformables.particle_fields import PARTICLES_IN_CHUNK
from kickdrift.world.deformables.self_collision.face_bvh import face_tree, stars
from kickdrift.world.deformables.self_collision.parallel_search import WORKERS

Integers = NDArray[np.int64]

_OF_PARTICLES = (
    t.PARTICLE_SHIFT, t.INTERVAL_START, t.PARTICLE_BOUNDS,
    t.PARTICLE_WIND, t.ZONE, t.ZONE_NUMBERS,
)  # fmt: skip
_OF_FACES = t.FACE_BOUNDS, t.FACE_NORMALS, t.FACE_STARS, t.FACE_TURN
OF_PAIRS = t.CLOTH_SEARCH, t.PARTICLE_PATH, t.CLOTH_PAIR, t.CLOTH_PAIR_NUMBERS
STARTED = t.STARTED_SEARCH, t.STARTED_PATH, t.STARTED_PAIR, t.STARTED_PAIR_NUMBERS  # these when the step began
OF_A_STEP = (
    *_OF_PARTICLES, *_OF_FACES, t.CLOTH_TREE, t.NORMAL_TREE, t.CLOTH_TREE_NODE, t.TREE_NEIGHBOUR,
    t.PARTICLE_LANES, *STARTED, t.FACE_GROUP, t.GROUP_REST, t.GROUP_STRAIN, t.BENDING_SUMS,
    t.SEARCH_TASK, t.FOUND_PAIR, t.FOUND_PAIR_NUMBERS, t.NEAR_PAIR, t.TETHER, t.TETHER_NUMBERS,
)  # fmt: skip


def arrange(tables: t.Tables, meshes: Sequence[ClothMesh]) -> None:
    """Resize the tables, and build the trees and groups of the triangles of all cloths, from their meshes at rest."""
    for own, of in ((_OF_PARTICLES, t.PARTICLE), (_OF_FACES, t.FACE)):
        for table in own:
            tables.resize(table, 0)
            tables.resize(table, tables.count(of))
    for table in (t.FACE_GROUP, t.GROUP_REST, t.GROUP_STRAIN, t.PARTICLE_LANES):
        tables.resize(table, 0)
    tables.resize(t.PARTICLE_LANES, c.LANE_FIELDS * tables.count(t.PARTICLE))[:] = 0.0
    tables.resize(t.BENDING_SUMS, -(-tables.count(t.PARTICLE) // PARTICLES_IN_CHUNK))
    for table in (t.CLOTH_TREE, t.NORMAL_TREE, t.CLOTH_TREE_NODE, t.TREE_NEIGHBOUR):
        tables.resize(table, 0)
    tables.resize(t.VIEW, max(tables.count(t.VIEW), WORKERS))
    for table in (t.PARTICLE_PATH, t.STARTED_PATH):
        tables.resize(table, tables.count(t.PARTICLE))
    for table in (t.CLOTH_SEARCH, t.STARTED_SEARCH):
        tables.resize(table, 1)
    for cloth, mesh in zip(tables.array(t.CLOTH), meshes, strict=True):
        tree, first = face_tree(mesh), tables.count(t.CLOTH_TREE)
        last = first + len(tree.items)
        cloth[[c.FIRST_NODE, c.LAST_NODE]] = first, last
        faces = slice(cloth[c.FIRST_FACE], cloth[c.LAST_FACE])
        tables.array(t.FACE_STARS)[faces, c.NEXT_AROUND : c.NEXT_AROUND + 3] = stars(mesh.triangles) + 3 * faces.start
        for table in (t.CLOTH_TREE, t.NORMAL_TREE):
            nodes = tables.resize(table, last)[first:]
            nodes[:, SKIP], nodes[:, ITEM] = tree.skips, tree.items
            nodes[tree.items >= 0, ITEM] += cloth[c.FIRST_FACE]
        marks, count = tables.resize(t.CLOTH_TREE_NODE, last)[first:], tables.count(t.TREE_NEIGHBOUR)
        marks[:, c.IS_CONNECTED] = tree.connected
        ends = np.searchsorted(tree.neighbours[:, 0], np.arange(len(tree.items) + 1))
        marks[:, c.NEAR_NODES], marks[:, c.NEAR_NODES + 1] = count + ends[:-1], count + ends[1:]
        tables.resize(t.TREE_NEIGHBOUR, count + len(tree.neighbours))[count:] = tree.neighbours[:, 1:]
        cloth[[c.FIRST_GROUP, c.LAST_GROUP]] = tables.count(t.FACE_GROUP)
        if cloth[c.DIMENSION] == c.SHEET:
            _group(tables, cloth)


def _group(tables: t.Tables, cloth: Integers) -> None:
    """Write the groups of the triangles of a sheet, after those of others."""
    faces = slice(cloth[c.FIRST_FACE], cloth[c.LAST_FACE])
    numbers = tables.array(t.FACE_NUMBERS)[faces, c.TO_REST : c.FACE_AREA + 1]
    groups = face_groups(tables.array(t.FACE)[faces, c.CORNERS : c.CORNERS + 3], numbers)
    first, rest = tables.count(t.FACE_GROUP), tables.count(t.GROUP_REST)
    last = first + len(groups.corners)
    cloth[c.LAST_GROUP] = last
    rows = tables.resize(t.FACE_GROUP, last)[first:]
    rows[:, c.GROUP_CORNERS : c.GROUP_CORNERS + 24] = groups.corners.transpose(0, 2, 1).reshape(-1, 24)
    rows[:, c.RESTS], rows[:, c.IN_ROWS] = rest + groups.of, groups.in_rows
    rows[:, c.ADDED_TO : c.ADDED_TO + 3] = np.where(groups.apart, c.FORCES_APART, c.FORCES)
    rows[:, c.AFTER_COLOUR] = first + groups.after
    tables.resize(t.GROUP_REST, rest + len(groups.rests))[rest:] = groups.rests.reshape(-1, 40)
    tables.resize(t.GROUP_STRAIN, last)[first:] = 0.0


def keep_pairs(tables: t.Tables) -> None:
    """Have the next step continue with the pairs of triangles in the tables, if any are known, or else seek them."""
    search = tables.array(t.CLOTH_SEARCH)
    search[search[:, c.SEARCH_STATE] == c.VALID, c.SEARCH_STATE] = c.KEPT


def forget_pairs(tables: t.Tables) -> None:
    """Have the next step seek the pairs of triangles."""
    tables.array(t.CLOTH_SEARCH)[:, c.SEARCH_STATE] = c.INVALID


def forget_motion(tables: t.Tables) -> None:
    """Forget where particles were and which pairs of triangles are known, after particles were added or removed."""
    tables.put(t.STARTED_PARTICLE, tables.array(t.PARTICLE))
    for table in OF_PAIRS:
        tables.resize(table, 0)


def roll_back_pairs(tables: t.Tables) -> None:
    """Restore the pairs of triangles that were known when the step began."""
    for table, started in zip(OF_PAIRS, STARTED, strict=True):
        tables.put(table, tables.array(started))
    keep_pairs(tables)

"""Tables of cloths that a step makes anew: their rows, and the trees in them."""

from collections.abc import Sequence

from kickdrift.world import tables as t
from kickdrift.world.cloth import layout as c
from kickdrift.world.cloth.face_tree import face_tree
from kickdrift.world.cloth.mesh import ClothMesh
from kickdrift.world.collision.bvh import ITEM, SKIP

_OF_PARTICLES = (
    t.PARTICLE_FORCE, t.STARTED_PARTICLE, t.PARTICLE_SHIFT, t.INTERVAL_START, t.PARTICLE_PATH, t.PARTICLE_BOUNDS,
    t.ZONE, t.ZONE_NUMBERS,
)  # fmt: skip
_OF_FACES = t.FACE_BOUNDS, t.FACE_NORMALS, t.FACE_TURN
OF_A_STEP = (
    *_OF_PARTICLES, *_OF_FACES, t.CLOTH_TREE, t.NORMAL_TREE, t.CLOTH_TREE_NODE, t.CLOTH_PAIR,
    t.CLOTH_PAIR_NUMBERS, t.CLOTH_SEARCH,
)  # fmt: skip


def arrange(tables: t.Tables, meshes: Sequence[ClothMesh]) -> None:
    """Give the tables their rows, and build the trees over the triangles of all cloths, as they lie without tension."""
    for own, of in ((_OF_PARTICLES, t.PARTICLE), (_OF_FACES, t.FACE)):
        for table in own:
            tables.resize(table, 0)
            tables.resize(table, tables.count(of))
    tables.array(t.STARTED_PARTICLE)[:] = tables.array(t.PARTICLE)  # where those that sleep are
    for table in (t.CLOTH_TREE, t.NORMAL_TREE, t.CLOTH_TREE_NODE):
        tables.resize(table, 0)
    tables.resize(t.CLOTH_SEARCH, 1)[:] = 0.0
    for cloth, mesh in zip(tables.array(t.CLOTH), meshes, strict=True):
        tree, first = face_tree(mesh), tables.count(t.CLOTH_TREE)
        last = first + len(tree.items)
        cloth[[c.FIRST_NODE, c.LAST_NODE]] = first, last
        for table in (t.CLOTH_TREE, t.NORMAL_TREE):
            nodes = tables.resize(table, last)[first:]
            nodes[:, SKIP], nodes[:, ITEM] = tree.skips, tree.items
            nodes[tree.items >= 0, ITEM] += cloth[c.FIRST_FACE]
        tables.resize(t.CLOTH_TREE_NODE, last)[first:, c.IS_CONNECTED] = tree.connected

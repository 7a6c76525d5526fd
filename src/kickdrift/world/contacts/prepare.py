"""Preparation of the constraints of contacts, in lanes, from their manifolds."""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts import prepare_simd as r
from kickdrift.world.contacts.constraint_groups import group_of, lane_count, new_scratch, put_vector_of, run, vector_of
from kickdrift.world.contacts.constraint_inputs import gather
from kickdrift.world.contacts.graph_colouring import LINKED
from kickdrift.world.contacts.simd_transpose import fetch_rows
from kickdrift.world.contacts.softness import softness
from kickdrift.world.settings import SLOP, STEP, SUBSTEPS
from kickdrift.world.tables import COLOURS, GROUPS, MANIFOLD, SETTINGS, flat_integers, floats, integers, rows

_MANY = 250  # groups, above which manifolds do not fit into a megabyte
_RAW = r.RAW * c.WIDTH


@compiled
def prepare(t: float, h: float, world: int) -> None:
    """Fill the groups with constraints."""
    colours, groups, settings = integers(world, COLOURS), integers(world, GROUPS), floats(world, SETTINGS)
    first, after = colours[0, c.FIRST_GROUP], colours[LINKED, c.AFTER_GROUP]
    slop, substep = settings[0, SLOP], settings[0, STEP] / settings[0, SUBSTEPS]
    raw, scratch = carray(floats_on_stack(_RAW), (_RAW,)), new_scratch()
    soft, softer = softness(world, True), softness(world, False)
    for k in range(r.SCRATCH_SIZE):
        scratch[k] = 0.0
    numbers, many, n = flat_integers(world, GROUPS), rows(world, GROUPS) > _MANY, lane_count(world)
    for g in range(first, after):
        if many and g + 1 < after:
            for k in range(0, MANIFOLD.width, 8):  # one cache line each
                fetch_rows(floats(world, MANIFOLD), k, numbers, GROUPS.width * (g + 1) + c.GROUP_CONTACTS)
        for lane in range(n):
            scratch[r.MARK * c.WIDTH + lane] = 1.0
            row = groups[g, c.GROUP_CONTACTS + lane]
            if row >= 0:
                gather(world, row, soft, softer, raw[lane:], scratch[lane:])
                continue
            for k in range(r.RAW):
                raw[k * c.WIDTH + lane] = 0.0
            for k in range(r.INERTIA_A, r.MARK):
                scratch[k * c.WIDTH + lane] = 0.0
        own = group_of(world, g)
        run(world, c.FILL, own, raw, substep, 0.0, 0.0)
        for lane in range(n):
            if raw[r.TURNS * c.WIDTH + lane] > 0.0:
                _write_cores(own[lane:], raw[lane:])
        run(world, c.REFRESH, own, scratch, slop, 0.0, 0.0)
        run(world, c.REFRESH_FRICTION, own, scratch, 0.0, 0.0, 0.0)


@compiled(inline=True)
def _write_cores(own: Any, raw: Any) -> None:
    """Write the middles and half axes of the cores of a constraint with a normal that turns."""
    put_vector_of(own, c.CORE_A, vector_of(raw, r.ARM_A))
    put_vector_of(own, c.CORE_B, vector_of(raw, r.ARM_B))
    put_vector_of(own, c.CORE_A + 3, vector_of(raw, r.HALF_A))
    put_vector_of(own, c.CORE_B + 3, vector_of(raw, r.HALF_B))

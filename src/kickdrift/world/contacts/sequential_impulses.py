"""Sequential impulses for contacts: sweeps over the colours, in lanes within a colour.

Soft steps after E. Catto, "Solver2D" (2024): every substep has a pass with a bias that pushes overlapping bodies apart like a
damped spring, and, after the drift, a relaxing pass that applies friction, and removes the velocity of the push by a solution
without this bias. Before the latter, arms are recomputed where bodies have moved.
"""

from collections.abc import Callable

from numba import prange

from kickdrift.core.compilation import compiled, specialise, unbound
from kickdrift.core.vectors import cross, plus, times
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.arm_refresh import gather_for_arms, refresh_marked
from kickdrift.world.contacts.body_gather_simd import add_changes, fetch, gather, gather_inertia, scatter
from kickdrift.world.contacts.constraint_groups import constraint, group_of, new_scratch, run, vector_of
from kickdrift.world.contacts.graph_colouring import LINKED, OVERFLOW, is_linked
from kickdrift.world.contacts.prepare_simd import DELTA_POSE_A, VELOCITY_A
from kickdrift.world.settings import PUSH_SPEED, SLOP
from kickdrift.world.tables import COLOURS, CONTACT, DELTA_POSE, GROUPS, MANIFOLD, MOTION, SETTINGS, floats, integers

_W = c.WIDTH

_TOUCHING = 1e-6  # of the slop: depth from which points count as touching, above rounding
_FEWEST = 16  # groups of a colour from which on a parallel region, of some 10 us, pays off

group: Callable[..., None] = unbound
LAST = OVERFLOW  # colour


def _sweep(t: float, h: float, world: int) -> None:
    """Call `group` on the groups of all colours up to LAST, in parallel for large colours; `specialise` binds both."""
    colours = integers(world, COLOURS)
    for k in range(OVERFLOW):
        first, last = colours[k, c.FIRST_GROUP], colours[k, c.AFTER_GROUP]
        if last - first < _FEWEST:
            for g in range(first, last):
                group(world, h, g)
        else:
            for g in prange(first, last):
                group(world, h, g)
    for k in range(OVERFLOW, LAST + 1):
        for g in range(colours[k, c.FIRST_GROUP], colours[k, c.AFTER_GROUP]):
            group(world, h, g)


@compiled
def _warm_start_group(world: int, h: float, g: int) -> None:
    """Apply the accumulated impulses of a group."""
    motion = floats(world, MOTION)
    own, scratch = group_of(world, g), new_scratch()
    fetch(world, g)
    linked = is_linked(world, g)
    if linked:
        for k in range(12 * _W):
            scratch[VELOCITY_A * _W + k] = 0.0
    else:
        gather(world, g, motion, VELOCITY_A, scratch)
    gather_inertia(world, g, scratch)
    run(world, c.APPLY_IMPULSES, own, scratch, 0.0, 0.0, 0.0)
    if linked:
        add_changes(world, g, motion, scratch)
    else:
        scatter(world, g, motion, scratch)


@compiled
def _solve_group(world: int, h: float, g: int) -> None:
    """Do the soft sweep over the normals of a group."""
    motion = floats(world, MOTION)
    own, scratch = group_of(world, g), new_scratch()
    fetch(world, g)
    push = floats(world, SETTINGS)[0, PUSH_SPEED]
    gather(world, g, motion, VELOCITY_A, scratch)
    gather(world, g, floats(world, DELTA_POSE), DELTA_POSE_A, scratch)
    gather_inertia(world, g, scratch)
    run(world, c.SOLVE_NORMALS, own, scratch, 1.0 / h, 1.0, push)
    scatter(world, g, motion, scratch)


@compiled
def _relax_group(world: int, h: float, g: int) -> None:
    """Recompute stale arms of a group, and do the rigid sweep over its friction and normals."""
    motion = floats(world, MOTION)
    own, scratch = group_of(world, g), new_scratch()
    fetch(world, g)
    gather_for_arms(world, g, scratch)
    run(world, c.FIND_STALE, own, scratch, 0.0, 0.0, 0.0)
    refresh_marked(world, h, g, own, scratch)
    if is_linked(world, g):  # the direct solver finds its impulses
        return
    least = _TOUCHING * floats(world, SETTINGS)[0, SLOP]
    run(world, c.SOLVE_FRICTION, own, scratch, 0.0, 0.0, 0.0)
    run(world, c.SOLVE_NORMALS, own, scratch, 1.0 / h, 0.0, least)
    scatter(world, g, motion, scratch)


# Apply the impulses of the last substep.
warm_start = compiled(specialise(_sweep, "warm_start", group=_warm_start_group, LAST=LINKED))
# Keep bodies apart, and push apart those that overlap.
solve = compiled(specialise(_sweep, "solve", group=_solve_group))
# Recompute arms; solve friction, torsion and rolling resistance; then remove the velocity of the push.
relax = compiled(specialise(_sweep, "relax", group=_relax_group, LAST=LINKED))

# The same on Numba's threads, with the same bits: no two contacts of a colour move the same body.
THREADED = {
    warm_start: compiled(parallel=True)(
        specialise(_sweep, "warm_start_threaded", group=_warm_start_group, LAST=LINKED)
    ),
    solve: compiled(parallel=True)(specialise(_sweep, "solve_threaded", group=_solve_group)),
    relax: compiled(parallel=True)(specialise(_sweep, "relax_threaded", group=_relax_group, LAST=LINKED)),
}


@compiled
def store(t: float, h: float, world: int) -> None:
    """Store the impulses in the manifolds, for warm starting the next step."""
    groups, manifold = integers(world, GROUPS), floats(world, MANIFOLD)
    contact, colours = integers(world, CONTACT), integers(world, COLOURS)
    for g in range(colours[0, c.FIRST_GROUP], colours[LINKED, c.AFTER_GROUP]):
        for lane in range(_W):
            row = groups[g, c.GROUP_CONTACTS + lane]
            if row < 0:
                continue
            own = constraint(world, row)
            for k in range(contact[row, c.POINTS]):
                impulse = own[(c.P + c.POINT_FIELDS * k + c.IMPULSE) * _W]
                manifold[row, c.NORMAL_IMPULSE + k] = impulse
            first = vector_of(own, c.T)
            d1, d2 = own[c.TANGENT_IMPULSE * _W], own[(c.TANGENT_IMPULSE + 1) * _W]
            friction = plus(times(d1, first), times(d2, cross(vector_of(own, c.N), first)))
            for k in range(3):
                manifold[row, c.FRICTION_IMPULSE + k] = friction[k]
            manifold[row, c.TWIST_IMPULSE] = own[c.TWISTING_IMPULSE * _W]
            contact[row, c.CONTACT_STATE] &= ~(c.MOVING | c.JUST_LANDED)
            if own[c.REFRESHED * _W] > 0.0:
                contact[row, c.CONTACT_STATE] |= c.MOVING
            if own[c.LANDED * _W] > 0.0:
                contact[row, c.CONTACT_STATE] |= c.JUST_LANDED
            if own[c.ROLL_RESISTANCE * _W] > 0.0:
                for k in range(3):
                    manifold[row, c.ROLLING_IMPULSE + k] = own[(c.ROLL_IMPULSE + k) * _W]

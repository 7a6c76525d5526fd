"""Sequential impulses for contacts: sweeps over the colours, in lanes within a colour.

Soft steps after E. Catto, "Solver2D" (2024): every substep has a pass with a bias that pushes overlapping bodies apart like a
damped spring, and, after the drift, a relaxing pass without bias that removes the velocity of the push and applies friction.
Before the latter, arms are recomputed where bodies have moved.
"""

from collections.abc import Callable
from typing import Any

from numba import carray, prange

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled, specialise, unbound
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import conjugate, product
from kickdrift.world.columns import quaternion_at
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.colouring import LINKED, OVERFLOW
from kickdrift.world.contacts.contact_solver_simd import KERNEL
from kickdrift.world.contacts.effective_mass_simd import SLIP_STRICTNESS, TWIST_STRICTNESS
from kickdrift.world.contacts.prepare_simd import (
    DELTA_POSE_A,
    FROM_A_TO_B,
    INERTIA_A,
    INERTIA_B,
    MARK,
    SCRATCH_SIZE,
    TURNED_A,
    TURNED_B,
    VELOCITY_A,
    VELOCITY_B,
)
from kickdrift.world.contacts.transpose import fetch_rows, gather_rows, scatter_rows
from kickdrift.world.layout import INVERSE_INERTIA_IN_WORLD, ORIENTATION, POSITION, VELOCITY
from kickdrift.world.settings import PUSH_SPEED, SLOP
from kickdrift.world.tables import (
    COLOURS,
    CONTACT,
    DELTA_POSE,
    GROUPS,
    INVERSE_MASS,
    KERNEL_ADDRESSES,
    LANES,
    MANIFOLD,
    MEMBER,
    MOTION,
    POSE,
    SETTINGS,
    STARTED_POSE,
    flat,
    flat_integers,
    floats,
    integers,
    rows,
)

_W = c.WIDTH
_SIZE = c.FIELDS * _W

_TOUCHING = 1e-6  # of the slop: depth from which points count as touching, above rounding
_MANY = 3000  # bodies of a batch, above which velocities, displacements and inertia do not fit into half a megabyte
_FEWEST = 16  # groups of a colour from which on a parallel region, of some 10 us, pays off

run_kernel = caller(KERNEL)
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
    motion, inverse_mass = floats(world, MOTION), floats(world, INVERSE_MASS)
    lanes, scratch, kernels = (
        flat(world, LANES),
        carray(floats_on_stack(SCRATCH_SIZE), (SCRATCH_SIZE,)),
        integers(world, KERNEL_ADDRESSES),
    )
    _fetch(world, g)
    linked = _is_linked(world, g)
    if linked:
        for k in range(12 * _W):
            scratch[VELOCITY_A * _W + k] = 0.0
    else:
        _gather(world, g, motion, VELOCITY_A, scratch)
    _gather_inertia(world, g, inverse_mass, scratch)
    own, n = lanes[g * _SIZE : (g + 1) * _SIZE], kernels[0, c.LANE_COUNT]
    run_kernel(kernels[0, c.APPLY_IMPULSES], (own, scratch, 1.0 / h, 1.0, 0.0, n))
    if linked:
        _add_changes(world, g, motion, scratch)
    else:
        _scatter(world, g, motion, scratch)


@compiled(inline=True)
def _is_linked(world: int, g: int) -> bool:
    """Whether the contacts of a group are solved directly; several of them may share a movable body."""
    linked: bool = g >= integers(world, COLOURS)[LINKED, c.FIRST_GROUP]
    return linked


@compiled
def _solve_group(world: int, h: float, g: int) -> None:
    """Do the soft sweep over the normals of a group."""
    motion, inverse_mass = floats(world, MOTION), floats(world, INVERSE_MASS)
    lanes, scratch, kernels = (
        flat(world, LANES),
        carray(floats_on_stack(SCRATCH_SIZE), (SCRATCH_SIZE,)),
        integers(world, KERNEL_ADDRESSES),
    )
    _fetch(world, g)
    delta_pose, push, n = floats(world, DELTA_POSE), floats(world, SETTINGS)[0, PUSH_SPEED], kernels[0, c.LANE_COUNT]
    _gather(world, g, motion, VELOCITY_A, scratch)
    _gather(world, g, delta_pose, DELTA_POSE_A, scratch)
    _gather_inertia(world, g, inverse_mass, scratch)
    own = lanes[g * _SIZE : (g + 1) * _SIZE]
    run_kernel(kernels[0, c.SOLVE_NORMALS], (own, scratch, 1.0 / h, 1.0, push, n))
    _scatter(world, g, motion, scratch)


@compiled
def _relax_group(world: int, h: float, g: int) -> None:
    """Recompute stale arms of a group, and do the rigid sweep over its friction and normals."""
    motion, inverse_mass = floats(world, MOTION), floats(world, INVERSE_MASS)
    lanes, scratch, kernels = (
        flat(world, LANES),
        carray(floats_on_stack(SCRATCH_SIZE), (SCRATCH_SIZE,)),
        integers(world, KERNEL_ADDRESSES),
    )
    delta_pose, n = floats(world, DELTA_POSE), kernels[0, c.LANE_COUNT]
    _fetch(world, g)
    _gather(world, g, motion, VELOCITY_A, scratch)
    _gather(world, g, delta_pose, DELTA_POSE_A, scratch)
    _gather_inertia(world, g, inverse_mass, scratch)
    own = lanes[g * _SIZE : (g + 1) * _SIZE]
    _refresh_stale(world, h, g, own, scratch, n)
    if _is_linked(world, g):  # the direct solver finds its impulses
        return
    least = _TOUCHING * floats(world, SETTINGS)[0, SLOP]
    run_kernel(kernels[0, c.SOLVE_FRICTION], (own, scratch, 1.0 / h, 0.0, 0.0, n))
    run_kernel(kernels[0, c.SOLVE_NORMALS], (own, scratch, 1.0 / h, 0.0, least, n))
    _scatter(world, g, motion, scratch)


@compiled
def _refresh_stale(world: int, h: float, g: int, own: Any, scratch: Any, n: int) -> None:
    """Recompute the arms of lanes whose bodies have turned or slid past each other."""
    kernels = integers(world, KERNEL_ADDRESSES)
    run_kernel(kernels[0, c.FIND_STALE], (own, scratch, TWIST_STRICTNESS, SLIP_STRICTNESS, 0.0, n))
    marked = 0.0
    for lane in range(n):
        marked += scratch[MARK * _W + lane]
    if marked == 0.0:
        return
    pose, started, groups = floats(world, POSE), floats(world, STARTED_POSE), integers(world, GROUPS)
    for lane in range(n):
        a, b = groups[g, c.BODIES_A + lane], groups[g, c.BODIES_B + lane]
        _gather_turn(pose, started, a, scratch[TURNED_A * _W + lane :])
        _gather_turn(pose, started, b, scratch[TURNED_B * _W + lane :])
        for k in range(3):
            scratch[(FROM_A_TO_B + k) * _W + lane] = pose[b, POSITION + k] - pose[a, POSITION + k]
    run_kernel(kernels[0, c.REFRESH], (own, scratch, floats(world, SETTINGS)[0, SLOP], h, 0.0, n))
    run_kernel(kernels[0, c.REFRESH_FRICTION], (own, scratch, 0.0, 1.0, 0.0, n))


@compiled(inline=True)
def _gather_turn(pose: Any, started: Any, body: int, scratch: Any) -> None:
    """Store the rotation of a body since the step began, a quaternion."""
    turn = product(quaternion_at(pose, body, ORIENTATION), conjugate(quaternion_at(started, body, ORIENTATION)))
    for k in range(4):
        scratch[k * _W] = turn[k]


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
    groups, lanes, manifold = integers(world, GROUPS), flat(world, LANES), floats(world, MANIFOLD)
    contact, colours = integers(world, CONTACT), integers(world, COLOURS)
    for g in range(colours[0, c.FIRST_GROUP], colours[LINKED, c.AFTER_GROUP]):
        for lane in range(_W):
            row = groups[g, c.GROUP_CONTACTS + lane]
            if row < 0:
                continue
            own = lanes[g * _SIZE + lane : (g + 1) * _SIZE]
            for k in range(contact[row, c.POINTS]):
                impulse = own[(c.P + c.POINT_FIELDS * k + c.IMPULSE) * _W]
                manifold[row, c.NORMAL_IMPULSE + k] = impulse
            n = (own[c.N * _W], own[(c.N + 1) * _W], own[(c.N + 2) * _W])
            u = (own[c.T * _W], own[(c.T + 1) * _W], own[(c.T + 2) * _W])
            d1, d2 = own[c.TANGENT_IMPULSE * _W], own[(c.TANGENT_IMPULSE + 1) * _W]
            manifold[row, c.FRICTION_IMPULSE] = d1 * u[0] + d2 * (n[1] * u[2] - n[2] * u[1])
            manifold[row, c.FRICTION_IMPULSE + 1] = d1 * u[1] + d2 * (n[2] * u[0] - n[0] * u[2])
            manifold[row, c.FRICTION_IMPULSE + 2] = d1 * u[2] + d2 * (n[0] * u[1] - n[1] * u[0])
            manifold[row, c.TWIST_IMPULSE] = own[c.TWISTING_IMPULSE * _W]
            contact[row, c.CONTACT_STATE] &= ~c.MOVING
            if own[c.REFRESHED * _W] > 0.0:
                contact[row, c.CONTACT_STATE] |= c.MOVING
            if own[c.ROLL_RESISTANCE * _W] > 0.0:
                for k in range(3):
                    manifold[row, c.ROLLING_IMPULSE + k] = own[(c.ROLL_IMPULSE + k) * _W]


@compiled
def _fetch(world: int, g: int) -> None:
    """Prefetch the bodies of the group after the next, if there are many; their rows are too scattered for the hardware."""
    if rows(world, MEMBER) < _MANY or g + 2 >= rows(world, GROUPS):
        return
    bodies, begin = flat_integers(world, GROUPS), GROUPS.width * (g + 2)
    for side in (c.BODIES_A, c.BODIES_B):
        fetch_rows(floats(world, MOTION), 0, bodies, begin + side)
        fetch_rows(floats(world, DELTA_POSE), 0, bodies, begin + side)
        fetch_rows(floats(world, INVERSE_MASS), 0, bodies, begin + side)


@compiled(inline=True)
def _gather(world: int, g: int, table: Any, field: int, scratch: Any) -> None:
    """Copy the first six columns of both bodies of every lane to `field`, those of the second body to `field` + 6."""
    bodies = flat_integers(world, GROUPS)
    gather_rows(table, 0, 0, 6, bodies, GROUPS.width * g + c.BODIES_A, scratch, field)
    gather_rows(table, 0, 0, 6, bodies, GROUPS.width * g + c.BODIES_B, scratch, field + 6)


@compiled(inline=True)
def _gather_inertia(world: int, g: int, inverse_mass: Any, scratch: Any) -> None:
    """Copy the inverse inertias of both bodies of every lane."""
    bodies = flat_integers(world, GROUPS)
    gather_rows(inverse_mass, 0, INVERSE_INERTIA_IN_WORLD, 6, bodies, GROUPS.width * g + c.BODIES_A, scratch, INERTIA_A)
    gather_rows(inverse_mass, 0, INVERSE_INERTIA_IN_WORLD, 6, bodies, GROUPS.width * g + c.BODIES_B, scratch, INERTIA_B)


@compiled(inline=True)
def _scatter(world: int, g: int, motion: Any, scratch: Any) -> None:
    """Write the velocities of both bodies of every lane back."""
    bodies = flat_integers(world, GROUPS)
    scatter_rows(motion, bodies, GROUPS.width * g + c.BODIES_A, scratch, VELOCITY_A)
    scatter_rows(motion, bodies, GROUPS.width * g + c.BODIES_B, scratch, VELOCITY_B)


@compiled(inline=True)
def _add_changes(world: int, g: int, motion: Any, scratch: Any) -> None:
    """Add the changes of velocity in scratch to the bodies of every lane, one lane after the other."""
    groups = integers(world, GROUPS)
    for lane in range(_W):
        if groups[g, c.GROUP_CONTACTS + lane] < 0:
            continue
        a, b = groups[g, c.BODIES_A + lane], groups[g, c.BODIES_B + lane]
        for k in range(6):
            motion[a, VELOCITY + k] += scratch[(VELOCITY_A + k) * _W + lane]
            motion[b, VELOCITY + k] += scratch[(VELOCITY_B + k) * _W + lane]

"""The constraints of contacts, solved by sequential impulses over the colours, in lanes within a colour.

Soft steps after E. Catto, "Solver2D" (2024): every substep is a pass with a bias that pushes overlapping bodies apart like a
damped spring, and, after the drift, one without that takes the velocity of the push away again and applies friction.
"""

from typing import Any

from numba import carray

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.lanes import CHANGE_A, INERTIA_A, SCRATCH, SWEEP, VELOCITY_A, VELOCITY_B
from kickdrift.world.settings import PUSH_SPEED
from kickdrift.world.tables import (
    CHANGE,
    CONTACT,
    GROUPS,
    LANES,
    MANIFOLD,
    MOTION,
    RESPONSE,
    SETTINGS,
    SWEEPS,
    flat,
    floats,
    integers,
    rows,
)

_W = c.WIDTH
_SIZE = c.FIELDS * _W
_APPLY_IMPULSES, _SOLVE_NORMALS, _SOLVE_FRICTION, _LANE_COUNT = range(4)

sweep = caller(SWEEP)


@compiled
def warm_start(t: float, h: float, world: int) -> None:
    """Apply the impulses of the last substep."""
    motion, response, groups = floats(world, MOTION), floats(world, RESPONSE), integers(world, GROUPS)
    lanes, scratch, sweeps = flat(world, LANES), carray(floats_on_stack(SCRATCH), (SCRATCH,)), integers(world, SWEEPS)
    n = sweeps[0, _LANE_COUNT]
    for g in range(rows(world, GROUPS)):
        _gather(groups, g, motion, 0, VELOCITY_A, scratch, n)
        _gather(groups, g, response, 1, INERTIA_A, scratch, n)
        own = lanes[g * _SIZE : (g + 1) * _SIZE]
        sweep(sweeps[0, _APPLY_IMPULSES], (own, scratch, 1.0 / h, 1.0, 0.0, n))
        _scatter(groups, g, motion, scratch, n)


@compiled
def solve(t: float, h: float, world: int) -> None:
    """Keep bodies apart, and push apart those that overlap."""
    motion, response, groups = floats(world, MOTION), floats(world, RESPONSE), integers(world, GROUPS)
    lanes, scratch, sweeps = flat(world, LANES), carray(floats_on_stack(SCRATCH), (SCRATCH,)), integers(world, SWEEPS)
    change, push, n = floats(world, CHANGE), floats(world, SETTINGS)[0, PUSH_SPEED], sweeps[0, _LANE_COUNT]
    for g in range(rows(world, GROUPS)):
        _gather(groups, g, motion, 0, VELOCITY_A, scratch, n)
        _gather(groups, g, change, 0, CHANGE_A, scratch, n)
        _gather(groups, g, response, 1, INERTIA_A, scratch, n)
        own = lanes[g * _SIZE : (g + 1) * _SIZE]
        sweep(sweeps[0, _SOLVE_NORMALS], (own, scratch, 1.0 / h, 1.0, push, n))
        _scatter(groups, g, motion, scratch, n)


@compiled
def relax(t: float, h: float, world: int) -> None:
    """Friction, twist and rolling resistance; then take the velocity of the push away.

    Backwards through the groups: with both sweeps in one direction, a pyramid of 210 boxes sways for minutes.
    """
    motion, response, groups = floats(world, MOTION), floats(world, RESPONSE), integers(world, GROUPS)
    lanes, scratch, sweeps = flat(world, LANES), carray(floats_on_stack(SCRATCH), (SCRATCH,)), integers(world, SWEEPS)
    change, n = floats(world, CHANGE), sweeps[0, _LANE_COUNT]
    count = rows(world, GROUPS)
    for back in range(count):
        g = count - 1 - back
        _gather(groups, g, motion, 0, VELOCITY_A, scratch, n)
        _gather(groups, g, change, 0, CHANGE_A, scratch, n)
        _gather(groups, g, response, 1, INERTIA_A, scratch, n)
        own = lanes[g * _SIZE : (g + 1) * _SIZE]
        sweep(sweeps[0, _SOLVE_FRICTION], (own, scratch, 1.0 / h, 0.0, 0.0, n))
        sweep(sweeps[0, _SOLVE_NORMALS], (own, scratch, 1.0 / h, 0.0, 0.0, n))
        _scatter(groups, g, motion, scratch, n)


@compiled
def store(t: float, h: float, world: int) -> None:
    """Keep the impulses for the next step."""
    groups, lanes, manifold = integers(world, GROUPS), flat(world, LANES), floats(world, MANIFOLD)
    contact = integers(world, CONTACT)
    for g in range(rows(world, GROUPS)):
        for lane in range(_W):
            row = groups[g, 2 * _W + lane]
            if row < 0:
                continue
            own = lanes[g * _SIZE + lane : (g + 1) * _SIZE]
            for k in range(contact[row, c.POINTS]):
                impulse = own[(c.P + c.POINT_FIELDS * k + c.IMPULSE) * _W]
                manifold[row, c.POINT + c.POINT_SIZE * k + c.NORMAL_IMPULSE] = impulse
            n = (own[c.N * _W], own[(c.N + 1) * _W], own[(c.N + 2) * _W])
            u = (own[c.T * _W], own[(c.T + 1) * _W], own[(c.T + 2) * _W])
            d1, d2 = own[c.SLID * _W], own[(c.SLID + 1) * _W]
            manifold[row, c.FRICTION_IMPULSE] = d1 * u[0] + d2 * (n[1] * u[2] - n[2] * u[1])
            manifold[row, c.FRICTION_IMPULSE + 1] = d1 * u[1] + d2 * (n[2] * u[0] - n[0] * u[2])
            manifold[row, c.FRICTION_IMPULSE + 2] = d1 * u[2] + d2 * (n[0] * u[1] - n[1] * u[0])
            manifold[row, c.TWIST_IMPULSE] = own[(c.TWIST + 1) * _W]
            for k in range(3):
                manifold[row, c.ROLLING_IMPULSE + k] = own[(c.ROLL + 2 + k) * _W]


@compiled(inline=True)
def _gather(groups: Any, g: int, table: Any, column: int, field: int, scratch: Any, n: int) -> None:
    """Copy six numbers of both bodies of every lane, those of the second six fields further."""
    for lane in range(n):
        a, b = groups[g, lane], groups[g, _W + lane]
        for k in range(6):
            scratch[(field + k) * _W + lane] = table[a, column + k]
            scratch[(field + 6 + k) * _W + lane] = table[b, column + k]


@compiled(inline=True)
def _scatter(groups: Any, g: int, motion: Any, scratch: Any, n: int) -> None:
    for lane in range(n):
        a, b = groups[g, lane], groups[g, _W + lane]
        for k in range(6):
            motion[a, k] = scratch[(VELOCITY_A + k) * _W + lane]
            motion[b, k] = scratch[(VELOCITY_B + k) * _W + lane]

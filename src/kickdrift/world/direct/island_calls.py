"""Functions of islands that stages call by their addresses: each is compiled once, those of joints only if there are any.

Their addresses are in a row of the table `KERNEL_ADDRESSES`; `kickdrift.world.step.kernels` names the functions.
"""

from numba import types

from kickdrift.core.calls import caller
from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c
from kickdrift.world.direct import layout as d
from kickdrift.world.tables import ISLAND, KERNEL_ADDRESSES, integers

_WHOLE, _FLOAT, _TRUTH = types.int64, types.float64, types.boolean
SOLVE = types.boolean(types.intp, _WHOLE, _FLOAT, _FLOAT, _WHOLE, _TRUTH, _TRUTH)
AIM = types.float64(types.intp, _WHOLE, _FLOAT, _WHOLE)
REPAIR = types.none(types.intp, _WHOLE, _FLOAT)

_solve, _aim, _repair = caller(SOLVE), caller(AIM), caller(REPAIR)


@compiled(inline=True)
def solve(world: int, island: int, h: float, ahead: float, task: int, afresh: bool, touched: bool) -> bool:
    """Call `kickdrift.world.direct.active_set.solve_island`."""
    found: bool = _solve(
        integers(world, KERNEL_ADDRESSES)[0, c.SOLVE_EQUATIONS], (world, island, h, ahead, task, afresh, touched)
    )
    return found


@compiled(inline=True)
def aim_island(world: int, island: int, h: float, mode: int) -> float:
    """Call `island_right_hand_sides.aim_joints` if the island has joints; without them nothing is off."""
    if integers(world, ISLAND)[island, d.HAS_JOINTS] == 0:
        return 0.0
    off: float = _aim(integers(world, KERNEL_ADDRESSES)[0, c.AIM_JOINTS], (world, island, h, mode))
    return off


@compiled(inline=True)
def repair(world: int, island: int, h: float) -> None:
    """Call `kickdrift.world.direct.position_correction.correct_poses`, for an island with joints."""
    _repair(integers(world, KERNEL_ADDRESSES)[0, c.REPAIR_POSES], (world, island, h))

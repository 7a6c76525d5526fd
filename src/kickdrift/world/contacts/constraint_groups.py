"""Access to the constraints of groups and of single contacts, and to the kernels that work on groups."""

from typing import Any

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.contact_solver_simd import run_kernel
from kickdrift.world.contacts.prepare_simd import SCRATCH_SIZE
from kickdrift.world.tables import CONTACT, KERNEL_ADDRESSES, LANES, flat, integers


@compiled(inline=True)
def group_of(world: int, g: int) -> Any:
    """Return the fields of the constraints of a group."""
    return flat(world, LANES)[g * c.GROUP_SIZE : (g + 1) * c.GROUP_SIZE]


@compiled(inline=True)
def constraint(world: int, row: int) -> Any:
    """Return the fields of a contact's lane."""
    place = integers(world, CONTACT)[row, c.PLACE_IN_GROUPS]
    begin = place // c.WIDTH * c.GROUP_SIZE + place % c.WIDTH
    return flat(world, LANES)[begin : begin + c.GROUP_SIZE - c.WIDTH + 1]


@compiled(inline=True)
def vector_of(own: Any, field: int) -> Vector:
    """Return three fields of a constraint as a vector; `own` begins at its lane."""
    return (own[field * c.WIDTH], own[(field + 1) * c.WIDTH], own[(field + 2) * c.WIDTH])


@compiled(inline=True)
def put_vector_of(own: Any, field: int, vector: Vector) -> None:
    """Write three fields of a constraint; `own` begins at its lane."""
    own[field * c.WIDTH], own[(field + 1) * c.WIDTH], own[(field + 2) * c.WIDTH] = vector


@compiled(inline=True)
def new_scratch() -> Any:
    """Return scratch memory on the stack, with undefined contents."""
    return carray(floats_on_stack(SCRATCH_SIZE), (SCRATCH_SIZE,))


@compiled(inline=True)
def lane_count(world: int) -> int:
    """Return the number of lanes, which the compiler must not know."""
    count: int = integers(world, KERNEL_ADDRESSES)[0, c.LANE_COUNT]
    return count


@compiled(inline=True)
def run(world: int, kernel: int, own: Any, scratch: Any, x: float, y: float, z: float) -> None:
    """Run a kernel, a column of `KERNEL_ADDRESSES`, on a group; its three numbers are explained in `contact_solver_simd`."""
    run_kernel(integers(world, KERNEL_ADDRESSES)[0, kernel], (own, scratch, x, y, z, lane_count(world)))

"""Vectors in lanes of a group, for the kernels of the contact solver."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import layout as c

W = c.WIDTH
NEXT = c.POINT_FIELDS * W  # distance from a field of a point to the same field of the next


@compiled(fast=True, inline=True)
def vector(array: Any, field: int, lane: int) -> tuple[float, float, float]:
    """Read a vector."""
    i = field * W + lane
    return array[i], array[i + W], array[i + 2 * W]


@compiled(fast=True, inline=True)
def put(array: Any, field: int, lane: int, x: float, y: float, z: float) -> None:
    """Write a vector."""
    i = field * W + lane
    array[i] = x
    array[i + W] = y
    array[i + 2 * W] = z


@compiled(fast=True, inline=True)
def turn(s: Any, inertia: int, lane: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the change of angular velocity by an angular impulse; `inertia` is the field of the inverse inertia."""
    i = inertia * W + lane
    return (
        s[i] * x + s[i + 3 * W] * y + s[i + 4 * W] * z,
        s[i + 3 * W] * x + s[i + W] * y + s[i + 5 * W] * z,
        s[i + 4 * W] * x + s[i + 5 * W] * y + s[i + 2 * W] * z,
    )


@compiled(fast=True, inline=True)
def impulses(own: Any, lane: int) -> tuple[float, float, float, float]:
    """Return the normal impulses of the four points; a loop here would prevent vectorisation of the loop over lanes."""
    i = (c.P + c.IMPULSE) * W + lane
    return own[i], own[i + NEXT], own[i + 2 * NEXT], own[i + 3 * NEXT]

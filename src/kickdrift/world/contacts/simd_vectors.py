"""Vectors in lanes of a group, for the kernels of the contact solver."""

from typing import Any

from kickdrift.core import vectors
from kickdrift.core.compilation import F, compiled
from kickdrift.core.vectors import Vector
from kickdrift.world.contacts import layout as c

W = c.WIDTH
NEXT = c.POINT_FIELDS * W  # distance from a field of a point to the same field of the next


# Inlined by Numba, before the compiler orders the terms of sums: those of a function would be ordered for themselves.
_INLINED = {"inline": "always"}


def _fast(function: F) -> F:
    """Return a function on vectors with fast mathematics, so that the kernels fuse its products and sums with theirs."""
    fast: F = compiled(fast=True, cached=False, options=_INLINED)(getattr(function, "py_func", function))
    return fast


plus, minus, times = _fast(vectors.plus), _fast(vectors.minus), _fast(vectors.times)
dot, cross = _fast(vectors.dot), _fast(vectors.cross)


@compiled(fast=True, inline=True)
def vector(array: Any, field: int, lane: int) -> Vector:
    """Read a vector."""
    i = field * W + lane
    return array[i], array[i + W], array[i + 2 * W]


@compiled(fast=True, inline=True)
def put(array: Any, field: int, lane: int, a: Vector) -> None:
    """Write a vector."""
    i = field * W + lane
    array[i], array[i + W], array[i + 2 * W] = a


@compiled(fast=True, cached=False, options=_INLINED)
def chosen(condition: bool, a: Vector, b: Vector) -> Vector:
    """Return a vector if a condition holds, otherwise another, without a branch, which would prevent vectorisation."""
    return (a[0] if condition else b[0], a[1] if condition else b[1], a[2] if condition else b[2])


@compiled(fast=True, inline=True)
def put_where(condition: bool, array: Any, field: int, lane: int, a: Vector) -> None:
    """Write a vector if a condition holds."""
    put(array, field, lane, chosen(condition, a, vector(array, field, lane)))


@compiled(fast=True, inline=True)
def turn(s: Any, inertia: int, lane: int, a: Vector) -> Vector:
    """Return the change of angular velocity by an angular impulse; `inertia` is the field of the inverse inertia."""
    i = inertia * W + lane
    return (
        s[i] * a[0] + s[i + 3 * W] * a[1] + s[i + 4 * W] * a[2],
        s[i + 3 * W] * a[0] + s[i + W] * a[1] + s[i + 5 * W] * a[2],
        s[i + 4 * W] * a[0] + s[i + 5 * W] * a[1] + s[i + 2 * W] * a[2],
    )


@compiled(fast=True, inline=True)
def impulses(own: Any, lane: int) -> tuple[float, float, float, float]:
    """Return the normal impulses of the four points; a loop here would prevent vectorisation of the loop over lanes."""
    i = (c.P + c.IMPULSE) * W + lane
    return own[i], own[i + NEXT], own[i + 2 * NEXT], own[i + 3 * NEXT]

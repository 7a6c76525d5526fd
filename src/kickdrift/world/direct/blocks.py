"""Blocks of the matrix of an island, six rows of six numbers, in registers."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.spatial import moved, plus_scaled, put_spatial, scaled, spatial_at
from kickdrift.core.vectors import Vector

Block = tuple[Any, Any, Any, Any, Any, Any]


@compiled(inline=True, cached=False, fast=True)
def block_at(m: Any, row: int, at: int) -> Block:
    """Read a block from a row of a table."""
    return (
        spatial_at(m, row, at),
        spatial_at(m, row, at + 6),
        spatial_at(m, row, at + 12),
        spatial_at(m, row, at + 18),
        spatial_at(m, row, at + 24),
        spatial_at(m, row, at + 30),
    )


@compiled(inline=True, cached=False, fast=True)
def put_block(m: Any, row: int, at: int, b: Block) -> None:
    """Write a block into a row of a table."""
    put_spatial(m, row, at, b[0])
    put_spatial(m, row, at + 6, b[1])
    put_spatial(m, row, at + 12, b[2])
    put_spatial(m, row, at + 18, b[3])
    put_spatial(m, row, at + 24, b[4])
    put_spatial(m, row, at + 30, b[5])


@compiled(inline=True, cached=False, fast=True)
def add_scaled(m: Any, row: int, at: int, factor: float, of: Any) -> None:
    """Add a multiple of six numbers to six numbers in a row of a table."""
    put_spatial(m, row, at, plus_scaled(spatial_at(m, row, at), factor, of))


@compiled(inline=True, cached=False, fast=True)
def add_block(m: Any, row: int, at: int, b: Block) -> None:
    """Add a block to the one in a row of a table."""
    add_scaled(m, row, at, 1.0, b[0])
    add_scaled(m, row, at + 6, 1.0, b[1])
    add_scaled(m, row, at + 12, 1.0, b[2])
    add_scaled(m, row, at + 18, 1.0, b[3])
    add_scaled(m, row, at + 24, 1.0, b[4])
    add_scaled(m, row, at + 30, 1.0, b[5])


@compiled(inline=True, cached=False, fast=True)
def move_impulses(b: Block, s: Vector) -> Block:
    """Move the reference point of impulses, the rows of a block, from O to P, with s = O - P."""
    return (
        b[0],
        b[1],
        b[2],
        plus_scaled(plus_scaled(b[3], s[1], b[2]), -s[2], b[1]),
        plus_scaled(plus_scaled(b[4], s[2], b[0]), -s[0], b[2]),
        plus_scaled(plus_scaled(b[5], s[0], b[1]), -s[1], b[0]),
    )


@compiled(inline=True, cached=False, fast=True)
def move_velocities(b: Block, s: Vector) -> Block:
    """Move the reference point of velocities, the columns of a block, from O to P, with s = O - P."""
    return (moved(b[0], s), moved(b[1], s), moved(b[2], s), moved(b[3], s), moved(b[4], s), moved(b[5], s))


@compiled(inline=True, cached=False, fast=True)
def rows_along(m: Any, row: int, at: int, axis: Vector) -> Any:
    """Return the product of an axis with three rows of a block."""
    first = scaled(axis[0], spatial_at(m, row, at))
    return plus_scaled(plus_scaled(first, axis[1], spatial_at(m, row, at + 6)), axis[2], spatial_at(m, row, at + 12))

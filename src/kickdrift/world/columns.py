"""Vectors, quaternions and symmetric matrices in the rows of tables, from some column on."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Symmetric, Vector


@compiled(inline=True, cached=False)
def vector_at(table: Any, row: int, column: int) -> Vector:
    """Three numbers of a row."""
    return (table[row, column], table[row, column + 1], table[row, column + 2])


@compiled(inline=True, cached=False)
def quaternion_at(table: Any, row: int, column: int) -> Quaternion:
    """Four numbers of a row."""
    return (table[row, column], table[row, column + 1], table[row, column + 2], table[row, column + 3])


@compiled(inline=True, cached=False)
def symmetric_at(table: Any, row: int, column: int) -> Symmetric:
    """Six numbers of a row."""
    return (
        table[row, column],
        table[row, column + 1],
        table[row, column + 2],
        table[row, column + 3],
        table[row, column + 4],
        table[row, column + 5],
    )

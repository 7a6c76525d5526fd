"""Collision: which shapes are near each other, and where they touch."""

from collections.abc import Callable
from typing import Any

# By the kinds of two shapes, the lower one first: collide(a, b, pose, margin, manifold) -> number of points.
PAIRS: dict[tuple[int, int], Callable[..., Any]] = {}

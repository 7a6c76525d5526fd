"""Reading poses and writing manifolds in contact functions."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector
from kickdrift.world.contacts.layout import FEATURE, LOAD, NORMAL, ON_A, ON_B, POINT, POINT_SIZE


@compiled(inline=True)
def place(pose: Any) -> Vector:
    """Return the origin of the second shape in the first's frame."""
    return (pose[0], pose[1], pose[2])


@compiled(inline=True)
def turn(pose: Any) -> Quaternion:
    """Return the quaternion that turns the second shape's axes into the first's."""
    return (pose[3], pose[4], pose[5], pose[6])


@compiled(inline=True)
def put_normal(manifold: Any, normal: Vector) -> None:
    """Write the unit vector from the first shape to the second, in the first's frame."""
    manifold[NORMAL], manifold[NORMAL + 1], manifold[NORMAL + 2] = normal


@compiled(inline=True)
def put_load(manifold: Any, load: Vector) -> None:
    """Write where a load acts, on which the choice among many points depends."""
    manifold[LOAD], manifold[LOAD + 1], manifold[LOAD + 2] = load


@compiled(inline=True)
def put_no_load(manifold: Any) -> None:
    """Let the choice among many points not depend on a load."""
    put_load(manifold, (math.nan, math.nan, math.nan))


@compiled(inline=True)
def put_point(manifold: Any, k: int, on_a: Vector, on_b: Vector, feature: int) -> None:
    """Write the k-th point: on the first shape in its frame, on the second in its own, and the id of its features."""
    i = POINT + POINT_SIZE * k
    manifold[i + ON_A], manifold[i + ON_A + 1], manifold[i + ON_A + 2] = on_a
    manifold[i + ON_B], manifold[i + ON_B + 1], manifold[i + ON_B + 2] = on_b
    manifold[i + FEATURE] = feature

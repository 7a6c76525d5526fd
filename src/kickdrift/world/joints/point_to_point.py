"""Joints along the line between a point of one body and a point of the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.world.argument_checks import vector
from kickdrift.world.joints.limits_motors_options import FREE, Axis, is_number
from kickdrift.world.joints.record import Placement, frame_along


def line_placement(anchor_a: ArrayLike, anchor_b: ArrayLike, length: float | None, axis: Axis) -> Placement:
    """Return the placement of a joint whose axis 2 is the line between two points.

    Raises
    ------
    ArgumentError
        For points that coincide, and for a length that is not positive.
    """
    a, b = vector("anchor_a", anchor_a, 3), vector("anchor_b", anchor_b, 3)
    distance = float(np.linalg.norm(b - a))
    if not distance > 0.0:
        raise ArgumentError(
            f"anchor_b={anchor_b!r} coincides with anchor_a; give two distinct points, or use a ball joint if they are"
            " to coincide."
        )
    if length is not None and not (is_number(length) and 0.0 < length < np.inf):
        raise ArgumentError(f"length={length!r} must be positive and finite, in m.")
    frame = frame_along((b - a) / distance)
    return Placement(a, b, frame, (FREE, FREE, axis), line=True, length=length or distance, principal=2)

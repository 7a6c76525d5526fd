"""Joints of planar worlds, whose bodies move at right angles to one direction."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.joints.record import Placement, frame_along
from kickdrift.world.settings import PLANE_NORMAL
from kickdrift.world.tables import SETTINGS, Tables

_OBLIQUE = 1e-6  # square of the sine of an angle up to which directions differ by rounding only


def within_plane(placement: Placement, tables: Tables) -> Placement:
    """Return a joint restricted to the plane in which the bodies of a world move, if it is planar.

    Points connected by a rod or a rope keep their distance across the plane, so that the one within it counts.

    Raises
    ------
    ArgumentError
        For lines and axes of sliding along which nothing can move in the plane.
    """
    normal = tables.array(SETTINGS)[0, PLANE_NORMAL : PLANE_NORMAL + 3]
    if not normal.any() or placement.geared is not None:
        return placement
    if placement.line:
        return _flattened(placement, normal)
    held = sum(float(normal @ placement.frame[:, k]) ** 2 for k in range(3) if placement.linear[k].locked)
    if _OBLIQUE < held < 1.0 - _OBLIQUE:
        axes = ", ".join(_numbers(axis) for axis in placement.frame.T)
        raise ArgumentError(
            f"the linear axes of the joint, {axes}, are oblique to the plane that the world moves in, with"
            f" plane_normal={_numbers(normal)}: bodies that slide along them would leave it. Give axes that lie in the plane"
            " or are at right angles to it."
        )
    return placement


def _flattened(placement: Placement, normal: NDArray[np.float64]) -> Placement:
    way = placement.anchor_b - placement.anchor_a
    deep = float(normal @ way)
    flat = way - deep * normal
    distance, length = float(np.linalg.norm(flat)), placement.length
    if not distance > 1e-9 * abs(deep):
        raise ArgumentError(
            f"anchor_a and anchor_b differ only along plane_normal={_numbers(normal)}, so that the line between them has no"
            " direction in the plane; give two points that are apart in the plane."
        )
    if any(axis.drive is not None for axis in placement.linear) and abs(deep) > _OBLIQUE * distance:
        raise ArgumentError(
            f"the ends of the spring are {abs(deep):.6g} m apart along plane_normal={_numbers(normal)}, but its law holds for"
            " its whole length; give anchors at the same distance from the plane."
        )
    if not length > abs(deep):
        raise ArgumentError(
            f"length={length!r} is too short, as the points are {abs(deep):.6g} m apart along"
            f" plane_normal={_numbers(normal)}; give a larger one."
        )
    return placement._replace(
        anchor_b=placement.anchor_a + flat,
        frame=frame_along(flat / distance),
        length=distance if length == float(np.linalg.norm(way)) else math.sqrt(length * length - deep * deep),
    )


def _numbers(vector: Any) -> str:
    return "(" + ", ".join(f"{number:.4g}" for number in vector) + ")"

"""Frames of shapes in contact functions: rotation matrix by rows (9) and origin (3)."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, matrix


@compiled
def set_frame(frame: Any, pose: Any) -> None:
    """Write the frame of a pose: origin (3) and orientation (4)."""
    _set_turn(frame, (pose[3], pose[4], pose[5], pose[6]))
    frame[9], frame[10], frame[11] = pose[0], pose[1], pose[2]


@compiled(inline=True)
def _set_turn(frame: Any, q: Quaternion) -> None:
    """Write the rotation matrix of a frame."""
    rows = matrix(q)
    frame[0], frame[1], frame[2] = rows[0]
    frame[3], frame[4], frame[5] = rows[1]
    frame[6], frame[7], frame[8] = rows[2]


@compiled
def set_at_rest(frame: Any) -> None:
    """Write the identity frame."""
    for k in range(12):
        frame[k] = 1.0 if k == 0 or k == 4 or k == 8 else 0.0


@compiled(inline=True)
def directed(frame: Any, a: Vector) -> Vector:
    """Convert a direction from the frame to its parent."""
    return (
        frame[0] * a[0] + frame[1] * a[1] + frame[2] * a[2],
        frame[3] * a[0] + frame[4] * a[1] + frame[5] * a[2],
        frame[6] * a[0] + frame[7] * a[1] + frame[8] * a[2],
    )


@compiled(inline=True)
def directed_back(frame: Any, a: Vector) -> Vector:
    """Convert a direction from the parent to the frame."""
    return (
        frame[0] * a[0] + frame[3] * a[1] + frame[6] * a[2],
        frame[1] * a[0] + frame[4] * a[1] + frame[7] * a[2],
        frame[2] * a[0] + frame[5] * a[1] + frame[8] * a[2],
    )


@compiled(inline=True)
def placed(frame: Any, a: Vector) -> Vector:
    """Convert a point from the frame to its parent."""
    b = directed(frame, a)
    return (b[0] + frame[9], b[1] + frame[10], b[2] + frame[11])


@compiled(inline=True)
def placed_back(frame: Any, a: Vector) -> Vector:
    """Convert a point from the parent to the frame."""
    return directed_back(frame, (a[0] - frame[9], a[1] - frame[10], a[2] - frame[11]))


@compiled
def set_frame_back(frame: Any, pose: Any) -> None:
    """Write the frame of the first shape in the second's, from the pose of the second in the first's."""
    _set_turn(frame, (pose[3], -pose[4], -pose[5], -pose[6]))
    frame[9], frame[10], frame[11] = directed(frame, (-pose[0], -pose[1], -pose[2]))

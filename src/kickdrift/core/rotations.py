"""Rotations for the interpreter: arrays of quaternions (w, x, y, z), one or many at once.

Compiled code has its own in `kickdrift.core.vectors`, in registers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])  # of the axes x, y, z


def turned(q: ArrayLike, a: ArrayLike) -> Floats:
    """Turn vectors (..., 3) by quaternions (..., 4)."""
    q, a = np.asarray(q), np.asarray(a)
    u = q[..., 1:]
    t = 2.0 * cross(u, a)
    result: Floats = a + q[..., :1] * t + cross(u, t)
    return result


def cross(a: Floats, b: Floats) -> Floats:
    """Multiply vectors (..., 3), with the bits of np.cross, which takes five times as long for a few of them."""
    result: Floats = a.take(_NEXT, -1) * b.take(_LAST, -1)
    result -= a.take(_LAST, -1) * b.take(_NEXT, -1)
    return result


def product(p: Floats, q: Floats) -> Floats:
    """Multiply quaternions (..., 4)."""
    w = p[..., :1] * q[..., :1] - np.sum(p[..., 1:] * q[..., 1:], axis=-1, keepdims=True)
    v = p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + cross(p[..., 1:], q[..., 1:])
    return np.concatenate((w, v), axis=-1)


def turn_to(direction: Floats) -> Floats:
    """Return a quaternion that turns the z axis into a unit vector."""
    x, y, z = direction
    if z >= 0.0:
        w = np.sqrt(0.5 * (1.0 + z))
        return np.array([w, -0.5 * y / w, 0.5 * x / w, 0.0])
    across = np.hypot(x, y)
    if across < np.finfo(np.float64).tiny:  # whose direction is lost to rounding
        return np.array([0.0, 1.0, 0.0, 0.0])
    sine = np.sqrt(0.5 * (1.0 - z))  # of half the angle; the cosine by 1 + z would cancel
    return np.array([0.5 * across / sine, -sine * (y / across), sine * (x / across), 0.0])


def about(axis: ArrayLike, angle: float) -> Floats:
    """Return the quaternion of a turn about a unit vector."""
    return np.concatenate(([np.cos(angle / 2)], np.sin(angle / 2) * np.asarray(axis)))


def matrices(q: ArrayLike) -> Floats:
    """Return the rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    w, x, y, z = np.moveaxis(np.asarray(q), -1, 0)
    rows = (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip
    return np.stack(rows, axis=-1).reshape(*np.shape(w), 3, 3)


def of_matrix(matrix: Floats) -> Floats:
    """Return the quaternion of a (3, 3) rotation matrix.

    The matrix holds the ten products of its components in pairs; they are divided by the largest one.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = matrix
    products = np.array(
        (
            (1.0 + xx + yy + zz, zy - yz, xz - zx, yx - xy),
            (zy - yz, 1.0 + xx - yy - zz, xy + yx, xz + zx),
            (xz - zx, xy + yx, 1.0 - xx + yy - zz, yz + zy),
            (yx - xy, xz + zx, yz + zy, 1.0 - xx - yy + zz),
        )
    )
    row = products[np.argmax(np.diag(products))]
    result: Floats = row / np.sqrt(row @ row)
    return result

"""Rotations of many bodies at once: arrays of quaternions (w, x, y, z)."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def turned(q: Floats, a: Floats) -> Floats:
    """Turn vectors (..., 3) by quaternions (..., 4)."""
    u = q[..., 1:]
    t = 2.0 * np.cross(u, a)
    result: Floats = a + q[..., :1] * t + np.cross(u, t)
    return result


def product(p: Floats, q: Floats) -> Floats:
    """Multiply quaternions (..., 4)."""
    w = p[..., :1] * q[..., :1] - np.sum(p[..., 1:] * q[..., 1:], axis=-1, keepdims=True)
    v = p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + np.cross(p[..., 1:], q[..., 1:])
    return np.concatenate((w, v), axis=-1)


def turn_to(direction: Floats) -> Floats:
    """Return a quaternion that turns the z axis into a unit vector."""
    x, y, z = direction
    if z < -0.999999999:
        return np.array([0.0, 1.0, 0.0, 0.0])
    w = np.sqrt(0.5 * (1.0 + z))
    return np.array([w, -0.5 * y / w, 0.5 * x / w, 0.0])

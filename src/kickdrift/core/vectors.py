"""Vectors, quaternions and symmetric matrices of three dimensions for compiled code, as tuples.

Tuples stay in registers: a vector is (x, y, z), a unit quaternion (w, x, y, z) turns a body's axes into the world's, and a
symmetric matrix is (xx, yy, zz, xy, xz, yz).
"""

import math

from kickdrift.core.compilation import compiled

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Symmetric = tuple[float, float, float, float, float, float]


@compiled(inline=True)
def plus(a: Vector, b: Vector) -> Vector:
    """Sum."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@compiled(inline=True)
def minus(a: Vector, b: Vector) -> Vector:
    """Difference."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@compiled(inline=True)
def times(factor: float, a: Vector) -> Vector:
    """Multiple."""
    return (factor * a[0], factor * a[1], factor * a[2])


@compiled(inline=True)
def dot(a: Vector, b: Vector) -> float:
    """Inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled(inline=True)
def cross(a: Vector, b: Vector) -> Vector:
    """Outer product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@compiled(inline=True)
def length(a: Vector) -> float:
    """Euclidean norm."""
    return math.sqrt(dot(a, a))


@compiled(inline=True)
def normal_to(a: Vector) -> Vector:
    """Return a unit vector at right angles to a unit vector, continuous but for two places."""
    if abs(a[2]) < 0.7:
        size = math.sqrt(a[0] * a[0] + a[1] * a[1])
        return (-a[1] / size, a[0] / size, 0.0)
    size = math.sqrt(a[1] * a[1] + a[2] * a[2])
    return (0.0, -a[2] / size, a[1] / size)


@compiled(inline=True)
def product(p: Quaternion, q: Quaternion) -> Quaternion:
    """Turn by q, then by p."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
        p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1],
    )


@compiled(inline=True)
def conjugate(q: Quaternion) -> Quaternion:
    """Turn back."""
    return (q[0], -q[1], -q[2], -q[3])


@compiled(inline=True)
def unit(q: Quaternion) -> Quaternion:
    """Divide a quaternion by its norm."""
    size = 1.0 / math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return (q[0] * size, q[1] * size, q[2] * size, q[3] * size)


@compiled(inline=True)
def is_scaled(q: Quaternion) -> bool:
    """Whether the length of a quaternion is neither one, but for rounding, nor zero."""
    square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]
    return abs(square - 1.0) > 1e-12 and square > 0.0


@compiled(inline=True)
def matrix(q: Quaternion) -> tuple[Vector, Vector, Vector]:
    """Return the rows of the rotation matrix of a unit quaternion."""
    w, x, y, z = q
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


@compiled(inline=True)
def axes(q: Quaternion) -> tuple[Vector, Vector, Vector]:
    """Return the columns of the rotation matrix of a unit quaternion: a body's axes in the world."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = matrix(q)
    return (xx, yx, zx), (xy, yy, zy), (xz, yz, zz)


@compiled(inline=True)
def turned(q: Quaternion, a: Vector) -> Vector:
    """Turn a vector: from a body's axes to the world's."""
    u = (q[1], q[2], q[3])
    t = times(2.0, cross(u, a))
    return plus(plus(a, times(q[0], t)), cross(u, t))


@compiled(inline=True)
def turned_back(q: Quaternion, a: Vector) -> Vector:
    """Turn a vector back: from the world's axes to a body's."""
    return turned(conjugate(q), a)


@compiled(inline=True)
def exponential(a: Vector) -> Quaternion:
    """Rotation about the direction of a vector by its length."""
    square = 0.25 * dot(a, a)
    if square < 0.01:  # the next terms of both series are below 1e-20, and the functions of the library take longer
        # Times constants: with divisions, the kick of a chain of 20 links takes a sixth longer.
        fourth = square * square
        c = 1.0 / 24.0 - square * (1.0 / 720.0) + fourth * (1.0 / 40320.0 - square * (1.0 / 3628800.0))
        c = 1.0 - (square * 0.5 - fourth * c)
        s = 1.0 / 240.0 - square * (1.0 / 10080.0) + fourth * (1.0 / 725760.0 - square * (1.0 / 79833600.0))
        s = 0.5 - (square * (1.0 / 12.0) - fourth * s)
    else:
        half = math.sqrt(square)
        c = math.cos(half)
        s = 0.5 * math.sin(half) / half
    return (c, s * a[0], s * a[1], s * a[2])


@compiled(inline=True)
def rotation_vector(q: Quaternion) -> Vector:
    """Return the logarithm of a unit quaternion: axis times angle, at most pi long."""
    sign = 1.0 if q[0] >= 0.0 else -1.0
    u = (sign * q[1], sign * q[2], sign * q[3])
    sine = length(u)
    if sine < 1e-9:
        return times(2.0, u)
    return times(2.0 * math.atan2(sine, sign * q[0]) / sine, u)


@compiled(inline=True)
def applied(s: Symmetric, a: Vector) -> Vector:
    """Product of a symmetric matrix and a vector."""
    return (
        s[0] * a[0] + s[3] * a[1] + s[4] * a[2],
        s[3] * a[0] + s[1] * a[1] + s[5] * a[2],
        s[4] * a[0] + s[5] * a[1] + s[2] * a[2],
    )


@compiled(inline=True)
def turned_symmetric(q: Quaternion, s: Symmetric) -> Symmetric:
    """Turn a symmetric matrix: R s R^T."""
    w, x, y, z = q
    r0 = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y))
    r1 = (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x))
    r2 = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    s0, s1, s2 = applied(s, r0), applied(s, r1), applied(s, r2)
    return (dot(r0, s0), dot(r1, s1), dot(r2, s2), dot(r0, s1), dot(r0, s2), dot(r1, s2))


@compiled(inline=True)
def inverse_symmetric(s: Symmetric) -> Symmetric:
    """Inverse of a symmetric matrix that has one."""
    xx = s[1] * s[2] - s[5] * s[5]
    xy = s[4] * s[5] - s[3] * s[2]
    xz = s[3] * s[5] - s[4] * s[1]
    scale = 1.0 / (s[0] * xx + s[3] * xy + s[4] * xz)
    return (
        xx * scale,
        (s[0] * s[2] - s[4] * s[4]) * scale,
        (s[0] * s[1] - s[3] * s[3]) * scale,
        xy * scale,
        xz * scale,
        (s[3] * s[4] - s[0] * s[5]) * scale,
    )

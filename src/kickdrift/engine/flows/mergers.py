"""Bodies that merge on contact, and share one position and one velocity from then on.

So the state keeps its shape, every body its mass, and momentum and centre of mass do not change. Merged bodies are recognised
by their common position. A merged body has the sum of their volumes.

Layout of the merged bodies, for n numbers of N bodies, in vectors of n numbers::

    0, 1      positions and velocities
    2         0 and Gm of each (N + 1), radius of each (N)
    3         of each of the N bodies given, the body that it is part of (N)
"""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.views import part

Floats = NDArray[np.float64]

VECTORS = 4
_ALMOST = 1.1  # of the distance at contact: accuracy of the estimate of the shortest distance within a step
_AT_ONCE = 0.01  # of a step, within which the shortest distance is that at its start, checked already
_SAME = 1e-12  # of the distance at contact: contacts closer than this are one
_BISECTIONS = 40


@compiled(cached=False, inline=True)
def whole(bodies: Floats, index: int, n: int) -> Floats:
    """Return the positions (0) or velocities (1) of the merged bodies."""
    return part(bodies, index * n, n)


@compiled(cached=False, inline=True)
def masses_of(bodies: Floats, n: int, count: int) -> Floats:
    """Return 0 and Gm of each."""
    return part(bodies, 2 * n, 1 + count)


@compiled(cached=False, inline=True)
def radii_of(bodies: Floats, n: int, count: int) -> Floats:
    """Return the radius of each."""
    return part(bodies, 2 * n + 1 + n // 3, count)


@compiled(cached=False)
def put_together(x: Floats, v: Floats, params: Floats, bodies: Floats) -> int:
    """Determine which of the given bodies have merged, and return the number that remains."""
    n, count = x.size, 0
    given = n // 3
    touching = params.size > 2 + 4 * given
    own, there_x, there_v = part(bodies, 3 * n, given), whole(bodies, 0, n), whole(bodies, 1, n)
    masses, radii = masses_of(bodies, n, given), radii_of(bodies, n, given)
    for i in range(given):
        own[i] = count
        if touching:
            for j in range(i):
                if x[3 * i] == x[3 * j] and x[3 * i + 1] == x[3 * j + 1] and x[3 * i + 2] == x[3 * j + 2]:
                    own[i] = min(own[i], own[j])
        at, radius = int(own[i]), params[2 + given + i] if touching else 0.0
        if at < count:
            masses[1 + at], radii[at] = masses[1 + at] + params[2 + i], (radii[at] ** 3 + radius**3) ** (1.0 / 3.0)
            continue
        masses[1 + at], radii[at] = params[2 + i], radius
        for k in range(3):
            there_x[3 * at + k], there_v[3 * at + k] = x[3 * i + k], v[3 * i + k]
        count += 1
    return count


@compiled(cached=False)
def take_apart(bodies: Floats, x: Floats, v: Floats) -> None:
    """Write the state of the bodies given."""
    n = x.size
    own, there_x, there_v = part(bodies, 3 * n, n // 3), whole(bodies, 0, n), whole(bodies, 1, n)
    for i in range(n // 3):
        for k in range(3):
            x[3 * i + k], v[3 * i + k] = there_x[3 * int(own[i]) + k], there_v[3 * int(own[i]) + k]


@compiled(cached=False)
def merge(one: int, other: int, bodies: Floats, n: int, count: int) -> None:
    """Move two bodies to their centre of mass, with its velocity."""
    x, v, masses = whole(bodies, 0, n), whole(bodies, 1, n), masses_of(bodies, n, count)
    total = masses[1 + one] + masses[1 + other]
    share = masses[1 + other] / total if total > 0.0 else 0.5
    for k in range(3):
        x[3 * one + k] += share * (x[3 * other + k] - x[3 * one + k])
        v[3 * one + k] += share * (v[3 * other + k] - v[3 * one + k])
        x[3 * other + k], v[3 * other + k] = x[3 * one + k], v[3 * one + k]


@compiled(cached=False)
def find_contact(h: float, radii: Floats, x: Floats, v: Floats, new_x: Floats, new_v: Floats) -> tuple[float, int, int]:
    """Return the fraction of a step after which two bodies touch, or almost do, 2 if none do; and the two bodies.

    It is that of the shortest distance, by the cubic through positions and velocities at both ends, or 1.
    """
    found, one, other = 2.0, -1, -1
    for i in range(1, radii.size):
        for j in range(i):
            contact, share = radii[i] + radii[j], 2.0
            d2 = e2 = u2 = w2 = closing = opening = 0.0
            for k in range(3):
                d, e = x[3 * i + k] - x[3 * j + k], new_x[3 * i + k] - new_x[3 * j + k]
                u, w = v[3 * i + k] - v[3 * j + k], new_v[3 * i + k] - new_v[3 * j + k]
                d2, e2, u2, w2 = d2 + d * d, e2 + e * e, u2 + u * u, w2 + w * w
                closing, opening = closing + d * u * h, opening + e * w * h
            if e2 < contact * contact:
                share = 1.0
            way = 0.5 * abs(h) * (math.sqrt(u2) + math.sqrt(w2))
            if closing < 0.0 < opening and min(d2, e2) < (_ALMOST * contact + way) ** 2:
                nearest, at = shortest_distance(h, i, j, x, v, new_x, new_v)
                if nearest < contact or (nearest < _ALMOST * contact and at > _AT_ONCE):
                    share = at
            if share < found:
                found, one, other = share, j, i
    return found, one, other


@compiled(cached=False)
def shortest_distance(
    h: float, i: int, j: int, x: Floats, v: Floats, new_x: Floats, new_v: Floats
) -> tuple[float, float]:
    """Return the shortest distance of two bodies that approach and separate within a step, and its fraction of the step."""
    low, high, distance = 0.0, 1.0, 0.0
    for _ in range(_BISECTIONS):
        s = 0.5 * (low + high)
        slope = distance = 0.0
        for k in range(3):
            a, c = x[3 * i + k] - x[3 * j + k], new_x[3 * i + k] - new_x[3 * j + k]
            b, e = h * (v[3 * i + k] - v[3 * j + k]), h * (new_v[3 * i + k] - new_v[3 * j + k])
            cubic, square = b + e - 2.0 * (c - a), 3.0 * (c - a) - 2.0 * b - e
            y = a + s * (b + s * (square + s * cubic))
            slope += y * (b + s * (2.0 * square + 3.0 * s * cubic))
            distance += y * y
        if slope < 0.0:
            low = s
        else:
            high = s
    return math.sqrt(distance), 0.5 * (low + high)


@compiled(cached=False, inline=True)
def gap(radii: Floats, i: int, j: int, x: Floats) -> float:
    """Return the gap between two bodies."""
    d2 = 0.0
    for k in range(3):
        d2 += (x[3 * i + k] - x[3 * j + k]) ** 2
    return float(math.sqrt(d2) - radii[i] - radii[j])


@compiled(cached=False)
def deepest(radii: Floats, one: int, other: int, x: Floats, new_x: Floats) -> tuple[int, int]:
    """Return the bodies that overlap most within a step, apart from two that touch at its end; -1 for none."""
    most, first, second = -_SAME * (radii[one] + radii[other]), -1, -1
    for i in range(1, radii.size):
        for j in range(i):
            now = gap(radii, j, i, new_x)
            if now < most and not (j == one and i == other) and gap(radii, j, i, x) > 0.0:
                most, first, second = now, j, i
    return first, second

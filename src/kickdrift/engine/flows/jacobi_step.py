"""Wisdom-Holman steps in Jacobi coordinates, with the bodies in the current order of their orbits.

States here are positions and velocities of the bodies from 1 on, relative to body 0. In Jacobi coordinates the perturbations of
the Kepler problems are small only as long as bodies are listed by the sizes of their orbits, which change where planets scatter
each other.
"""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.views import part
from kickdrift.engine.flows.kepler import gauss_functions
from kickdrift.systems.jacobi import combine, locate
from kickdrift.systems.splitting import mus, planets, weights

Floats = NDArray[np.float64]

# The energy hardly depends on bodies of a hundredth of the heaviest's mass or less: distances show where their orbits are
# wrong.
_LIGHT, _OF_LIGHT = 0.01, 100.0


@compiled(cached=False)
def sort_by_orbit(x: Floats, v: Floats, masses: Floats, binding: Floats, order: Floats) -> None:
    """Write the binding of each body to body 0, 2 / r - v^2 / Gm_0 = 1 / a, and the bodies from the innermost orbit on."""
    for i in range(1, masses.size - 1):
        r2 = v2 = 0.0
        for k in range(3 * i, 3 * i + 3):
            r2 += x[k] * x[k]
            v2 += v[k] * v[k]
        binding[i] = 2.0 / math.sqrt(r2) - v2 / masses[1]
        at = i
        while at > 1 and binding[i] > binding[int(order[at - 1])]:
            order[at] = order[at - 1]
            at -= 1
        order[at] = i


@compiled(cached=False)
def number(order: Floats, masses: Floats, radii: Floats, numbers: Floats, sizes: Floats) -> None:
    """Write the params of a planetary system with the bodies in this order, and their radii."""
    bodies = masses.size - 1
    n, total = 3 * bodies, masses[1]
    gm, share, mu = planets(n, numbers), weights(n, numbers), mus(n, numbers)
    numbers[0], numbers[1], numbers[2] = 1.0, 0.0, total
    gm[0] = share[0] = mu[0] = 0.0
    for at in range(1, bodies):
        own = masses[1 + int(order[at])]
        total += own
        sizes[at] = radii[int(order[at])]
        numbers[2 + at] = gm[at] = own
        share[at], mu[at] = own / total, total


@compiled(cached=False)
def enter(y: Floats, order: Floats, numbers: Floats, into: Floats) -> None:
    """Write Jacobi coordinates: of positions, or of velocities."""
    share = weights(y.size, numbers)
    cx = cy = cz = 0.0
    for at in range(1, y.size // 3):
        i, k = 3 * int(order[at]), 3 * at
        into[k], into[k + 1], into[k + 2] = y[i] - cx, y[i + 1] - cy, y[i + 2] - cz
        cx, cy, cz = cx + share[at] * into[k], cy + share[at] * into[k + 1], cz + share[at] * into[k + 2]


@compiled(cached=False)
def leave(jacobi: Floats, order: Floats, numbers: Floats, into: Floats) -> None:
    """Undo `enter`."""
    share = weights(jacobi.size, numbers)
    cx = cy = cz = 0.0
    for at in range(1, jacobi.size // 3):
        i, k = 3 * int(order[at]), 3 * at
        into[i], into[i + 1], into[i + 2] = cx + jacobi[k], cy + jacobi[k + 1], cz + jacobi[k + 2]
        cx, cy, cz = cx + share[at] * jacobi[k], cy + share[at] * jacobi[k + 1], cz + share[at] * jacobi[k + 2]


@compiled(cached=False)
def take_word(
    h: float, word: Floats, nearest: float, x: Floats, v: Floats, numbers: Floats, sizes: Floats, room: Floats
) -> bool:
    """Do the letters of a word that begins with a Kepler flow, and return whether the result may be accurate.

    They are not where two bodies come, from one kick to the next, further relative to each other than their distance over
    `nearest`, or one that is light beside the heaviest relative to body 0, around which its Kepler problem is not; or so close
    that they would fall to each other within the step, or within ten if one is light; or nearly touch; or where a Kepler
    problem has no solution.
    """
    n, mu = x.size, mus(x.size, numbers)
    located, before, kicks = part(room, 0, n), part(room, n, n), part(room, 2 * n, n)
    located[0] = located[1] = located[2] = 0.0
    for letter in range(word.size):
        share = word[letter] * h
        if letter % 2 == 0:
            for body in range(1, n // 3):
                if not follow_orbit(share, mu[body], part(x, 3 * body, 3), part(v, 3 * body, 3)):
                    return False
        else:
            for k in range(n):
                kicks[k] = 0.0
            for k in range(n):
                before[k] = located[k]
            locate(x, numbers, located)
            if letter > 1 and not resolved(h, nearest, numbers, sizes, before, located):
                return False
            combine(x, numbers, located, True, kicks)
            for k in range(3, n):
                v[k] += share * kicks[k]
    return True


@compiled(cached=False, fast=True)
def resolved(h: float, nearest: float, numbers: Floats, sizes: Floats, before: Floats, after: Floats) -> bool:
    """Whether pairs of bodies (with body 0 only light ones) are that far apart at two kicks of a step h."""
    light = 0.0
    for i in range(1, after.size // 3):
        light = max(light, _LIGHT * numbers[2 + i])
    for i in range(2, after.size // 3):
        for j in range(0 if numbers[2 + i] <= light else 1, i):
            old = new = way = 0.0
            for k in range(3):
                one, other = before[3 * i + k] - before[3 * j + k], after[3 * i + k] - after[3 * j + k]
                old, new, way = old + one * one, new + other * other, way + (other - one) ** 2
            closest, fall = min(old, new), (numbers[2 + i] + numbers[2 + j]) * h * h
            if not nearest * nearest * way < closest:
                return False
            if j == 0:
                continue
            if min(numbers[2 + i], numbers[2 + j]) <= light:
                fall *= _OF_LIGHT
            free, touch = fall * fall < closest * closest * closest, 2.0 * (sizes[i] + sizes[j])
            if not (free and touch * touch <= closest):
                return False
    return True


@compiled(cached=False, inline=True)
def follow_orbit(h: float, mu: float, x: Floats, v: Floats) -> bool:
    """Advance a body around the centre of its force."""
    x0, x1, x2, v0, v1, v2 = x[0], x[1], x[2], v[0], v[1], v[2]
    r, eta, speed2 = math.sqrt(x0 * x0 + x1 * x1 + x2 * x2), x0 * v0 + x1 * v1 + x2 * v2, v0 * v0 + v1 * v1 + v2 * v2
    f, g, df, dg, trouble = gauss_functions(mu, h, r, eta, speed2)
    x[0], x[1], x[2] = x0 + (f * x0 + g * v0), x1 + (f * x1 + g * v1), x2 + (f * x2 + g * v2)
    v[0], v[1], v[2] = v0 + (df * x0 + dg * v0), v1 + (df * x1 + dg * v1), v2 + (df * x2 + dg * v2)
    return trouble == 0.0

"""Close encounters of planets: a Wisdom-Holman step where that is accurate, otherwise smaller steps or direct integration.

A template, see `kickdrift.engine.flows.kick_drift`. The step is a word of Kepler flows and kicks in Jacobi coordinates, see
`jacobi_step`, if the following holds for the states at its start and at its end:

- from one kick to the next, no two bodies move relative to each other by more than a fraction of their distance, so that none
  pass each other unnoticed, and none are so close that they would fall onto each other within the step;
- the order of their orbits by size is the same;
- the energy is the same up to a fraction of the energies that bind the bodies to body 0, divided among the parts.

Otherwise the step is rejected, and done in three parts, or in nine, which have to meet the same criteria; or else all bodies
are integrated with a far smaller error, see `nystrom`. The criteria are the same for the start and the end, and so a step
back meets the criteria that the step forth meets: the switch is symmetric, as in [1]_ and [2]_, except for steps whose two
results lie on both sides of a limit.

The coefficients are the inverse of the first fraction, the second one, the tolerance of the integration, and the word. Memory
is used within a step only: n numbers each for the functions below, and the room of the integration.

References
----------
.. [1] D. Hernandez, W. Dehnen, Mon. Not. R. Astron. Soc. 522, 4639 (2023).
.. [2] T. Lu, D. Hernandez, H. Rein, Mon. Not. R. Astron. Soc. 533, 3708 (2024).
"""

import math

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled
from kickdrift.core.errors import MethodMismatchError
from kickdrift.core.views import part
from kickdrift.engine.flows.jacobi_step import enter, leave, number, sort_by_orbit, take_word
from kickdrift.engine.flows.layout import EVALUATIONS, FAILED_CONTROL, TAKEN_BACK, TROUBLE, coefficients_at, memory
from kickdrift.engine.flows.mergers import VECTORS, masses_of, merge, put_together, radii_of, take_apart, whole
from kickdrift.engine.flows.nystrom import ROOM, STAGES, integrate, vector

Floats = NDArray[np.float64]

APPROACH, ENERGY, TOLERANCE, WORD = range(4)  # of the coefficients
WORD_SIZE = 17
_VECTORS = 15
# Beside integration at once: three Jupiters that scatter each other take 10 to 40 % less time; 2, 4 and 2, 4, 8 are no better.
_PARTS = (1, 3, 9)


def memory_size(n: int, coefficients: Floats, params: Floats) -> int:
    """Numbers of memory for a state of n numbers."""
    return (VECTORS + _VECTORS + ROOM) * n


def constants(coefficients: Floats, n: int, params: Floats, general: bool) -> dict[str, int]:
    """Refuse systems other than bodies around a heavy one.

    Raises
    ------
    MethodMismatchError
    """
    if n < 6 or n % 3 or params.size not in (2 + 4 * (n // 3), 2 + 5 * (n // 3)):
        raise MethodMismatchError(
            "the method is for bodies that attract each other, whose encounters it detects, and this system is not one"
            " of these; create it with kd.systems.planetary, or use method='blanes-aba-1064'."
        )
    return {}


def encounters(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Advance x and v by h; bodies that touch merge, and the step continues with one body less."""
    n, left, other = x.size, h, 0
    bodies = part(memory(work), 0, VECTORS * n)
    while other >= 0:
        count = put_together(x, v, params, bodies)
        left, one, other = advance(left, params.size > 2 + 4 * (n // 3), count, bodies, n, work)
        if other >= 0:
            merge(one, other, bodies, n, count)
        elif left != 0.0:
            work[TROUBLE] = FAILED_CONTROL
        take_apart(bodies, x, v)


@compiled(cached=False)
def advance(h: float, touching: bool, count: int, bodies: Floats, given: int, work: Floats) -> tuple[float, int, int]:
    """Advance the bodies by h, or until two touch; return the rest of h, and the two bodies."""
    n, own = 3 * count, memory(work)
    asked = part(work, coefficients_at(given), WORD + WORD_SIZE)
    vectors, room = part(own, VECTORS * given, _VECTORS * given), part(own, (VECTORS + _VECTORS) * given, ROOM * n)
    masses, radii = masses_of(bodies, given, count), radii_of(bodies, given, count)
    x, v = part(whole(bodies, 0, given), 0, n), part(whole(bodies, 1, given), 0, n)
    near_x, near_v = part(vectors, 0, n), part(vectors, n, n)
    for parts in _PARTS:
        relate(x, near_x)
        relate(v, near_v)
        done = 0
        while done < parts:
            work[EVALUATIONS] += WORD_SIZE // 2
            if not step_by_word(h / parts, asked[ENERGY] / parts, masses, radii, asked, vectors):
                break
            done += 1
        if done == parts:
            place(h, masses, x, v, near_x, near_v)
            return 0.0, -1, -1
        work[TAKEN_BACK] += parts == 1
    there_x, there_v = vector(room, 0, n), vector(room, 1, n)
    for k in range(n):
        there_x[k], there_v[k] = x[k], v[k]
    steps, left, one, other = integrate(h, asked[TOLERANCE], masses, radii, touching, room)
    work[EVALUATIONS] += STAGES * steps
    for k in range(n):
        x[k], v[k] = there_x[k], there_v[k]
    return left, one, other


@compiled(cached=False)
def step_by_word(h: float, tolerance: float, masses: Floats, radii: Floats, asked: Floats, vectors: Floats) -> bool:
    """Advance the relative state by the word, and return whether that was accurate."""
    bodies = masses.size - 1
    n = 3 * bodies
    x, v = part(vectors, 0, n), part(vectors, n, n)
    jacobi_x, jacobi_v = part(vectors, 2 * n, n), part(vectors, 3 * n, n)
    binding, order = part(vectors, 4 * n, bodies), part(vectors, 5 * n, bodies)
    binding_after, order_after = part(vectors, 6 * n, bodies), part(vectors, 7 * n, bodies)
    numbers, room, sizes = (
        part(vectors, 8 * n, 2 + 4 * bodies),
        part(vectors, 11 * n, 3 * n),
        part(vectors, 14 * n, bodies),
    )
    sort_by_orbit(x, v, masses, binding, order)
    if not passes(x, v, masses, radii):
        return False
    before = energy(x, v, masses)
    number(order, masses, radii, numbers, sizes)
    enter(x, order, numbers, jacobi_x)
    enter(v, order, numbers, jacobi_v)
    if not take_word(h, part(asked, WORD, WORD_SIZE), asked[APPROACH], jacobi_x, jacobi_v, numbers, sizes, room):
        return False
    leave(jacobi_x, order, numbers, x)
    leave(jacobi_v, order, numbers, v)
    sort_by_orbit(x, v, masses, binding_after, order_after)
    if not passes(x, v, masses, radii):
        return False
    scale = scale_after = 0.0
    for i in range(1, bodies):
        if order[i] != order_after[i]:
            return False
        scale += 0.5 * masses[1] * masses[1 + i] * abs(binding[i])
        scale_after += 0.5 * masses[1] * masses[1 + i] * abs(binding_after[i])
    return bool(abs(energy(x, v, masses) - before) <= tolerance * min(scale, scale_after))


@compiled(cached=False)
def passes(x: Floats, v: Floats, masses: Floats, radii: Floats) -> bool:
    """Whether the orbits of all bodies with a radius pass body 0 without touching it."""
    for i in range(1, radii.size):
        contact = 2.0 * (radii[0] + radii[i])
        if contact > 0.0:
            r2 = v2 = xv = 0.0
            for k in range(3 * i, 3 * i + 3):
                r2, v2, xv = r2 + x[k] * x[k], v2 + v[k] * v[k], xv + x[k] * v[k]
            # L^2 = r^2 v^2 - (x.v)^2 is q^2 (v^2 - 2 mu / r) + 2 mu q for the pericentre q, and grows with it.
            if r2 * v2 - xv * xv < contact * (contact * v2 + 2.0 * masses[1] * (1.0 - contact / math.sqrt(r2))):
                return False
    return True


@compiled(cached=False)
def relate(y: Floats, into: Floats) -> None:
    """Write positions or velocities relative to body 0."""
    for k in range(y.size):
        into[k] = y[k] - y[k % 3]


@compiled(cached=False, fast=True)
def energy(x: Floats, v: Floats, masses: Floats) -> float:
    """Return G times the energy of a relative state, without that of the centre of mass."""
    total, whole = 0.0, masses[1]
    px = py = pz = 0.0
    for i in range(1, masses.size - 1):
        m, potential = masses[1 + i], 0.0
        vx, vy, vz = v[3 * i], v[3 * i + 1], v[3 * i + 2]
        for j in range(i):
            dx, dy, dz = x[3 * j] - x[3 * i], x[3 * j + 1] - x[3 * i + 1], x[3 * j + 2] - x[3 * i + 2]
            potential += masses[1 + j] / math.sqrt(dx * dx + dy * dy + dz * dz)
        total += m * (0.5 * (vx * vx + vy * vy + vz * vz) - potential)
        whole, px, py, pz = whole + m, px + m * vx, py + m * vy, pz + m * vz
    return float(total - 0.5 * (px * px + py * py + pz * pz) / whole)


@compiled(cached=False)
def place(h: float, masses: Floats, x: Floats, v: Floats, near_x: Floats, near_v: Floats) -> None:
    """Write the state after a step: the relative state around the centre of mass, which moves uniformly."""
    whole = 0.0
    for i in range(1, masses.size):
        whole += masses[i]
    for k in range(3):
        centre = speed = behind = slower = 0.0
        for i in range(masses.size - 1):
            share = masses[1 + i] / whole
            centre, speed = centre + share * x[3 * i + k], speed + share * v[3 * i + k]
            behind, slower = behind + share * near_x[3 * i + k], slower + share * near_v[3 * i + k]
        for i in range(masses.size - 1):
            x[3 * i + k] = (centre + h * speed - behind) + near_x[3 * i + k]
            v[3 * i + k] = (speed - slower) + near_v[3 * i + k]

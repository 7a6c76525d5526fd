"""Step control by the error of each step, from the estimate of a tableau, or from step doubling.

Templates, the letters of a trial: `begin_trial`, the step, `judge_embedded`; or `begin_trial`, the step, `end_coarse`, the step
in halves, whose result is kept, and `judge`. Errors are measured as in Hairer, Norsett, Wanner, Solving Ordinary Differential
Equations I, 2nd ed. (1993), eq. (II.4.11), those of tableaux as in eq. (II.10.17); step doubling: section II.4, eq. (4.4). The
controller is proportional and integral: Gustafsson, ACM Trans. Math. Softw. 17, 533 (1991).

Memory of control: state at the start of the trial (2 n), rounding errors of its sums (2 n), state after the whole step
(2 n), absolute tolerances (2 n). The params of control: relative tolerance, order, size of the first step wanted or zero, and
clock at the start of the trial, with its rounding error.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import compiled, unbound
from kickdrift.core.elementwise import assign
from kickdrift.core.views import part
from kickdrift.engine.flows.implicit import padded
from kickdrift.engine.flows.layout import (
    CLOCK,
    CLOCK_OF_V,
    CONTROL,
    DENSITY,
    END,
    FIRST_STEP,
    LAST_ERROR,
    LOST_TO_ROUNDING,
    MEMORY,
    REJECTED,
    RETRIED,
    ROUNDED_OFF,
    SHADOW,
    TROUBLE,
    VELOCITY,
    at_end,
    coefficients_at,
    control_memory,
    has_part,
    is_lost,
    memory,
    own_params,
)

Floats = NDArray[np.float64]

acceleration_at: Callable[..., None] = unbound
velocity_at: Callable[..., None] = unbound

PARAMS = 5
RELATIVE, ORDER, GIVEN, BEGIN, BEGIN_ROUNDED_OFF = range(PARAMS)  # of the params of control
_SAFETY, _LEAST, _MOST = 0.9, 0.2, 5.0
_INTEGRAL, _PROPORTIONAL = 0.7, 0.4  # exponents over the order of the error


@compiled(inline=True)
def saved(n: int, index: int, size: int, work: Floats) -> Floats:
    """Return one of the vectors in memory."""
    return part(control_memory(n, work), index * n, size)


@compiled(inline=True)
def shadow(work: Floats) -> Floats:
    """Return the copy of the memory of the flows."""
    return part(work, int(work[SHADOW]), int(work[CONTROL] - work[SHADOW]))


@compiled
def distance(a: Floats, b: Floats, absolute: Floats, relative: float) -> float:
    """Return the sum of the squares of differences, each over its tolerance."""
    total = 0.0
    for i in range(a.size):
        difference = (a[i] - b[i]) / (absolute[i] + relative * max(abs(a[i]), abs(b[i])))
        total += difference * difference
    return total


def choose_first_step(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Prepare the control: if no first step is given, choose one that moves the state by a hundredth of its size.

    Hairer, Norsett, Wanner, as above: the first two steps of the algorithm on page 169.
    """
    n, own = x.size, own_params(work)
    work[LAST_ERROR] = work[RETRIED] = 1.0
    if own[GIVEN] != 0.0:
        return
    rate, v_rate, nothing = saved(n, 0, n, work), saved(n, 1, v.size, work), saved(n, 2, n, work)
    for i in range(n):
        nothing[i] = 0.0
    if has_part(VELOCITY, work):
        velocity_at(t, x, v, params, work, rate)
    else:
        assign(rate, v)
    if v.size > 0:
        acceleration_at(t, x, v, params, work, v_rate)
    own_x, own_v = saved(n, 6, n, work), saved(n, 7, v.size, work)
    size = weighed(x, x, own_x, own[RELATIVE]) + weighed(v, v, own_v, own[RELATIVE])
    speed = weighed(rate, x, own_x, own[RELATIVE]) + weighed(v_rate, v, own_v, own[RELATIVE])
    if size > 0.0 and 0.0 < speed < math.inf:
        step = 0.01 * math.sqrt(size / speed)
        if step < abs(work[FIRST_STEP]):
            work[DENSITY] = abs(work[FIRST_STEP]) / step


@compiled
def weighed(a: Floats, state: Floats, absolute: Floats, relative: float) -> float:
    """Return the sum of the squares of numbers, each over the tolerance of the state."""
    total = 0.0
    for i in range(a.size):
        share = a[i] / (absolute[i] + relative * abs(state[i]))
        total += share * share
    return total


def begin_trial(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Keep the state."""
    n, own = x.size, own_params(work)
    assign(saved(n, 0, n, work), x)
    assign(saved(n, 1, v.size, work), v)
    assign(saved(n, 2, 2 * n, work), part(work, n, 2 * n))
    assign(shadow(work), part(work, int(work[MEMORY]), shadow(work).size))
    own[BEGIN], own[BEGIN_ROUNDED_OFF] = work[CLOCK], work[ROUNDED_OFF]


@compiled(inline=True)
def take_back(x: Floats, v: Floats, work: Floats) -> None:
    """Return to the start of the trial."""
    n, own = x.size, own_params(work)
    assign(x, saved(n, 0, n, work))
    assign(v, saved(n, 1, v.size, work))
    assign(part(work, n, 2 * n), saved(n, 2, 2 * n, work))
    assign(part(work, int(work[MEMORY]), shadow(work).size), shadow(work))
    work[CLOCK], work[ROUNDED_OFF] = own[BEGIN], own[BEGIN_ROUNDED_OFF]
    work[CLOCK_OF_V] = own[BEGIN]


def end_coarse(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Keep the result of the whole step, and return to the start."""
    n = x.size
    assign(saved(n, 4, n, work), x)
    assign(saved(n, 5, v.size, work), v)
    take_back(x, v, work)


def judge(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Accept or reject the halves by their difference from the whole step."""
    n, own = x.size, own_params(work)
    squares = distance(x, saved(n, 4, n, work), saved(n, 6, n, work), own[RELATIVE])
    squares += distance(v, saved(n, 5, v.size, work), saved(n, 7, v.size, work), own[RELATIVE])
    decide(math.sqrt(squares / (n + v.size)) / (2.0 ** own[ORDER] - 1.0), x, v, work)


def judge_embedded(t: float, h: float, x: Floats, v: Floats, params: Floats, work: Floats) -> None:
    """Accept or reject a Runge-Kutta step by the two estimates of its tableau.

    The rates of its stages are where the step has left them, see `kickdrift.engine.flows.runge_kutta`.
    """
    n, n_v, own = x.size, v.size, own_params(work)
    at = coefficients_at(n)
    s = int(work[at])
    weights = part(work, at + 1 + 3 * s * (s + 1), 2 * s)
    x_rates, v_rates = part(memory(work), 0, s * n), part(memory(work), padded(s * n), s * n_v)
    fine, coarse = 0.0, 0.0
    for i in range(n + n_v):
        tolerance, fifth, third = 0.0, 0.0, 0.0
        if i < n:
            tolerance = saved(n, 6, n, work)[i] + own[RELATIVE] * max(abs(x[i]), abs(saved(n, 0, n, work)[i]))
        else:
            k = i - n
            tolerance = saved(n, 7, n_v, work)[k] + own[RELATIVE] * max(abs(v[k]), abs(saved(n, 1, n_v, work)[k]))
        for j in range(s):
            rate = x_rates[j * n + i] if i < n else v_rates[j * n_v + i - n]
            fifth += weights[j] * rate
            third += weights[s + j] * rate
        fine += (fifth / tolerance) ** 2
        coarse += (third / tolerance) ** 2
    error = 0.0 if fine == 0.0 else abs(h) * fine / math.sqrt((fine + 0.01 * coarse) * (n + n_v))
    decide(error, x, v, work)


@compiled
def decide(error: float, x: Floats, v: Floats, work: Floats) -> None:
    """Accept or reject a step by its error over the tolerance, and choose the next size, at most up to the end."""
    order = own_params(work)[ORDER]
    size = work[FIRST_STEP] / work[DENSITY]
    exponent = 1.0 / (order + 1.0)
    if error <= 1.0 and work[TROUBLE] == 0.0:
        error = max(error, 1e-10)
        factor = _SAFETY * error ** (-_INTEGRAL * exponent) * work[LAST_ERROR] ** (_PROPORTIONAL * exponent)
        factor = min(max(factor, _LEAST), _MOST if work[REJECTED] == 0.0 else 1.0)
        work[LAST_ERROR], work[REJECTED] = error, 0.0
    else:
        factor = _LEAST
        if error < math.inf and work[TROUBLE] == 0.0:
            factor = max(_SAFETY * error**-exponent, _LEAST)
        work[REJECTED], work[TROUBLE] = 1.0, 0.0
        take_back(x, v, work)
    size *= factor
    left = work[END] - work[CLOCK]
    if at_end(work):
        return
    if abs(size) >= abs(left):
        size = left
    elif abs(size) > 0.5 * abs(left):
        size = 0.5 * left  # two equal steps, rather than a short one at the end
    if is_lost(size, work):
        work[TROUBLE] = LOST_TO_ROUNDING
    else:
        work[DENSITY] = work[FIRST_STEP] / size

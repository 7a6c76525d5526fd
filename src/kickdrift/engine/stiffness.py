"""Whether explicit methods would be held to steps much smaller than the one given: looked at before a run by ``"auto"``.

The eigenvalues of the Jacobian at the start, and on along a rough solution: Robertson's problem is not stiff at its start, and
HIRES becomes so in ten units of time. The solution is that of a Rosenbrock method of order 2, L-stable so that transients which
decay in less than a step do not hold it up, with an error control so that it stays near the motion: without one it sees
stiffness where there is none, in Lorenz's equations. It ends after a number of steps.

Of large states, where eigenvalues cost more than the run may, the largest one by power iteration, at the start.
"""

import math
from collections.abc import Callable
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.kinds import Kind
from kickdrift.engine.flows.layout import call_flat
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
Rates = Callable[[float, Floats], Floats]

_LIMIT = 5.0  # |h lambda| that DOP853 tolerates: it is stable to 5.9, and a run may go beyond what is seen here
_FAST = 1.0  # h omega from which on the trigonometric methods are ahead of words of kicks and drifts
_LOOKS = 30  # along the rough solution
# Error of a step of the rough solution, in terms of each number, or of this share of the largest. So the fastest decay seen of
# 21 problems was 0.9 to 1.4 of what it is along an accurate solution, but where it comes later than 30 steps reach.
_ROUGHLY, _LEAST = 0.3, 1e-4
_SHORTENED = 20  # times that a step is
_GAMMA = 1.0 - math.sqrt(0.5)  # of ROS2
_LARGEST = 40  # numbers of a state whose eigenvalues are found: in 2 ms
_ITERATIONS = 12
_DIFFERENCE = 1e-7


class Stiffness(Enum):
    """The kind of motion that is much faster than a step."""

    NONE = "nothing"
    DECAY = "decays"
    OSCILLATION = "oscillations"


def stiffness(system: System, t0: float, step: float, span: float) -> Stiffness:
    """Judge a system at its start, and along a rough solution; a function that fails there is left to the run."""
    if system.kind is Kind.OSCILLATORY:
        fastest = abs(step) * system.params[-system.x0.size :].max()
        return Stiffness.OSCILLATION if fastest > _FAST else Stiffness.NONE
    try:
        with np.errstate(all="ignore"):
            return _judge(_rates(system), t0, np.concatenate([system.x0.ravel(), system.v0.ravel()]), step, span)
    except Exception:  # a user's function may be called outside its domain
        return Stiffness.NONE


def _rates(system: System) -> Rates:
    n = system.x0.size

    def evaluate(function: Callable[..., None], t: float, x: Floats, v: Floats, out: Floats) -> None:
        if system.native:
            call_flat(function, t, x, v, system.params, out)
        else:
            function(t, x, v, system.params, out)

    def rates(t: float, y: Floats) -> Floats:
        x, v, out, of_v = y[:n].copy(), y[n:].copy(), np.zeros(n), np.zeros(y.size - n)
        if system.velocity is None:
            out = v
        else:
            evaluate(system.velocity, t, x, v, out)
        if of_v.size:
            evaluate(system.acceleration, t, x, v, of_v)
        return np.concatenate([out, of_v])

    return rates


def _judge(rates: Rates, t: float, y: Floats, h: float, span: float) -> Stiffness:
    if y.size > _LARGEST:
        return _by_power_iteration(rates, t, y, h)
    stride, end = h, t + span
    for _ in range(_LOOKS):
        rate = rates(t, y)
        jacobian = _jacobian(rates, t, y, rate)
        if not np.isfinite(jacobian).all():
            break
        if abs(h) * abs(jacobian).sum(axis=1).max() > _LIMIT:
            eigenvalues = h * np.linalg.eigvals(jacobian)
            if eigenvalues.real.min() < -_LIMIT:
                return Stiffness.DECAY
            if abs(eigenvalues.imag).max() > _LIMIT:
                return Stiffness.OSCILLATION
        if t == end:
            break
        t, y, stride = _advance(rates, t, y, rate, jacobian, stride, end)
    return Stiffness.NONE


def _advance(
    rates: Rates, t: float, y: Floats, rate: Floats, jacobian: Floats, stride: float, end: float
) -> tuple[float, Floats, float]:
    """Do a step, shortened until its error is small enough; return the time, the state, and the next step.

    ROS2: Verwer, Spee, Blom, Hundsdorfer, SIAM J. Sci. Comput. 20, 1456 (1999).
    """
    for _ in range(_SHORTENED):
        last = abs(stride) >= abs(end - t)
        stride = end - t if last else stride
        inverse = np.linalg.inv(np.eye(y.size) - _GAMMA * stride * jacobian)
        first = inverse @ rate
        second = inverse @ (rates(t + stride, y + stride * first) - 2.0 * first)
        new = y + stride * (1.5 * first + 0.5 * second)
        size = np.maximum(abs(y), abs(new))
        error = (0.5 * abs(stride * (first + second)) / np.maximum(size, _LEAST * size.max() + 1e-300)).max() / _ROUGHLY
        following = stride * min(5.0, max(0.2, 0.8 * error**-0.5))  # 0.2 for a NaN
        if error <= 1.0:
            break
        stride = following
    return end if last else t + stride, new, following


def _jacobian(rates: Rates, t: float, y: Floats, rate: Floats) -> Floats:
    columns = []
    for j in range(y.size):
        moved = y.copy()
        moved[j] += _DIFFERENCE * max(abs(y[j]), 1e-3 * abs(y).max(), 1e-8)
        columns.append((rates(t, moved) - rate) / (moved[j] - y[j]))
    return np.array(columns).T


def _by_power_iteration(rates: Rates, t: float, y: Floats, h: float) -> Stiffness:
    """Judge by the power iteration with the Jacobian."""
    rate, size = rates(t, y), _DIFFERENCE * max(float(np.linalg.norm(y)), 1.0)
    direction = np.cos(1.0 + np.arange(y.size) ** 2)  # without the symmetries of a chain or a grid
    along = growth = 0.0
    for _ in range(_ITERATIONS):
        direction = direction / np.linalg.norm(direction)
        image = h * (rates(t, y + size * direction) - rate) / size
        along, growth = float(direction @ image), float(np.linalg.norm(image))
        if not (np.isfinite(growth) and growth > 0.0):
            return Stiffness.NONE
        direction = image
    if growth <= _LIMIT:
        return Stiffness.NONE
    return Stiffness.DECAY if along < -0.5 * growth else Stiffness.OSCILLATION


def may_be_stiff(kind: Kind) -> bool:
    """Whether `auto` looks: for kinds whose methods have no structure of their own to keep, or that say what is fast."""
    return kind in (Kind.OSCILLATORY, Kind.FIRST_ORDER, Kind.PARTITIONED, Kind.HAMILTONIAN, Kind.VELOCITY_DEPENDENT)

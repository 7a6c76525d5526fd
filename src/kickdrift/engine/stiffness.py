"""Whether explicit methods would be held to steps much smaller than the one given: looked at before a run by ``"auto"``.

The eigenvalues of the Jacobian at the start, and along a few steps of the linearly implicit Euler method, which goes
through transients that decay in less than a step: Robertson's problem is not stiff at its start. Then along a few strides
of a hundredth of the span: HIRES becomes stiff in some units of time, and without them is lost at steps of 0.02 to 0.16, with
them of 0.02 to 0.05. Longer strides find stiffness where there is none, in Lorenz's equations.

Of large states, where eigenvalues cost more than the run may, the largest one by power iteration, at the start.
"""

from collections.abc import Callable
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.kinds import Kind
from kickdrift.engine.flows.layout import call_flat
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
Rates = Callable[[float, Floats], Floats]

# |h lambda| that DOP853 tolerates: it is stable to 6.4 on the real axis and beyond 5 on the imaginary one, and the values found
# here may grow by half.
_LIMIT = 4.0
_FAST = 1.0  # h omega from which on the trigonometric methods are ahead of words of kicks and drifts
_STEPS, _STRIDES, _STRIDE = 3, 3, 0.01  # the last one in terms of the span
_LARGEST = 40  # numbers of a state whose eigenvalues are found: in 2 ms
_ITERATIONS = 12
_DIFFERENCE = 1e-7


class Stiffness(Enum):
    """The kind of motion that is much faster than a step."""

    NONE = "nothing"
    DECAY = "decays"
    OSCILLATION = "oscillations"


def stiffness(system: System, t0: float, step: float, span: float) -> Stiffness:
    """Judge a system at its start, and a few steps and strides on; a function that fails there is left to the run."""
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
    strides = [h] * _STEPS + [span * _STRIDE] * (_STRIDES if abs(span * _STRIDE) > abs(h) else 0)
    for stride in (*strides, 0.0):
        rate = rates(t, y)
        jacobian = _jacobian(rates, t, y, rate)
        if not np.isfinite(jacobian).all():
            return Stiffness.NONE
        if abs(h) * abs(jacobian).sum(axis=1).max() > _LIMIT:
            eigenvalues = h * np.linalg.eigvals(jacobian)
            if eigenvalues.real.min() < -_LIMIT:
                return Stiffness.DECAY
            if abs(eigenvalues.imag).max() > _LIMIT:
                return Stiffness.OSCILLATION
        y = y + np.linalg.solve(np.eye(y.size) - stride * jacobian, stride * rate)
        t += stride
    return Stiffness.NONE


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

"""Problems of every kind on which the methods are measured for the tables: the order of each, and work and precision."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import kickdrift as kd
from kickdrift.methods import Kind, Method

_FLOOR, _MOST_STEPS, _RATIO = 2e-12, 3000, 1.4  # of errors that are measured; of steps of a run; from step to step


@dataclass(frozen=True)
class Case:
    """A problem of a kind.

    Attributes
    ----------
    formula : str
        For people.
    problem, x0, v0 : as for `kickdrift.solve`
    end, largest : float
        Of the span, and of the steps that are tried.
    known : callable, optional
        Returns x and v at the end; by default DOP853 at a tolerance of 1e-13 finds them.
    """

    formula: str
    problem: Any
    x0: Any
    v0: Any
    end: float
    largest: float
    known: Callable[[float], Any] | None = None
    equations: Any = None  # which DOP853 takes, where the problem itself is nothing for it


def _on_circle(t: float) -> tuple[Any, Any]:
    """Return where a pendulum of length 1 is that swings from an angle of 2 with g = 1."""
    angle, rate = (part[0] for part in kd.systems.pendulum(2.0).exact(np.array([t])))
    return np.array([np.sin(angle), -np.cos(angle)]), rate * np.array([np.cos(angle), np.sin(angle)])


def _two_heavy_planets() -> Any:
    x0, v0 = np.zeros((2, 3, 3))
    x0[1:, 0], v0[1:, 1] = (1.0, 1.8), (1.05, -0.72)
    return kd.systems.planetary([1.0, 0.05, 0.05], x0, v0)


_turned = 0.5 * np.array([np.sin(2.0), -np.cos(2.0)])
CASES = {
    Kind.NEWTONIAN: Case(
        r"$x'' = -x - x^3 + \cos 2t$", lambda t, x: -x - x**3 + np.cos(2 * t), [0.7, -0.2], [0.3, 0.5], 5.0, 0.8
    ),
    Kind.SEPARABLE: Case(
        r"$H = \sqrt{1 + p^2} + q^2/2 + q^4/4$",
        kd.Separable(lambda p: p / np.sqrt(1 + p * p), lambda q: q + q**3),
        [0.5, -0.2], [1.0, 0.4], 4.0, 0.8,
    ),
    Kind.HAMILTONIAN: Case(
        "$H = (1 + q^2)(1 + p^2)/2$",
        kd.Hamiltonian(dHdq=lambda q, p: q * (1 + p * p), dHdp=lambda q, p: p * (1 + q * q)),
        [0.8, 0.3], [0.5, -0.6], 5.0, 0.5,
    ),
    Kind.PARTITIONED: Case(
        r"$x' = x(1 - v),\ v' = v(x - 1)$ (Lotka and Volterra)",
        kd.Partitioned(lambda x, v: x * (1 - v), lambda x, v: v * (x - 1)), [0.5, 0.8], [1.5, 0.7], 5.0, 0.5,
    ),
    Kind.FIRST_ORDER: Case(
        r"$y_0' = y_1,\ y_1' = (1 - y_0^2) y_1 - y_0$ (van der Pol)",
        kd.FirstOrder(lambda y: np.array([y[1], (1 - y[0] ** 2) * y[1] - y[0]])), [1.0, 0.5], None, 3.0,
        0.3,  # above, the slope of gauss-8 is 6
    ),
    Kind.VELOCITY_DEPENDENT: Case(
        r"$x'' = -\sin x - v/10 - v^3/20 + 0.3 \cos t$",
        lambda t, x, v: -np.sin(x) - 0.1 * v - 0.05 * v**3 + 0.3 * np.cos(t), [2.0, 1.0], [0.5, -0.3], 5.0, 0.6,
    ),
    Kind.DAMPED: Case(
        r"$x'' = -\sin x + 0.3 \cos t - v/5$",
        kd.Damped(lambda t, x: -np.sin(x) + 0.3 * np.cos(t), damping=0.2), [2.0, 1.0], [0.5, -0.3], 5.0, 0.8,
    ),
    Kind.CHARGED: Case(
        r"$x'' = v \times B,\ B = |x|\, e_z$",
        kd.ChargedParticle(1.0, lambda x: np.array([0.0, 0.0, np.sqrt(x[0] ** 2 + x[1] ** 2)])),
        [1.0, 0.2, 0.0], [0.3, 0.5, 0.0], 5.0, 0.6,
    ),
    Kind.CONSTRAINED: Case(
        "$x'' = -e_y - G^T \\lambda,\\ |x|^2 = 1$ (a pendulum)",
        kd.Constrained(lambda x: np.array([0.0, -1.0]), lambda x: x[0] ** 2 + x[1] ** 2 - 1.0),
        2 * _turned, [0.0, 0.0], 5.0, 0.3, known=_on_circle,
    ),
    Kind.NEARLY_KEPLERIAN: Case(
        "a star and two planets, each of a twentieth of its mass", _two_heavy_planets(), None, None, 6.0, 0.5
    ),
    Kind.MULTIRATE: Case(
        r"$x'' = -x - 25 x^3$, the second term of which is fast",
        kd.Multirate(slow_force=lambda x: -x, fast_force=lambda x: -25 * x**3), 0.5, 0.3, 3.0, 0.2,
    ),
    Kind.OSCILLATORY: Case(
        r"$x'' = -\omega^2 x - (x_0 + x_1)^3,\ \omega = (0, 5)$",
        kd.Oscillatory(lambda x: -((x[0] + x[1]) ** 3) * np.ones(2), omega=[0.0, 5.0]),
        [1.0, 0.2], [0.0, 1.0], 3.0, 0.3,
    ),
}  # fmt: skip


@cache
def _end(kind: Kind) -> Any:
    case = CASES[kind]
    if case.known is not None:
        return case.known(case.end)
    options = {"rtol": 1e-13, "atol": 1e-14, "method": "dop853", "save_every": 2**60, "progress": False}
    run = kd.solve(case.problem, (0.0, case.end), case.x0, case.v0, step=0.01, **options)
    return run.x[-1], run.v[-1]


def _error(kind: Kind, method: Method, step: float) -> tuple[float, float]:
    case = CASES[kind]
    options = {"step": step, "method": method, "save_every": 2**60, "progress": False}
    run = kd.solve(case.problem, (0.0, case.end), case.x0, case.v0, **options)
    if not run.success:
        return run.step, np.inf
    x, v = _end(kind)
    return run.step, float(max(np.abs(run.x[-1] - x).max(), np.abs(run.v[-1] - v).max(initial=0.0)))


def _slope(kind: Kind, method: Method) -> float | None:
    """Return the slope over the four smallest steps whose errors are above rounding."""
    made: list[tuple[float, float]] = []
    step = CASES[kind].largest
    while CASES[kind].end / step < _MOST_STEPS:
        used, error = _error(kind, method, step)
        if error < _FLOOR:
            break
        if error < 0.1:
            made.append((used, error))
        step = used / _RATIO
    if len(made) < 3:
        return None
    steps, errors = np.log(np.array(made[-4:])).T
    return float(np.polyfit(steps, errors, 1)[0])


def case_of(method: Method) -> Kind | None:
    """Return the kind on whose problem a method is measured; None where there is none, as for averages over noise."""
    return method.kind if method.kind in CASES else None


def orders(store: Path) -> dict[str, float | None]:
    """Measure the order of every method, or read what was measured of the same methods before."""
    catalogue = kd.methods.catalogue()
    source = Path(__file__).read_bytes() + repr([(m.name, m.word, m.kind) for m in catalogue.values()]).encode()
    key = hashlib.sha256(source).hexdigest()
    if store.exists():
        kept = json.loads(store.read_text())
        if kept["of"] == key:
            return dict(kept["orders"])
    found: dict[str, float | None] = {}
    for method in catalogue.values():
        kind = case_of(method)
        found[method.name] = None if kind is None else _slope(kind, method)
    store.parent.mkdir(parents=True, exist_ok=True)
    store.write_text(json.dumps({"of": key, "orders": found}))
    return found

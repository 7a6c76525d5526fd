"""`kd.advise`: its recommendation meets the tolerance, and costs at most twice the best that brute force finds."""

import sys
from pathlib import Path

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.analysis import pilot
from kickdrift.core.errors import ArgumentError, KickdriftError

ROOT = Path(__file__).parent.parent
CASES = [("pendulum", 300.0, 1e-8), ("kepler", 100.0, 1e-4), ("outer-solar-system", 1e5, 1e-5)]


@pytest.fixture(scope="module", autouse=True)
def _importable():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT))
        yield
    for name in [name for name in sys.modules if name.split(".")[0] == "benchmarks"]:
        del sys.modules[name]


@pytest.mark.parametrize(("name", "span", "tolerance"), CASES)
def test_it_meets_the_tolerance_at_twice_the_least_cost_or_less(name, span, tolerance):
    from benchmarks import advice

    system = kd.systems.get(name)
    found = kd.advise(system, (0.0, span), tolerance, seconds=1e6)
    end, scales = advice.exact_end(system, span)
    run, error = advice.error_of(system, span, found.method, found.step, end, scales)
    assert error <= tolerance
    _, best = advice.cheapest(system, span, tolerance, end, scales)
    assert run.n_force_evaluations <= 2 * best
    longer = 3 * found.step  # the tolerance is not met by just anything
    if name != "kepler":
        assert advice.error_of(system, span, found.method, longer, end, scales)[1] > tolerance


def test_a_span_that_is_too_long_to_measure_is_extrapolated():
    orbit = kd.systems.kepler(0.2)
    problem = kd.SecondOrder(lambda x: -x / (x[0] ** 2 + x[1] ** 2) ** 1.5)
    found = kd.advise(problem, (0.0, 3000.0), 1e-4, orbit.x0, orbit.v0, methods=["blanes-moan-srkn6b", "kahan-li-8"])
    assert found.pilot < found.span / 2
    assert "of the span, extrapolated" in repr(found)
    run = kd.solve(problem, (0.0, 3000.0), orbit.x0, orbit.v0, method=found.method, step=found.step, save_every=2**60)
    assert np.abs(run.x[-1] - orbit.exact(run.t[-1:])[0][0]).max() < 1e-4 * 1.2
    assert {trial.method for trial in found.trials} == {"blanes-moan-srkn6b", "kahan-li-8"}


def test_it_shows_its_evidence():
    found = kd.advise(kd.systems.pendulum(), (0.0, 50.0), 1e-6, methods=["velocity-verlet", "kahan-li-8"])
    lines = repr(found).splitlines()
    assert lines[0] == f"pendulum over 50 to an error of 1e-06: method='kahan-li-8', step={found.step:.6g}"
    assert "the whole span" in lines[1]
    assert any(line.startswith("| kahan-li-8") for line in lines)
    costs = [trial.evaluations for trial in found.trials]
    assert costs == sorted(costs)
    assert found.trials[0].method == found.method
    assert len(found.trials) + len(found.left_out) == 2
    pytest.importorskip("pandas")
    assert list(found.to_pandas()["method"]) == [trial.method for trial in found.trials]


def test_the_error_expected_is_that_of_the_step_advised_also_over_few_steps():
    def driven(t, x, v):
        return -x - 0.3 * v + np.cos(t)

    start = 1.0, 0.0
    [trial] = kd.advise(driven, (0.0, 50.0), 1e-7, *start, methods=["dop853"]).trials
    sol = kd.solve(driven, (0.0, 50.0), *start, method="dop853", step=trial.step)
    finer = kd.solve(driven, (0.0, 50.0), *start, method="dop853", step=0.05)
    error = np.hypot(sol.x[-1] - finer.x[-1], sol.v[-1] - finer.v[-1]) / np.hypot(finer.x[-1], finer.v[-1])
    assert trial.error == pytest.approx(error, rel=0.5)


def test_backwards_with_friction_and_of_first_order():
    backwards = kd.advise(kd.systems.pendulum(), (0.0, -50.0), 1e-5, methods=["kahan-li-8"])
    assert backwards.span == -50.0
    drag = kd.advise(
        lambda x, v: -x - 0.1 * v, (0.0, 30.0), 1e-5, 1.0, 0.0, methods=["gauss-4", "dop853"], compile=False
    )
    run = kd.solve(lambda x, v: -x - 0.1 * v, (0.0, 30.0), 1.0, 0.0, method=drag.method, step=drag.step, compile=False)
    rate = np.sqrt(1 - 0.05**2)
    exact = np.exp(-0.05 * run.t) * (np.cos(rate * run.t) + 0.05 / rate * np.sin(rate * run.t))
    assert np.abs(run.x - exact).max() < 1e-5
    prey = kd.FirstOrder(lambda y: np.array([y[0] * (1 - y[1]), y[1] * (y[0] - 1)]))
    assert kd.advise(prey, (0.0, 20.0), 1e-4, [0.5, 1.0], methods=["dop853"], compile=False).method == "dop853"


def test_what_cannot_be_advised_on_is_refused(monkeypatch):
    monkeypatch.setattr(
        pilot, "_SECONDS", 60.0
    )  # a busy machine would try a part of the span before the motion goes to infinity
    pendulum = kd.systems.pendulum()
    for tolerance in (0.0, 1.0, "small"):
        with pytest.raises(ArgumentError, match="tolerance="):
            kd.advise(pendulum, (0.0, 1.0), tolerance)
    with pytest.raises(ArgumentError, match="it is stochastic"):
        kd.advise(kd.Langevin(lambda x: -x, friction=1.0, temperature=1.0), (0.0, 1.0), 1e-3, 1.0, 0.0, compile=False)
    with pytest.raises(KickdriftError, match="forces at the initial state are not finite"):
        kd.advise(lambda x: np.nan * x, (0.0, 1.0), 1e-3, 1.0, 0.0, compile=False)
    with pytest.raises(KickdriftError, match=r"DOP853 (finds no step|cannot compute)"):
        kd.advise(lambda x: x**3, (0.0, 100.0), 1e-3, 1.0, 1.0, compile=False)
    rod = kd.Constrained(lambda x: np.array([0.0, -9.81]), lambda x: x @ x - 1)
    with pytest.raises(ArgumentError, match="it has constraints"):
        kd.advise(rod, (0.0, 1.0), 1e-3, [1.0, 0.0], [0.0, 0.0], compile=False)
    with pytest.raises(KickdriftError, match=r"no method meets tolerance=1e-12 .*velocity-verlet"):
        kd.advise(pendulum, (0.0, 100.0), 1e-12, methods=["velocity-verlet"])
    with pytest.raises(ArgumentError, match="two finite times"):
        kd.advise(pendulum, (0.0, 0.0), 1e-3)
    with pytest.raises(KickdriftError, match="not tried within seconds=0"):
        kd.advise(pendulum, (0.0, 10.0), 1e-3, seconds=0)

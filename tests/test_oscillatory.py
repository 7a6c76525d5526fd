"""Trigonometric and multirate methods: order, energy over long times beyond the steps that others bear, resonances."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.core.kinds import Kind
from kickdrift.methods import Letter, Method, word

TRIGONOMETRIC = ["deuflhard-2", "mollified-impulse", "hairer-lubich-2", "grimm-hochbruck-2", "gautschi-2"]
OMEGA = 50.0


# The chain of Hairer, Lubich and Wanner, section I.5.1, of three stiff springs: extensions of the soft ones.
SIGNS = np.array([[1, 0, 0, -1, 0, 0], [-1, 1, 0, -1, -1, 0], [0, -1, 1, 0, -1, -1], [0, 0, 1, 0, 0, 1]], dtype=float)


def soft(x, out):
    for j in range(6):
        out[j] = 0.0
    for i in range(4):
        extension = 0.0
        for j in range(6):
            extension += SIGNS[i, j] * x[j]
        for j in range(6):
            out[j] -= SIGNS[i, j] * extension**3


def stiff_springs(x, out):
    for j in range(6):
        out[j] = -OMEGA * OMEGA * x[j] if j > 2 else 0.0


def oscillatory(x, v):
    total = 0.0
    for j in range(3, 6):
        total += 0.5 * (v[j] ** 2 + (OMEGA * x[j]) ** 2)
    return total


def energy(x, v):
    total = 0.0
    for j in range(6):
        total += 0.5 * (v[j] ** 2 + (OMEGA * x[j] if j > 2 else 0.0) ** 2)
    for i in range(4):
        extension = 0.0
        for j in range(6):
            extension += SIGNS[i, j] * x[j]
        total += 0.25 * extension**4
    return total


FREQUENCIES = [0.0, 0.0, 0.0, OMEGA, OMEGA, OMEGA]
CHAIN = kd.Oscillatory(soft, FREQUENCIES, energy=energy, invariants={"oscillatory": oscillatory})
IN_TWO = kd.Multirate(slow_force=soft, fast_force=stiff_springs, energy=energy)
X0, V0 = [1.0, 0.0, 0.0, 1 / OMEGA, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0, 0.0, 0.0]


def run(method, step, end, problem=CHAIN, **options):
    return kd.solve(problem, (0.0, end), X0, V0, step=step, method=method, **options)


def energy_error(solution, name="energy"):
    values = solution.invariants[name]
    return abs(values / values[0] - 1).max()


@pytest.mark.parametrize("method", [*TRIGONOMETRIC, "respa-2", kd.methods.respa(substeps=3)], ids=str)
def test_order(method):
    def force(t, x, out):
        for k in range(2):
            out[k] = -(x[k] ** 3) + 0.3 * np.cos(2 * t)

    def fast(x, out):
        out[0] = 0.0
        out[1] = -9.0 * x[1]

    trigonometric = method in TRIGONOMETRIC
    problem = kd.Oscillatory(force, [0.0, 3.0]) if trigonometric else kd.Multirate(slow_force=force, fast_force=fast)
    found = kd.analysis.observed_order(
        problem, method=method, steps=(0.02, 0.01), t_span=(0.0, 3.0), x0=[0.7, 0.3], v0=[0.3, 0.5], compile=False
    ).order
    assert found == pytest.approx(2, abs=0.1)


def test_without_other_forces_oscillations_are_exact_at_any_step():
    alone = kd.Oscillatory(lambda x: 0.0 * x, [0.0, 3.0])
    for method in TRIGONOMETRIC:
        found = kd.solve(alone, (0.0, 100.0), [1.0, 0.5], [0.1, 2.0], step=1.7, method=method, compile=False)
        t = found.t
        assert np.allclose(found.x[:, 0], 1.0 + 0.1 * t, rtol=1e-13)
        assert abs(found.x[:, 1] - 0.5 * np.cos(3 * t) - 2 / 3 * np.sin(3 * t)).max() < 1e-12


@pytest.mark.parametrize(
    ("method", "step", "most"),
    [
        ("deuflhard-2", 0.03, 0.015),
        ("mollified-impulse", 0.03, 0.03),
        ("mollified-impulse", 0.1, 0.05),
        ("hairer-lubich-2", 0.1, 0.03),
        ("grimm-hochbruck-2", 0.1, 0.08),
        ("gautschi-2", 0.03, 0.005),
    ],
)
def test_energy_of_a_stiff_chain_over_long_times_at_steps_beyond_those_of_verlet(method, step, most):
    # h omega is 1.5 and 5; errors neither grow nor vanish.
    found = run(method, step, 5000.0, save_every=11)
    assert found.success
    assert most / 10 < energy_error(found) < most
    assert energy_error(found, "oscillatory") < 0.1  # what the stiff springs have together is nearly conserved
    assert energy_error(run(method, step, 500.0, save_every=11)) > 0.3 * energy_error(found)


def test_verlet_is_lost_there():
    assert run("velocity-verlet", 0.05, 100.0).status.name == "NOT_FINITE"


def test_where_a_step_is_half_a_period_of_what_oscillates_only_filters_help():
    step = 0.0628  # h omega = 3.14
    for method in ("deuflhard-2", "gautschi-2"):
        lost = run(method, step, 2000.0, save_every=11)
        assert not lost.success or energy_error(lost) > 10
    lost = run("respa-2", step, 2000.0, IN_TWO, save_every=11)
    assert not lost.success or energy_error(lost) > 10
    for method in ("mollified-impulse", "hairer-lubich-2", "grimm-hochbruck-2"):
        assert energy_error(run(method, step, 2000.0, save_every=11)) < 0.06


def test_respa_keeps_the_energy_and_its_fast_steps_do_not_move_with_the_slow_ones():
    found = run(kd.methods.respa(substeps=20), 0.03, 2000.0, IN_TWO, save_every=11)
    assert found.about.method == "respa-2-substeps-20"
    assert 1e-3 < energy_error(found) < 0.02
    # With ever more substeps the fast part is exact: what is left is the error of the impulses.
    exact, near = run("deuflhard-2", 0.03, 3.0), run(kd.methods.respa(substeps=200), 0.03, 3.0)
    assert abs(exact.x - near.x).max() < 1e-4
    assert abs(exact.x - run(kd.methods.respa(substeps=3), 0.03, 3.0).x).max() > 1e-3


def test_the_slow_force_is_evaluated_once_a_step():
    calls = {"slow": 0, "fast": 0}

    def slow(x):
        calls["slow"] += 1
        return -x

    def fast(x):
        calls["fast"] += 1
        return -100.0 * x

    problem = kd.Multirate(slow_force=slow, fast_force=fast)
    found = kd.solve(problem, (0.0, 1.0), 1.0, 0.0, step=0.1, method=kd.methods.respa(substeps=7), compile=False)
    assert found.n_force_evaluations == 10 + 1 + 7 * 10 + 1
    assert abs(calls["slow"] - 11) <= 3  # with those that try the function
    assert abs(calls["fast"] - 71) <= 3
    filtered = kd.solve(
        kd.Oscillatory(slow, 10.0), (0.0, 1.0), 1.0, 0.0, step=0.1, method="mollified-impulse", compile=False
    )
    assert filtered.n_force_evaluations == 11


@pytest.mark.parametrize("method", ["deuflhard-2", "mollified-impulse"])
def test_equal_filters_make_it_symplectic(method):
    assert defect(method) < 1e-12


@pytest.mark.parametrize("method", ["hairer-lubich-2", "grimm-hochbruck-2", "gautschi-2"])
def test_others_are_not(method):
    assert defect(method) > 1e-6


def defect(method):
    """How far one step is from symplectic: by differences of an exact derivative's eleven digits."""
    problem = kd.Oscillatory(lambda x: -np.array([x[1] * x[0], 0.5 * x[0] ** 2]), [1.0, 4.0])

    def step(z):
        found = kd.solve(problem, (0.0, 0.5), z[:2], z[2:], step=0.5, method=method, compile=False, compensated=False)
        return np.concatenate([found.x[-1], found.v[-1]])

    z, h = np.array([0.7, -0.2, 0.3, 0.5]), 1e-2  # the step is a polynomial of degree 2 in each kick: exact to h^4
    columns = []
    for i in range(4):
        e = np.eye(4)[i] * h
        near, far = step(z + e) - step(z - e), step(z + 2 * e) - step(z - 2 * e)
        columns.append((8 * near - far) / (12 * h))
    jacobian = np.array(columns).T
    form = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    return abs(jacobian.T @ form @ jacobian - form).max()


@pytest.mark.parametrize("method", [*TRIGONOMETRIC, "respa-2"])
def test_a_step_back_undoes_a_step(method):
    problem = CHAIN if method in TRIGONOMETRIC else IN_TWO
    there = run(method, 0.03, 3.0, problem)
    back = kd.solve(problem, (3.0, 0.0), there.x[-1], there.v[-1], step=0.03, method=method)
    assert np.allclose(back.x[-1], X0, rtol=0, atol=1e-11)


def test_frequencies_to_each_body_and_forces_on_all():
    start = np.arange(6.0).reshape(2, 3)
    by_body = kd.Oscillatory(lambda x: -0.1 * x, [1.0, 2.0])
    each = kd.Oscillatory(lambda x: -0.1 * x, [[1.0] * 3, [2.0] * 3])
    one, other = (
        kd.solve(p, (0.0, 2.0), start, start, step=0.5, method="mollified-impulse", compile=False)
        for p in (by_body, each)
    )
    assert np.array_equal(one.x, other.x)


def test_auto_filters_where_oscillations_are_fast_and_not_where_they_are_slow():
    assert run("auto", 0.03, 0.3).about.method == "garcia-archilla-sanz-serna-skeel-2"
    assert run("auto", 0.003, 0.3).about.method == "blanes-moan-srkn11b"
    assert run("auto", 0.003, 0.3, IN_TWO).about.method == "respa-2"


@pytest.mark.parametrize("omega", [-1.0, np.inf, [1.0, 2.0], "fast"])
def test_frequencies_that_are_none_are_refused(omega):
    with pytest.raises(ArgumentError, match="omega="):
        run("deuflhard-2", 0.1, 1.0, kd.Oscillatory(lambda x: -x, omega), compile=False)


@pytest.mark.parametrize("substeps", [0, -3, 2.5, True])
def test_substeps_that_are_none_are_refused(substeps):
    with pytest.raises(ArgumentError, match="substeps="):
        kd.methods.respa(substeps)


def test_a_force_in_one_part_has_no_multirate_method():
    with pytest.raises(MethodMismatchError, match=r"kd\.Multirate"):
        kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.1, method="respa-2")
    with pytest.raises(MethodMismatchError, match=r"kd\.Oscillatory"):
        run("mollified-impulse", 0.1, 1.0, IN_TWO)


def test_a_plain_kick_between_filtered_ones_changes_none_of_them():
    problem = kd.Oscillatory(lambda x: -(x**3), omega=[0.0, 30.0])
    filtered, plain, turn = Letter.FILTERED_KICK, Letter.KICK, Letter.OSCILLATE
    ends = []
    for name, first in (("between", (filtered, plain, filtered)), ("after", (filtered, filtered, plain))):
        half = [(letter, "1/4" if letter is plain else "1/8") for letter in first]
        method = Method(
            name=name, order=2, word=word(*half, (turn, 1), *reversed(half)), symmetric=True, kind=Kind.OSCILLATORY,
            source="two flows that commute", parameters=(1, 1, 0),
        )  # fmt: skip
        ends.append(kd.solve(problem, (0.0, 1.0), x0=[1.0, 0.3], v0=[0.0, 1.0], step=0.1, method=method).x[-1])
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)


def test_without_a_method_fast_oscillations_are_no_force():
    problem = kd.Oscillatory(lambda x: -(x**3), omega=[0.0, 50.0])
    solution = kd.solve(problem, (0.0, 10.0), x0=[1.0, 0.02], v0=[0.0, 1.0], step=0.05)
    assert solution.success
    assert solution.about.method == kd.methods.get("mollified-impulse").name

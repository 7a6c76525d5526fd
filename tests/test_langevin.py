"""Langevin dynamics: what is exact is tested without sampling; samples are compared by their standard errors.

Samples are many independent copies in one state. The mean over time of each copy is one number, and the standard error
that of the mean of these: no correlation in time enters. Seeds are fixed, and a z-score of 4 has a chance of 6e-5.
"""

import math
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.engine.flows import noise
from kickdrift.methods import Kind, Letter, Method, word

IMPLICIT = "drift-implicit-euler-maruyama"
SPLITTINGS = ("baoab", "aboba", "obabo", "baoa")
METHODS = (*SPLITTINGS, IMPLICIT)


def spring(x):
    return -x


def solve(problem, t, x0, v0, step, method, **options):
    return kd.solve(problem, (0.0, t), x0, v0, step=step, method=method, **{"compile": False} | options)


def z_score(samples, expected):
    """Of the mean of independent samples."""
    samples = np.asarray(samples)
    return float((samples.mean() - expected) / (samples.std(ddof=1) / math.sqrt(samples.size)))


# The linear problem: a step is z -> M z + noise of covariance Q, and nothing need be sampled.


def linear(method, h, omega=1.0, gamma=1.0, kt=1.0):
    """M and Q of a word on v' = -omega^2 x - gamma v + noise, letter by letter."""
    m, q = np.eye(2), np.zeros((2, 2))
    for letter, weight in kd.methods.get(method).word:
        s, added = float(weight) * h, 0.0
        if letter is Letter.KICK:
            one = np.array([[1, 0], [-s * omega**2, 1]])
        elif letter is Letter.DRIFT:
            one = np.array([[1, s], [0, 1]])
        elif letter is Letter.THERMOSTAT:
            one, added = np.diag([1, math.exp(-gamma * s)]), kt * (1 - math.exp(-2 * gamma * s))
        elif letter is Letter.NOISE:
            one, added = np.eye(2), 2 * gamma * kt * s
        else:
            one = np.linalg.inv(np.array([[1, -s], [s * omega**2, 1 + gamma * s]]))
        m, q = one @ m, one @ q @ one.T + np.diag([0, added])
    return m, q


def stationary(method, h, **constants):
    return solve_discrete_lyapunov(*linear(method, h, **constants))


@pytest.mark.parametrize("gamma", [0.01, 1.0, 30.0])
@pytest.mark.parametrize("h", [0.1, 0.5, 1.0, 1.5, 1.9, 1.99])
def test_variances_of_the_harmonic_oscillator_without_sampling(h, gamma):
    kt, omega = 0.7, 1.0
    a = 1 - h * h / 4
    for method, position, velocity in (
        ("baoab", 1, a),  # positions exact at every stable step
        ("aboba", 1, 1 / a),
        ("baoa", 1, 1),
        ("obabo", 1 / a, 1),
    ):
        covariance = stationary(method, h, omega=omega, gamma=gamma, kt=kt)
        assert covariance[0, 0] == pytest.approx(kt * position, rel=1e-9)
        assert covariance[1, 1] == pytest.approx(kt * velocity, rel=1e-9)
        assert covariance[0, 1] == pytest.approx(kt * h / 2 if method == "baoa" else 0, abs=1e-9)
    assert stationary(IMPLICIT, h, gamma=gamma)[0, 0] < 1 - 0.01 * h


@pytest.mark.parametrize("method", METHODS)
def test_the_engine_does_these_steps_with_this_noise(method):
    h, gamma, kt, mass = 0.7, 0.6, 0.5, 2.0
    copies, steps = (2000, 60) if method != IMPLICIT else (60, 400)
    problem = kd.Langevin(lambda x: -1.3 * x, gamma, kt, mass, seed=11)
    rng = np.random.default_rng(1)
    sol = solve(problem, h * steps, rng.normal(size=copies), rng.normal(size=copies), h, method)
    m, q = linear(method, h, math.sqrt(1.3 / mass), gamma, kt / mass)
    states = np.stack([sol.x, sol.v])
    before, after = states[:, :-1].reshape(2, -1), states[:, 1:].reshape(2, -1)
    noises = after - m @ before  # independent of each other and of the states before
    for i in range(2):
        assert abs(z_score(noises[i], 0)) < 4
        for j in range(2):
            assert abs(z_score(noises[i] * noises[j], q[i, j])) < 4
            assert abs(z_score(noises[i] * before[j], 0)) < 4
    wrong = after - linear(method, h, math.sqrt(1.3 / mass), 1.3 * gamma, kt / mass)[0] @ before
    assert abs(z_score(wrong[1] * before[1], 0)) > 4


def position_variance(method, h, copies=20_000, steps=100, transient=30):
    rng = np.random.default_rng(2)
    start = rng.normal(size=(2, copies))
    sol = solve(kd.Langevin(spring, 1.0, 1.0, seed=3), h * steps, *start, h, method)
    return (sol.x[transient:] ** 2).mean(axis=0)


@pytest.mark.parametrize("h", [0.5, 1.0, 1.5, 1.9])
def test_baoab_has_the_exact_position_variance_of_the_harmonic_oscillator(h):
    samples = position_variance("baoab", h)
    assert abs(z_score(samples, 1)) < 4
    biased = position_variance("obabo", h)
    assert z_score(biased, 1) > 10
    assert abs(z_score(biased, 1 / (1 - h * h / 4))) < 4


# A nonlinear, forced problem: averages over a tree of noises, by quadrature instead of sampling.


def double_well(t, x):
    return x - x**3 + 0.5 * np.cos(2 * t)


def averages(method, n, t, monkeypatch, nodes=3):
    """Means of x, x^2, v, v^2 and x v at the end of n steps, by Gauss-Hermite quadrature over all draws."""
    values, weights = np.polynomial.hermite_e.hermegauss(nodes)
    draws = n * sum(letter in (Letter.THERMOSTAT, Letter.NOISE) for letter, _ in kd.methods.get(method).word)
    choices = np.arange(nodes**draws) // nodes ** np.arange(draws)[:, None] % nodes

    def fill(seed, draw, out):
        out[:] = values[choices[int(draw)]]

    with monkeypatch.context() as patch:
        patch.setattr(noise, "fill_normal", fill)
        start = np.full(nodes**draws, 0.8), np.full(nodes**draws, 0.3)
        sol = solve(kd.Langevin(double_well, 1.0, 0.3), t, *start, t / n, method, t_eval=[t])
    x, v = sol.x[-1], sol.v[-1]
    return np.array([x, x**2, v, v**2, x * v]) @ (weights / weights.sum())[choices].prod(axis=0)


@pytest.fixture(scope="module")
def limit():
    with pytest.MonkeyPatch.context() as patch:
        coarse, fine = (averages("baoab", n, 0.5, patch) for n in (4, 8))
        other_coarse, other_fine = (averages("obabo", n, 0.5, patch) for n in (2, 4))
    by_baoab, by_obabo = (4 * fine - coarse) / 3, (4 * other_fine - other_coarse) / 3
    assert np.allclose(by_baoab, by_obabo, rtol=0, atol=1e-4)  # Richardson's extrapolation of both, of order 4
    return by_baoab


@pytest.mark.parametrize(("method", "order"), [("baoab", 2), ("aboba", 2), ("obabo", 2), ("baoa", 1)])
def test_weak_order_on_a_nonlinear_forced_problem(method, order, limit, monkeypatch):
    steps = (4, 8) if method == "baoa" else (2, 4)
    coarse, fine = (abs(averages(method, n, 0.5, monkeypatch) - limit) for n in steps)
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.1)


def test_weak_order_of_the_drift_implicit_method(monkeypatch):
    t = 0.04  # short: each copy is an unknown of one system of equations
    coarse, fine = (averages("baoab", n, t, monkeypatch) for n in (2, 4))
    limit = (4 * fine - coarse) / 3
    coarse, fine = (abs(averages(IMPLICIT, n, t, monkeypatch) - limit) for n in (2, 4))
    # The error of the mean of x v changes its sign near t = 0.05.
    assert np.log2(coarse / fine)[:4] == pytest.approx(1, abs=0.1)


def test_samples_have_the_averages_of_the_tree(monkeypatch):
    copies = 200_000
    exact = averages("baoab", 4, 0.5, monkeypatch, nodes=5)
    start = np.full(copies, 0.8), np.full(copies, 0.3)
    sol = solve(kd.Langevin(double_well, 1.0, 0.3, seed=4), 0.5, *start, 0.125, "baoab", t_eval=[0.5])
    x, v = sol.x[-1], sol.v[-1]
    for samples, expected in zip((x, x**2, v, v**2, x * v), exact, strict=True):
        assert abs(z_score(samples, expected)) < 4
    assert abs(z_score(x**2, averages("baoab", 1, 0.5, monkeypatch)[1])) > 4


# Known laws.


@pytest.mark.parametrize("h", [0.1, 1.0, 5.0])
def test_the_thermostat_is_exact_at_any_step(h):
    copies, gamma, kt, mass = 50_000, 0.8, 0.6, 3.0
    free = kd.Langevin(lambda x: 0 * x, gamma, kt, mass, seed=5)
    for method in ("baoab", "obabo"):
        sol = solve(free, h, np.zeros(copies), np.full(copies, 1.5), h, method)
        v, mean = sol.v[-1], 1.5 * math.exp(-gamma * h)
        assert abs(z_score(v, mean)) < 4
        assert abs(z_score((v - mean) ** 2, kt / mass * (1 - math.exp(-2 * gamma * h)))) < 4


def test_free_diffusion():
    copies, gamma, kt, mass, t, h = 50_000, 1.5, 0.6, 2.0, 8.0, 0.05
    rng = np.random.default_rng(6)
    v0 = math.sqrt(kt / mass) * rng.normal(size=copies)
    sol = solve(
        kd.Langevin(lambda x: 0 * x, gamma, kt, mass, seed=7), t, np.zeros(copies), v0, h, "baoab", save_every=20
    )
    # Ornstein and Uhlenbeck, from an equilibrium of the velocities.
    exact = 2 * kt / (mass * gamma**2) * (gamma * sol.t - 1 + np.exp(-gamma * sol.t))
    for x, expected in zip(sol.x[1:], exact[1:], strict=True):
        assert abs(z_score(x**2, expected)) < 4
        assert abs(z_score(x**2, 1.1 * expected)) > 4


def test_equipartition_with_masses_and_frictions_of_each_number():
    mass, friction, kt = np.array([1.0, 5.0, 30.0]), np.array([0.5, 2.0, 1.0]), 0.8
    problem = kd.Langevin(lambda x: -x - x**3, friction, kt, mass, seed=8)
    copies = (3000, 3)
    sol = solve(problem, 60.0, np.zeros(copies), np.zeros(copies), 0.1, "obabo", save_every=4)
    for k in range(3):
        assert abs(z_score(mass[k] * (sol.v[75:, :, k] ** 2).mean(axis=0), kt)) < 4
        # The virial theorem: <x dV/dx> = kT.
        x = sol.x[75:, :, k]
        assert abs(z_score((x**2 + x**4).mean(axis=0), kt)) < 4


def test_positions_in_a_double_well_have_boltzmanns_distribution():
    def variance(method):
        well = kd.Langevin(lambda x: 4 * x * (1 - x * x), 1.0, 0.4, seed=17)  # V = (x^2 - 1)^2
        start = np.where(np.arange(20_000) % 2, 1.0, -1.0), np.zeros(20_000)
        return (solve(well, 80.0, *start, 0.2, method, save_every=2).x[50:] ** 2).mean(axis=0)

    x = np.linspace(-4, 4, 4001)
    weights = np.exp(-((x * x - 1) ** 2) / 0.4)
    exact = x * x @ weights / weights.sum()
    assert abs(z_score(variance("baoab"), exact)) < 4
    assert z_score(variance("obabo"), exact) < -6
    assert z_score(variance("aboba"), exact) < -6


@pytest.mark.parametrize("method", SPLITTINGS)
def test_at_temperature_zero_it_is_exact_damping_to_the_bit(method):
    letters = tuple(
        (Letter.DAMP if letter is Letter.THERMOSTAT else letter, weight)
        for letter, weight in kd.methods.get(method).word
    )
    symmetric = kd.methods.get(method).symmetric
    damped = Method("damped", 1, letters, symmetric, Kind.DAMPED, "a test")
    cold = solve(kd.Langevin(double_well, 0.7, 0.0, 2.0, seed=9), 5.0, 0.8, 0.3, 0.1, method)
    still = solve(kd.Damped(double_well, 1.4, 2.0), 5.0, 0.8, 0.3, 0.1, damped)
    assert np.array_equal(cold.x, still.x)
    assert np.array_equal(cold.v, still.v)


def test_the_drift_implicit_method_at_temperature_zero_is_implicit_euler():
    cold = solve(kd.Langevin(double_well, 0.7, 0.0, 2.0), 5.0, 0.8, 0.3, 0.1, IMPLICIT)
    still = solve(kd.Damped(double_well, 1.4, 2.0), 5.0, 0.8, 0.3, 0.1, "implicit-euler")
    assert np.allclose(cold.x, still.x, rtol=1e-12)


def test_the_drift_implicit_method_bears_stiff_springs_and_friction():
    stiff = kd.Langevin(lambda x: -1e4 * x, friction=1e3, temperature=1.0, seed=10)
    steps, h = 600, 0.1  # h omega = 10, h gamma = 100
    start = np.full(20, 0.01), np.zeros(20)
    bounded = solve(stiff, h * steps, *start, h, IMPLICIT)
    assert bounded.success
    expected = stationary(IMPLICIT, h, omega=100.0, gamma=1e3)[0, 0]
    assert abs(z_score((bounded.x[50:] ** 2).mean(axis=0), expected)) < 4
    for method in SPLITTINGS:
        assert not np.abs(solve(stiff, h * steps, *start, h, method).x[-1]).max() < 1e100


# The same seed, the same bits.


@numba.njit(parallel=True)
def shared_springs(x, out):
    for i in numba.prange(x.size):
        out[i] = -x[i] * (1.0 + 0.1 * i)


def on_threads(n):
    kept = numba.get_num_threads()
    numba.set_num_threads(n)
    try:
        start = np.linspace(-1, 1, 40), np.zeros(40)
        return solve(kd.Langevin(shared_springs, 1.0, 1.0, seed=12), 10.0, *start, 0.1, "baoab", compile=True)
    finally:
        numba.set_num_threads(kept)


def test_any_number_of_threads_gives_the_same_bits():
    runs = [on_threads(n) for n in range(1, numba.config.NUMBA_NUM_THREADS + 1)]
    assert all(np.array_equal(runs[0].x, run.x) for run in runs)


def spring_and_cube(x):
    return -x - 0.1 * x * x * x


COPIES = np.linspace(-1, 1, 11)


def seeded(seed, method="baoab", **options):
    return solve(kd.Langevin(spring_and_cube, 1.0, 1.0, seed=seed), 5.0, COPIES, 0 * COPIES, 0.1, method, **options)


def test_runs_at_the_same_time_and_one_after_the_other_give_the_same_bits():
    alone = [seeded(seed, compile=True) for seed in range(4)]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda seed: seeded(seed, compile=True), range(4)))
    for one, other in zip(alone, together, strict=True):
        assert np.array_equal(one.x, other.x)
        assert np.array_equal(one.v, other.v)
    assert len({run.x.tobytes() for run in alone}) == 4


@pytest.mark.parametrize(("method", "compensated"), [("obabo", False), (IMPLICIT, True)])
def test_compiled_and_interpreted_give_the_same_bits(method, compensated):
    runs = [seeded(13, method, compile=compile_, compensated=compensated) for compile_ in (True, False)]
    assert np.array_equal(runs[0].x, runs[1].x)
    assert np.array_equal(runs[0].v, runs[1].v)


def test_what_is_saved_does_not_matter():
    every = seeded(14)
    assert np.array_equal(every.x[::5], seeded(14, save_every=5).x)
    assert np.array_equal(every.x[[7, 50]], seeded(14, t_eval=[0.7, 5.0]).x)


def test_a_state_of_more_numbers_has_the_noise_of_fewer():
    problem = kd.Langevin(spring_and_cube, 1.0, 1.0, seed=15)
    few, many = (solve(problem, 2.0, np.ones(n), np.zeros(n), 0.1, "baoab") for n in (5, 12))
    assert np.array_equal(few.x, many.x[:, :5])


@pytest.mark.parametrize("bit", [0, 1, 31, 32, 63])
def test_every_bit_of_the_seed_counts(bit):
    assert not np.isclose(seeded(0).x[-1], seeded(1 << bit).x[-1]).any()


def test_a_run_that_fails_goes_back_to_its_last_good_state_with_its_noise():
    # h omega = 2.5: it grows until it is infinite, in the middle of a chunk of steps that is then run again in parts.
    hot = kd.Langevin(lambda x: -6.25 * x, 1.0, 1.0, seed=16)
    ended = solve(hot, 5000.0, 1.0, 0.0, 1.0, "baoab")
    assert ended.status is kd.Outcome.NOT_FINITE
    assert 100 < ended.n_steps < 5000
    again = solve(hot, float(ended.n_steps), 1.0, 0.0, 1.0, "baoab")
    assert again.success
    assert np.array_equal(ended.x, again.x)
    assert np.array_equal(ended.v, again.v)


def test_bodies_of_the_kernels():
    params = np.array([5.0, 0.5, 0.5, 2.0, 1.0, 3.0, 0.25, 7.0, 9.0])  # one of the user's, frictions, variances, seed
    v, normal = np.array([1.0, -2.0, 3.0]), np.array([0.3, -1.2, 0.8])
    for kernel, arguments in ((noise.relax, (0.3, params, v)), (noise.shake, (0.3, params))):
        outs = normal.copy(), normal.copy()
        kernel(*arguments, outs[0])
        kernel.py_func(*arguments, outs[1])
        assert np.array_equal(*outs)
    lost = np.exp(-0.3 * params[1:4])
    noise.relax(0.3, params, v, normal)
    expected = lost * v + np.sqrt((1 - lost**2) * params[4:7]) * np.array([0.3, -1.2, 0.8])
    assert np.allclose(v + normal, expected, rtol=1e-14)


# What is refused.


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"friction": -1.0}, "friction=-1.0 must be at least 0"),
        ({"temperature": -0.1}, "temperature=-0.1 must be at least 0"),
        ({"temperature": [1.0, 2.0]}, "temperature=\\[1.0, 2.0\\] does not fit"),
        ({"mass": [1.0, -1.0]}, "must be positive"),
        ({"seed": -1}, "seed=-1 must be an integer from 0"),
        ({"seed": 2**64}, "must be an integer"),
        ({"seed": 1.0}, "seed=1.0 must be an integer"),
        ({"seed": True}, "seed=True must be an integer"),
    ],
)
def test_refusals(arguments, sentence):
    problem = kd.Langevin(spring, **{"friction": 1.0, "temperature": 1.0} | arguments)
    with pytest.raises(ArgumentError, match=sentence):
        solve(problem, 1.0, [0.0, 0.0], [0.0, 0.0], 0.1, "baoab")


def test_the_largest_seed_is_kept_exactly():
    assert not np.array_equal(seeded(2**64 - 1).x[-1], seeded(2**64 - 2).x[-1])


def test_noise_does_not_run_backwards():
    with pytest.raises(ArgumentError, match="backwards in time"):
        kd.solve(kd.Langevin(spring, 1.0, 1.0), (1.0, 0.0), 0.0, 0.0, step=0.1, method="baoab", compile=False)
    third = word((Letter.KICK, 1), (Letter.DRIFT, 1), (Letter.THERMOSTAT, "3/2"), (Letter.THERMOSTAT, "-1/2"))
    mine = Method("mine", 1, third, False, Kind.LANGEVIN, "a test")
    with pytest.raises(ArgumentError, match="negative weights"):
        solve(kd.Langevin(spring, 1.0, 1.0), 1.0, 0.0, 0.0, 0.1, mine)


def test_methods_that_do_not_fit_are_refused():
    with pytest.raises(MethodMismatchError, match="use 'baoab'"):
        solve(kd.Langevin(spring, 1.0, 1.0), 1.0, 0.0, 0.0, 0.1, "velocity-verlet")
    with pytest.raises(MethodMismatchError, match="Langevin dynamics"):
        solve(spring, 1.0, 0.0, 0.0, 0.1, "baoab")


def test_a_force_that_depends_on_the_velocity_is_refused():
    with pytest.raises(ArgumentError, match="name them t, x, params, out"):
        solve(kd.Langevin(lambda x, v: -v, 1.0, 1.0), 1.0, 0.0, 0.0, 0.1, "baoab")

"""Mechanics with constraints: SHAKE, RATTLE, and the semi-implicit Euler method with projections."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kickdrift as kd
from kickdrift.core import linear_algebra
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.engine.flows import constraint_rows, constraints
from kickdrift.engine.problem_adapter import describe
from kickdrift.engine.start import Start
from kickdrift.methods import constrained

METHODS = ("rattle", "shake", "projected-kick-drift")


def down(x):
    return np.array([0.0, -1.0])


def on_circle(x):
    return x[0] ** 2 + x[1] ** 2 - 1


def pendulum(**changes):
    return replace(
        kd.Constrained(
            force=down,
            constraint=on_circle,
            jacobian=lambda x: 2 * x,
            energy=lambda x, v: 0.5 * (v[0] ** 2 + v[1] ** 2) + x[1],
        ),
        **changes,
    )


AT_TWO = {"x0": [np.sin(2.0), -np.cos(2.0)], "v0": [0.0, 0.0], "compile": False}


def spherical():
    return kd.Constrained(
        force=lambda x: np.array([0.0, 0.0, -1.0]),
        constraint=lambda x: x[0] ** 2 + x[1] ** 2 + x[2] ** 2 - 1,
        jacobian=lambda x: 2 * x,
        energy=lambda x, v: 0.5 * (v[0] ** 2 + v[1] ** 2 + v[2] ** 2) + x[2],
        invariants={"angular momentum": lambda x, v: x[0] * v[1] - x[1] * v[0]},
    )


SPHERICAL = {"x0": [1.0, 0.0, 0.0], "v0": [0.0, 0.8, 0.3]}


def weights_with_wind(t, x, params, out):
    """Weights 2 and 1 under gravity 1, and a wind that blows on the lower one."""
    out[:] = 0.0
    out[0, 1], out[1, 1] = -2.0, -1.0
    out[1, 0] = params[0] * np.cos(3 * t)


def rods(x):
    # Products, since the power 2 of the interpreter is not always rounded as they are.
    a, b, c, d = x[0, 0], x[0, 1], x[1, 0] - x[0, 0], x[1, 1] - x[0, 1]
    return np.array([a * a + b * b - 1, c * c + d * d - 1])


def rods_jacobian(x, out):
    out[:] = 0.0
    for k in range(2):
        out[0, 0, k] = 2 * x[0, k]
        out[1, 0, k] = -2 * (x[1, k] - x[0, k])
        out[1, 1, k] = 2 * (x[1, k] - x[0, k])


def double(**changes):
    return replace(
        kd.Constrained(
            force=weights_with_wind,
            constraint=rods,
            mass=[[2.0], [1.0]],
            jacobian=rods_jacobian,
            energy=lambda x, v: (v[0] ** 2).sum() + 0.5 * (v[1] ** 2).sum() + 2 * x[0, 1] + x[1, 1],
        ),
        **changes,
    )


DOUBLE = {"x0": [[0.6, -0.8], [0.6, -1.8]], "v0": np.zeros((2, 2))}


def slope(t, values, blocks=20):
    """Slope of the means of blocks over time, and its standard error."""
    rows = t.size // blocks * blocks
    t, means = (a[:rows].reshape(blocks, -1).mean(axis=1) for a in (t, values))
    t = t - t.mean()
    fitted = t @ means / (t @ t)
    left = means - means.mean() - fitted * t
    return fitted, np.sqrt(left @ left / (blocks - 2) / (t @ t))


def drifts(t, values):
    fitted, error = slope(t, values)
    return abs(fitted) > 4 * error


# The figure: constraints at rounding, energy without drift.


@pytest.fixture(scope="module")
def long_spherical():
    return kd.solve(spherical(), (0.0, 2000.0), method="rattle", step=0.02, **SPHERICAL)


@pytest.fixture(scope="module")
def long_double():
    return kd.solve(double(), (0.0, 2000.0), method="rattle", step=0.02, args=[0.0], **DOUBLE)


def test_spherical_pendulum_over_1e5_steps(long_spherical):
    s = long_spherical
    assert s.success
    assert s.n_steps == 100_000
    assert s.n_force_evaluations == 100_001
    assert abs((s.x**2).sum(axis=1) - 1).max() < 1e-14
    assert abs(2 * (s.x * s.v).sum(axis=1)).max() < 1e-14
    assert abs(s.energy - s.energy[0]).max() < 2e-4
    assert not drifts(s.t, s.energy)
    assert np.ptp(s.invariants["angular momentum"]) < 1e-12


def test_double_pendulum_over_1e5_steps(long_double):
    s = long_double
    assert s.success
    assert s.n_steps == 100_000
    rod, rate = s.x[:, 1] - s.x[:, 0], s.v[:, 1] - s.v[:, 0]
    assert abs((s.x[:, 0] ** 2).sum(axis=1) - 1).max() < 1e-14
    assert abs((rod**2).sum(axis=1) - 1).max() < 1e-14
    assert abs((s.x[:, 0] * s.v[:, 0]).sum(axis=1)).max() < 1e-14
    assert abs((rod * rate).sum(axis=1)).max() < 1e-14
    assert abs(s.energy - s.energy[0]).max() < 2e-4
    assert not drifts(s.t, s.energy)


def test_the_energy_of_an_explicit_step_drifts_in_spite_of_its_projections():
    x, v = (np.array(SPHERICAL[name]) for name in ("x0", "v0"))
    energies = []
    for _ in range(2000):
        x, v = x + 0.002 * v, v + 0.002 * np.array([0.0, 0.0, -1.0])
        x /= np.linalg.norm(x)
        v -= (x @ v) * x
        energies.append(0.5 * v @ v + x[2])
    assert drifts(0.002 * np.arange(2000), np.array(energies))


def test_solves_cut_short_drift_and_leave_the_constraints(monkeypatch):
    options = {"method": "rattle", "step": 0.02, "compile": False, "args": [0.0], **DOUBLE}
    whole = kd.solve(double(), (0.0, 40.0), **options)
    assert not drifts(whole.t, whole.energy)
    monkeypatch.setattr(constraints, "MOST_ITERATIONS", 1)
    monkeypatch.setattr(constraints, "ROUNDING", 1.0)
    cut = kd.solve(double(), (0.0, 40.0), **options)
    assert cut.success
    assert drifts(cut.t, cut.energy)
    assert abs((cut.x[:, 0] ** 2).sum(axis=1) - 1).max() > 1e-6


def test_solves_end_once_their_increments_are_rounding():
    asked = []

    def rods(x):
        asked.append(1)
        return np.array([x[0] @ x[0] - 1, (x[1] - x[0]) @ (x[1] - x[0]) - 1])

    falling = kd.Constrained(lambda x: np.array([[0.0, -9.81]] * 2), rods, jacobian=_of_rods)
    start = {"x0": [[1.0, 0.0], [1.0, 1.0]], "v0": np.zeros((2, 2))}
    kd.solve(falling, (0.0, 0.05), step=0.001, method="rattle", compile=False, **start)
    assert len(asked) < 4.5 * 50  # 5.2 a step, were they to go on until they no longer shrink


def _of_rods(x):
    rod, nothing = 2 * (x[1] - x[0]), np.zeros(2)
    return np.array([[2 * x[0], nothing], [-rod, rod]])


@pytest.mark.parametrize("method", METHODS)
def test_interpreted_runs_have_the_bits_of_compiled_ones(method, long_double):
    options = {"t_span": (0.0, 1.0), "method": method, "step": 0.02, "args": [0.0], **DOUBLE}
    interpreted = kd.solve(double(), compile=False, **options)
    compiled = long_double if method == "rattle" else kd.solve(double(), **options)
    assert np.array_equal(interpreted.x, compiled.x[:51])
    assert np.array_equal(interpreted.v, compiled.v[:51])
    without = kd.solve(double(jacobian=None), compile=False, **options)
    assert np.allclose(without.x, interpreted.x, rtol=0, atol=1e-11)
    assert np.array_equal(without.x, kd.solve(double(jacobian=None), **options).x)


# Orders.


def of_angle(angle, rate):
    return np.array([np.sin(angle), -np.cos(angle)]), rate * np.array([np.cos(angle), np.sin(angle)])


def pendulum_reference(end):
    angle, rate = kd.systems.pendulum(2.0).exact(np.array([end]))
    return of_angle(angle[0], rate[0])


def double_in_angles(end, wind):
    """The double pendulum by Lagrange's equations in its two angles."""

    def rates(t, y):
        a, b, u, w = y
        push = wind * np.cos(3 * t)
        mass = [[3, np.cos(a - b)], [np.cos(a - b), 1]]
        force = [
            -np.sin(a - b) * w**2 - 3 * np.sin(a) + push * np.cos(a),
            np.sin(a - b) * u**2 - np.sin(b) + push * np.cos(b),
        ]
        return [u, w, *np.linalg.solve(mass, force)]

    start = [np.arcsin(0.6), 0.0, 0.0, 0.0]
    a, b, u, w = solve_ivp(rates, (0.0, end), start, method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    (upper, of_upper), (rod, of_rod) = of_angle(a, u), of_angle(b, w)
    return np.array([upper, upper + rod]), np.array([of_upper, of_upper + of_rod])


PROBLEMS = {
    "pendulum": (pendulum(), (0.0, 5.0), AT_TWO, pendulum_reference(5.0)),
    "double": (double(), (0.0, 3.0), {**DOUBLE, "args": [0.0], "compile": False}, double_in_angles(3.0, 0.0)),
    "forced": (double(), (0.0, 3.0), {**DOUBLE, "args": [1.5], "compile": False}, double_in_angles(3.0, 1.5)),
}


def observed(name, method, steps, reference=None):
    problem, t_span, options, exact = PROBLEMS[name]
    return kd.analysis.observed_order(problem, method, t_span, steps, reference=reference or exact, **options).order


@pytest.mark.parametrize("name", PROBLEMS)
def test_rattle_has_order_two(name):
    assert observed(name, "rattle", (0.02, 0.01, 0.005)) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("name", PROBLEMS)
def test_projected_kick_drift_has_order_one(name):
    order = observed(name, "projected-kick-drift", (0.008, 0.004, 0.002))
    assert order == pytest.approx(1, abs=0.1)


def test_the_velocities_of_shake_have_order_one_off_the_constraints_and_two_along_them():
    problem, t_span, options, (x, v) = PROBLEMS["pendulum"]
    errors = []
    for step in (0.02, 0.01, 0.005):
        s = kd.solve(problem, t_span, method="shake", step=step, **options)
        along = np.array([-s.x[-1, 1], s.x[-1, 0]])
        errors.append([np.abs(s.x[-1] - x).max(), abs(along @ (s.v[-1] - v)), abs(s.x[-1] @ s.v[-1])])
    orders = np.log2(np.array(errors)[:-1] / np.array(errors)[1:])
    assert np.allclose(orders, [2, 2, 1], atol=0.1)


def test_shake_and_rattle_have_the_same_positions():
    options = {**DOUBLE, "args": [1.5], "compile": False, "t_span": (0.0, 5.0), "step": 0.02}
    shake, rattle = (kd.solve(double(), method=method, **options) for method in ("shake", "rattle"))
    assert np.allclose(shake.x, rattle.x, rtol=0, atol=1e-12)
    assert abs(shake.v - rattle.v).max() > 1e-3


def test_the_reference_of_observed_order_knows_the_constraints():
    problem, t_span, options, exact = PROBLEMS["forced"]
    own, given = (
        kd.analysis.observed_order(problem, "rattle", t_span, (0.02, 0.01), reference=reference, **options).errors
        for reference in (None, exact)
    )
    assert np.allclose(own, given, rtol=0, atol=1e-9)


# Structure.


@pytest.mark.parametrize(("method", "symmetric"), [("rattle", True), ("projected-kick-drift", False)])
def test_there_and_back(method, symmetric):
    options = {"args": [1.5], "compile": False, "step": 0.05, "method": method}
    there = kd.solve(double(), (0.0, 5.0), **DOUBLE, **options)
    back = kd.solve(double(), (5.0, 0.0), there.x[-1], there.v[-1], **options)
    off = abs(back.x[-1] - there.x[0]).max()
    assert off < 1e-12 if symmetric else off > 1e-3
    assert kd.methods.get(method).symmetric is symmetric


def area_after(step):
    """Determinant of a step of the pendulum in its angle and rate, by central differences."""

    def in_angles(angle, rate):
        x, v = step(*of_angle(angle, rate))
        return np.array([np.arctan2(x[0], -x[1]), -x[1] * v[0] + x[0] * v[1]])

    d = 1e-4
    columns = [
        (in_angles(1.0 + d * e, 0.7 + d * f) - in_angles(1.0 - d * e, 0.7 - d * f)) / (2 * d) for e, f in np.eye(2)
    ]
    return np.linalg.det(np.array(columns))


@pytest.mark.parametrize("method", ["rattle", "projected-kick-drift"])
def test_steps_preserve_area(method):
    def step(x, v):
        s = kd.solve(pendulum(), (0.0, 0.3), x, v, step=0.3, method=method, compile=False)
        return s.x[-1], s.v[-1]

    assert area_after(step) == pytest.approx(1, abs=1e-7)


def test_a_step_that_goes_back_along_the_gradient_where_it_arrives_does_not_preserve_area():
    def step(x, v):
        v = v + 0.3 * down(x)
        arrived = (x + 0.3 * v) / np.linalg.norm(x + 0.3 * v)
        v = (arrived - x) / 0.3
        return arrived, v - (arrived @ v) * arrived

    assert abs(area_after(step) - 1) > 1e-3


# Larger systems, and redundant constraints.


def links(x):
    return ((x - np.vstack((np.zeros((1, 3)), x[:-1]))) ** 2).sum(axis=1) - 1


def chain(**changes):
    weight = 2.0
    return kd.Constrained(
        force=lambda x: 0 * x + np.array([0.0, 0.0, -weight]),
        constraint=links,
        mass=weight,
        energy=lambda x, v: 0.5 * weight * (v**2).sum() + weight * x[:, 2].sum(),
        **changes,
    )


def test_a_chain_of_twenty_links_swings():
    along = np.array([0.6, 0.0, -0.8])
    x0 = np.arange(1, 21)[:, None] * along
    s = kd.solve(chain(), (0.0, 3.0), x0, np.zeros((20, 3)), step=0.02, method="rattle", compile=False)
    assert s.success, s.message
    assert abs(np.array([links(x) for x in s.x])).max() < 1e-12
    assert abs(s.energy - s.energy[0]).max() < 1e-3 * np.ptp([2 * x[:, 2].sum() for x in s.x])


def test_a_hanging_chain_rests_and_each_link_carries_what_is_below():
    x0 = np.arange(1, 21)[:, None] * np.array([0.0, 0.0, -1.0])
    s = kd.solve(chain(), (0.0, 1.0), x0, np.zeros((20, 3)), step=0.05, method="rattle", compile=False)
    assert abs(s.x - x0).max() < 1e-12
    # The gradient of a link's constraint is twice its unit vector: its force is 2 lambda.
    assert np.allclose(2 * s.multipliers, 2.0 * np.arange(20, 0, -1), rtol=1e-9)


def test_a_light_weight_below_a_heavy_one():
    problem = double(mass=[[1e4], [1e-4]], force=lambda x: np.array([[0.0, -1e4], [0.0, -1e-4]]), energy=None)
    s = kd.solve(problem, (0.0, 5.0), method="rattle", step=0.01, compile=False, **DOUBLE)
    assert s.success, s.message
    assert abs(np.array([rods(x) for x in s.x])).max() < 1e-12


@pytest.mark.parametrize(
    ("redundant", "jacobian"),
    [
        (lambda x: np.array([on_circle(x), on_circle(x)]), lambda x: np.array([2 * x, 2 * x])),
        (
            lambda x: np.array([on_circle(x), (2 + x[0]) * on_circle(x)]),
            lambda x: np.array([2 * x, 2 * (2 + x[0]) * x + np.array([on_circle(x), 0.0])]),
        ),
        (
            lambda x: np.array([1e3 * on_circle(x), np.sqrt(x[0] ** 2 + x[1] ** 2) - 1]),
            lambda x: np.array([2e3 * x, x / np.sqrt(x[0] ** 2 + x[1] ** 2)]),
        ),
    ],
    ids=["twice", "another multiple elsewhere", "square and distance"],
)
@pytest.mark.parametrize("given", [True, False])
def test_redundant_constraints_move_as_one(redundant, jacobian, given):
    jacobian = jacobian if given else None
    options = {**AT_TWO, "t_span": (0.0, 5.0), "step": 0.02, "method": "rattle"}
    both, single = (
        kd.solve(kd.Constrained(down, redundant, jacobian=jacobian), **options),
        kd.solve(pendulum(), **options),
    )
    assert both.success, both.message
    assert np.allclose(both.x, single.x, rtol=0, atol=1e-10)
    if jacobian is not None:
        gradients = np.array([jacobian(x) for x in both.x])
        force = np.einsum("tmn,tm->tn", gradients, both.multipliers)
        assert np.allclose(force, 2 * single.x * single.multipliers, rtol=0, atol=1e-9)


def test_constraints_said_twice_share_the_force():
    twice = kd.Constrained(down, lambda x: np.array([on_circle(x), on_circle(x)]))
    options = {**AT_TWO, "t_span": (0.0, 1.0), "step": 0.1, "method": "rattle"}
    both, single = kd.solve(twice, **options).multipliers, kd.solve(pendulum(), **options).multipliers
    assert np.allclose(both, 0.5 * single, atol=1e-7)


SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
SIDES = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3)]


def square_of(n_rods):
    """Four weights, held in a square by four sides, one diagonal and, redundant, the other."""
    pairs = SIDES[:n_rods]
    return kd.Constrained(
        force=lambda x: 0 * x + np.array([0.0, -1.0]),
        constraint=lambda x: np.array([((x[i] - x[j]) ** 2).sum() - (1 + (i + 2 == j)) for i, j in pairs]),
        mass=[[1.0], [2.0], [3.0], [4.0]],
    )


def test_a_rigid_square_with_both_diagonals_moves_as_with_one():
    spin = 2 * (SQUARE - 0.5) @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    options = {"x0": SQUARE, "v0": spin, "step": 0.02, "method": "rattle", "compile": False, "t_span": (0.0, 3.0)}
    one, both = kd.solve(square_of(5), **options), kd.solve(square_of(6), **options)
    assert both.success, both.message
    assert both.multipliers.shape == (151, 6)
    assert np.allclose(one.x, both.x, rtol=0, atol=1e-10)


# What is refused.


def linkage(x):
    """A parallelogram of rods 1, 2, 1 between pivots at 0 and 2."""
    return np.array([(x[0] ** 2).sum() - 1, (x[1, 0] - 2) ** 2 + x[1, 1] ** 2 - 1, ((x[1] - x[0]) ** 2).sum() - 4])


def with_(jacobian):
    return pendulum(jacobian=jacobian)


ON = ([0.6, -0.8], [0.0, 0.0])


@pytest.mark.parametrize(
    ("problem", "start", "reason"),
    [
        (with_(lambda x: np.array([2 * x[0], -2 * x[1]])), ON, r"entry \(0, 1\) is 1.6 .* changes by -1.6 per unit"),
        (with_(lambda x: x), ON, r"entry \(0, 0\) is 0.6 .* changes by 1.2 per unit of x\[0\]"),
        (with_(lambda x: np.array([1.2, 2 * x[1]])), ON, r"entry \(0, 0\) is 1.2 at x=\[0.60\d+"),
        (double(jacobian=lambda x: np.ones((2, 2, 2)), force=down), (DOUBLE["x0"], DOUBLE["v0"]), r"entry \(0, 0, 0\)"),
        (pendulum(), ([0.6, -0.81], [0.0, 0.0]), r"constraint 0 is 0.0161 there, not 0; move it by at most 0.006"),
        (pendulum(), ([0.0, 0.0], [0.0, 0.0]), "check the constraint"),
        (pendulum(), ([0.6, -0.8], [1.0, 0.0]), r"changes at a rate of 1.2, not 0; .* v0=\[0.6"),
        (chain(), (np.ones((20, 3)), np.zeros((20, 3))), "constraint 0 is 2 there, not 0"),
        (kd.Constrained(down, lambda x: on_circle(x) ** 2), ON, r"constraint 0 .* rank found is 0"),
        (kd.Constrained(down, lambda x: 0 * x[0]), ON, r"constraint 0 .* rank found is 0"),
        (
            kd.Constrained(down, lambda x: np.array([on_circle(x), on_circle(x) + 1e-7 * (x[0] - 0.6)])),
            ON,
            r"nearly dependent \(the rank found is 1",
        ),
        (kd.Constrained(down, linkage), ([[1.0, 0.0], [3.0, 0.0]], np.zeros((2, 2))), "found at x0 is 2, but 3 are"),
        (
            kd.Constrained(down, lambda x: np.array([np.hypot(x[0], x[1]) - 0.0])),
            ([0.0, 0.0], [0.0, 0.0]),
            "not finite|rank found",
        ),
        (kd.Constrained(down, lambda x: np.log(x[0])), ([-1.0, 0.0], [0.0, 0.0]), "are not finite"),
        (kd.Constrained(down, lambda x: np.outer(x, x)), ON, r"returns an array of shape \(2, 2\)"),
        (kd.Constrained(down, lambda x: None), ON, "failed at the start"),
        (kd.Constrained(down, lambda t, x: on_circle(x)), ON, "name them x, q, params"),
        (kd.Constrained(lambda x, v: -v, on_circle), ON, "has an argument v"),
        (kd.Constrained(down, on_circle, mass=0.0), ON, "must be positive"),
    ],
)
def test_what_cannot_be_is_refused_before_any_step(problem, start, reason):
    with pytest.raises(ArgumentError, match=reason):
        kd.solve(problem, (0.0, 1.0), *start, step=0.1, method="rattle", compile=False)


def test_the_start_that_a_refusal_offers_is_accepted():
    x0, v0 = [0.6, -0.81], [1.0, 0.0]
    for _ in range(2):
        with pytest.raises(ArgumentError) as refusal:
            kd.solve(pendulum(), (0.0, 1.0), x0, v0, step=0.1, method="rattle", compile=False)
        name, numbers = re.search(r"(x0|v0)=\[([^]]*)\]", str(refusal.value)).groups()
        offered = [float(number) for number in numbers.split(",")]
        x0, v0 = (offered, v0) if name == "x0" else (x0, offered)
    assert kd.solve(pendulum(), (0.0, 1.0), x0, v0, step=0.1, method="rattle", compile=False).success


def test_methods_and_constraints_belong_together():
    with pytest.raises(MethodMismatchError, match="use 'rattle'"):
        kd.solve(pendulum(), (0.0, 1.0), step=0.1, method="leapfrog", **AT_TWO)
    with pytest.raises(MethodMismatchError, match="use 'rattle'"):
        kd.solve(pendulum(), (0.0, 1.0), step=0.1, method="semi-implicit-euler", **AT_TWO)
    for method in METHODS:
        with pytest.raises(MethodMismatchError, match=method):
            kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1, method=method)
    assert kd.solve(pendulum(), (0.0, 1.0), step=0.1, method="auto", **AT_TWO).about.method == "rattle"


def test_a_projection_moves_positions_and_not_the_clock():
    K, D, P, Q = kd.methods.Letter.KICK, kd.methods.Letter.DRIFT, constrained.P, constrained.Q
    rattle = kd.methods.get("rattle")
    late = replace(rattle, name="late", word=kd.methods.word((K, "1/2"), (D, 1), (K, "1/2"), (P, 1), (Q, 1)))
    options = {**DOUBLE, "args": [1.5], "compile": False, "t_span": (0.0, 1.0), "step": 0.01}
    # Its last kick is before the projection, so that the next step's first one has to look again.
    assert kd.solve(double(), method=late, **options).n_force_evaluations == 200
    assert kd.solve(double(), method=rattle, **options).n_force_evaluations == 101


# Steps that cannot be done, and large ones that can.


@pytest.mark.parametrize("method", METHODS)
def test_a_step_out_of_reach_ends_the_run_with_a_sentence(method):
    # A drift of 3 cannot be pulled back to a circle of radius 1 along the radius that it started from.
    s = kd.solve(pendulum(force=lambda x: 0 * x), (0.0, 4.0), [1, 0], [0, 3], step=1.0, method=method, compile=False)
    assert s.status is kd.Outcome.NOT_CONVERGED
    assert s.n_steps == 0
    assert re.search(r"ends at t=0.0, after 0 of 4 steps. The residual was \S+. Try a smaller step", s.message)


def test_a_run_that_comes_to_a_step_out_of_reach_keeps_what_is_done():
    faster = pendulum(force=lambda t, x: t * np.array([-x[1], x[0]]))
    s = kd.solve(faster, (0.0, 40.0), [1.0, 0.0], [0.0, 0.0], step=0.1, method="rattle", compile=False)
    # The speed is t^2 / 2: at a drift of about 1 a step there is no way back.
    assert s.status is kd.Outcome.NOT_CONVERGED
    assert s.t[-1] == pytest.approx(np.sqrt(2 / 0.1), abs=0.3)
    assert abs((s.x**2).sum(axis=1) - 1).max() < 1e-14


def on_sphere_and_cylinder(x):
    """Viviani's curve, which crosses itself in (1, 0, 0), where sphere and cylinder touch."""
    return np.array([x[0] ** 2 + x[1] ** 2 + x[2] ** 2 - 1, (x[0] - 0.5) ** 2 + x[1] ** 2 - 0.25])


def test_a_constraint_that_is_dependent_on_others_but_not_fulfilled_with_them_ends_the_run():
    problem = kd.Constrained(lambda x: 0 * x, on_sphere_and_cylinder)
    regular = describe(
        problem, 0.0, Start(np.array([0.5, 0.5, np.sqrt(0.5)]), np.zeros(3)), np.zeros(0), compile_=False
    )
    crossing, along = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 1.0])
    s = kd.solve(regular, (0.0, 0.1), crossing, along, step=0.1, method="rattle")
    assert s.status is kd.Outcome.NOT_CONVERGED
    with pytest.raises(ArgumentError, match="found at x0 is 1, but 2 are nearby"):
        kd.solve(problem, (0.0, 0.1), crossing, along, step=0.1, method="rattle", compile=False)


def test_large_steps_are_solved_to_rounding():
    # The drift covers 0.95 of the radius, where the kept matrix alone contracts by 0.7 an iteration.
    s = kd.solve(
        pendulum(force=lambda x: 0 * x), (0.0, 95.0), [1, 0], [0, 0.95], step=1.0, method="rattle", compile=False
    )
    assert s.success, s.message
    assert abs((s.x**2).sum(axis=1) - 1).max() < 1e-14
    assert np.allclose((s.v**2).sum(axis=1), 0.95**2, rtol=1e-13)


# Multipliers.


@pytest.mark.parametrize(("jacobian", "accuracy"), [(True, 1e-10), (False, 1e-7)])
@pytest.mark.parametrize("method", METHODS)
def test_the_multiplier_of_a_pendulum_is_the_tension_of_its_string(method, jacobian, accuracy):
    heavy = pendulum(mass=3.0, force=lambda x: np.array([0.0, -3.0]), jacobian=(lambda x: 2 * x) if jacobian else None)
    s = kd.solve(heavy, (0.0, 5.0), method=method, step=0.01, **AT_TWO)
    along = s.v - (s.x * s.v).sum(axis=1, keepdims=True) * s.x
    tension = 3.0 * ((along**2).sum(axis=1) - s.x[:, 1])
    assert s.multipliers.shape == (501, 1)
    # The force -G lambda = -2 x lambda, towards the pivot where lambda is positive.
    assert np.allclose(2 * s.multipliers[:, 0], tension, rtol=0, atol=accuracy * abs(tension).max())
    assert tension.min() < 0 < tension.max()


def test_multipliers_see_the_time():
    s = kd.solve(double(), (0.0, 2.0), method="rattle", step=0.02, args=[1.5], compile=False, **DOUBLE)
    without = kd.solve(double(), (0.0, 2.0), method="rattle", step=0.02, args=[0.0], compile=False, **DOUBLE)
    # At the start, the lower rod hangs straight down, across the wind, and the upper one does not.
    lower_pull = 2 * s.multipliers[0, 1]
    assert lower_pull == pytest.approx(2 * without.multipliers[0, 1] + 2 * (s.multipliers - without.multipliers)[0, 1])
    # The second differences of the positions are what forces and multipliers say.
    i, h = 50, s.step
    acceleration = (s.x[i + 1] - 2 * s.x[i] + s.x[i - 1]) / h**2
    jacobian, force = np.zeros((2, 2, 2)), np.zeros((2, 2))
    rods_jacobian(s.x[i], jacobian)
    weights_with_wind(s.t[i], s.x[i], np.array([1.5]), force)
    predicted = (force - np.einsum("mik,m->ik", jacobian, s.multipliers[i])) / np.array([[2.0], [1.0]])
    assert np.allclose(acceleration, predicted, atol=1e-3)
    assert not np.allclose(acceleration, predicted - force, atol=0.1)


def test_multipliers_are_saved(tmp_path):
    s = kd.solve(pendulum(), (0.0, 1.0), method="rattle", step=0.1, **AT_TWO)
    loaded = kd.load(s.save(tmp_path / "pendulum"))
    assert np.array_equal(loaded.multipliers, s.multipliers)
    with pytest.raises(kd.KickdriftError, match="has no constraints"):
        _ = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1).multipliers


# Kernels.


@pytest.mark.parametrize("compiled", [True, False])
def test_independent_vectors_are_found(compiled):
    independent = linear_algebra.independent if compiled else linear_algebra.independent.py_func
    rng = np.random.default_rng(2)
    for rank, m in ((1, 1), (1, 4), (3, 3), (3, 7), (5, 6)):
        vectors = rng.normal(size=(m, rank)) @ rng.normal(size=(rank, 9))
        vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
        order = np.zeros(m)
        assert independent((vectors @ vectors.T).ravel(), order, 1e-12) == rank
        assert sorted(order) == list(range(m))
        assert np.linalg.matrix_rank(vectors[order[:rank].astype(int)]) == rank
    assert independent(np.full(4, np.nan), np.zeros(2), 1e-12) == 0


@pytest.mark.parametrize("compiled", [True, False])
def test_the_kernels_of_the_projections(compiled):
    def kernel(function):
        return function if compiled else function.py_func

    rng = np.random.default_rng(4)
    n, m = 5, 3
    G, inverse = rng.normal(size=(m, n)), rng.uniform(0.5, 2, n)
    params = np.array([7.0, m, 1.0, *inverse])
    assert kernel(constraint_rows.count)(n, params) == m
    inverse_lengths, sums, products, out = np.zeros(m), np.zeros(m), np.zeros(m * m), np.zeros(n)
    kernel(constraint_rows.measure)(G.ravel(), params, inverse_lengths, sums)
    lengths = np.sqrt((G**2) @ inverse)
    assert np.allclose(inverse_lengths, 1 / lengths)
    assert np.allclose(sums, abs(G).sum(axis=1))
    kernel(constraint_rows.multiply)(G.ravel(), 2 * G.ravel(), inverse_lengths, params, products)
    assert np.allclose(products.reshape(m, m), 2 * (G * inverse) @ G.T / np.outer(lengths, lengths))
    own = np.zeros(constraint_rows.memory_size(n, np.zeros(0), params))
    kernel(constraint_rows.rows_of)(n, m, own)[0][:] = G.ravel()
    assert kernel(constraint_rows.factor_rows)(n, m, params, own)
    assert own[0] == 3
    own[0] = 2
    kernel(constraint_rows.rows_of)(n, m, own)[3][:] = [2, 0, 1]
    assert kernel(constraint_rows.factor_with)(2 * G.ravel(), n, m, params, own)
    assert kernel(constraint_rows.factor_products)(n, m, own)
    matrix, pivots = kernel(constraint_rows.factored)(n, m, own)
    right = np.array([1.0, 2.0, 0.0])
    linear_algebra.lu_solve(matrix, pivots, right)
    chosen = products.reshape(m, m)[np.ix_([2, 0], [2, 0])]
    assert np.allclose(chosen @ right[:2], [1.0, 2.0])
    assert right[2] == 0.0
    kernel(constraint_rows.push)(G.ravel(), inverse_lengths, np.array([2.0, 0, 1]), right, params, out)
    assert np.allclose(out, inverse * (right[:2] / lengths[[2, 0]] @ G[[2, 0]]))
    kernel(constraint_rows.respond)(n, m, params, own)
    response, left = kernel(constraint_rows.response_of)(n, m, own), np.array([0.3, 5.0, -0.7])
    kernel(constraint_rows.apply)(response, left, out)
    multipliers = np.append(np.linalg.solve(chosen, -(left / lengths)[[2, 0]]) / lengths[[2, 0]], 0.0)
    assert np.allclose(out, inverse * (multipliers @ G[[2, 0, 1]]))
    assert constraint_rows.farthest(np.array([1.0, -8.0, 2.0]), np.array([1.0, 4.0, 2.0])) == 2.0
    assert np.isnan(constraint_rows.farthest(np.array([np.nan]), np.ones(1)))
    parts = kernel(constraint_rows.iterated)(n, m, own)
    assert [part.size for part in parts] == [m, m, n, n, n]

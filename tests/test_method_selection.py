"""Which method runs on which kind of problem: the whole product, and what ``method="auto"`` takes."""

from dataclasses import replace

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.methods import Kind

METHODS = kd.methods.catalogue()


# A problem of each kind, small and smooth, as keyword arguments of solve.
PROBLEMS = {
    Kind.FIRST_ORDER: {"problem": kd.FirstOrder(lambda y: np.array([y[1], -y[0]])), "x0": [1.0, 0.0]},
    Kind.PARTITIONED: {
        "problem": kd.Partitioned(lambda x, v: x * (1 - v), lambda x, v: v * (x - 1)),
        "x0": 0.5,
        "v0": 1.5,
    },
    Kind.HAMILTONIAN: {
        "problem": kd.Hamiltonian(dHdq=lambda q, p: q * (1 + p * p), dHdp=lambda q, p: p * (1 + q * q)),
        "x0": 0.5,
        "v0": 0.5,
    },
    Kind.SEPARABLE: {"problem": kd.Separable(lambda p: p / np.sqrt(1 + p * p), lambda q: q), "x0": 0.5, "v0": 0.5},
    Kind.VELOCITY_DEPENDENT: {"problem": lambda x, v: -x - 0.1 * v * abs(v), "x0": 1.0, "v0": 0.5},
    Kind.NEWTONIAN: {"problem": lambda x: -x - x**3, "x0": 1.0, "v0": 0.5},
    Kind.DAMPED: {"problem": kd.Damped(lambda x: -x, damping=0.1), "x0": 1.0, "v0": 0.5},
    Kind.CHARGED: {
        "problem": kd.ChargedParticle(1.0, lambda x: np.array([0.0, 0.0, 1.0 + x[0]]), lambda x: -0.1 * x),
        "x0": [1.0, 0.0, 0.0],
        "v0": [0.0, 0.5, 0.1],
    },
    Kind.NEARLY_KEPLERIAN: {
        "problem": kd.systems.planetary(
            [1.0, 1e-3, 1e-3],
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-2.0, 0.0, 0.0]],
            [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -0.7, 0.0]],
        )
    },
    Kind.MULTIRATE: {
        "problem": kd.Multirate(slow_force=lambda x: -x, fast_force=lambda x: -100 * x),
        "x0": 1.0,
        "v0": 0.5,
    },
    Kind.OSCILLATORY: {"problem": kd.Oscillatory(lambda x: -(x**3), omega=10.0), "x0": 1.0, "v0": 0.5},
    Kind.CONSTRAINED: {
        "problem": kd.Constrained(lambda x: np.array([0.0, -1.0]), lambda x: x[0] ** 2 + x[1] ** 2 - 1),
        "x0": [1.0, 0.0],
        "v0": [0.0, 0.5],
    },
    Kind.LANGEVIN: {"problem": kd.Langevin(lambda x: -x, friction=1.0, temperature=1.0), "x0": 1.0, "v0": 0.5},
}

# Rows: what a method is for. Columns, in the order of the enumeration: the problems on which it runs.
RUNS_ON = {
    #                         F P H S V N D C K M O X L
    Kind.FIRST_ORDER: "       1 1 1 1 1 1 1 1 1 1 1 0 0",
    Kind.PARTITIONED: "       0 1 1 1 1 1 1 1 1 1 1 0 0",
    Kind.HAMILTONIAN: "       0 0 1 1 0 1 0 0 1 1 1 0 0",
    Kind.SEPARABLE: "         0 0 0 1 0 1 0 0 1 1 1 0 0",
    Kind.VELOCITY_DEPENDENT: "0 0 0 0 1 1 1 1 1 1 1 0 0",
    Kind.NEWTONIAN: "         0 0 0 0 0 1 0 0 1 1 1 0 0",
    Kind.DAMPED: "            0 0 0 0 0 0 1 0 0 0 0 0 0",
    Kind.CHARGED: "           0 0 0 0 0 0 0 1 0 0 0 0 0",
    Kind.NEARLY_KEPLERIAN: "  0 0 0 0 0 0 0 0 1 0 0 0 0",
    Kind.MULTIRATE: "         0 0 0 0 0 0 0 0 0 1 1 0 0",
    Kind.OSCILLATORY: "       0 0 0 0 0 0 0 0 0 0 1 0 0",
    Kind.CONSTRAINED: "       0 0 0 0 0 0 0 0 0 0 0 1 0",
    Kind.LANGEVIN: "          0 0 0 0 0 0 0 0 0 0 0 0 1",
}


def solve(kind, method, **options):
    given = PROBLEMS[kind]
    if kind is Kind.NEARLY_KEPLERIAN and method != "wisdom-holman-switched":  # whose flow is compiled in any case
        given = {"problem": replace(given["problem"], native=False)}  # or all implicit flows would be compiled for it
    return kd.solve(t_span=(0.0, 0.02), step=0.01, method=method, compile=False, **given, **options)


def test_the_table_and_the_problems_are_complete():
    assert set(RUNS_ON) == set(PROBLEMS) == set(Kind)
    assert {len(row.split()) for row in RUNS_ON.values()} == {len(Kind)}
    assert list(Kind) == list(PROBLEMS)


@pytest.mark.parametrize("method", METHODS.values(), ids=lambda method: method.name)
def test_a_method_runs_on_a_problem_or_is_refused(method):
    for kind, mark in zip(Kind, RUNS_ON[method.kind].split(), strict=True):
        runs = mark == "1"
        if runs or (kind is Kind.HAMILTONIAN and method.counterpart):
            solution = solve(kind, method.name)
            assert solution.success, kind
            assert solution.about.kind == kind.name
            assert solution.about.method == (method.name if runs and not method.counterpart else solution.about.method)
            continue
        with pytest.raises(MethodMismatchError, match=f"method='{method.name}' is for .*; use ") as refusal:
            solve(kind, method.name)
        instead = str(refusal.value).split("use '")[1].split("'")[0]
        assert solve(kind, instead).success, kind


@pytest.mark.parametrize(
    ("name", "stands_for"),
    [
        ("semi-implicit-euler", "implicit-kick-drift"),
        ("drift-kick", "implicit-drift-kick"),
        ("stormer-verlet", "implicit-verlet"),
        ("position-verlet", "implicit-position-verlet"),
    ],
)
def test_classical_names_mean_their_implicit_forms_for_hamiltonians_that_are_not_separable(name, stands_for):
    assert solve(Kind.HAMILTONIAN, name).about.method == stands_for


@pytest.mark.parametrize(
    ("kind", "order", "name"),
    [
        (Kind.NEWTONIAN, 1, "velocity-verlet"),
        (Kind.NEWTONIAN, 2, "velocity-verlet"),
        (Kind.NEWTONIAN, 4, "blanes-moan-srkn6b"),
        (Kind.NEWTONIAN, None, "blanes-moan-srkn11b"),
        (Kind.NEWTONIAN, 5, "blanes-moan-srkn11b"),
        (Kind.NEWTONIAN, 6, "blanes-moan-srkn11b"),
        (Kind.NEWTONIAN, 8, "kahan-li-8"),
        (Kind.NEWTONIAN, 10, "sofroniou-spaletta-10"),
        (Kind.SEPARABLE, None, "blanes-moan-s10"),
        (Kind.HAMILTONIAN, 4, "gauss-4"),
        (Kind.HAMILTONIAN, None, "dop853"),
        (Kind.PARTITIONED, None, "dop853"),
        (Kind.FIRST_ORDER, None, "dop853"),
        (Kind.VELOCITY_DEPENDENT, None, "dop853"),
        (Kind.SEPARABLE, 4, "blanes-moan-s6"),
        (Kind.SEPARABLE, 6, "blanes-moan-s10"),
        (Kind.SEPARABLE, 8, "kahan-li-8"),
    ],
)
def test_auto_takes_what_is_best_for_the_structure_and_order(kind, order, name):
    assert solve(kind, "auto", order=order).about.method == name
    assert kd.methods.preferred(kind, order).name == name


@pytest.mark.parametrize("kind", Kind, ids=lambda kind: kind.name.lower())
def test_auto_runs_on_every_kind(kind):
    solution = solve(kind, "auto")
    assert solution.success
    assert solution.about.order >= 2


@pytest.mark.parametrize("kind", Kind, ids=lambda kind: kind.name.lower())
def test_auto_refuses_an_order_that_there_is_not(kind):
    with pytest.raises(MethodMismatchError, match=r"order=12 is higher than .* the highest is "):
        solve(kind, "auto", order=12)


@pytest.mark.parametrize("order", [0, -2, 2.5, "4", True])
def test_an_order_that_is_none_is_refused(order):
    with pytest.raises(ArgumentError, match="order="):
        solve(Kind.NEWTONIAN, "auto", order=order)


def test_an_order_without_auto_is_refused():
    with pytest.raises(ArgumentError, match="order=4 is for method='auto'"):
        solve(Kind.NEWTONIAN, "velocity-verlet", order=4)


@pytest.mark.parametrize(
    ("kind", "order", "name"),
    [
        (Kind.NEWTONIAN, None, "semi-implicit-euler"),
        (Kind.FIRST_ORDER, None, "semi-implicit-euler"),
        (Kind.CONSTRAINED, None, "rattle"),
        (Kind.LANGEVIN, None, "baoab"),
        (Kind.NEWTONIAN, 6, "blanes-moan-srkn11b"),
    ],
)
def test_without_a_method_it_is_semi_implicit_euler_or_what_fits(kind, order, name):
    assert solve(kind, None, order=order).about.method == name


def test_a_refusal_names_the_description_that_would_fit():
    with pytest.raises(MethodMismatchError, match=r"use 'implicit-verlet' \(order 2\), or describe it as kd.Charged"):
        solve(Kind.VELOCITY_DEPENDENT, "boris")


# What is much faster than a step.


def decaying(rate, many=0):
    """y' = -rate (y - cos t) beside a rotation, or in each of many components."""

    def rates(t, y):
        if many:
            return -rate * (y - np.cos(t))
        return np.array([-rate * (y[0] - np.cos(t)), y[2], -y[1]])

    return {"problem": kd.FirstOrder(rates), "x0": np.linspace(0.5, 1.0, many or 3)}


def taken(step, order=None, **problem):
    return kd.solve(t_span=(0.0, 4 * step), step=step, method="auto", order=order, compile=False, **problem).about


@pytest.mark.parametrize("many", [0, 60])
def test_auto_is_l_stable_where_decays_are_much_faster_than_the_step(many):
    assert taken(0.01, **decaying(1e4, many)).method == "radau-5"
    assert taken(0.0001, **decaying(1e4, many)).method == "dop853"
    assert "stiff" in taken(0.01, **decaying(1e4, many)).choice
    assert taken(0.01, **decaying(-1e4, many)).method != "radau-5"  # what grows is not stiff


@pytest.mark.parametrize(
    ("order", "name"), [(1, "implicit-euler"), (2, "radau-3"), (4, "radau-5"), (6, "radau-7"), (8, "gauss-8")]
)
def test_auto_keeps_the_order_wanted_where_it_is_stiff(order, name):
    assert taken(0.01, order, **decaying(1e4)).method == name


def test_auto_takes_a_higher_order_for_many_stiff_steps():
    def method(steps):
        problem = decaying(1e4)
        return kd.solve(t_span=(0.0, 0.1 * steps), step=0.1, method="auto", compile=False, **problem).about.method

    assert (method(50), method(51)) == ("radau-5", "radau-7")


def test_auto_sees_stiffness_that_starts_after_the_first_steps():
    def robertson(y):
        slow, middle, fast = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]
        return np.array([middle - slow, slow - middle - fast, fast])

    problem = {"problem": kd.FirstOrder(robertson), "x0": [1.0, 0.0, 0.0]}  # whose fastest decay there takes 25 units
    assert taken(1.0, **problem).method == "radau-5"
    assert taken(1e-4, **problem).method == "dop853"


def test_auto_sees_stiffness_that_starts_later():
    def warming(y):
        return np.array([1.0, -10.0 * y[0] * (y[1] - 1.0)])  # decays at 10 t

    problem = {"problem": kd.FirstOrder(warming), "x0": [0.0, 0.5]}

    def method(end):
        return kd.solve(t_span=(0.0, end), step=0.1, method="auto", compile=False, **problem).about.method

    assert method(5.0) == "dop853"  # and 50 at the end: as fast as it bears
    assert method(400.0) == "radau-7"


def test_auto_sees_stiffness_far_beyond_the_first_steps():
    def hires(y):
        fast = 280.0 * y[5] * y[7]
        return np.array(
            [
                -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007,
                1.71 * y[0] - 8.75 * y[1],
                -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4],
                8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3],
                -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6],
                -fast + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6],
                fast - 1.81 * y[6],
                -fast + 1.81 * y[6],
            ]
        )

    def method(step):  # decays at 10 at the start, at 150 after three units of time
        start = [1.0, 0, 0, 0, 0, 0, 0, 0.0057]
        return kd.solve(kd.FirstOrder(hires), (0.0, 10.0), start, step=step, method="auto", compile=False).about.method

    assert method(0.04) == "radau-7"
    assert method(0.02) == "dop853"


def test_auto_sees_no_stiffness_where_there_is_none():
    def lorenz(y):
        return np.array([10.0 * (y[1] - y[0]), y[0] * (28.0 - y[2]) - y[1], y[0] * y[1] - 8.0 / 3.0 * y[2]])

    def brusselator(y):
        return np.array([1.0 + y[0] * y[0] * y[1] - 4.0 * y[0], 3.0 * y[0] - y[0] * y[0] * y[1]])

    for rates, start, step in ((lorenz, [1.0, 1.0, 20.0], 0.15), (brusselator, [1.5, 3.0], 0.4)):
        run = kd.solve(kd.FirstOrder(rates), (0.0, 150.0), start, step=step, method="auto", compile=False)
        assert run.about.method == "dop853"  # whose decays reach 21 and 9.7


def test_auto_neither_damps_nor_lets_grow_oscillations_much_faster_than_the_step():
    def turning(y):
        return np.array([100.0 * y[1], -100.0 * y[0]])

    problem = {"problem": kd.FirstOrder(turning), "x0": [1.0, 0.0]}
    assert taken(0.1, **problem).method == "gauss-4"
    assert taken(0.01, **problem).method == "dop853"
    many = {
        "problem": kd.FirstOrder(lambda y: 100.0 * np.concatenate([y[30:], -y[:30]])),
        "x0": np.linspace(0.5, 1.0, 60),
    }
    assert taken(0.1, **many).method == "gauss-4"
    assert taken(0.01, **many).method == "dop853"


def test_auto_leaves_a_function_that_fails_off_the_way_to_the_run():
    def rooted(y):
        if y[0] > 1.0:
            raise ValueError("beyond")
        return -1e4 * y

    assert taken(0.01, problem=kd.FirstOrder(rooted), x0=[1.0]).method == "dop853"


def test_a_report_says_why_auto_took_a_method():
    solution = solve(Kind.NEWTONIAN, "auto")
    assert "fastest" in solution.about.choice
    assert solution.about.choice in solution.report()
    assert "chosen because" not in solve(Kind.NEWTONIAN, "velocity-verlet").report()

"""Bad input: one clear error, with the argument, its value and the remedy, before any work is done."""

import dataclasses

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.methods.tableau import Tableau

GOOD = {"t_span": (0.0, 1.0), "x0": [1.0, 0.0], "v0": [0.0, 1.0], "step": 0.1, "compile": False}


def spring(x):
    return -x


def _adds_to_out(x, out):
    out[:] -= x


async def _awaited(x):
    return -x


def _yields(x):
    yield -x


def _changes_x(x):
    x += 1.0
    return -x


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"x0": None}, "x0 is missing"),
        ({"v0": None}, "v0 is missing"),
        ({"x0": [1.0, 2.0, 3.0]}, r"v0 has shape \(2,\) but x0 has shape \(3,\)"),
        ({"v0": 1.0}, "v0 has shape"),
        ({"x0": [], "v0": []}, "empty"),
        ({"x0": [np.nan, 0.0]}, "x0 is nan at index"),
        ({"v0": [0.0, np.inf]}, r"v0 is inf at index \(1,\)"),
        ({"x0": ["a", "b"]}, "x0=.*not an array of numbers"),
        ({"x0": [1j, 2]}, "complex"),
        ({"x0": [[1.0], [2.0, 3.0]]}, "not an array of numbers"),
        ({"step": 0}, "step=0 must be positive"),
        ({"step": -0.1}, "step=-0.1 must be positive.*t_span sets the direction"),
        ({"step": np.nan}, "step=nan must be positive"),
        ({"step": np.inf}, "step=inf must be positive"),
        ({"step": "fast"}, "step='fast' must be a number"),
        ({"step": 10**400}, r"step=10{10,50}\.\.\.0{10,50} must be a number"),
        ({"t_span": (0.0, 7 * 10**400)}, r"t_span=\(0.0, 70{10,50}\.\.\.0{10,50}\) must be two numbers"),
        ({"step": None}, "step is missing"),
        ({"step": 2.0}, "step=2.0 is larger than t_span"),
        ({"step": 1e-18}, "more than float64 can count"),
        ({"t_span": (0.0, 0.0)}, "is empty"),
        ({"t_span": (0.0, np.nan)}, "must be finite"),
        ({"t_span": (0.0, np.inf)}, "must be finite"),
        ({"t_span": (0.0,)}, "two numbers"),
        ({"t_span": (0.0, 1.0, 2.0)}, "two numbers"),
        ({"t_span": 3.0}, "two numbers"),
        ({"t_span": ("a", "b")}, "two numbers"),
        ({"t_span": (1e20, 1e20 + 1), "step": 0.1}, "is empty"),
        ({"method": "leapfrg"}, "method='leapfrg' is unknown; did you mean 'leapfrog'"),
        ({"method": "qqq"}, "known: "),
        ({"method": 3}, "method=3 is unknown"),
        ({"t_eval": [2.0]}, r"t_eval=.*2.0.* lies outside t_span"),
        ({"t_eval": [-0.1]}, "lies outside"),
        ({"t_eval": [np.nan]}, "lies outside"),
        ({"t_eval": []}, "at least one time"),
        ({"t_eval": [[0.1]]}, "at least one time"),
        ({"t_eval": 0.5}, "at least one time"),
        ({"t_eval": "now"}, "list of times"),
        ({"t_eval": [0.1], "save_every": 2}, "give one"),
        ({"save_every": 0}, "save_every=0 must be a positive whole number"),
        ({"save_every": -1}, "positive whole number"),
        ({"save_every": 1.5}, "positive whole number"),
        ({"save_every": True}, "positive whole number"),
        ({"step": 1e-9}, "save_every=None keeps all 1000000001 steps.*give save_every="),
        ({"t_span": (1e16, 1e16 + 100), "step": 1.0}, "is lost to rounding beside times of"),
        ({"step": 1e-14, "save_every": 1}, "save_every=1 keeps all .* steps, .* and there is room for"),
        ({"method": ["leapfrog"]}, "is unknown"),
        ({"args": (1.0, np.nan)}, "must be finite"),
        ({"args": "k"}, "args='k' must be numbers"),
        ({"args": [[1.0]]}, "flat list"),
        ({"x0": np.ma.masked_array([1.0], mask=[True])}, "it has masked entries"),
        ({"v0": np.ma.masked_array([1.0], mask=[True])}, "it has masked entries"),
        ({"args": np.ma.masked_array([1.0, 2.0], mask=[True, False])}, "it has masked entries"),
        ({"t_eval": np.ma.masked_array([0.1, 0.2], mask=[True, False])}, "it has masked entries"),
    ],
)
def test_bad_arguments(change, says):
    with pytest.raises(ArgumentError, match=says):
        kd.solve(spring, **{**GOOD, **change})


@pytest.mark.parametrize("held", [True, np.True_, [2.0, True], [[2.0], (np.False_,)], np.array([True, False])])
def test_truth_values_are_no_numbers(held):
    def given(**change):
        return lambda: kd.solve(spring, **{**GOOD, **change})

    bodies, still = np.eye(3)[:2], np.zeros((2, 3))
    for refuses in (
        given(x0=held, v0=held),
        given(args=held),
        given(t_eval=held),
        lambda: kd.solve(kd.Newtonian(spring, mass=held), **{**GOOD, "x0": [[1.0], [0.0]], "v0": [[0.0], [0.0]]}),
        lambda: kd.systems.nbody(held, bodies, still),
        lambda: kd.systems.planetary([1.0, 0.1], bodies, still, radii=held),
        lambda: kd.spline([0.0, 1.0, 2.0], held),
        lambda: kd.solve_ensemble(spring, (0.0, 1.0), held, 0.0, step=0.1),
    ):
        with pytest.raises(ArgumentError, match="True or False"):
            refuses()


def test_a_stride_that_no_64_bits_hold_keeps_the_ends():
    assert kd.solve(spring, **{**GOOD, "save_every": 2**63}).t.tolist() == list(GOOD["t_span"])


@pytest.mark.filterwarnings("ignore::kickdrift.core.errors.InterpretedWarning")
@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("x0", [1.0, [1.0]])
def test_a_return_that_was_forgotten_is_said(x0, compiled):
    def forgetful(x):
        -x  # noqa: B018

    with pytest.raises(ArgumentError, match="it returned None"):
        kd.solve(forgetful, (0.0, 1.0), x0, np.zeros_like(x0), step=0.1, compile=compiled)


@pytest.mark.parametrize(
    ("function", "says"),
    [
        (3.0, "neither a function nor a system"),
        ("kepler", "neither a function nor a system"),
        (None, "neither a function nor a system"),
        (lambda: 0.0, "no arguments"),
        (kd.systems.kepler, "function that creates a system; call it"),
        (_adds_to_out, "must overwrite all of them"),
        (_changes_x, "modifies x"),
        (lambda q: -q, "does not know; name them t, x, v, params, out"),
        (lambda x, k: -k * x, "pass numbers as args"),
        (lambda *args: 0.0, "does not know"),
        (lambda x, **options: -x, "does not know"),
        (lambda x: np.zeros(3), "must return an array of shape"),
        (lambda x: "no", "must return"),
        (lambda x: None, "must return"),
        (lambda x: 1 / 0, "ZeroDivisionError"),
        (lambda x: x.shape[5], "IndexError"),
        (kd.SecondOrder(spring, energy=lambda x: x), "must return one number"),
        (kd.SecondOrder(spring, energy=lambda x, out: 0.0), "does not know"),
        (kd.SecondOrder(spring, energy=3.0), "not a function"),
        (_awaited, "_awaited is an async function"),
        (_yields, "_yields is an async function or a generator"),
    ],
)
def test_bad_functions(function, says):
    with pytest.raises(ArgumentError, match=says):
        kd.solve(function, **GOOD)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: kd.systems.harmonic_oscillator(omega=0.0), "omega=0.0"),
        (lambda: kd.systems.harmonic_oscillator(omega=np.nan), "omega=nan"),
        (lambda: kd.systems.pendulum(amplitude=4.0), "amplitude=4.0"),
        (lambda: kd.systems.pendulum(omega=-1.0), "omega=-1.0"),
        (lambda: kd.systems.kepler(eccentricity=1.0), "eccentricity=1.0"),
        (lambda: kd.systems.kepler(eccentricity=-0.1), "eccentricity=-0.1"),
        (lambda: kd.systems.kepler(mu=0.0), "mu=0.0"),
        (lambda: kd.systems.kepler(semi_major_axis=-1.0), "semi_major_axis=-1.0"),
        (lambda: kd.systems.harmonic_oscillator(omega="1"), "omega='1' must be a number: it holds str"),
        (lambda: kd.systems.harmonic_oscillator(x0=[1.0, 2.0]), "x0=.* must be a number"),
        (lambda: kd.systems.pendulum(amplitude=None), "amplitude=None must be a number"),
        (lambda: kd.systems.kepler(mu=1j), "mu=1j must be a number: it is complex"),
        (lambda: kd.systems.solar_system(["Sun", "Vulcan"]), "bodies='Vulcan' is unknown; "),
        (lambda: kd.systems.solar_system(["Sun", "sun"]), "'Sun' twice"),
        (lambda: kd.systems.solar_system([]), "at least one name"),
        (lambda: kd.systems.solar_system("Sun"), "must be a list"),
        (lambda: kd.System("mine", spring, np.zeros(1), np.zeros(1)), "is not compiled"),
        (lambda: dataclasses.replace(kd.systems.kepler(), v0=np.zeros(3)), "must be equal"),
        (lambda: kd.systems.get(["a"]), "is unknown"),
        (lambda: kd.systems.get("keppler"), "did you mean 'kepler'"),
        (lambda: kd.systems.nbody([1.0], np.zeros((2, 3)), np.zeros((2, 3))), r"x0 has shape \(2, 3\), but 1 masses"),
        (lambda: kd.systems.nbody([1.0, 1.0], np.zeros((2, 2)), np.zeros((2, 2))), "x0 has shape"),
        (lambda: kd.systems.nbody([1.0, -1.0], np.eye(3)[:2], np.zeros((2, 3))), r"masses\[1\]"),
        (lambda: kd.systems.nbody([1.0, np.nan], np.eye(3)[:2], np.zeros((2, 3))), r"masses\[1\]"),
        (lambda: kd.systems.nbody([1.0, 1.0], np.ones((2, 3)), np.zeros((2, 3))), "same position"),
        (lambda: kd.systems.nbody([], [], []), "masses has shape"),
        (lambda: kd.systems.nbody(["a"], [[0, 0, 0]], [[0, 0, 0]]), "arrays of numbers"),
        (lambda: kd.systems.nbody([1.0], [[0, 0, np.inf]], [[0, 0, 0]]), r"x0\[0\]=\[0.0, 0.0, inf\] must be finite"),
        (lambda: kd.systems.nbody([1.0], [[0, 0, 0]], [[0, 0, 0]], G=-1.0), "G=-1.0"),
        (lambda: kd.systems.nbody([1.0], [[0, 0, 0]], [[0, 0, 0]], softening=-1.0), "softening=-1.0"),
        (lambda: kd.systems.nbody([1.0], [[0, 0, 0]], [[0, 0, 0]], names=["a", "b"]), "names="),
    ],
)
def test_bad_systems(make, says):
    with pytest.raises(ArgumentError, match=says):
        make()


def test_a_system_keeps_its_shape_and_its_parameters():
    with pytest.raises(ArgumentError, match="states of shape"):
        kd.solve(kd.systems.kepler(), (0.0, 1.0), [1.0], [0.0], step=0.1)
    with pytest.raises(ArgumentError, match="its own parameters"):
        kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1, args=(1.0,))


def test_every_error_is_a_kickdrift_error_and_says_a_sentence():
    with pytest.raises(kd.KickdriftError) as caught:
        kd.solve(spring, **{**GOOD, "step": -1})
    assert str(caught.value).endswith(".")


def test_errors_hold_any_cause():
    assert str(kd.KickdriftError(OSError("No space left."))) == "No space left."


numbers = st.one_of(st.floats(), st.integers(-3, 3), st.just(0.1))
shapes = hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=3)


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    x0=st.one_of(numbers, shapes.flatmap(lambda shape: hnp.arrays(float, shape))),
    v0=st.one_of(numbers, shapes.flatmap(lambda shape: hnp.arrays(float, shape))),
    t_span=st.tuples(numbers, numbers),
    step=numbers,
    method=st.sampled_from([*kd.methods.catalogue(), "nonsense"]),
    compensated=st.booleans(),
)
def test_solve_gives_a_solution_or_a_kickdrift_error(x0, v0, t_span, step, method, compensated):
    count = abs(t_span[1] - t_span[0]) / abs(step) if step else 0.0
    if 1000 < count < np.inf:
        step = abs(t_span[1] - t_span[0]) / 1000  # keep the interpreted runs short
    try:
        with np.errstate(all="ignore"):
            solution = kd.solve(
                spring, t_span, x0, v0, step=step, method=method, compensated=compensated, compile=False
            )
    except kd.KickdriftError:
        return
    assert np.isfinite(solution.x).all()
    assert np.isfinite(solution.v).all()
    assert solution.x.shape == (solution.t.size, *np.shape(x0))
    assert (np.diff(solution.t) * np.sign(solution.step) > 0).all()
    assert solution.success == (solution.t[-1] == float(t_span[1]))


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    state=st.sampled_from([(), (1,), (3,), (2, 3)]).flatmap(lambda shape: hnp.arrays(float, (2, *shape))),
    t_span=st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)),
    steps=st.floats(0.5, 1000),
    method=st.sampled_from(["kick-drift", "velocity-verlet"]),
)
def test_compiled_runs_give_a_solution_or_a_kickdrift_error(state, t_span, steps, method):
    try:
        solution = kd.solve(spring, t_span, state[0], state[1], step=abs(t_span[1] - t_span[0]) / steps, method=method)
    except kd.KickdriftError:
        return
    assert np.isfinite(solution.x).all()
    assert solution.success or solution.status is kd.Outcome.NOT_FINITE
    assert abs(solution.step) * solution.n_steps <= abs(t_span[1] - t_span[0]) * (1 + 1e-12)


@pytest.mark.parametrize("name", ["compile", "compensated", "progress"])
@pytest.mark.parametrize("value", ["no", 0, np.zeros(3)])
def test_what_is_neither_true_nor_false_is_refused(name, value):
    with pytest.raises(ArgumentError, match=rf"{name}=.* must be True or False"):
        kd.solve(lambda x: -x, t_span=(0, 1), x0=1.0, v0=0.0, step=0.1, **{name: value})


@pytest.mark.parametrize(
    "value", [np.array([1 + 1j]), [1j], np.complex64(1j), 10**400, [10**400], ["1"], [None], [[1], [1, 2]]]
)
@pytest.mark.parametrize("name", ["x0", "v0"])
def test_what_would_lose_a_part_as_a_float_is_refused(name, value):
    start = {"x0": [1.0], "v0": [0.0], name: value}
    with pytest.raises(ArgumentError, match=f"{name}=.* is not an array of numbers"):
        kd.solve(lambda x: -x, t_span=(0, 1), step=0.1, **start)


@pytest.mark.parametrize("method", [np.array(["leapfrog", "verlet"]), np.ones(2), np.array("leapfrog"), [], 10**400])
def test_what_names_no_method_is_refused(method):
    with pytest.raises(ArgumentError, match=r"method=.* is unknown"):
        kd.solve(lambda x: -x, t_span=(0, 1), x0=1.0, v0=0.0, step=0.1, method=method)


@pytest.mark.parametrize("b", [["1/2", "1/2"], [10**400, 1], [0.5, None], 1.0, [[1.0], [1.0, 2.0]], [1j, 1]])
def test_weights_that_are_no_numbers_are_refused(b):
    with pytest.raises(ArgumentError, match=r"b=.* must be"):
        Tableau(a=[[0, 0], [1, 0]], b=b)


def test_a_method_that_claims_more_than_its_word_has_is_refused():
    verlet = kd.methods.get("leapfrog")
    with pytest.raises(ArgumentError, match="order=4 of 'mine': its word has only order 2 on the harmonic oscillator"):
        dataclasses.replace(verlet, name="mine", order=4)
    assert dataclasses.replace(verlet, name="mine").order == 2


@pytest.mark.parametrize(
    ("argument", "value"), [("mass", 1e-320), ("mass", 1 + 1j), ("mass", 10**400), ("invariants", [1, 2])]
)
def test_descriptions_take_what_they_are_given_or_say_why_not(argument, value):
    problem = kd.Newtonian(lambda x: -x, **{argument: value})
    with pytest.raises(ArgumentError, match=f"{argument}="):
        kd.solve(problem, (0, 1), x0=[1.0], v0=[0.0], step=0.1)


def test_names_of_numbers_belong_to_ensembles():
    with pytest.raises(ArgumentError, match=r"in order: give args=\(4\.0, 1\)"):
        kd.solve(lambda x, params: -params[0] * x, **GOOD, args={"k": 4.0, "c": 1})


@pytest.mark.parametrize(
    ("solve", "start"), [(kd.solve, {"x0": 1.0, "v0": 0.0}), (kd.solve_ensemble, {"x0": [1.0], "v0": [0.0]})]
)
def test_a_number_that_is_indexed_is_said_to_be_one(solve, start):
    with pytest.raises(ArgumentError, match=r"scalar variable\. x is one number: .* one list per member"):
        solve(lambda x: -x[0], **GOOD | start)


@pytest.mark.parametrize("compiled", [False, True])
def test_an_index_beyond_params_says_nothing_of_x(compiled):
    with pytest.raises(ArgumentError, match=r"[^.]\. Pass the numbers of params") as caught:
        kd.solve(lambda x, params: -params[0] * x, **GOOD | {"compile": compiled})
    assert "x is one number" not in str(caught.value)

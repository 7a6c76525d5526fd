"""Users' functions: compiled by the names of their arguments, interpreted where Numba cannot, warned about once."""

import json
import math
import warnings
from functools import partial

import numpy as np
import pytest
from numba import njit, types

import kickdrift as kd
from kickdrift.core.compilation import compiled
from kickdrift.core.errors import ArgumentError, InterpretedWarning
from kickdrift.engine.function_key import taken_apart

SPAN = {"t_span": (0.0, 1.0), "step": 0.1}


def with_x(x):
    return -x


def with_t_and_x(t, x):
    return -x + 0.0 * t


def with_everything(params, v, x, t):
    return -params[0] * x + 0.0 * v + 0.0 * t


def into_out(x, out):
    out[:] = -x


def as_list(x):
    return [-x[0], -x[1]]


def as_tuple(x):
    return (-x[0], -x[1])


@pytest.mark.parametrize("function", [with_x, with_t_and_x, with_everything, into_out, as_list, as_tuple])
def test_argument_names_and_results(function):
    reference = kd.solve(kd.systems.harmonic_oscillator(), **SPAN)
    args = (1.0,) if function is with_everything else ()
    s = kd.solve(function, x0=[1.0, 2.0], v0=[0.0, 0.0], args=args, **SPAN)
    assert np.array_equal(s.x[:, 0], reference.x)
    assert np.array_equal(s.x[:, 1], 2 * reference.x)


def into_planes(x, out):
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            out[i, j] = -x[i, j]


def test_planes_arrive_as_planes():
    s = kd.solve(into_planes, x0=np.ones((2, 3)), v0=np.zeros((2, 3)), **SPAN)
    assert np.array_equal(s.x[:, 1, 2], kd.solve(kd.systems.harmonic_oscillator(), **SPAN).x)


def test_a_result_that_broadcasts_is_taken():
    fall = kd.solve(lambda x: np.array([0.0, 0.0, -9.81]), x0=np.zeros((5, 3)), v0=np.zeros((5, 3)), **SPAN)
    assert np.allclose(fall.v[-1], [0.0, 0.0, -9.81])


def test_a_table_of_a_function_may_have_holes():
    table = np.array([4.0, np.nan])

    def spring(x):
        return -table[0] * x

    assert kd.solve(spring, (0.0, 1.0), 1.0, 0.0, step=0.5).x.tolist() == [1.0, 0.0, -1.0]


def test_a_jitted_function_is_used_as_it_is():
    from numba import njit

    s = kd.solve(njit(with_x), x0=1.0, v0=0.0, **SPAN)
    assert np.array_equal(s.x, kd.solve(kd.systems.harmonic_oscillator(), **SPAN).x)


class Spring:
    def __call__(self, x):
        return -x


def test_methods_and_callable_objects_work_interpreted():
    reference = kd.solve(kd.systems.harmonic_oscillator(), **SPAN)
    assert np.array_equal(kd.solve(Spring(), x0=1.0, v0=0.0, compile=False, **SPAN).x, reference.x)
    assert np.array_equal(kd.solve(Spring().__call__, x0=1.0, v0=0.0, compile=False, **SPAN).x, reference.x)


def pulled_by(x, k):
    return -k * x


def test_partials_work():
    half = partial(pulled_by, k=1.0)
    s = kd.solve(half, x0=1.0, v0=0.0, compile=False, **SPAN)
    assert np.array_equal(s.x, kd.solve(kd.systems.harmonic_oscillator(), **SPAN).x)
    with pytest.warns(InterpretedWarning, match="partial runs interpreted"):
        kd.solve(half, x0=1.0, v0=0.0, **SPAN)
    with pytest.warns(InterpretedWarning, match="Spring runs interpreted"):
        kd.solve(Spring(), x0=1.0, v0=0.0, **SPAN)


def uncompilable(x):
    return -json.loads("1.0") * x


def test_what_numba_cannot_compile_runs_interpreted_with_one_warning():
    with pytest.warns(InterpretedWarning, match="uncompilable runs interpreted.*compile=False") as caught:
        s = kd.solve(uncompilable, x0=1.0, v0=0.0, **SPAN)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert np.array_equal(s.x, kd.solve(kd.systems.harmonic_oscillator(), **SPAN).x)


_CALLS = 0


def counting(x):
    global _CALLS
    _CALLS += 1
    return -x


def test_a_function_that_assigns_to_a_global_runs_interpreted():
    with pytest.warns(InterpretedWarning, match="counting runs interpreted"):
        kd.solve(counting, x0=1.0, v0=0.0, **SPAN)
    assert _CALLS > 10


WAVE = np.array([1j, 2j])


def into_out_complex(x, out):
    out[:] = WAVE * x


@pytest.mark.parametrize("compiles", [True, False])
@pytest.mark.parametrize(
    ("force", "why"),
    [
        (lambda x: -x * (1 + 0j), "it returned complex numbers"),
        (lambda x: WAVE * x, "it returned complex numbers"),
        (lambda x: [1j * x[0], 0.0], "it returned complex numbers"),
        (lambda x: np.complex64(1j), "it returned complex numbers"),
        (into_out_complex, "discards the imaginary part"),
    ],
)
@pytest.mark.filterwarnings("ignore::kickdrift.core.errors.InterpretedWarning")
def test_complex_accelerations_are_refused(force, why, compiles):
    with pytest.raises(ArgumentError, match=why):
        kd.solve(force, x0=[1.0, 0.0], v0=[0.0, 0.0], compile=compiles, **SPAN)


def test_an_acceleration_that_becomes_complex_ends_the_run():
    s = kd.solve(lambda x: -np.emath.sqrt(x), x0=1.0, v0=-2.0, compile=False, **SPAN)
    assert s.status.name == "FAILED"
    assert "it returned complex numbers" in s.message


def test_compile_false_silences_the_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        kd.solve(uncompilable, x0=1.0, v0=0.0, compile=False, **SPAN)


def test_compiled_wrong_shapes_are_errors_before_the_run():
    with pytest.raises(ArgumentError, match="must return an array of shape"):
        kd.solve(lambda x: np.zeros(3), x0=[1.0, 0.0], v0=[0.0, 0.0], **SPAN)


def test_energy_and_invariants_of_a_users_system():
    def energy(x, v, params):
        return 0.5 * (v @ v + params[0] * (x @ x))

    def angular_momentum(x, v):
        return x[0] * v[1] - x[1] * v[0]

    problem = kd.SecondOrder(
        lambda x, params: -params[0] * x, energy=energy, invariants={"angular momentum": angular_momentum}
    )
    for compile_ in (True, False):
        s = kd.solve(problem, x0=[1.0, 0.0], v0=[0.0, 0.5], args=(4.0,), compile=compile_, **SPAN)
        assert s.energy[0] == 0.5 * (0.25 + 4.0)
        assert np.allclose(s.invariants["angular momentum"], 0.5, rtol=1e-14)
        assert list(s.invariants) == ["energy", "angular momentum"]


def test_without_an_energy_the_error_says_how_to_give_one():
    s = kd.solve(with_x, x0=1.0, v0=0.0, compile=False, **SPAN)
    with pytest.raises(kd.KickdriftError, match=r"kd\.SecondOrder\(acceleration, energy="):
        _ = s.energy
    with pytest.raises(KeyError):
        s.invariants["energy"]


def _writes_beyond(x, out):
    for i in range(x.size + 1):
        out[i] = -1.0


@pytest.mark.parametrize("n", [2, 300])
@pytest.mark.parametrize(
    "function", [lambda x, params: -params[0] * x, lambda x: -x * x[1000], _writes_beyond], ids=["params", "x", "out"]
)
def test_compiled_functions_do_not_read_or_write_out_of_bounds(function, n):
    with pytest.raises(ArgumentError, match="index out of bounds at the start"):
        kd.solve(function, (0.0, 1.0), np.ones(n), np.ones(n), step=0.1)


def _reads_beyond_later(x, params):
    return -x * params[0 if x[0] > 0.5 else 1000]


def _writes_beyond_later(x, out):
    for i in range(x.size if x[0] > 0.5 else x.size + 1000):
        out[i] = -x[0]


@njit
def _looked_up(table, i):
    return table[i]


def _has_read_beyond_later(x, params):
    return -x * _looked_up(params, 0 if x[0] > 0.5 else 1000)


@pytest.mark.parametrize("n", [2, 300])
@pytest.mark.parametrize("method", ["kick-drift", "runge-kutta-4"])
@pytest.mark.parametrize("function", [_reads_beyond_later, _writes_beyond_later, _has_read_beyond_later])
def test_an_index_out_of_bounds_later_ends_the_run_with_what_was_done(function, method, n):
    s = kd.solve(function, (0.0, 3.0), np.ones(n), np.zeros(n), step=0.01, method=method, args=(1.0,))
    assert s.status is kd.Outcome.FAILED
    assert "IndexError" in s.message
    assert s.x[-1, 0] == pytest.approx(0.5, abs=0.02)


def test_bounds_are_not_checked_where_that_is_not_wanted():
    def last_of_none(x, params):
        return -x + 0.0 * (params.size and params[0])

    options = {**SPAN, "x0": 1.0, "v0": 0.0}
    checked, unchecked = (taken_apart(last_of_none).options(check) for check in (True, False))
    assert (checked["boundscheck"], unchecked["boundscheck"]) == (True, False)
    assert np.array_equal(kd.solve(last_of_none, check_bounds=False, **options).x, kd.solve(last_of_none, **options).x)


def test_an_invariant_that_raises_is_no_number_and_the_run_is_kept(tmp_path):
    problem = kd.SecondOrder(lambda x: -x, energy=lambda x: 1 / 0 if x < 0.9 else 1.0)
    run = kd.solve(problem, (0.0, 1.0), 1.0, 0.0, step=0.1, compile=False)
    assert run.energy[0] == 1.0
    assert np.isnan(run.energy[-1])
    assert kd.load(run.save(tmp_path / "run.npz")).x[-1] == run.x[-1]


@pytest.mark.parametrize("name", ["x", "v", "t", "time", "energy"])
def test_invariants_have_names_of_their_own(name):
    with pytest.raises(ArgumentError, match="which is already in use"):
        kd.solve(
            kd.SecondOrder(lambda x: -x, invariants={name: lambda x: x}), (0, 1), 1.0, 0.0, step=0.1, compile=False
        )


@pytest.mark.parametrize("whole", [10**10, -(10**10), 2**62])
def test_whole_numbers_that_overflow_compiled_are_refused(whole):
    def acceleration(x):
        return -(whole * whole) / 1e20 * x

    for _ in range(2):
        with pytest.raises(ArgumentError, match=r"compiled but .* in Python near the initial state; integers"):
            kd.solve(acceleration, t_span=(0, 1), step=0.1, x0=1.0, v0=0.0)
    exact = kd.solve(acceleration, t_span=(0, 1), step=0.1, x0=1.0, v0=0.0, compile=False)
    assert np.isfinite(exact.x).all()


def test_sums_that_cancel_at_a_symmetric_start_are_no_overflow():
    def acceleration(x, out):
        for i in range(4):
            out[i] = 0.0
            for j in range(4):
                out[i] += 1e30 * (x[j] - x[i]) + 1e30 * math.sin(x[i] + x[j]) * (x[j] - x[i])

    solution = kd.solve(acceleration, t_span=(0, 1e-20), step=1e-21, x0=[0.1, -0.1, 0.3, -0.3], v0=np.zeros(4))
    assert solution.success


def test_functions_of_chance_are_not_compared_with_themselves():
    def acceleration(x):
        return -x + np.random.normal()  # noqa: NPY002 - what users write

    np.random.seed(3)  # noqa: NPY002
    wanted = np.random.normal()  # noqa: NPY002
    np.random.seed(3)  # noqa: NPY002
    assert kd.solve(acceleration, t_span=(0, 1), step=0.1, x0=1.0, v0=0.0).success
    assert np.random.normal() == wanted  # noqa: NPY002


def mixed_numbers(x):
    return np.array([-1, x[0] > 5.0, 0.5 * x[0]])


def in_branches(x):
    if x[0] > 1.0:
        return np.array([-x[0], -x[1], 0.0])
    result = np.array([-x[1], -x[0], -0.0])
    return result  # noqa: RET504 - what is tried here


def changed_afterwards(x):
    result = np.array([-x[0], -x[1], 0.0])
    result[2] = -x[2]
    return result


def one_for_all(x):
    return np.array([-x[0]])


def a_list_that_is_used(x):
    numbers = [x[0], x[1], x[2]]
    numbers[0] = sum(numbers)
    return np.array(numbers)


def of_a_type(x):
    return np.array([x[0], 0.1, 2.7], dtype=np.int64)


def a_bare_list(x):
    if x[0] > 1.0:
        return [-x[0], 1, x[1]]
    return np.array([-x[1], -x[0], 0.5])


LISTS = [mixed_numbers, in_branches, changed_afterwards, one_for_all, a_list_that_is_used, of_a_type, a_bare_list]


@pytest.mark.parametrize("function", LISTS)
def test_arrays_made_of_lists(function):
    given = {"x0": [1.5, 2.0, 3.0], "v0": [0.0, 0.0, 0.0], "progress": False, **SPAN}
    compiled, interpreted = (kd.solve(function, compile=compile_, **given) for compile_ in (True, False))
    assert np.array_equal(compiled.x, interpreted.x)


RETURNED = [(in_branches, types.UniTuple), (a_bare_list, types.UniTuple), (changed_afterwards, types.Array)]


@pytest.mark.parametrize(("function", "returned"), RETURNED)
def test_an_array_that_is_only_returned_is_not_made(function, returned):
    signature = (types.float64[::1],)
    native = compiled(cached=False)(taken_apart(function).snapshot(True, tuples=True))
    assert isinstance(native.get_compile_result(signature).signature.return_type, returned)


def test_a_list_of_another_length_is_refused():
    with pytest.raises(ArgumentError, match="must return an array of shape"):
        kd.solve(lambda x: np.array([x[0], x[1]]), x0=[1.0, 2.0, 3.0], v0=[0.0, 0.0, 0.0], **SPAN)

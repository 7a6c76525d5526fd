"""Users' functions are compiled once for ever: what their compiled code is made of, and what it takes as data."""

import math
import os
import subprocess
import sys
from types import ModuleType

import numpy as np
import pytest
from numba import njit
from numba.core import event
from numba.core.typing import templates
from numba.extending import overload

import kickdrift as kd
from kickdrift.engine.function_key import taken_apart

STIFFNESS = 1.0
POWER = 1
TABLE = np.ones(3)
PLACES = np.array([0, 1])
OWN = ModuleType("own")
OWN.stiffness = 1.0
SPAN = {"t_span": (0.0, 1.0), "x0": 1.0, "v0": 0.0, "step": 0.1}


def pulled(x):
    return -STIFFNESS * x


def raised(x):
    return -(x**POWER)


def looked_up(x):
    return -TABLE[0] * x


def placed(x):
    return -x * PLACES[1]


def uses_module(x):
    return -OWN.stiffness * x


def closed_over(k):
    return lambda x: -k * x


def with_default(stiffness):
    return lambda x, k=stiffness: -k * x


def with_named_default(stiffness):
    def force(x, *, k=stiffness):
        return -k * x

    return force


def with_callee(stiffness):
    table = np.array([0.0, stiffness])

    @njit
    def looked_up(scale, i):
        return scale * table[i]

    @njit(fastmath=True)
    def spring(x):
        return looked_up(1.0, 1) * x

    def force(x):
        return -spring(x)

    return force


@njit
def applied(function, x):
    return function(x)


def with_function_as_value(k):
    @njit
    def spring(x):
        return k * x

    return lambda x: -applied(spring, x)


def with_inner(k):
    return lambda x: -sum([k * x for _ in range(1)])


@njit
def jitted(x):
    return -STIFFNESS * x


def helped(x):
    return jitted(x)


def key(function):
    return taken_apart(function).key


def oscillator(frequency=1.0):
    return kd.solve(kd.systems.harmonic_oscillator(frequency), (0, 1), step=0.1).x


@pytest.fixture
def passes():
    """Record what Numba does to compile."""
    with event.install_recorder("numba:run_pass") as recorder:
        yield recorder.buffer


def test_equal_code_has_equal_keys():
    functions = [pulled, raised, looked_up, placed, uses_module, helped, jitted, closed_over(1.0), with_inner(1.0)]
    assert all(taken_apart(function).known for function in functions)
    assert all(key(function) == key(function) for function in functions)
    assert len({key(function) for function in functions}) == len(functions)
    assert key(lambda x: -math.sin(x)) == key(lambda x: -math.sin(x)) != key(lambda x: -math.cos(x))


@pytest.mark.parametrize("make", [closed_over, with_default, with_named_default])
def test_numbers_are_no_part_of_a_key_unless_they_are_integers(make):
    assert key(make(1.0)) == key(make(2.0)) == key(make(np.float64(3.0)))
    assert list(taken_apart(make(2.0)).numbers.values()) == [2.0]
    assert len({key(make(k)) for k in (1.0, 1, 2, True, np.ones(2), np.ones(3), np.ones(2, dtype=np.float32))}) == 7
    assert key(make(np.zeros(2))) == key(make(np.ones(2)))
    assert key(make(np.ones(2, dtype=np.int64))) != key(make(np.zeros(2, dtype=np.int64)))


@pytest.mark.parametrize(("function", "name", "value"), [(raised, "POWER", 2), (placed, "PLACES", np.array([0, 2]))])
def test_what_compiled_code_freezes_is_in_the_key(monkeypatch, function, name, value):
    before = key(function)
    monkeypatch.setitem(globals(), name, value)
    assert key(function) != before


@pytest.mark.parametrize("make", [with_inner, with_function_as_value])
def test_numbers_of_functions_inside_or_given_to_others_are_in_the_key(make):
    assert key(make(1.0)) != key(make(4.0))
    for k in (1.0, 4.0):
        assert np.array_equal(kd.solve(make(k), **SPAN).x, oscillator(math.sqrt(k)))


def test_numbers_of_functions_that_are_called_are_data(monkeypatch):
    assert key(with_callee(1.0)) == key(with_callee(4.0))
    before = key(helped)
    monkeypatch.setitem(globals(), "STIFFNESS", 4.0)
    assert key(helped) == before
    assert np.array_equal(kd.solve(helped, **SPAN).x, oscillator(2.0))


def test_whole_and_half_exponents_are_frozen_for_the_bits_of_numpy():
    def attraction(power):
        return lambda x: -x / np.sqrt((x * x).sum()) ** power

    def repulsion(power):
        return lambda x: -x + x**-power

    for make, powers in ((attraction, (2.0, 3.0, 2.5)), (repulsion, (1.0, 0.5))):
        assert len({key(make(power)) for power in powers}) == len(powers)
        assert key(make(2.2)) == key(make(2.3))
    options = {"t_span": (0.0, 10.0), "x0": [1.0, 0.1], "v0": [0.1, 1.0], "step": 0.01}
    square = kd.solve(attraction(2.0), **options)
    assert np.array_equal(square.x, kd.solve(lambda x: -x / np.sqrt((x * x).sum()) ** 2, **options).x)


def test_a_constant_of_a_module_is_in_the_key(monkeypatch):
    before = key(uses_module)
    monkeypatch.setattr(OWN, "stiffness", 4.0)
    assert key(uses_module) != before
    assert np.array_equal(kd.solve(uses_module, **SPAN).x, oscillator(2.0))


@pytest.mark.parametrize("function", [closed_over([1.0]), closed_over({"k": 1.0}), closed_over(object())])
def test_where_one_cannot_tell_the_key_is_of_this_function_now(function):
    assert not taken_apart(function).known
    assert key(function) != key(function)


def test_what_numba_has_compiled_for_good_is_its_own_key():
    one, other = (njit("float32(float32)")(lambda x: -x) for _ in range(2))
    assert not taken_apart(one).known
    assert key(one) == key(one) != key(other)


def test_signatures_of_doubles_round_nothing_and_have_bounds():
    @njit("float64[:](float64[:])")
    def pull(x):
        return -x

    @njit("void(float64[:], float64[:])")
    def beside(x, out):
        for k in range(x.size + 1000):
            out[k] = -x[0]

    assert taken_apart(pull).known
    assert np.array_equal(kd.solve(pull, (0.0, 1.0), [1.0], [0.0], step=0.1).x[:, 0], oscillator(1.0))
    with pytest.raises(kd.ArgumentError, match="out of bounds"):
        kd.solve(beside, (0.0, 1.0), [1.0], [0.0], step=0.1)


def test_a_division_by_zero_is_infinite_in_functions_that_are_called_too():
    @njit
    def inverse(x):
        return 1.0 / x

    @njit(error_model="python")
    def strict_inverse(x):
        return 1.0 / x

    free = kd.solve(lambda x: 0.0 * x + inverse(x - 1.0), **SPAN)
    assert free.status is kd.Outcome.NOT_FINITE
    with pytest.raises(kd.ArgumentError, match="ZeroDivisionError"):
        kd.solve(lambda x: strict_inverse(x - 1.0), **SPAN)


def test_what_others_tell_numba_of_numpys_functions_is_in_no_key():
    def cubed(x):
        return -(np.ascontiguousarray(x) ** 3)

    def squared(x):
        return -(x**2)

    assert taken_apart(cubed).known
    before = len(templates.builtin_registry.functions)
    overload(np.ascontiguousarray)(lambda x: lambda x: 2.0 * x)
    try:
        assert not taken_apart(cubed).known
        assert taken_apart(squared).known
    finally:
        del templates.builtin_registry.functions[before:]
        del templates.builtin_registry.globals[-1:]
    assert taken_apart(cubed).known


@pytest.mark.parametrize("make", [closed_over, with_default, with_named_default, with_callee])
def test_other_numbers_are_seen_and_compile_nothing(passes, make):
    kd.solve(make(9.0), **SPAN)
    for k in (1.0, 4.0):
        del passes[:]
        assert np.array_equal(kd.solve(make(k), **SPAN).x, oscillator(math.sqrt(k)))
    # The oscillator may be compiled; the function is not.
    assert not [what for _, what in passes if "lambda" in str(what.data) or "force" in str(what.data)]


def pushed_apart(x):
    return x - x.mean()


def pushed_apart_in_a_loop(x, out):
    for i in range(x.shape[0]):
        out[i] = x[i] - x.mean()


@pytest.mark.parametrize("function", [pushed_apart, pushed_apart_in_a_loop])
def test_a_large_state_of_another_length_compiles_nothing(passes, function):
    kd.solve(function, (0, 1), np.ones((50, 3)), np.ones((50, 3)), step=0.1, method="leapfrog")
    del passes[:]
    x0 = np.arange(180.0).reshape(60, 3)
    s = kd.solve(function, (0, 1), x0, np.zeros((60, 3)), step=0.1, method="leapfrog")
    assert not passes
    reference = kd.solve(function, (0, 1), x0, np.zeros((60, 3)), step=0.1, method="leapfrog", compile=False)
    assert np.allclose(s.x, reference.x, rtol=1e-14)


def test_changed_globals_are_seen(monkeypatch):
    first = [kd.solve(function, **SPAN).x for function in (pulled, looked_up, helped)]
    assert all(np.array_equal(x, oscillator()) for x in first)
    monkeypatch.setitem(globals(), "STIFFNESS", 4.0)
    TABLE[:] = 4.0
    again = [kd.solve(function, **SPAN).x for function in (pulled, looked_up, helped)]
    TABLE[:] = 1.0
    assert all(np.array_equal(x, oscillator(2.0)) for x in again)


def test_conserved_quantities_and_masses_have_numbers_of_their_own():
    k, m = 3.0, np.array([2.0, 4.0])
    scale = np.array([1.0, 1.0])
    problem = kd.Newtonian(
        lambda x: -k * x,
        mass=m,
        energy=lambda x, v, params: 0.5 * (k * (x @ x) + (m * v) @ v) * params[0] * scale[0],
        invariants={"k": lambda x: k * scale[1]},
    )
    s = kd.solve(problem, (0, 1), [1.0, 2.0], [0.0, 0.5], step=0.001, method="leapfrog", args=(1.0,))
    assert np.allclose(s.energy, 0.5 * (3.0 * 5.0 + 4.0 * 0.25), rtol=1e-6)
    assert (s.invariants["k"] == 3.0).all()


def test_a_frozen_array_cannot_be_written_to():
    counts = np.zeros(1)

    def counting(x):
        counts[0] += 1.0
        return -x

    with pytest.warns(kd.core.errors.InterpretedWarning, match="counting runs interpreted"):
        kd.solve(counting, **SPAN)


SCRIPT = """
import sys
import numpy as np
import kickdrift as kd
from numba.core import event

def make(k, order):
    if order == "first":
        def force(x):
            return -k * x
    else:
        def force(x):
            return -2.0 * k * x
    return force

with event.install_recorder("numba:run_pass") as recorder:
    for order in sys.argv[1:]:
        s = kd.solve(make(3.0, order), (0.0, 1.0), [1.0, 0.0], [0.0, 1.0], step=0.1)
        print(s.x[-1, 0])
print(len(recorder.buffer))
"""


def run(script, *arguments, folder):
    """Run a script, or code on the command line, and return what it prints."""
    command = [sys.executable, *(("-c", script) if isinstance(script, str) else (str(script),)), *arguments]
    variables = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
    *numbers, passes = subprocess.run(command, capture_output=True, text=True, check=True, env=variables).stdout.split()
    return numbers, int(passes)


def test_another_process_compiles_nothing_and_takes_no_function_for_another(tmp_path):
    script, cache = tmp_path / "script.py", tmp_path / "cache"
    script.write_text(SCRIPT)
    executed = f"exec({SCRIPT!r}, {{'__name__': 'no module'}})"
    first, compiling = run(executed, "first", folder=cache)
    assert compiling > 0
    # Of the same name, and with the number that Numba gave the first one's in its process.
    second, _ = run(SCRIPT, "second", folder=cache)
    assert second != first
    both, compiling = run(script, "first", "second", folder=cache)
    assert both == first + second
    assert compiling == 0


def test_the_files_used_last_are_kept(tmp_path, monkeypatch):
    from kickdrift.core import users_cache

    monkeypatch.setattr(users_cache, "_MOST_FILES", 3)
    files = [tmp_path / f"{i}.nbc" for i in range(5)]
    for age, file in enumerate(files):
        file.write_bytes(b"")
        os.utime(file, (1e9 - age, 1e9 - age))
    users_cache.UsersCache(pulled, "inner", {})._make_room(files[0])
    assert sorted(tmp_path.iterdir()) == files[:3]

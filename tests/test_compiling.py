"""Compiled functions: what is compiled, what is kept on disk, and what other processes do of it."""

import importlib.util
import math
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numba
import numpy as np
import pytest
from numba import types
from numba.core.errors import TypingError
from numba.core.registry import cpu_target

from kickdrift.core import contexts, views
from kickdrift.core.cache import fingerprint, machine
from kickdrift.core.calls import address_of
from kickdrift.core.compilation import compiled, is_on_disk, specialise, unbound
from kickdrift.core.linking import Part, Whole
from kickdrift.core.parallel_compile import _families
from kickdrift.engine.announcing import compiling_announced
from kickdrift.scenes.worlds.catalogue import SCENES
from kickdrift.world.collision.broad_phase.pair_update import find_pairs
from kickdrift.world.contacts.contact_solver_simd import KERNELS
from kickdrift.world.direct.island_restitution import bounce_islands
from kickdrift.world.direct.island_solver import solve_islands
from kickdrift.world.direct.velocity_projection import relax_islands
from kickdrift.world.shapes.shape_kinds import RAYS
from kickdrift.world.step.compiling import _jobs, all_jobs
from kickdrift.world.step.stage_loop import STAGE

INNER = """
from kickdrift.core.compilation import compiled

POWER = {power}


@compiled
def inner(x, power):
    return {body}
"""
OUTER = """
import inner_part
from inner_part import inner
from kickdrift.core.compilation import compiled

CONSTANT = {constant}


@compiled
def outer(x):
    return CONSTANT * inner(x, 2) + inner_part.inner(x, inner_part.POWER)
"""
FLOAT = numba.float64(numba.float64)


def python(code, **environment):
    command = [sys.executable, "-c", code]
    variables = {**os.environ, **environment}
    return subprocess.run(command, capture_output=True, text=True, check=True, env=variables).stdout.strip()


@pytest.fixture
def module(tmp_path, monkeypatch):
    """Return a function that writes a module of two compiled functions, of which one calls the other, and imports it."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))

    def written(body, constant=3.0, power=3):
        (tmp_path / "inner_part.py").write_text(INNER.format(body=body, power=power))
        (tmp_path / "outer_part.py").write_text(OUTER.format(constant=constant))
        for name in ("inner_part", "outer_part"):
            sys.modules.pop(name, None)
            # Bytecode is told from that of other sources by their size and the second in which they were written.
            Path(importlib.util.cache_from_source(str(tmp_path / f"{name}.py"))).unlink(missing_ok=True)
        importlib.invalidate_caches()
        return importlib.import_module("outer_part")

    return written


def test_constants_among_arguments_are_no_reason_to_compile_again(module):
    functions = module("x**power")
    assert functions.outer(2.0) == 3.0 * 4.0 + 8.0
    assert len(functions.inner.overloads) == 1


def test_the_interpreter_calls_what_compiled_code_calls():
    @compiled(cached=False)
    def double(x, times=2):
        return times * x

    double.compile(numba.float64(numba.float64, numba.int64))
    for _ in range(3):
        assert double(1.5) == 3.0
        assert double(2) == 4
        assert double(1.5, times=3) == 4.5
        np.testing.assert_array_equal(double(np.arange(3.0)), [0.0, 2.0, 4.0])


def test_what_is_only_called_by_compiled_code_is_no_machine_code(module):
    functions = module("x**power")
    functions.outer.compile(FLOAT)
    (inner,) = functions.inner.overloads.values()
    assert isinstance(inner.library, Part)
    assert not functions.inner._wholes
    outer = functions.outer.get_compile_result(FLOAT).library
    assert isinstance(outer, Whole)
    assert [function.name for function in outer.get_defined_functions()] == [
        functions.outer.get_compile_result(FLOAT).fndesc.llvm_func_name
    ]


def test_functions_of_numba_call_ours_with_all_that_they_call(module):
    outer = module("x**power").outer

    @numba.njit
    def twice(x):
        return 2.0 * outer(x)

    assert twice(2.0) == 2.0 * (3.0 * 4.0 + 8.0)


def test_code_is_found_again_and_not_once_a_function_that_it_uses_has_changed(module, tmp_path):
    first = module("x**power").outer
    assert not is_on_disk(first, FLOAT)
    first.compile(FLOAT)
    again = module("x**power").outer
    assert again is not first
    assert is_on_disk(again, FLOAT)
    changed = module("x**power + 1.0").outer
    assert not is_on_disk(changed, FLOAT)
    assert changed(2.0) == 3.0 * 5.0 + 9.0
    changed.compile(FLOAT)
    assert not is_on_disk(module("x**power + 1.0", constant=4.0).outer, FLOAT)
    assert not is_on_disk(module("x**power + 1.0", power=4).outer, FLOAT)
    assert len(list((tmp_path / "cache").rglob("*outer-*-inner-*.nbc"))) == 1  # nothing is left of the first one


def test_a_broken_file_is_as_none(module, tmp_path):
    module("x**power").outer.compile(FLOAT)
    for file in (tmp_path / "cache").rglob("*.nbc"):
        file.write_bytes(file.read_bytes()[:100])
    assert module("x**power").outer(2.0) == 20.0


def test_what_is_bound_tells_copies_apart():
    bound = [specialise(template, "copy", part=compiled(function)) for function in (abs_, abs_, negative)]
    assert fingerprint(bound[0]) == fingerprint(bound[1]) != fingerprint(bound[2])


part = unbound


def template(x):
    return part(x)


def abs_(x):
    return abs(x)


def negative(x):
    return -x


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (lambda a, b: min(a, b), lambda a, b: max(a, b)),
        (lambda a: a.min(), lambda a: a.max()),
        (lambda a: np.linalg.norm(a), lambda a: np.linalg.det(a)),
        (lambda a, *, b=1: a + b, lambda a, *, b=2: a + b),
    ],
)
def test_names_are_part_of_a_fingerprint(one, other):
    other.__qualname__ = one.__qualname__
    assert fingerprint(one) != fingerprint(other)


def test_fingerprints_do_not_depend_on_the_process():
    code = (
        "from kickdrift.world.contacts.contact_solver_simd import KERNELS as kernels;"
        "from kickdrift.core.cache import fingerprint;"
        "file = kernels[0]._cache._file('', kernels[0].targetctx);"
        "print([fingerprint(kernel.py_func) for kernel in kernels.values()], file.name)"
    )
    kernels = list(KERNELS.values())
    here = [fingerprint(kernel.py_func) for kernel in kernels], kernels[0]._cache._file("", kernels[0].targetctx).name
    assert python(code, PYTHONHASHSEED="1") == " ".join(map(str, here))  # of another seed, except once in 2^32 times


def test_code_of_another_compiler_is_not_loaded(tmp_path):
    package = Path(views.__file__).parent.parent
    shutil.copytree(package, tmp_path / "kickdrift", ignore=shutil.ignore_patterns("__pycache__"))
    code = "from kickdrift.core.vectors import dot as f; print(f._cache._file('', f.targetctx).name)"
    first, again = (python(code, PYTHONPATH=str(tmp_path)) for _ in range(2))
    with (tmp_path / "kickdrift" / "core" / "passes.py").open("a") as source:
        source.write("\n# another pass\n")
    assert first == again
    assert python(code, PYTHONPATH=str(tmp_path)) != first


FACTOR = unbound


def _scaled(x):
    return FACTOR * x + FACTOR


JOBS = (
    "from kickdrift.core import parallel_compile;"
    "from kickdrift.world.collision.narrow_phase.pair_dispatch import PAIRS;"
    "from kickdrift.world.collision.narrow_phase.manifolds import COLLIDE;"
    "from kickdrift.engine import letters;"
    "jobs = [(PAIRS[0, 2], COLLIDE)];"
    "jobs += [job for job in letters.shared() if '_drift_drift_1_1_' in job[0].__name__];"
    "parallel_compile.processes_for = lambda jobs: 2;"
)


def test_another_process_compiles_what_is_found_here(tmp_path):
    code = JOBS + (
        "from collections import deque;"
        "before, done = len(parallel_compile.missing(jobs * 2)), [];"
        "places, one_more = parallel_compile._places(jobs), lambda: done.append(1);"
        "workers = parallel_compile._workers(1, deque([job] for job in jobs), places, one_more);"
        "workers.__enter__(); workers.__exit__(None, None, None);"
        "print(before, len(parallel_compile.missing(jobs)), len(done))"
    )
    assert python(code, NUMBA_CACHE_DIR=str(tmp_path)) == "2 0 2"


@pytest.mark.parametrize("worker", ["raise SystemExit", "import time; time.sleep(0.5)"])
def test_processes_that_do_nothing_do_not_matter(worker, tmp_path):
    code = (
        f"{JOBS} parallel_compile._WORKER = {worker!r};"
        "parallel_compile.compile_together(jobs); print(parallel_compile.missing(jobs))"
    )
    assert python(code, NUMBA_CACHE_DIR=str(tmp_path)) == "[]"


def test_a_long_session_keeps_no_more_for_each_function(monkeypatch):
    monkeypatch.setattr(contexts, "_MOST_KNOWN", 30)
    known = contexts.own_typing(cpu_target.typing_context).known
    for factor in range(3):
        function = compiled(cached=False)(specialise(_scaled, f"scaled_{factor}", FACTOR=factor))
        signature = types.float64(types.float64)
        for equal in (signature, types.float64(types.float64), types.float64(types.float64)):
            function.compile(equal)
            function.load(equal)
        assert function(2.0) == 2.0 * factor + factor
        assert list(function._loaded.values()) == [signature]
        assert len(known) <= 30
    assert machine(cpu_target.target_context) is machine(cpu_target.target_context.subtarget())


def test_compiling_is_announced_where_it_is_wanted_and_takes_longer_than_a_moment(capsys, monkeypatch):
    monkeypatch.setattr("kickdrift.engine.announcing._A_MOMENT", 0.1)
    for wanted, seconds, said in ((True, 0.2, True), (True, 0.0, False), (False, 0.2, False), (None, 0.2, True)):
        with compiling_announced(wanted), compiling_announced(None, "22 functions"):
            time.sleep(seconds)
        lines = capsys.readouterr().err.splitlines()
        assert lines[:1] == ["kickdrift: compiling 22 functions once on this machine ..."][:said]
        assert [line.startswith("kickdrift: compiled in ") for line in lines[1:]] == [True][:said]


def test_what_needs_the_same_is_compiled_in_one_process():
    stages = [solve_islands, bounce_islands, find_pairs, relax_islands]
    families = _families([(stage, STAGE) for stage in stages])
    assert [{function for function, _ in family} for family in families] == [
        {solve_islands, bounce_islands, relax_islands},
        {find_pairs},
    ]


def test_a_function_that_was_compiled_for_a_caller_has_an_address_of_its_own():
    @compiled(cached=False)
    def called(x):
        return 2.0 * x

    @compiled(cached=False)
    def caller_of(x):
        return called(x) + 1.0

    signature = types.float64(types.float64)
    assert address_of(caller_of, signature) != 0
    assert address_of(called, signature) != 0


def test_what_compiles_ahead_is_all_that_the_scenes_need():
    ahead = {id(function) for function, _ in all_jobs()}
    for scene in SCENES.values():
        world = scene.make()
        world.forces.clear()  # functions in Python, which no one can compile before they are written
        needed = _jobs(world.word, world.shape_rows.kinds, world.shape_rows.pairs())
        assert {function.__name__ for function, _ in needed if id(function) not in ahead} == set()
    assert len(ahead) > len(needed)
    assert {id(ray) for ray in RAYS.values()} <= ahead


@compiled(cached=False)
def _sum_of_view(array):
    view = array[1:]
    total = 0.0
    for value in view:
        total += value
    return total


@compiled(cached=False)
def _sums_of_views(array, out):
    out[0] = _sum_of_view(array[1:]) + _sum_of_view(array[2:])


@compiled(cached=False)
def _sums_of_copies(array, out):
    copy = np.empty(array.size)
    for k in range(array.size):
        copy[k] = array[k]
    out[0] = _sum_of_view(copy[1:]) + _sum_of_view(copy[2:])


@compiled(cached=False)
def _returned(array, out):
    return array[1:]


def test_code_that_allocates_nothing_counts_no_references():
    array = types.Array(types.float64, 1, "C")
    counted = {}
    for function in (_sums_of_views, _sums_of_copies, _returned):
        signature = types.none(array, array) if function is not _returned else array(array, array)
        library = function.get_compile_result(signature).library
        counted[function] = "NRT_decref" in library.get_llvm_str() or "NRT_incref" in library.get_llvm_str()
    assert counted == {_sums_of_views: False, _sums_of_copies: True, _returned: True}
    before, out = np.arange(5.0), np.zeros(1)
    for function in (_sums_of_views, _sums_of_copies):
        function(before, out)
        assert out[0] == 9.0 + 7.0


def test_views_are_the_same_compiled_and_interpreted():
    @compiled(cached=False)
    def seen(array, out):
        out[0], out[1] = views.part(array, 2, 2).sum(), views.part(array, 2, 2).size
        out[2], out[3] = float(views.words(array)[1]), views.float_of(views.words(array)[3])

    array, outs = np.array([1.0, -2.0, 3.0, 0.1]), [np.zeros(4), np.zeros(4)]
    for function, out in zip((seen, seen.py_func), outs, strict=True):
        function(array, out)
    assert np.array_equal(*outs)
    assert outs[0].tolist() == [3.1, 2.0, float(np.float64(-2.0).view(np.int64)), 0.1]


@compiled(cached=False)
def _norm(vector):
    return np.linalg.norm(vector)


@compiled(cached=False)
def norm(vector):
    return _norm(vector)  # which is compiled as what users write; the function called by the interpreter, by Numba


@compiled(cached=False)
def _norm_of_order(vector, order):
    return np.linalg.norm(vector, order)


@compiled(cached=False)
def norm_of_order(vector, order):
    return _norm_of_order(vector, order)


def test_norms_neither_overflow_nor_underflow():
    tiny, huge, least = 1e-200, 1e200, 5e-324
    for vector, expected in (
        ([3.0, 4.0], 5.0),
        ([-3.0 * huge, 4.0 * huge], 5.0 * huge),
        ([3.0 * tiny, -4.0 * tiny], 5.0 * tiny),
        ([-3e-155, 4e-155, 0.0], 5e-155),  # the sum of squares is subnormal
        ([2.0, tiny], 2.0),
        ([huge, 2.0], huge),
        ([3 * least, -4 * least], 5 * least),
        ([np.finfo(float).max, 1.0], np.finfo(float).max),
        ([np.finfo(float).max, np.finfo(float).max], np.inf),
        ([1.0, -np.inf], np.inf),
        ([0.0, -0.0], 0.0),
        ([], 0.0),
    ):
        assert norm(np.array(vector)) == pytest.approx(expected, rel=4e-16, abs=0.0), vector
    assert math.isnan(norm(np.array([1.0, np.nan])))
    assert math.isnan(norm(np.array([np.inf, np.nan])))  # as in NumPy
    every_second = np.arange(6.0)[::2]
    assert norm(every_second) == norm(every_second[::-1]) == math.sqrt(20.0)


def test_all_other_norms_are_those_of_numba():
    matrix = np.array([[1.0, 2.0], [3.0, 4.0]])
    assert norm(matrix) == pytest.approx(math.sqrt(30.0), rel=1e-15)
    assert [norm_of_order(matrix[1], order) for order in (1, 2)] == [7.0, 5.0]
    assert norm(np.array([3.0, 4.0j])) == 5.0
    single = np.array([3.0, 4.0], dtype=np.float32)
    assert (norm(single), norm.get_compile_result((types.float32[::1],)).signature.return_type) == (5.0, types.float32)
    for refused, why in (
        (np.ones((1, 1, 1)), "only supported on 1 and 2-D arrays"),
        (np.arange(3), "only supported on float and complex arrays"),
        ((1.0, 2.0), "only supported for array types"),
    ):
        with pytest.raises(TypingError, match=why):
            norm(refused)

    @compiled(cached=False)
    def rows(matrix):
        return np.linalg.norm(matrix, axis=1)

    with pytest.raises(TypingError, match="axis"):
        rows.get_compile_result((types.float64[:, ::1],))


def test_code_from_disk_is_loaded_without_what_compiles_it(tmp_path):
    code = (
        "import sys, numpy as np, kickdrift as kd;"
        "gravity = lambda x: -x / np.linalg.norm(x) ** 3;"
        "kd.solve(gravity, (0, 1), [1, 0], [0, 1], method='semi-implicit-euler', step=0.1, progress=False);"
        "compiling = 'kickdrift.core.passes', 'numba.core.typing.arraydecl', 'numba.np.arrayobj', 'scipy.linalg';"
        "print([name in sys.modules for name in compiling])"
    )
    first, second = (python(code, NUMBA_CACHE_DIR=str(tmp_path)) for _ in range(2))
    assert first == str([True] * 4)
    assert second == str([False] * 4)


POWERS = """
import re

import numba

from kickdrift.core.compilation import compiled

POWER = numba.float64(numba.float64, numba.int64)


@compiled(fast=True)
def fast(x, n):
    return x**n + 1.0


@compiled
def strict(x, n):
    return x**n + 1.0


def code(function):
    text = str(function.get_compile_result(POWER).library._final_module)
    return re.sub(r"B\\d*v\\d+", "", text)


for function in {order}:
    function.compile(POWER)
print("reassoc" in code(fast), "reassoc" in code(strict), len(code(fast)), code(strict))
"""


def test_what_was_compiled_before_does_not_change_compiled_code():
    """Functions of Numba's, here `int_power`, are compiled once, for all that use them."""
    one, other = (python(POWERS.format(order=order)) for order in ("(fast, strict)", "(strict, fast)"))
    assert one.startswith("True False ")
    assert one == other

"""The examples and the code of the README run, and say what they should."""

import importlib.util
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import kickdrift as kd

ROOT = Path(__file__).parent.parent


def example(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / "examples" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def test_forty_lines_of_numpy_equal_the_engine_bit_for_bit():
    plain = example("semi_implicit_euler")
    xs, vs = plain.integrate(plain.gravity, x=[1.0, 0.0], v=[0.0, 1.1], step=0.01, n_steps=1000)
    options = {"t_span": (0.0, 10.0), "x0": [1.0, 0.0], "v0": [0.0, 1.1], "step": 0.01}
    for compiled in (True, False):
        sol = kd.solve(plain.gravity, compensated=False, compile=compiled, **options)
        assert np.array_equal(sol.x, xs)
        assert np.array_equal(sol.v, vs)
    assert not np.array_equal(kd.solve(plain.gravity, **options).x, xs)  # compensated sums round otherwise


def test_the_method_fits_forty_lines():
    lines = (ROOT / "examples" / "semi_implicit_euler.py").read_text().splitlines()
    assert len(lines[lines.index("import numpy as np") :]) <= 40


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("semi_implicit_euler", "never off by more than"),
        ("worked_example", "3  0.3   0.9405  -0.2960   0.9553  -0.2955     0.9722"),
        ("benchmarks_game", "-0.169075164\n-0.169087605\n"),
        ("own_force", "driven by 1.0"),
    ],
)
def test_examples_say_what_they_should(name, says, capsys):
    example(name).main()
    assert says in capsys.readouterr().out


def test_every_example_is_tested():
    assert {path.stem for path in (ROOT / "examples").glob("*.py")} == {
        "semi_implicit_euler",
        "worked_example",
        "benchmarks_game",
        "own_force",
    }


def test_the_code_of_the_readme_runs(tmp_path, small_pictures, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)
    assert len(blocks) >= 5
    scope: dict = {"__name__": "readme"}
    for block in blocks:
        exec(block, scope)

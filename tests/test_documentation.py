"""The site has every public name on a page, and the examples in docstrings run."""

import ast
import doctest
import importlib
import inspect
import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

import kickdrift as kd

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "src" / "kickdrift"
MODULES = [kd, kd.methods, kd.systems, kd.analysis, kd.plots]


def names_on_pages():
    """Every name that a page of the API lists, with its module."""
    found = set()
    for page in (ROOT / "docs" / "api").glob("*.rst"):
        module = ""
        for line in page.read_text().splitlines():
            if line.startswith(".. currentmodule:: "):
                module = line.split()[-1] + "."
            elif re.fullmatch(r"   ~?[\w.]+", line):
                name = line.strip().removeprefix("~")
                found.add(name if name.startswith("kickdrift.") else module + name)
    return found


def at(path):
    """The object of a dotted name."""
    module, _, name = path.rpartition(".")
    return getattr(importlib.import_module(module), name)


def test_every_public_name_is_on_a_page():
    listed = [at(name) for name in names_on_pages()]
    missing = [
        f"{module.__name__}.{name}"
        for module in MODULES
        for name in module.__all__
        if not isinstance(getattr(module, name), ModuleType) and not any(getattr(module, name) is one for one in listed)
    ]
    assert not missing


@pytest.mark.parametrize("method", [name for name in dir(kd.World) if name.startswith("add_") and name != "add_force"])
def test_the_signatures_of_what_adds_to_a_world_show_all_arguments(method):
    parameters = inspect.signature(getattr(kd.World, method)).parameters.values()
    assert not any(each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD) for each in parameters)
    assert max(len(str(each.annotation)) for each in parameters) < 80  # types by their names


def test_a_signature_shows_the_options_that_a_method_passes_on_and_no_others():
    box = inspect.signature(kd.World.add_box).parameters
    assert box["mass"].kind == box["friction"].kind == inspect.Parameter.KEYWORD_ONLY
    assert box["friction"].default == 0.6
    assert "mass" not in inspect.signature(kd.World.add_mesh).parameters
    assert list(inspect.signature(kd.World.add_gear).parameters)[:4] == ["self", "joint_a", "joint_b", "ratio"]
    assert inspect.signature(kd.World.add_cloth_grid).parameters["density"].default == 0.2


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_modules_list_their_public_names_and_nothing_else(module):
    assert dir(module) == sorted(module.__all__)


def test_signatures_name_the_types_of_arrays():
    public = {name: getattr(module, name) for module in MODULES for name in module.__all__}
    for shown in (*SHOWN_WITH_METHODS, kd.analysis.WorkPrecision):
        public |= {f"{shown.__name__}.{name}": getattr(shown, name) for name in dir(shown) if name[0] != "_"}
    public = {name: one for name, one in public.items() if callable(one) and not isinstance(one, ModuleType)}
    assert not [name for name, one in public.items() if "numpy.ndarray" in signature(one)]
    assert "numpy.ndarray" in str(inspect.signature(lambda x: x).replace(return_annotation=NDArray[np.float64]))


def signature(one):
    try:
        return str(inspect.signature(one))
    except ValueError:  # of a class without one
        return ""


def with_examples():
    """Modules whose docstrings have examples."""
    return sorted(path for path in PACKAGE.rglob("*.py") if ">>>" in path.read_text())


def module_of(path):
    return ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")


def test_each_example_of_the_gallery_has_a_title_a_text_and_a_number():
    gallery = sorted((ROOT / "docs" / "gallery").glob("*/*.py"))
    assert len(gallery) >= 40
    for path in gallery:
        tree = ast.parse(path.read_text())
        title, underline, _, *text = (ast.get_docstring(tree) or "").splitlines()
        assert set(underline) == {"="}, path
        assert len(underline) == len(title), path
        assert len(" ".join(text)) > 100, path
        assert "print(" in path.read_text(), path
    assert {path.parent.name for path in gallery} == {
        path.parent.name for path in (ROOT / "docs" / "gallery").glob("*/GALLERY_HEADER.rst")
    }


# Returned or raised, not made or called.
RESULTS = {"Advice", "LyapunovExponents", "Merger", "ObservedOrder", "OrbitalElements", "PoincareSection", "WorkPrecision",
           "FileFormatError", "InterpretedWarning", "LostBodyError", "MissingExtraError", "UnknownNameError",
           "UnsolvedWarning"}  # fmt: skip
# Methods for the package itself, which no page shows
INSIDE = {"advance_from", "do_steps", "drawn_cloth", "presenter", "presenters"}
SHOWN_WITH_METHODS = (
    kd.World,
    kd.Solution,
    kd.Recording,
    kd.EnsembleSolution,
    kd.Box,
    kd.Sphere,
    kd.Capsule,
    kd.Cylinder,
    kd.Cone,
    kd.Hull,
)


def test_every_public_function_has_an_example():
    public = {f"{module.__name__}.{name}": getattr(module, name) for module in MODULES for name in module.__all__}
    for shown in SHOWN_WITH_METHODS:
        public |= {f"{shown.__name__}.{name}": getattr(shown, name, None) for name in dir(shown) if name[0] != "_"}
    without = [
        name
        for name, one in public.items()
        if callable(one) and name.rpartition(".")[2] not in RESULTS | INSIDE and ">>> " not in (one.__doc__ or "")
    ]
    assert not without


def examples_of(path):
    """Examples of a module, also of functions that decorators hide from doctest's own finder."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            text, name = ast.get_docstring(node) or "", getattr(node, "name", path.stem)
            test = doctest.DocTestParser().get_doctest(text, {}, name, str(path), getattr(node, "lineno", 0))
            if test.examples:
                yield test


@pytest.mark.parametrize("path", with_examples(), ids=module_of)
def test_examples_in_docstrings_run(path, tmp_path, monkeypatch):
    if path.stem == "robot_file":
        pytest.importorskip("mujoco", reason="robots are read by MuJoCo, which is not installed")
    monkeypatch.chdir(tmp_path)
    runner, said = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS), []
    for test in examples_of(path):
        runner.run(test, out=said.append)
    assert not runner.failures, "".join(said)
    assert runner.tries > 0


def test_examples_are_no_wider_than_the_pages():
    width = 89  # characters, prompts included: what the methods of a class have at 1280 pixels
    lines = [
        line
        for path in with_examples()
        for test in examples_of(path)
        for example in test.examples
        for line in (*("    " + line for line in example.source.splitlines()), *example.want.splitlines())
    ]
    assert lines
    assert not [line for line in lines if len(line) > width]


def test_a_wrong_example_is_seen(tmp_path):
    path = tmp_path / "wrong.py"
    path.write_text('def one():\n    """Return 1.\n\n    >>> 1 + 1\n    3\n    """\n')
    runner = doctest.DocTestRunner()
    for test in examples_of(path):
        runner.run(test, out=lambda text: None)
    assert runner.failures == 1

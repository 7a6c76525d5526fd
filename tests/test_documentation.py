"""The site has every public name on a page, and the examples in docstrings run."""

import doctest
import importlib
import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

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
            elif re.fullmatch(r"   [\w.]+", line):
                name = line.strip()
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


def with_examples():
    """Modules whose docstrings have examples."""
    return sorted(path for path in PACKAGE.rglob("*.py") if ">>>" in path.read_text())


def module_of(path):
    return ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")


@pytest.mark.parametrize("path", with_examples(), ids=module_of)
def test_examples_in_docstrings_run(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    module = importlib.import_module(module_of(path))
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    runner = doctest.DocTestRunner(optionflags=options)
    said = []
    for test in doctest.DocTestFinder(exclude_empty=True).find(module, globs={"np": np}):
        if test.examples and test.filename and Path(test.filename).samefile(path):
            runner.run(test, out=said.append)
    assert not runner.failures, "".join(said)
    assert runner.tries > 0

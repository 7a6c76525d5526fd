"""The floors hold, and the front door stays light."""

import ast
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import numba
from packaging.requirements import Requirement
from packaging.version import Version

import kickdrift as kd

ROOT = Path(__file__).parent.parent


def python(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def test_imports_go_down_only():
    lint = Path(sys.executable).parent / "lint-imports"
    done = subprocess.run([lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_types_come_from_no_floor_above_either():
    contract = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"][0]
    floors = [[name.strip() for name in line.split("|")] for line in contract["layers"]]
    height = {name: -k for k, line in enumerate(floors) for name in line}
    assert len(height) > len(floors) == 8
    upwards = []
    for floor in height:
        for path in (ROOT / "src" / Path(*floor.split("."))).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ImportFrom) and node.module:
                    taken = [f"{node.module}.{alias.name}" for alias in node.names]
                else:
                    taken = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                others = {".".join(name.split(".")[:2]) for name in taken}
                upwards += [(path.name, other) for other in others if height.get(other, -100) > height[floor]]
    assert upwards == []


def test_a_sideways_import_would_be_caught(tmp_path):
    package = tmp_path / "storeys"
    (package / "above").mkdir(parents=True)
    for folder in (package, package / "above"):
        (folder / "__init__.py").touch()
    (package / "below.py").write_text("from storeys import above\n")
    (tmp_path / ".importlinter").write_text(
        "[importlinter]\nroot_package = storeys\n[importlinter:contract:1]\nname = down\ntype = layers\n"
        "layers =\n    storeys.above\n    storeys.below\n"
    )
    lint = Path(sys.executable).parent / "lint-imports"
    done = subprocess.run([lint, "--no-cache"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stdout + done.stderr


def test_nothing_is_imported_before_it_is_needed_and_no_warning_filter_changes():
    filters, imported, solved, dropped, tabled = python(
        "import numpy, numba, sys, warnings; filters = list(warnings.filters); import kickdrift as kd;"
        "print(filters == warnings.filters); print(*sys.modules);"
        "kd.solve(lambda x: -x, (0, 1), 1.0, 0.0, step=0.1, compile=False); print(*sys.modules);"
        "kd.World().add_sphere(radius=1.0); dop853 = kd.methods.get('dop853'); print(*sys.modules);"
        "dop853.tableau(); print(*sys.modules)"
    ).splitlines()
    assert filters == "True"
    assert {"numpy", "kickdrift"} <= set(imported.split())
    heavy = {"matplotlib", "scipy.special", "xarray", "typer", "pydantic", "pandas", "astropy", "pint"}
    assert heavy.isdisjoint(imported.split())
    assert {"astropy", "pint", "pandas"}.isdisjoint(solved.split())  # which only quantities with units need
    assert "kickdrift.world.deformables.forces.highest_frequency" in dropped.split()
    assert {"scipy.sparse", "scipy.integrate"}.isdisjoint(dropped.split())  # of cloths, and of the table of dop853
    assert "scipy.integrate" in tabled.split()


def test_promised_names_are_there():
    for name in ("solve", "System", "SecondOrder", "Solution", "KickdriftError", "Outcome", "load"):
        assert name in kd.__all__
        assert getattr(kd, name).__doc__
    for name in ("nbody", "solar_system", "kepler", "catalogue"):
        assert callable(getattr(kd.systems, name))
    for name in ("observed_order", "stability_limit", "energy_error", "symplecticity_defect"):
        assert callable(getattr(kd.analysis, name))


def test_no_file_is_long():
    lengths = {path: path.read_text().count("\n") for path in (ROOT / "src").rglob("*.py")}
    assert {path.name: n for path, n in lengths.items() if n > 300} == {}


def test_what_numba_keeps_to_itself_is_there_and_its_next_version_is_not_taken():
    private = [
        (node.module, name.name)
        for path in (ROOT / "src").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(("numba.core", "numba.np"))
        for name in node.names
    ]
    assert private, "Numba needs no upper bound any more."
    for module, name in private:
        assert hasattr(import_module(module), name), f"Numba {numba.__version__} has no {module}.{name}"
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    bound = next(Requirement(text) for text in project["dependencies"] if text.startswith("numba")).specifier
    tried = Version(numba.__version__)
    assert tried in bound
    assert Version(f"{tried.major}.{tried.minor + 1}.0") not in bound, "compile and test with it first"

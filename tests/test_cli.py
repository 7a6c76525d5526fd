"""The command line: what it writes and says, its exit codes, and what it refuses."""

import gc
import importlib
import os
import re
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from time import sleep

import numpy as np
import pytest
from typer.testing import CliRunner

import kickdrift as kd
from kickdrift import cli
from kickdrift.cli import compiling, help_texts
from kickdrift.cli.app import app
from kickdrift.cli.times import parse_time
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.announcing import compiling_announced
from kickdrift.engine.progress import Bar
from kickdrift.methods import Kind
from kickdrift.scenes import planets

solve_module = importlib.import_module("kickdrift.engine.solve")  # whose name is that of its function, too

COLLISION = """\
run = {duration = 10.0, step = 1.0, method = "drift-kick"}
bodies = [
    {name = "a", mass = 0.0, position = [3, 0, 0], velocity = [-1, 0, 0]},
    {name = "b", mass = 0.0, position = [-3, 0, 0], velocity = [1, 0, 0]},
]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def undrawn(monkeypatch):
    """Empty files in place of pictures, which take half a second each: for tests that look at something else."""
    monkeypatch.setattr("matplotlib.figure.Figure.draw_without_rendering", lambda figure: None)
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda figure, path, **options: Path(path).touch())


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments], prog_name="kickdrift")


def process(*arguments, **options):
    command = [sys.executable, *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, **options)


def test_solar_system_is_kept_reported_drawn_and_compared(folder):
    result = call("run", "solar-system", "--years", 1)
    assert result.exit_code == cli.DONE, result.output
    kept = kd.load(folder / "kickdrift-output" / "solar-system.npz")
    assert np.array_equal(kept.x, planets(1.0).x)
    assert (folder / "kickdrift-output" / "solar-system.png").read_bytes().startswith(b"\x89PNG")
    assert result.stderr.splitlines()[0] == (
        "kickdrift: solar-system (11 bodies), 365.25 day in steps of 0.25 by blanes-moan-srkn6b"
    )
    assert "energy error" in result.stdout
    rows = {line.split()[0]: line.split()[1:] for line in result.stdout.splitlines() if line}
    assert rows["body"] == ["0", "1", "10", "100", "365.25"]
    assert rows["Mercury"][-1] == "57.6"
    assert "general relativity" in result.stdout


def test_options_choose_span_step_method_bodies_and_folder(folder, undrawn):
    result = call(
        *("run", "solar-system", "--duration", "2 years", "--step", "6 h", "--method", "leapfrog"),
        *("--bodies", "sun, earth,Jupiter", "--output", folder / "a" / "b", "--save-every", "1461"),
    )
    assert result.exit_code == cli.DONE, result.output
    kept = kd.load(folder / "a" / "b" / "solar-system.npz")
    assert kept.about.coordinates["body"] == ["Sun", "Earth", "Jupiter"]
    assert (kept.step, kept.n_steps, kept.about.method) == (0.25, 2922, "leapfrog")
    assert kept.t.tolist() == [0.0, 1.0, 10.0, 100.0, 365.25, 730.5]
    assert "The attraction of Mercury, Venus, Moon, Mars, Saturn, Uranus, Neptune, Pluto is neglected" in result.stdout


def test_what_cannot_be_compared_is_said(folder, undrawn):
    result = call("run", "solar-system", "--bodies", "Earth,Jupiter", "--years", 1)
    assert result.exit_code == cli.DONE
    assert "no comparison with JPL" in result.stderr
    assert "add Sun" in result.stderr
    result = call("run", "solar-system", "--years", 0.5)
    assert result.exit_code == cli.DONE
    assert "JPL's epochs 1, 10, 100 (days after J2000) fall between steps" in result.stderr


def test_quiet_writes_files_only(folder, undrawn):
    result = call("run", "kepler", "--duration", 1, "--quiet")
    assert (result.exit_code, result.output) == (cli.DONE, "")
    assert {path.name for path in (folder / "kickdrift-output").iterdir()} == {"kepler.npz", "kepler.png"}


def test_compiling_ahead_counts_what_it_compiles(monkeypatch):
    compiled = []
    jobs = [(missing_job, None) for missing_job in (len, abs, max)]
    monkeypatch.setattr(compiling, "missing", lambda all_of_them: jobs)
    monkeypatch.setattr("kickdrift.engine.announcing._A_MOMENT", 0.0)
    monkeypatch.setattr(
        compiling, "compile_together", lambda some, done: [compiled.append(job) or done() or sleep(0.1) for job in some]
    )
    monkeypatch.setattr(compiling.first_calls, "ALL", (gc.collect,))
    result = call("compile")
    assert result.exit_code == cli.DONE, result.output
    assert compiled == jobs
    first, last = result.stderr.splitlines()
    assert first == "kickdrift: compiling 3 functions once on this machine ..."
    assert last.startswith("kickdrift: compiled in ")
    monkeypatch.setattr(compiling.first_calls, "ALL", ())
    assert call("compile", "--quiet").stderr == ""


def test_what_is_called_once_to_be_compiled_is_a_short_run():
    compiling.first_calls.interpreted()  # `python -m benchmarks --only readme` does the others, which compile for minutes


@pytest.mark.filterwarnings("default")
def test_a_warning_is_one_line_without_a_place_in_the_code(monkeypatch):
    def plan(*_):
        warnings.warn("joints lost energy.", kd.UnsolvedWarning, stacklevel=1)
        raise ArgumentError("enough.")

    monkeypatch.setattr(importlib.import_module("kickdrift.cli.app"), "make_plan", plan)
    assert call("run", "pendulum").stderr.splitlines() == [
        "kickdrift: warning: joints lost energy.",
        "kickdrift: enough.",
    ]


def test_an_empty_cache_is_announced(folder, monkeypatch):
    assert "compil" not in call("run", "kepler", "--duration", 1).stderr
    choose = solve_module.choose

    def choose_slowly(*arguments):
        with compiling_announced(None, "12 functions"):
            sleep(0.1)
            return choose(*arguments)

    monkeypatch.setattr("kickdrift.engine.announcing._A_MOMENT", 0.05)
    monkeypatch.setattr(solve_module, "choose", choose_slowly)
    announced = call("run", "kepler", "--duration", 1).stderr.splitlines()
    assert announced[0].startswith("kickdrift: kepler")
    assert announced[1] == "kickdrift: compiling 12 functions once on this machine ..."
    assert announced[2].startswith("kickdrift: compiled in")
    assert call("run", "kepler", "--duration", 1, "--quiet").stderr == ""


def test_the_report_says_why_a_method_was_taken(folder, undrawn):
    assert "chosen because" in call("run", "kepler", "--duration", 1, "--method", "auto").stdout
    assert "chosen because" not in call("run", "kepler", "--duration", 1, "--method", "kick-drift").stdout


@pytest.mark.parametrize("name", ["harmonic-oscillator", "pendulum", "kepler", "benchmarks-game"])
def test_every_system_runs_by_name(folder, name):
    result = call("run", name, "--duration", 1)
    assert result.exit_code == cli.DONE, result.output
    assert kd.load(folder / "kickdrift-output" / f"{name}.npz").t[-1] == 1.0


def test_own_bodies_run_as_their_file_says_and_options_overrule_it(folder, undrawn):
    (folder / "two.toml").write_text(help_texts.SAMPLE_TOML)
    result = call("run", "two.toml")
    assert result.exit_code == cli.DONE, result.output
    assert result.stderr.splitlines()[0].endswith(" by stormer-verlet")  # as the file has it, and the report
    assert "stormer-verlet, order 2" in result.stdout
    kept = kd.load(folder / "kickdrift-output" / "two.npz")
    assert (kept.t[-1], kept.step, kept.n_steps) == (100.0, 0.001, 100_000)
    assert kept.t.size == 1001
    assert kept.about.coordinates["body"] == ["Sun", "Earth"]
    result = call("run", "two.toml", "--years", 1, "--step", "3652.5 d", "--method", "kick-drift")
    assert result.exit_code == cli.BAD_INPUT
    assert "step=10.0 is larger than t_span" in result.stderr
    result = call("run", "two.toml", "--years", 1, "--step", "1 d", "--method", "kick-drift", "--save-every", 1)
    assert result.exit_code == cli.DONE
    kept = kd.load(folder / "kickdrift-output" / "two.npz")
    assert (kept.n_steps, kept.t[-1], kept.about.method) == (366, 1.0, "kick-drift")


def test_a_file_named_like_a_system_is_not_that_system(folder, undrawn):
    (folder / "solar-system.toml").write_text(help_texts.SAMPLE_TOML)
    result = call("run", "solar-system.toml", "--duration", 1)
    assert result.exit_code == cli.DONE
    assert "JPL" not in result.output


def test_compare_shows_four_methods_and_a_picture(folder):
    result = call("compare", "harmonic-oscillator", "--step", 0.1, "--duration", 100)
    assert result.exit_code == cli.DONE, result.output
    assert (folder / "kickdrift-output" / "harmonic-oscillator-energy.png").read_bytes().startswith(b"\x89PNG")
    head, *rows = result.stdout.splitlines()[:5]
    assert head.split("  ")[0] == "method"
    table = {row.split()[0]: row.split()[1:] for row in rows}
    assert list(table) == ["explicit-euler", "implicit-euler", "semi-implicit-euler", "stormer-verlet"]
    errors = [float(cells[0]) for cells in table.values()]
    # (1 + h^2)^n - 1 and 1 - (1 + h^2)^-n for explicit and implicit Euler, n = 1000; h/2 and h^2/4 for the other two.
    assert errors == pytest.approx([1.01**1000 - 1, 1 - 1.01**-1000, 0.0526, 0.0025], rel=0.02)
    # arctan(h) / h and 2 arcsin(h / 2) / h, less 1, times the span; near the centre, where implicit Euler ends, the nearest
    # point of an orbit is not sharp.
    slow, fast = -0.3306, 0.0417
    assert [float(cells[2]) for cells in table.values()] == pytest.approx([slow, slow, fast, fast], abs=0.05)
    assert float(table["stormer-verlet"][2]) == pytest.approx(fast, abs=1e-3)
    assert [cells[3] for cells in table.values()][0::2] == ["1000", "1000"]
    assert table["stormer-verlet"][3] == "1001"
    assert (
        float(table["stormer-verlet"][5]) < float(table["semi-implicit-euler"][5]) < float(table["explicit-euler"][5])
    )
    assert all(cells[-1] == "done" for cells in table.values())


def test_compare_shows_how_far_a_method_came(folder, undrawn):
    result = call("compare", "kepler", "--step", 0.01, "--duration", 20)
    assert result.exit_code == cli.DONE, result.output
    assert "not converged at t=6.82" in result.stdout


def test_lists_hold_the_whole_catalogues():
    methods = call("list", "methods")
    systems = call("list", "systems")
    assert methods.exit_code == systems.exit_code == cli.DONE
    for method in kd.methods.catalogue().values():
        line = next(line for line in methods.stdout.splitlines() if line.startswith(f"{method.name} "))
        for cell in (method.name, *method.aliases, method.source):
            assert cell in line
        assert ("all but constraints and noise" if method.kind is Kind.FIRST_ORDER else method.kind.value) in line
    assert [line.split()[0] for line in systems.stdout.splitlines()[1:]] == list(kd.systems.catalogue())
    evaluations = {
        line.split()[0]: line.split()[3] for line in methods.stdout.splitlines() if "(" not in line.split()[2]
    }
    assert (evaluations["velocity-verlet"], evaluations["blanes-moan-srkn6b"]) == ("1", "6")
    assert evaluations["implicit-euler"] == "iterated"


def test_a_narrow_terminal_gets_blocks(monkeypatch, capsys):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "20")
    cli.output.show_table(("name", "word"), [("velocity-verlet", "K/2 D K/2")])
    assert capsys.readouterr().out == "velocity-verlet\n  word  K/2 D K/2\n"


def test_a_terminal_wide_enough_gets_a_table_with_wrapped_cells(monkeypatch, capsys):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "40")
    cli.output.show_table(("name", "source"), [("verlet", "a paper of many words that are wrapped in the cell")])
    assert capsys.readouterr().out.splitlines() == [
        "name    source",
        "verlet  a paper of many words that are",
        "        wrapped in the cell",
    ]


@pytest.mark.parametrize(
    "arguments", [(*command, "--help") for command in ((), ("run",), ("view",), ("compare",), ("list",))]
)
def test_help_has_examples(arguments):
    result = call(*arguments)
    assert result.exit_code == cli.DONE
    assert "\n    kickdrift " in result.stdout
    if arguments[0] == "run":
        assert all(f"    {line}".rstrip() in result.stdout for line in help_texts.SAMPLE_TOML.splitlines())


def test_version():
    result = call("--version")
    assert (result.exit_code, result.stdout) == (cli.DONE, f"kickdrift {kd.__version__}\n")


REFUSED = {
    ("run", "solar-sytem"): ["TARGET='solar-sytem'", "'solar-system'"],
    ("run", "notes.txt"): ["TARGET='notes.txt'", "neither a system nor a bodies file", ".toml"],
    ("run", "missing.toml"): ["missing.toml", "No such file"],
    ("run", "folder.toml"): ["folder.toml", "Is a directory"],
    ("run", "zip.toml"): ["zip.toml", "not UTF-8"],
    ("run", "typo.toml"): ["typo.toml: bodies[0].mas", "'mas'", "did you mean 'mass'"],
    ("run", "empty-run.toml"): ["--duration", "empty-run.toml", "[run]"],
    ("run", "empty-run.toml", "--duration", "1"): ["--step", "empty-run.toml", "[run]"],
    ("run", "kepler", "--step", "fast"): ["--step='fast'", "'0.5 day'"],
    ("run", "kepler", "--step", ""): ["--step=''"],
    ("run", "kepler", "--step", "0"): ["--step='0'", "not zero"],
    ("run", "kepler", "--step=-0.1"): ["--step='-0.1'", "positive"],
    ("run", "kepler", "--step", "1e999"): ["--step='1e999'", "finite"],
    ("run", "kepler", "--step", "1e-300"): ["step=1e-300", "larger"],
    ("run", "kepler", "--step", "200"): ["step=200.0", "smaller"],
    ("run", "kepler", "--step", "1 day"): ["--step='1 day'", "no unit of time", "plain numbers"],
    ("run", "benchmarks-game", "--step", "1 day"): ["--step='1 day'", "year of 365.24 days", "plain numbers"],
    ("run", "solar-system", "--step", "1 parsec"): ["--step='1 parsec'", "'parsec'", "hour"],
    ("run", "solar-system", "--step", "1 2 day"): ["--step='1 2 day'", "is not a time"],
    ("run", "kepler", "--duration", "0"): ["--duration='0'", "not zero"],
    ("run", "kepler", "--duration", "nan"): ["--duration='nan'", "is not a time"],
    ("run", "kepler", "--years", "1"): ["--years", "no unit of time"],
    ("run", "solar-system", "--years", "many"): ["--years='many'", "give a number"],
    ("run", "solar-system", "--years", "0"): ["--years", "not zero"],
    ("run", "solar-system", "--years", "nan"): ["--years", "nan"],
    ("run", "solar-system", "--years", "1", "--duration", "5"): ["--years='1'", "--duration='5'", "leave one out"],
    ("run", "kepler", "--method", "leapfrg"): ["method='leapfrg'", "'leapfrog'"],
    ("run", "solar-system", "--bodies", "Sun,Erth"): ["bodies='Erth'", "'Earth'"],
    ("run", "solar-system", "--bodies", "Sun,sun"): ["'Sun' twice"],
    ("run", "solar-system", "--bodies", ""): ["bodies=''"],
    ("run", "kepler", "--bodies", "Sun"): ["--bodies='Sun'", "'solar-system'"],
    ("run", "kepler", "--save-every", "0"): ["--save-every='0'", "positive"],
    ("run", "kepler", "--save-every", "1.5"): ["--save-every='1.5'", "whole number"],
    ("run", "kepler", "--output", "notes.txt"): ["--output='notes.txt'", "cannot be written", "another folder"],
    ("run", "kepler", "--output", "notes.txt/below"): ["--output='notes.txt/below'", "Not a directory"],
    ("run", "kepler", "--output", "/proc/kickdrift"): ["--output='/proc/kickdrift'", "cannot be written"],
    ("view", "pyramd"): ["TARGET='pyramd'", "'pyramid'"],
    ("view", "kepler"): ["is a system", "kickdrift run kepler"],
    ("view", "notes.txt"): ["TARGET='notes.txt'", "cannot be viewed", ".npz"],
    ("view", "missing.npz"): ["missing.npz", "No such file"],
    ("view", "notes.npz"): ["notes.npz", "is not a kickdrift solution"],
    ("view", "missing.xml"): ["missing.xml", "No such file"],
    ("view", "bouncing-disk", "--step=-1"): ["--step='-1'", "positive"],
    ("view", "bouncing-disk", "--port", "65536"): ["port=65536", "from 0 to 65535"],
    ("compare", "keplr"): ["TARGET='keplr'", "'kepler'"],
    ("compare", "kepler", "--step", "2 h"): ["--step='2 h'"],
    ("compare", "kepler", "--output", "notes.txt"): ["--output='notes.txt'", "another folder"],
}


@pytest.mark.parametrize("arguments", REFUSED, ids=" ".join)
def test_bad_input_is_one_sentence_before_any_work(folder, arguments):
    (folder / "notes.txt").write_text("notes")
    (folder / "notes.npz").write_text("notes")
    (folder / "folder.toml").mkdir()
    (folder / "zip.toml").write_bytes(b"PK\x03\x04\xff")
    (folder / "typo.toml").write_text('[[bodies]]\nname = "a"\nmas = 1\n')
    (folder / "empty-run.toml").write_text(COLLISION.partition("\n")[2])
    before = sorted(folder.iterdir())
    result = call(*arguments)
    assert result.exit_code == cli.BAD_INPUT
    assert result.stdout == ""
    assert result.stderr.startswith("kickdrift: ")
    assert result.stderr.count("\n") == 1
    for part in REFUSED[arguments]:
        assert part in result.stderr
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("run", "kepler", "--stpe", "1"), "--step"),
        (("run",), "target"),
        (("list", "planets"), "'planets'"),
        (("fly",), "'fly'"),
    ],
)
def test_usage_that_cannot_be_parsed(folder, arguments, named):
    result = call(*arguments)
    assert result.exit_code == cli.BAD_INPUT
    assert named.lower() in result.stderr.lower()
    assert not list(folder.iterdir())


def test_a_run_that_fails_keeps_what_it_has(folder):
    (folder / "collision.toml").write_text(COLLISION)
    result = call("run", "collision.toml")
    assert result.exit_code == cli.FAILED
    assert "not a number" in result.stderr.splitlines()[-1]
    kept = kd.load(folder / "kickdrift-output" / "collision.npz")
    assert kept.status is kd.Outcome.NOT_FINITE
    assert kept.t.tolist() == [0.0, 1.0, 2.0]
    assert kept.x[-1, :, 0].tolist() == [1.0, -1.0]
    assert (folder / "kickdrift-output" / "collision.png").exists()
    assert "outcome" in result.stdout


def test_an_implicit_step_that_is_not_solved(folder):
    result = call("run", "kepler", "--method", "implicit-euler")
    assert result.exit_code == cli.FAILED
    assert "smaller step" in result.stderr
    assert kd.load(folder / "kickdrift-output" / "kepler.npz").status is kd.Outcome.NOT_CONVERGED


def interrupt(bar, step, seconds):
    if step > 1000:
        raise KeyboardInterrupt


def test_an_interrupted_run_keeps_what_it_has(folder, monkeypatch):
    monkeypatch.setattr(Bar, "show", interrupt)
    result = call("run", "solar-system")
    assert result.exit_code == cli.INTERRUPTED
    kept = kd.load(folder / "kickdrift-output" / "solar-system.npz")
    assert kept.status is kd.Outcome.INTERRUPTED
    assert 1000 < kept.n_steps < 146_100
    assert (folder / "kickdrift-output" / "solar-system.png").exists()
    assert "Mercury" in result.stdout
    assert "Interrupted by the user" in result.stderr


def test_an_interrupted_comparison_shows_what_it_has(folder, monkeypatch):
    monkeypatch.setattr(Bar, "show", interrupt)
    result = call("compare", "kepler")
    assert result.exit_code == cli.INTERRUPTED
    assert "explicit-euler" in result.stdout
    assert "implicit-euler" not in result.stdout
    assert "interrupted at t=" in result.stdout


def test_an_interruption_outside_the_loop(folder, monkeypatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("kickdrift.cli.run.solve", stop)
    result = call("run", "kepler")
    assert result.exit_code == cli.INTERRUPTED
    assert result.stderr.splitlines()[-1] == "kickdrift: interrupted."


def test_files_of_the_same_name_are_replaced_and_others_stay(folder, undrawn):
    (folder / "kickdrift-output").mkdir()
    (folder / "kickdrift-output" / "kepler.npz").write_text("mine")
    (folder / "kickdrift-output" / "notes.txt").write_text("mine")
    assert call("run", "kepler", "--duration", 1).exit_code == cli.DONE
    names = {path.name for path in (folder / "kickdrift-output").iterdir()}
    assert names == {"kepler.npz", "kepler.png", "notes.txt"}
    assert kd.load(folder / "kickdrift-output" / "kepler.npz").success


def test_a_solution_that_cannot_be_written_is_reported_all_the_same(folder, monkeypatch):
    def full(solution, path):
        raise kd.KickdriftError(f"path={str(path)!r} cannot be written: No space left on device.")

    monkeypatch.setattr(kd.Solution, "presenters", replace(kd.Solution.presenters, save=full))
    result = call("run", "kepler", "--duration", 1)
    assert result.exit_code == cli.BAD_INPUT
    assert "energy error" in result.stdout
    assert "No space left" in result.stderr


def test_without_typer_one_line_names_the_extra(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "typer", None)
    assert cli.main() == cli.BAD_INPUT
    assert capsys.readouterr().err == (
        "kickdrift: the command line needs the package 'typer', which is not installed;"
        " run: pip install 'kickdrift[cli]'\n"
    )


def test_what_only_some_commands_need_is_not_imported():
    code = "import kickdrift.cli.app, sys; sys.exit(bool({'matplotlib', 'pydantic', 'rich'} & set(sys.modules)))"
    assert process("-c", code).returncode == 0


def test_as_a_module_and_piped():
    environment = os.environ | {"COLUMNS": "20"}
    result = process("-m", "kickdrift", "list", "methods", env=environment)
    assert result.returncode == 0
    assert re.search(r"^blanes-moan-srkn6b +4 ", result.stdout, re.MULTILINE)
    result = process("-m", "kickdrift", "run", "pendulm")
    assert (result.returncode, result.stdout) == (2, "")
    assert "'pendulum'" in result.stderr


@pytest.mark.parametrize(
    ("text", "own_unit", "value"),
    [
        ("0.5", "", 0.5),
        ("0.5", "day", 0.5),
        ("0.5 day", "day", 0.5),
        ("12h", "day", 0.5),
        (" 12 hours ", "day", 0.5),
        ("1440 min", "day", 1.0),
        ("86400 s", "d", 1.0),
        ("1 yr", "day", 365.25),
        ("1 Year", "year", 1.0),
        ("-2.5e1 days", "day", -25.0),
        (".5 fortnight", "fortnight", 0.5),
    ],
)
def test_times(text, own_unit, value):
    assert parse_time("--step", text, own_unit) == value


def test_a_unit_needs_one_to_convert_to():
    with pytest.raises(ArgumentError, match="has its time in 'fortnight'"):
        parse_time("--step", "1 day", "fortnight")


def viewed(folder, monkeypatch, *arguments):
    """Call `kickdrift view`, with nobody who waits; return what it said, and the world, its step and port."""
    seen = []

    class Page:
        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def wait(self):
            pass

    def view(world, step, *, port):
        seen.append((world, step, port))
        return Page()

    monkeypatch.setattr(kd.World, "view", view)
    result = call("view", *arguments)
    assert result.exit_code == cli.DONE, result.output
    return result, *(seen[0] if seen else ())


def test_scenes_and_worlds_that_were_saved_are_viewed(folder, monkeypatch):
    _, world, step, port = viewed(folder, monkeypatch, "bouncing-disk")
    assert (len(world.position) > 1, step, port) == (True, 1 / 100, 8080)
    assert viewed(folder, monkeypatch, "bouncing-disk", "--step", "0.02", "--port", 0)[2:] == (0.02, 0)
    world.step(1 / 128)
    world.save("world.npz")
    _, again, step, _ = viewed(folder, monkeypatch, "world.npz")
    assert (again.time, step) == (world.time, 1 / 128)


def test_a_world_with_functions_is_viewed_in_a_script(folder):
    world = kd.World()
    world.add_sphere(0.5, mass=1.0)
    world.add_force(lambda position, force: None)
    world.save("pushed.npz")
    result = call("view", "pushed.npz")
    assert result.exit_code == cli.BAD_INPUT
    assert "kd.load_world('pushed.npz', forces=[...]).view" in result.stderr


def test_runs_that_were_saved_become_pages(folder, monkeypatch):
    world = kd.World()
    world.add_sphere(0.5, mass=1.0)
    world.run(0.1, 1 / 60, progress=False).save("ball.npz")
    planets(1.0).save("planets.npz")
    for name in ("ball", "planets"):
        (result,) = viewed(folder, monkeypatch, f"{name}.npz")
        assert result.stdout == f"open {name}.html\n"
        assert (folder / f"{name}.html").read_text(encoding="utf-8").startswith("<!doctype html>")
    result = call("view", "ball.npz", "--step", "0.1")
    assert result.exit_code == cli.BAD_INPUT
    assert "--step='0.1' applies to worlds" in result.stderr


def test_robots_are_viewed_with_what_is_to_be_said_of_them(folder, monkeypatch):
    pytest.importorskip("mujoco", reason="robots are read by MuJoCo")
    (folder / "arm.xml").write_text(
        '<mujoco><worldbody><body><joint name="elbow" axis="0 1 0" frictionloss="0.1"/>'
        '<geom type="capsule" size="0.05" fromto="0 0 0 1 0 0"/></body></worldbody></mujoco>'
    )
    _, world, step, _ = viewed(folder, monkeypatch, "arm.xml")
    assert (world.joint("elbow").angle, step) == (0.0, 1 / 200)

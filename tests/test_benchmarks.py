"""The benchmarks: the arithmetic of the rows, the table, and that C does the work that kickdrift does."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

import kickdrift as kd

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module", autouse=True)
def _importable():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT))
        yield
    for name in [name for name in sys.modules if name.split(".")[0] == "benchmarks"]:
        del sys.modules[name]


def test_a_row_is_judged_by_its_median():
    from benchmarks import table

    samples = [1.0, 1.1, 1.2, 1.3, 9.0]
    row = table.measured("a / b", samples, table.at_most(1.5))
    assert (row.measured, row.wanted, row.spread) == ("1.2 x", "at most 1.5 x", "1.1 to 1.3")
    assert row.verdict is table.Verdict.MET
    assert table.measured("a / b", samples, table.at_most(1.05)).verdict is table.Verdict.MISSED
    assert table.measured("a / b", samples, table.at_least(1.05)).verdict is table.Verdict.MET
    assert table.measured("a / b", samples, table.at_least(1.5)).verdict is table.Verdict.MISSED
    assert table.measured("a / b", samples).verdict is table.Verdict.UNJUDGED


def test_a_bound_between_the_quartiles_is_noise():
    from benchmarks import table

    samples = [1.0, 1.1, 1.2, 1.3, 9.0]
    assert table.measured("a", samples, table.at_most(1.25)).verdict is table.Verdict.MET_NARROWLY
    assert table.measured("a", samples, table.at_most(1.15)).verdict is table.Verdict.MISSED_NARROWLY
    assert table.measured("a", samples, table.at_least(1.15)).verdict is table.Verdict.MET_NARROWLY


def test_what_has_to_be_equal():
    from benchmarks import table

    assert table.equal("energy", "-0.1", "-0.1").verdict is table.Verdict.MET
    assert table.equal("energy", "-0.1", "-0.2").verdict is table.Verdict.MISSED


@pytest.mark.parametrize(("value", "text"), [(0.07243, "0.0724"), (1.5, "1.5"), (2284e6, "2.28e+09"), (348.6, "349")])
def test_numbers_are_short(value, text):
    from benchmarks import table

    assert table.number(value) == text


def test_the_table():
    from benchmarks import table

    rows = [
        table.measured("a / b", [2.0], table.at_least(3), "a | b"),
        table.measured("import", [0.1], unit="s"),
        table.skipped("c", "install gcc"),
    ]
    assert table.markdown([("title", rows)]) == (
        "| what | wanted | measured | quartiles | verdict | note |\n"
        "| --- | --- | --- | --- | --- | --- |\n"
        "| **title** | | | | | |\n"
        "| a / b | at least 3 x | 2 x | 2 to 2 | missed | a \\| b |\n"
        "| import |  | 0.1 s | 0.1 to 0.1 |  |  |\n"
        "| c |  |  |  | skipped | install gcc |\n"
    )


def test_turns_go_forwards_and_backwards_after_a_round_thrown_away():
    from benchmarks.turns import in_turns

    calls = []

    def contestant(name):
        calls.append(name)
        return float(len(calls))

    costs = in_turns({"a": lambda: contestant("a"), "b": lambda: contestant("b")}, rounds=2)
    assert "".join(calls) == "ab" + "ab" + "ba"
    assert costs["a"].tolist() == [3.0, 6.0]
    assert costs["b"].tolist() == [4.0, 5.0]


def test_ratios_are_taken_round_by_round():
    from benchmarks.turns import cheapest, nanoseconds, ratio

    costs = {"a": np.array([2.0, 8.0, 6.0]), "b": np.array([1.0, 2.0, 6.0])}
    assert ratio(costs, "a", "b").tolist() == [2.0, 4.0, 1.0]
    assert cheapest(costs, costs) == "b"
    assert nanoseconds(costs, "a", "b") == "a 6 ns, b 2 ns"


def test_steps_for_an_error_are_found_for_a_method_of_order_one():
    from benchmarks.implicit_euler import _steps_for

    found = _steps_for(1e-3, lambda steps: min(7.0, 40.0 / steps))
    assert 0.95e-3 <= 40.0 / found <= 1e-3
    with pytest.raises(ValueError, match="no step"):
        _steps_for(1e-3, lambda steps: 1.0 if steps < 1000 else 1e-4)


def test_without_a_compiler_there_is_a_sentence(monkeypatch):
    from benchmarks import c_programs
    from benchmarks.table import Missing

    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(Missing, match="gcc"):
        c_programs.build("kepler")


def test_without_a_peer_there_is_a_sentence():
    from benchmarks.peers import package
    from benchmarks.table import Missing

    with pytest.raises(Missing, match=r"kickdrift\[bench\]"):
        package("no_such_peer")


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
@pytest.mark.parametrize("compensated", [False, True])
def test_the_c_program_of_the_benchmarks_game_does_what_kickdrift_does(compensated):
    from benchmarks import against_c, c_programs

    solution = against_c.solve(1000, compensated)
    for path in c_programs.build("benchmarks_game").values():
        energies = c_programs.run(path, 1000).results
        np.testing.assert_allclose(energies, solution.energy, rtol=1e-12)
        assert f"{energies[-1]:.9f}" == "-0.169087605"


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
def test_the_c_program_of_kepler_does_what_kickdrift_does():
    from benchmarks import c_programs, kepler

    x = kepler.kickdrift(1000)[1]
    for path in c_programs.build("kepler").values():
        np.testing.assert_allclose(c_programs.run(path, 1000).results, x, rtol=0, atol=1e-11)


def test_every_nonlinear_system_of_the_catalogue_is_compared():
    from benchmarks.implicit_euler import cases

    assert set(cases()) == set(kd.systems.catalogue()) - {"harmonic-oscillator"} | {"duffing"}

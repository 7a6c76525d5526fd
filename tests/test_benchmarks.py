"""The benchmarks: the arithmetic of the rows, the table, and that C does the work that kickdrift does."""

import math
import shutil
import sys
from dataclasses import replace
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


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
@pytest.mark.parametrize("has", [False, True])
def test_the_c_program_of_gravity_does_what_kickdrift_does_where_it_runs(has, monkeypatch):
    from benchmarks import gravity
    from benchmarks.table import Verdict

    runs = has and gravity.has_avx512()
    monkeypatch.setattr(gravity, "has_avx512", lambda: runs)
    monkeypatch.setitem(gravity.STEPS, 300, {"kickdrift": 3})
    (row,) = gravity.by_hand(300, 1)  # which compares the accelerations
    assert (row.verdict is Verdict.SKIPPED) is not runs
    assert "AVX-512" in row.what + row.note


def test_every_nonlinear_system_of_the_catalogue_is_compared():
    from benchmarks.implicit_euler import cases

    assert set(cases()) == set(kd.systems.catalogue()) - {"harmonic-oscillator"} | {"duffing"}


def power_law(order, work=(1.0, 10.0, 100.0, 1000.0)):
    return np.array(work), np.array(work) ** -float(order)


def test_errors_are_interpolated_by_their_logarithms():
    from kickdrift.analysis.work_curve import error_at

    work, errors = power_law(4)
    assert error_at(work, errors, 30.0) == pytest.approx(30.0**-4, rel=1e-12)
    assert np.interp(30.0, work, errors) > 60 * 30.0**-4  # which a straight line between the runs would give
    assert error_at(work, errors, 1e5) == pytest.approx(errors[-1], rel=1e-12)
    assert error_at(work, errors, 0.9) == np.inf


def test_work_is_interpolated_by_its_logarithm():
    from kickdrift.analysis.work_curve import error_at, work_for

    work, errors = power_law(4)
    assert work_for(work, errors, 30.0**-4) == pytest.approx(30.0, rel=1e-12)
    assert work_for(work, errors, error_at(work, errors, 7.0)) == pytest.approx(7.0, rel=1e-12)
    assert work_for(work, errors, 2.0) == work[0]
    assert work_for(work, errors, 1e-13) == np.inf


def test_failed_runs_and_runs_that_rounding_made_worse_do_not_count():
    from kickdrift.analysis.work_curve import error_at, work_for

    work, errors = power_law(2)
    worse = np.array([np.inf, *errors, 1e-3])
    longer = np.array([0.5, *work, 1e4])
    assert error_at(longer, worse, 30.0) == pytest.approx(30.0**-2, rel=1e-12)
    assert error_at(longer, worse, 1e4) == pytest.approx(errors[-1], rel=1e-12)
    assert error_at(longer, worse, 0.7) == np.inf
    assert work_for(longer, worse, 1e-3) == pytest.approx(10**1.5, rel=1e-12)
    assert work_for(work, np.full(4, np.inf), 0.1) == np.inf


def curve(label, order, slowness, rounds=3):
    from kickdrift.analysis.work_curve import Curve

    work, errors = power_law(order)
    return Curve(label, errors, work, slowness * np.tile(work, (rounds, 1)))


def test_a_peer_ten_times_slower_is_off_by_ten_to_the_order_at_equal_time():
    from benchmarks.precision import curves

    ours = [curve("kickdrift two", 2, 1.0), curve("kickdrift four", 4, 1.0)]
    for slowness, errors, times in ((1.0, 1.0, 1.0), (10.0, 1e4, 10.0), (0.5, 1 / 16, 0.5)):
        found = curves.compare(curve("peer", 4, slowness), 2, ours)
        np.testing.assert_allclose(found.errors, errors, rtol=1e-9)
        np.testing.assert_allclose(found.times, times, rtol=1e-9)
        assert found.most_exact == found.quickest == "kickdrift four"


def test_runs_beyond_ours_are_not_extrapolated():
    from benchmarks.precision import curves

    ours = [curve("kickdrift four", 4, 1.0)]
    quick = curves.compare(curve("quick", 4, 0.5), 0, ours)
    assert quick.errors.tolist() == [0.0] * 3
    assert quick.quickest == "kickdrift four"
    exact = curves.compare(curve("exact", 5, 1.0), 3, ours)
    assert exact.times.tolist() == [0.0] * 3
    assert (exact.errors < 1).all()


def test_the_nearest_run_is_found_by_the_logarithm():
    from kickdrift.analysis.work_curve import nearest

    found = curve("four", 4, 1.0)  # errors 1, 1e-4, 1e-8, 1e-12
    assert [nearest(found, error) for error in (0.9, 2e-3, 0.5e-4, 3e-10, 1e-17)] == [0, 1, 1, 2, 3]


@pytest.fixture(scope="module")
def precision_cases():
    from benchmarks.precision.cases import every_case

    return every_case()


def test_every_kind_has_a_case_with_the_methods_that_auto_takes(precision_cases):
    assert {case.kind for case in precision_cases} == set(kd.methods.Kind)
    assert len({case.name for case in precision_cases}) == len(precision_cases)
    for case in precision_cases:
        assert all(kd.methods.get(name).kind.includes(case.kind) for name in case.methods)
        assert kd.methods.preferred(case.kind).name in case.methods
        assert len({peer.label for peer in case.peers}) == len(case.peers) > 0


def test_a_case_is_the_same_problem_for_kickdrift_and_its_peers(precision_cases):
    from benchmarks.precision.laws import expressed

    for case in precision_cases:
        if case.kind is kd.methods.Kind.LANGEVIN:
            continue  # peers get the force of its own

        def rates(t, y, case=case):
            return np.array(expressed(case.law, math, len(case.x0), t, y))

        span = case.span / 5000
        start = () if isinstance(case.problem, kd.System) else (case.x0, case.v0) if case.v0 else (case.x0,)
        method = {kd.methods.Kind.CONSTRAINED: "rattle"}.get(case.kind, "gauss-4")
        problem = replace(case.problem, native=False) if isinstance(case.problem, kd.System) else case.problem
        found = kd.solve(problem, (0.0, span), *start, step=span / 8, method=method, compile=False)
        end = np.concatenate([found.x[-1].ravel(), found.v[-1].ravel()])
        law = kd.FirstOrder(rates)
        wanted = kd.solve(law, (0.0, span), case.start, step=span / 8, method="gauss-4", compile=False).x[-1]
        moved = np.abs(wanted - case.start).max()
        assert np.abs(end - wanted).max() < 1e-4 * moved, case.name


def small(case):
    return replace(case, span=10.0, evaluations=(400.0, 1600.0), peers=())


def test_runs_get_the_evaluations_and_tolerances_of_the_case(precision_cases):
    from benchmarks.precision.case import Contestant
    from benchmarks.precision.measure import values

    case = small(precision_cases[0])
    assert values(case, Contestant("a b", None, cost=8.0, count=3)).tolist() == [50, 100, 200]
    assert values(case, Contestant("a b", None, cost=8.0, limit=800.0, count=2)).tolist() == [50, 100]
    np.testing.assert_allclose(values(case, Contestant("a b", None, limit=1e-8, count=3)), [1e-4, 1e-6, 1e-8])


def test_who_is_missing_is_said_and_who_does_other_work_is_found(precision_cases):
    from benchmarks.precision import measure, ours
    from benchmarks.precision.case import Contestant, Run
    from benchmarks.table import Missing

    def absent(case):
        raise Missing("pip install kickdrift[bench]")

    def other_work(case):
        return lambda value, keep: Run(1e-3, np.array([[0.1, 0.0, 0.0, 0.7]]), value)

    case = small(precision_cases[0])
    own = ours.contestant(case, "blanes-moan-srkn6b", count=2)
    found, missing = measure.curves(case, [own, Contestant("absent Method", absent)], rounds=1)
    assert missing == {"absent Method": "pip install kickdrift[bench]"}
    assert [curve.label for curve in found] == ["kickdrift blanes-moan-srkn6b"]
    assert found[0].seconds.shape == (1, 2)
    assert found[0].errors[0] > 10 * found[0].errors[1] > 0
    np.testing.assert_allclose(found[0].evaluations, case.evaluations, rtol=0.05)
    with pytest.raises(AssertionError, match="same work"):
        measure.curves(case, [Contestant("wrong Method", other_work, cost=1.0)], rounds=1)


def test_the_reference_of_a_case_is_the_exact_end(precision_cases):
    from benchmarks.precision import ours

    [kepler] = [case for case in precision_cases if case.name == "kepler"]
    turn = replace(kepler, span=2 * np.pi, end=())
    np.testing.assert_allclose(ours.reference(turn), kepler.end, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(ours.reference(kepler), kepler.end)


def test_the_best_other_method_is_found_between_chaos_and_rounding():
    from benchmarks.precision.preference import best_other

    chosen = np.array([0.5, 1e-4, 1e-8, 1e-13])
    others = {"a": chosen * [1e-3, 2, 2, 1e-3], "b": chosen * [1, 8, 0.1, 1], "c": chosen * [1, 1.9, 3, 1]}
    name, ratios = best_other(chosen, others)
    assert name == "b"
    np.testing.assert_allclose(ratios, [8, 0.1])
    assert best_other(chosen, {"a": others["a"], "c": others["c"]})[0] == "a"
    assert best_other(chosen, {})[0] == ""


def test_rivals_are_words_of_kicks_and_drifts_that_have_the_order():
    from benchmarks.precision.preference import rivals

    Kind = kd.methods.Kind
    names = {method.name for method in rivals(Kind.SEPARABLE, 6)}
    assert {"blanes-moan-s10", "yoshida-6"} < names
    assert not names & {"blanes-moan-srkn11b", "gauss-6", "yoshida-8"}
    assert "blanes-moan-srkn11b" in {method.name for method in rivals(Kind.NEWTONIAN, 6)}


def test_a_picture_names_every_line_once_and_is_small(precision_cases, tmp_path):
    from benchmarks.precision import picture

    kickdrift = [curve(f"kickdrift order-{order}", order, 0.01) for order in (2, 3, 4)]
    peers = [curve(f"heyoka {order}", order, 0.1) for order in (2, 3, 4)]
    path = tmp_path / "pictures" / "case.png"
    picture.draw(precision_cases[0], kickdrift, peers, path)
    assert path.read_bytes().startswith(b"\x89PNG")
    assert path.stat().st_size < 150_000


def test_labels_do_not_lie_on_each_other():
    from benchmarks.precision.labels import Label, place
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 4))
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log", xlim=(0.5, 2e3), ylim=(1e-10, 10))
    work, errors = power_law(3)
    labels = [Label(f"method {i}", "black", i == 0, work, errors * (1 + 0.1 * i)) for i in range(5)]
    place(axes, labels)
    boxes = [text.get_window_extent() for text in axes.texts]
    assert sorted(text.get_text() for text in axes.texts) == [label.text for label in labels]
    assert not any(one.overlaps(other) for i, one in enumerate(boxes) for other in boxes[:i])
    assert all(axes.get_window_extent().contains(*corner) for box in boxes for corner in (box.min, box.max))


def test_carts_that_are_compared_do_the_same():
    pytest.importorskip("mujoco")
    from benchmarks import rl, table

    rl._check_they_do_the_same()
    rows = rl.compare(1)
    assert [row.verdict for row in rows].count(table.Verdict.SKIPPED) == 0
    assert len(rows) == 7


def test_carts_that_do_something_else_are_not_compared(monkeypatch):
    pytest.importorskip("mujoco")
    from benchmarks import rl

    monkeypatch.setattr(rl, "_MJCF", rl._MJCF.replace('axis="0 1 0"', 'axis="0 -1 0"'))
    with pytest.raises(AssertionError, match="end differently"):
        rl._check_they_do_the_same()


def test_loops_by_hand_do_the_work_of_kickdrift():
    from benchmarks import steps

    kinds = ("composition-diagonal-2", "boris, 1 ")  # the others check themselves as they are timed
    chosen = [pair for pair in steps.pairs() if pair.what.startswith(kinds)]
    assert len(chosen) == len(kinds)
    for pair in chosen:
        pair.check()
    with pytest.raises(AssertionError, match="does not do the same work"):
        replace(chosen[0], loop=lambda steps: chosen[0].loop(steps + 1)).check()


def test_times_to_an_error_are_read_off_between_steps_from_which_on_no_error_is_larger():
    from benchmarks.auto.work import Curve

    errors = np.array([np.inf, 1e-1, 1e-5, 1e-3, 1e-4, 1e-6])
    seconds = np.array([[1.0], [2.0], [4.0], [8.0], [16.0], [32.0]])
    found = Curve(errors, seconds, ("a", "a", "a", "b", "b", "c"))
    assert found.time_to(1e-2) == pytest.approx(2.0 * 2 ** (1 / 4))  # errors fall by 1e4 from 2 to 4 seconds
    assert found.time_to(3e-4)[0] == pytest.approx(8.0 * 2 ** np.log10(1e-3 / 3e-4))  # not at the lucky 1e-5
    assert found.time_to(1e-7) is None
    assert found.time_to(0.5)[0] == 2.0  # nothing to read off from what was lost
    assert found.methods_at(1e-5) == ("b", "c")


def test_problems_of_auto_are_of_the_kinds_of_their_candidates():
    from benchmarks.auto import problems

    from kickdrift.analysis import candidates

    assert len(problems.named()) == 12
    for problem in problems.every_problem():
        span = 0.0, problem.largest
        run = kd.solve(
            problem.problem, span, problem.x0, problem.v0, step=problem.largest, method="auto", compile=False
        )
        assert run.about.kind == problem.kind.name
        for name in candidates.of(problem.kind):
            assert kd.methods.get(name).kind.includes(problem.kind)


def test_the_statements_of_a_page_have_their_lines():
    from benchmarks import readme

    page = (
        "title\n\n```python\nx = [1,\n     2]  # two\nprint(x)\n```\n\n```sh\nls\n```\n\n```python\nx.append(3)\n```\n"
    )
    assert [(line, first) for line, _, first in readme.statements_of(page)] == [
        (4, "x = [1,"),
        (6, "print(x)"),
        (14, "x.append(3)"),
    ]
    assert [statement[:2] for statement in readme.run(page)] == [(4, "x = [1,"), (6, "print(x)"), (14, "x.append(3)")]
    with pytest.raises(NameError):
        readme.run(page.replace("x = [1,\n     2]  # two", "pass\n"))

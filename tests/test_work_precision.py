"""Work-precision runs: exact errors and evaluations, tables and pictures."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift import analysis
from kickdrift.core.errors import ArgumentError

KEPLER = kd.systems.kepler(0.3)
STEPS = [0.04, 0.02, 0.01]


@pytest.fixture(scope="module")
def measured():
    return analysis.work_precision(KEPLER, (0.0, 10.0), ["leapfrog", "forest-ruth-4"], STEPS, rounds=2)


def test_errors_and_evaluations_are_those_of_the_runs(measured):
    for curve, evaluations in zip(measured.curves, (1, 3), strict=True):
        assert curve.seconds.shape == (2, 3)
        for step, error, count in zip(STEPS, curve.errors, curve.evaluations, strict=True):
            run = kd.solve(KEPLER, (0.0, 10.0), step=step, method=curve.label)
            x, v = KEPLER.exact(run.t[-1:])
            assert error == max(abs(run.x[-1] - x[0]).max(), abs(run.v[-1] - v[0]).max())
            assert count == run.n_force_evaluations
            assert count == pytest.approx(evaluations * run.n_steps, abs=1)


def test_a_curve_has_the_order_of_its_method(measured):
    for curve, order in zip(measured.curves, (2, 4), strict=True):
        slope = np.polyfit(np.log(curve.evaluations), np.log(curve.errors), 1)[0]
        assert slope == pytest.approx(-order, abs=0.1)


def test_it_shows_itself_as_a_table(measured):
    lines = repr(measured).splitlines()
    assert [cell.strip() for cell in lines[0].split("|")[1:-1]] == [
        "method", "step", "error", "force evaluations", "seconds",
    ]  # fmt: skip
    assert len(lines) == 2 + 6
    assert lines[2].split("|")[1:3] == [" velocity-verlet ", " 0.04 "]


def test_as_a_data_frame(measured):
    pytest.importorskip("pandas")
    table = measured.to_pandas()
    assert list(table["method"]) == ["velocity-verlet"] * 3 + ["forest-ruth-4"] * 3
    assert list(table["force evaluations"][:3]) == [251, 501, 1001]
    assert table["error"].dtype == np.float64


def test_its_picture_has_a_line_a_method(measured, small_pictures, tmp_path):
    figure = measured.plot(tmp_path / "work.png")
    assert (tmp_path / "work.png").stat().st_size > 1000
    left, right = figure.axes
    for curve, line in zip(measured.curves, left.lines, strict=True):
        assert np.array_equal(line.get_xdata(), curve.evaluations)
        assert np.array_equal(line.get_ydata(), curve.errors)
    assert [text.get_text() for text in right.get_legend().get_texts()] == ["velocity-verlet", "forest-ruth-4"]


def test_steps_may_be_those_of_each_method_and_runs_may_fail():
    steps = {"explicit-euler": [2.0], "kahan-li-8": [0.5, 1.0]}
    found = analysis.work_precision(
        kd.SecondOrder(lambda x: -(x**5)), (0.0, 200.0), list(steps), steps, 1.0, 0.5, rounds=1, reference=(1.0, 0.5)
    )
    assert np.isinf(found.curves[0].errors).all()
    assert found.curves[1].steps.tolist() == [1.0, 0.5]


def test_the_reference_is_that_of_the_whole_span_where_the_first_run_stops_early():
    cubic = {"x0": [0.7, -0.2], "v0": [0.3, 0.5]}
    table = analysis.work_precision(
        lambda t, x: -x - x**3 + np.cos(2 * t),
        (0.0, 20.0),
        ["kick-drift", "kahan-li-8"],
        [0.4, 0.05],
        rounds=1,
        **cubic,
    )
    failed, accurate = table.curves
    assert failed.errors[0] == np.inf
    assert accurate.errors[1] < 1e-9


def test_without_an_exact_solution_a_tight_run_is_the_reference():
    found = analysis.work_precision(
        lambda x: -np.sin(x), (0.0, 5.0), ["kahan-li-8"], [0.5], 1.0, 0.0, rounds=1, compile=False
    )
    assert 1e-12 < found.curves[0].errors[0] < 1e-7


@pytest.mark.parametrize(
    ("methods", "options", "reason"),
    [
        ([], {}, "methods="),
        ("leapfrog", {}, "methods='leapfrog'"),
        (["leapfrog"], {"steps": []}, "has no step for 'velocity-verlet'"),
        (["leapfrog"], {"steps": {"kahan-li-8": [0.1]}}, "has no step for 'velocity-verlet'"),
        (["leapfrog"], {"rounds": 0}, "rounds=0"),
        (["leapfog"], {}, "did you mean"),
    ],
)
def test_what_cannot_be_measured_is_refused(methods, options, reason):
    with pytest.raises(ArgumentError, match=reason):
        analysis.work_precision(KEPLER, (0.0, 1.0), methods, **{"steps": [0.1], **options})

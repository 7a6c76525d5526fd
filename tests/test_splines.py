"""Tables inside of forces: SciPy's splines, compiled and interpreted alike, and no times outside of them."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.engine import user_functions
from kickdrift.systems.spline import OUTSIDE

TIMES = np.array([0.0, 0.3, 1.0, 1.2, 2.5, 3.0, 4.4, 5.0, 7.0, 8.0, 9.5, 10.0])


def driven(table, end=10.0, **options):
    return kd.solve(lambda t, x: table(t) - x, (0.0, end), 1.0, 0.0, **{"step": 0.01, "method": "leapfrog", **options})


@pytest.mark.parametrize("end", ["not-a-knot", "natural", "clamped"])
@pytest.mark.parametrize("shape", [(), (3,), (2, 3)])
def test_a_table_is_the_spline_of_scipy(end, shape):
    values = np.random.default_rng(2).normal(size=(TIMES.size, *shape))
    table, theirs = kd.spline(TIMES, values, end), CubicSpline(TIMES, values, bc_type=end)
    for t in (*np.linspace(0.0, 10.0, 101), *TIMES):
        assert np.allclose(table(t), theirs(t), rtol=0, atol=1e-13)
        assert np.allclose(table.py_func(t), table(t), rtol=0, atol=1e-15)
        assert np.shape(table(t)) == shape


@pytest.mark.parametrize("count", [2, 3, 4, 8, 9, 1000])
@pytest.mark.parametrize("even", [True, False])
def test_any_number_of_rows(count, even):
    times = np.linspace(-3.0, 3.0, count) if even else np.sinh(np.linspace(-3.0, 3.0, count))
    table, theirs = kd.spline(times, np.cos(times)), CubicSpline(times, np.cos(times))
    for t in np.linspace(times[0], times[-1], 57):
        assert table(t) == pytest.approx(float(theirs(t)), abs=1e-12)


def test_it_repeats():
    times = np.linspace(0.0, 2 * np.pi, 40)
    values = np.cos(times)
    values[-1] = values[0]
    table = kd.spline(times, values, "periodic")
    assert table(0.0) == pytest.approx(table(2 * np.pi), abs=1e-12)


@pytest.mark.parametrize("shape", [(), (3,)])
def test_compiled_and_interpreted_runs_are_equal_bit_for_bit(shape):
    values = np.random.default_rng(3).normal(size=(TIMES.size, *shape))
    table = kd.spline(TIMES, values)

    def force(t, x):
        return table(t) - x

    start = np.ones(shape), np.zeros(shape)
    runs = [kd.solve(force, (0.0, 10.0), *start, step=0.05, method="leapfrog", compile=way) for way in (True, False)]
    assert np.array_equal(runs[0].x, runs[1].x)
    assert runs[0].success


def test_a_run_converges_to_that_of_the_function_that_is_tabulated():
    times = np.linspace(0.0, 10.0, 401)
    run = driven(kd.spline(times, np.sin(2 * times)), method="kahan-li-8", step=0.05)
    t = run.t  # x'' = sin 2t - x from (1, 0)
    assert np.abs(run.x - (np.cos(t) + 2 / 3 * np.sin(t) - np.sin(2 * t) / 3)).max() < 3e-8


def test_another_table_is_not_compiled_anew():
    compiled = user_functions._compiled

    def force(table):
        return lambda t, x: table(t) - 2 * x

    def run(rows, end=10.0):
        times = np.linspace(0.0, end, rows)
        table = kd.spline(times, np.cos(times))
        return kd.solve(force(table), (0.0, end), 1.0, 0.0, step=0.1)

    run(100)
    before = compiled.cache_info().misses
    first = run(128)
    run(70, end=5.0)
    assert compiled.cache_info().misses == before
    run(129)  # of another power of two
    assert compiled.cache_info().misses == before + 1
    assert first.success


@pytest.mark.parametrize("span", [(0.0, 10.5), (5.0, -0.1), (-1.0, 5.0), (11.0, 5.0)])
@pytest.mark.parametrize("compile_", [True, False])
def test_a_span_that_leaves_a_table_is_refused_before_the_run(span, compile_):
    table = kd.spline(TIMES, np.sin(TIMES))

    def force(t, x):
        return table(t) - x

    with pytest.raises(ArgumentError, match=f"extends beyond a table of kd.spline|{OUTSIDE}") as caught:
        kd.solve(force, span, 1.0, 0.0, step=0.1, compile=compile_)
    if "leaves" in str(caught.value):
        assert "from 0.0 to 10.0" in str(caught.value)


def test_methods_that_look_beyond_the_span_say_so():
    times = np.linspace(0.0, 10.0, 30)
    table = kd.spline(times, np.sin(times))
    assert driven(table, step=0.3, method="blanes-moan-srkn6b").success
    with pytest.raises(ArgumentError, match="'okunbor-skeel-6' with step"):
        driven(table, step=0.3, method="okunbor-skeel-6")
    wider = kd.spline(times - 1.0, np.sin(times - 1.0))
    assert driven(wider, 8.0, step=0.3, method="okunbor-skeel-6").success


@pytest.mark.parametrize("name", ["impacts", "switches", "events", "step_control"])
def test_tables_in_gaps_switches_events_and_densities_are_checked_before_the_run(name):
    table = kd.spline(np.linspace(0.0, 1.0, 11), np.ones(11))
    options = {"step": 0.05, "method": "velocity-verlet", "compile": False, name: lambda t, x: x + 2.0 * table(t)}
    with pytest.raises(ArgumentError, match=r"extends beyond a table of kd\.spline"):
        kd.solve(lambda x: -1.0, (0.0, 2.0), 1.0, 0.0, **options)
    if name == "step_control":  # asked half a step ahead of the start, and beyond the end
        with pytest.raises(ArgumentError, match=r"evaluates it at t=-0\.025"):
            kd.solve(lambda x: -1.0, (0.0, 1.0), 1.0, 0.0, **options)
        wide = kd.spline(np.linspace(-0.1, 1.2, 11), np.ones(11))
        options[name] = lambda t, x: x + 2.0 * wide(t)
    assert kd.solve(lambda x: -1.0, (0.0, 1.0), 1.0, 0.0, **options).success


def test_walls_that_move_by_a_table_do_so_from_its_first_time_to_its_last():
    times = np.linspace(0.0, 2.0, 41)
    wall = kd.spline(times, 0.5 * times**2)
    lift = kd.Impacts(lambda t, x: x - wall(t), restitution=0.0)
    sol = kd.solve(lambda x: -1.0, (0.0, 2.0), 0.0, 0.0, step=0.05, method="velocity-verlet", impacts=lift)
    assert sol.success
    assert np.abs(sol.x - 0.5 * sol.t**2).max() < 1e-10
    assert sol.v[-1] == pytest.approx(2.0, abs=1e-8)


def test_a_run_does_not_go_on_beyond_its_table():
    table = kd.spline(np.linspace(0.0, 1.0, 11), np.zeros(11))
    sol = driven(table, 0.5, step=0.05)
    with pytest.raises(ArgumentError, match=r"t_span=\(0.0, 2.0\) extends beyond a table"):
        sol.continue_to(2.0)
    assert sol.continue_to(1.0).success


def test_in_a_problem_of_several_functions_and_through_another_one():
    table = kd.spline(TIMES, np.sin(TIMES))

    def push(t):
        return table(t)

    problem = kd.SecondOrder(lambda t, x: push(t) - x, energy=lambda x, v: v * v + x * x)
    with pytest.raises(ArgumentError, match="extends beyond a table"):
        kd.solve(problem, (0.0, 12.0), 1.0, 0.0, step=0.1, compile=False)


def test_a_table_over_positions_may_be_left_by_a_run_which_then_ends():
    places = np.linspace(-1.0, 1.0, 50)
    table = kd.spline(places, -places)

    def force(x):
        return table(x)

    inside = kd.solve(force, (0.0, 20.0), 0.5, 0.0, step=0.01, method="leapfrog")
    assert np.abs(inside.x - 0.5 * np.cos(inside.t)).max() < 1e-4
    outside = kd.solve(force, (0.0, 20.0), 0.5, 2.0, step=0.01)
    assert not outside.success
    assert OUTSIDE in outside.message
    assert 0.9 < outside.x[-1] <= 1.02


def test_rounding_at_the_ends_is_inside():
    table = kd.spline([0.0, 0.5, 1.0], [0.0, 1.0, 0.0])
    assert table(1.0 + 1e-12) == pytest.approx(0.0, abs=1e-11)
    for t in (1.001, -0.001, np.nan):
        with pytest.raises(ValueError, match=OUTSIDE):
            table(t)


@pytest.mark.parametrize(
    ("t", "values", "options", "reason"),
    [
        ([0, 1, 1], [1, 2, 3], {}, "t must be strictly increasing, but 1.0 is followed by 1.0"),
        ([0, 2, 1], [1, 2, 3], {}, "t must be strictly increasing, but 2.0"),
        ([0], [1], {}, "at least two times"),
        ([0, 1], [1, 2, 3], {}, "one value per time"),
        ([0, np.nan], [1, 2], {}, "must be finite"),
        ([0, 1], ["a", "b"], {}, "arrays of numbers"),
        ([0, 1, 2], [1, 2, 3], {"end": "free"}, "end='free'"),
        ([0, 1, 2], [1, 2, 3], {"end": "periodic"}, "do not fit end='periodic'"),
    ],
)
def test_tables_that_cannot_be_are_refused(t, values, options, reason):
    with pytest.raises(ArgumentError, match=reason):
        kd.spline(t, values, **options)


def test_ensembles_that_leave_a_table_are_refused_before_the_run():
    table = kd.spline(TIMES, np.sin(TIMES))

    def driven_by_it(t, x):
        return table(t) - x

    def run(end, **options):
        start = [[1.0], [2.0]], [[0.0], [0.0]]
        return kd.solve_ensemble(
            driven_by_it, (0.0, end), *start, step=0.01, method="leapfrog", save_every=100, **options
        )

    assert run(TIMES[-1]).success.all()
    with pytest.raises(ArgumentError, match=r"extends beyond a table of kd\.spline"):
        run(TIMES[-1] + 0.5)
    switch = kd.spline(TIMES, TIMES - 2.0)
    with pytest.raises(ArgumentError, match=r"extends beyond a table of kd\.spline"):
        kd.solve_ensemble(
            lambda x: -x,
            (0.0, TIMES[-1] + 0.5),
            [[1.0], [2.0]],
            [[0.0], [0.0]],
            step=0.01,
            t_eval=[TIMES[-1] + 0.2],
            switches=lambda t: switch(t),
        )


def test_an_array_of_times_is_refused():
    with pytest.raises(ArgumentError, match=r"takes one number, not an array of shape \(2,\)"):
        kd.spline(TIMES, np.sin(TIMES))(np.array([1.0, 2.0]))

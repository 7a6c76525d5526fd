"""Events: zeros of functions of the state are found where they are, all of them, and end runs."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.core.outcomes import Outcome
from kickdrift.engine import quantities, run

QUIET = {"compile": False, "progress": False}


def with_attributes(function, **attributes):
    for name, value in attributes.items():
        setattr(function, name, value)
    return function


def ground(x):
    return x[1]


def thrown(*events, step=0.05, method="velocity-verlet", end=5.0, **options):
    """Throw a ball with 1 and 10 m/s."""
    start = [0.0, 0.0], [1.0, 10.0]
    return kd.solve(
        lambda x: np.array([0.0, -9.81]),
        (0.0, end),
        *start,
        step=step,
        method=method,
        events=list(events),
        **QUIET | options,
    )


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("method", ["velocity-verlet", "position-verlet", "yoshida-6", "gauss-4", "dop853"])
def test_a_ball_lands_when_it_should(method, compiled):
    hit = with_attributes(lambda x: x[1], terminal=True, direction=-1)
    sol = thrown(hit, method=method, compile=compiled)
    flight = 2 * 10 / 9.81
    assert sol.status is Outcome.STOPPED
    assert sol.success
    assert sol.t[-1] == pytest.approx(flight, abs=1e-13)
    assert sol.t_events[0] == pytest.approx([flight], abs=1e-13)
    assert sol.x[-1] == pytest.approx([flight, 0.0], abs=1e-12)
    assert sol.v_events[0][0] == pytest.approx([1.0, -10.0], abs=1e-12)
    assert sol.n_steps == 40
    assert sol.t.size == 42
    assert "events[0]" in sol.message
    assert sol(flight - 1e-3).x[1] == pytest.approx(1e-3 * 10, rel=1e-3)
    with pytest.raises(ArgumentError, match="outside the times of the solution"):
        sol(flight + 1e-3)


def test_every_crossing_of_a_pendulum_is_found_at_its_time():
    def right(x):
        return np.sin(x)

    options = {"step": 0.05, "method": "blanes-moan-srkn11b", "save_every": 100_000, "progress": False}
    sol = kd.solve(kd.systems.pendulum(), (0.0, 17_000.0), 1.0, 0.0, events=right, **options)
    half = 2 * ellipk(np.sin(0.5) ** 2)
    wanted = half * (0.5 + np.arange(int(17_000.0 / half - 0.5) + 1))
    assert wanted.size > 5000
    assert sol.t_events[0].size == wanted.size
    np.testing.assert_allclose(sol.t_events[0][:100], wanted[:100], atol=1e-10)
    np.testing.assert_allclose(np.diff(sol.t_events[0]), half, atol=1e-9)
    assert np.abs(sol.x_events[0]).max() < 2e-11  # four spacings of the time


@pytest.mark.parametrize(("direction", "first"), [(0, 0), (1, 1), (-1, 0), (0.5, 1), (-np.inf, 0)])
def test_directions_are_those_of_scipy(direction, first):
    crossing = with_attributes(lambda x: x, direction=direction)
    sol = kd.solve(lambda x: -x, (0.0, 20.0), 1.0, 0.0, step=0.1, method="gauss-6", events=crossing, **QUIET)
    stride = 1 if direction == 0 else 2
    wanted = np.pi * (0.5 + np.arange(first, 7, stride))
    wanted = wanted[wanted < 20.0]
    np.testing.assert_allclose(sol.t_events[0], wanted, atol=1e-7)
    theirs = with_attributes(lambda t, y: y[0], direction=direction)
    other = solve_ivp(
        lambda t, y: [y[1], -y[0]], (0.0, 20.0), [1.0, 0.0], "DOP853", events=theirs, rtol=1e-10, atol=1e-12
    )
    np.testing.assert_allclose(sol.t_events[0], other.t_events[0], atol=1e-6)


@pytest.mark.parametrize("terminal", [1, 3, True])
def test_the_run_ends_at_the_zero_that_is_wanted(terminal):
    crossing = with_attributes(lambda x: x, terminal=terminal)
    other = with_attributes(lambda v: v)
    sol = kd.solve(
        lambda x: -x, (20.0, 0.0), 1.0, 0.0, step=0.1, method="gauss-6", events=[other, crossing], save_every=7, **QUIET
    )
    count = int(terminal)
    assert sol.t[-1] == pytest.approx(20.0 - np.pi * (count - 0.5), abs=1e-7)
    assert sol.t_events[1].size == count
    np.testing.assert_allclose(sol.t_events[0], 20.0 - np.pi * np.arange(1, count), atol=1e-7)
    np.testing.assert_allclose(sol.t[:-1], 20.0 - 0.7 * sol.step / -0.1 * np.arange(sol.t.size - 1), atol=1e-12)


def test_a_run_of_varying_steps_that_an_event_ends_has_the_times_before_it():
    stop, wanted = with_attributes(lambda x: x, terminal=True), np.linspace(0.0, 3.0, 61)
    options = {"method": "dop853", "rtol": 1e-9, "atol": 1e-9, "events": stop, **QUIET}
    sol = kd.solve(lambda x: -x, (0.0, 10.0), 1.0, 0.0, t_eval=wanted, **options)
    np.testing.assert_allclose(sol.t, np.append(wanted[wanted < np.pi / 2], np.pi / 2), atol=1e-9)
    np.testing.assert_allclose(sol.x, np.cos(sol.t), atol=1e-9)
    rows = kd.solve(lambda x: -x, (0.0, 10.0), 1.0, 0.0, **options)
    between = np.linspace(rows.t[-2], rows.t[-1], 20)
    np.testing.assert_allclose(rows(between).x, np.cos(between), atol=1e-9)


def test_a_run_that_ends_before_the_first_time_wanted_has_states_up_to_there():
    stop = with_attributes(lambda x: x, terminal=True)
    sol = kd.solve(lambda x: -x, (0.0, 10.0), 1.0, 0.0, step=0.01, t_eval=[5.0], events=stop, method="rk4", **QUIET)
    times = np.append(np.linspace(0.0, 1.5, 4), sol.t[-1])
    np.testing.assert_allclose(sol(times).x, np.cos(times), atol=1e-8)


@pytest.mark.parametrize("bound", [None, 3.0])
def test_the_force_evaluations_of_a_run_that_an_event_ends_depend_on_no_chunk(bound, monkeypatch):
    """Chunks of steps are as long as the clock lets them be: here of 10 steps and of all, with 12 zeros after the end."""
    stop, other = (
        with_attributes(lambda x: x, terminal=3, rate_bound=bound),
        with_attributes(lambda v: v, rate_bound=bound),
    )
    counts = []
    for size in (10, 10_000):
        monkeypatch.setattr(run, "next_chunk", lambda *_, size=size: size)
        sol = kd.solve(lambda x: -x, (0.0, 45.0), 1.0, 0.0, step=0.05, method="rk4", events=[stop, other], **QUIET)
        assert [zeros.size for zeros in sol.t_events] == [3, 2]
        counts.append(sol.n_force_evaluations)
    assert counts[0] == counts[1]


@pytest.mark.parametrize("bounces", [False, True])
def test_nor_where_it_ends_between_steps_or_impacts(bounces, monkeypatch):
    """In the next step another event has a zero; a ball bounces there more than once in a step."""
    stop, other = with_attributes(lambda t: t - 0.75, terminal=True), with_attributes(lambda t: t - 0.8)
    events = [stop, with_attributes(lambda x: x, rate_bound=0.5) if bounces else other]
    options = {"impacts": kd.Impacts(lambda x: x, restitution=0.9)} if bounces else {}
    step, height = (0.05, 0.01) if bounces else (0.25, 1.0)
    counts = []
    for size in (1, 3, 10_000):
        monkeypatch.setattr(run, "next_chunk", lambda *_, size=size: size)
        sol = kd.solve(
            lambda x: -9.81,
            (0.0, 2.0),
            height,
            0.0,
            step=step,
            method="velocity-verlet",
            events=events,
            **options,
            **QUIET,
        )
        assert sol.t[-1] == pytest.approx(0.75, abs=1e-12)
        counts.append(sol.n_force_evaluations)
    assert len(set(counts)) == 1


def test_nor_do_the_rows_where_a_run_ends_just_after_the_end_of_a_step(monkeypatch):
    """Step 15 ends at 0.7499999999999999."""
    ends = []
    for size in (1, 3, 10_000):
        monkeypatch.setattr(run, "next_chunk", lambda *_, size=size: size)
        stop = with_attributes(lambda t: t - 0.75, terminal=True)
        sol = kd.solve(lambda x: -x, (0.0, 0.85), 1.0, 0.0, step=0.05, method="velocity-verlet", events=stop, **QUIET)
        on = sol.continue_to(1.5)
        assert on.t_events[0] == pytest.approx([0.75])
        ends.append((sol.n_steps, sol.t.tolist(), sol.n_force_evaluations, on.n_force_evaluations))
    assert ends[0] == ends[1] == ends[2]


def test_the_first_of_two_ends_in_a_step_counts():
    early = with_attributes(lambda t: t - 0.52, terminal=True)
    late = with_attributes(lambda t: t - 0.58, terminal=True)
    sol = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.1, events=[late, early], **QUIET)
    assert sol.t[-1] == pytest.approx(0.52, abs=1e-14)
    assert [own.size for own in sol.t_events] == [0, 1]


def test_zeros_within_a_step_are_found_with_a_bound_of_the_rate_and_missed_without():
    def dip(t, x):
        return (t - 0.52) * (t - 0.58)

    options = {"step": 0.1, **QUIET}
    assert kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, events=dip, **options).t_events[0].size == 0
    dip.rate_bound = 1.1
    sol = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, events=dip, **options)
    np.testing.assert_allclose(sol.t_events[0], [0.52, 0.58], atol=1e-13)
    down = with_attributes(lambda t, x: dip(t, x), rate_bound=1.1, direction=-1)
    sol = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, events=down, **options)
    np.testing.assert_allclose(sol.t_events[0], [0.52], atol=1e-13)


@pytest.mark.parametrize("ensemble", [False, True])
@pytest.mark.parametrize("direction", [0, 1, -1])
def test_all_zeros_within_a_step_are_found_with_a_bound_of_the_rate(direction, ensemble):
    """Three in a step, where the sign has changed at its end; and two in one that begins with a zero."""

    def wave(t, x):
        return np.sin(30.0 * t + 0.0 * x[0])

    def cubic(t, x):
        return (t - 0.25) * (t - 0.3) * (t - 0.35) + 0.0 * x[0]

    def from_zero_to_zero(t, x):
        return (t - 0.25) * (t - 0.3) * (t - 0.5) + 0.0 * x[0]

    options = {"step": 0.25, "method": "velocity-verlet", "progress": False}
    functions = wave, cubic, from_zero_to_zero
    options["events"] = [with_attributes(f, direction=direction, rate_bound=30.1) for f in functions]
    if ensemble:
        sol = kd.solve_ensemble(lambda x: -x, (0.0, 2.0), np.ones((9, 1)), np.zeros((9, 1)), **options)[8]
    else:
        sol = kd.solve(lambda x: -x, (0.0, 2.0), [1.0], [0.0], **options)
    counts = np.arange(1, 20)
    waves, cubics = np.pi / 30.0 * counts, np.array([0.25, 0.3, 0.35])
    if direction:
        waves, cubics = waves[(-1.0) ** counts == direction], cubics[np.array([1, -1, 1]) == direction]
    np.testing.assert_allclose(sol.t_events[0], waves, atol=1e-13)
    np.testing.assert_allclose(sol.t_events[1], cubics, atol=1e-13)
    others = np.array([0.25, 0.3, 0.5])
    np.testing.assert_allclose(
        sol.t_events[2], others[np.array([1, -1, 1]) == direction] if direction else others, atol=1e-13
    )


@pytest.mark.parametrize("ensemble", [False, True])
def test_zeros_as_close_as_a_hundred_thousandth_of_a_step_are_found_with_a_bound_of_the_rate(ensemble):
    def turn(x):
        return (x[0] - 0.5) * (x[0] - 0.50001)

    turn.rate_bound = 2.0
    options = {"step": 0.5, "method": "kahan-li-8", "events": turn, "progress": False}
    if ensemble:
        sol = kd.solve_ensemble(lambda x: -x, (0.0, 100.0), np.ones((9, 1)), np.zeros((9, 1)), **options)[8]
    else:
        sol = kd.solve(lambda x: -x, (0.0, 100.0), [1.0], [0.0], **options)
    times = np.arccos([0.50001, 0.5])
    every = np.add.outer(2 * np.pi * np.arange(17), [*times, *(-times)]).ravel()
    np.testing.assert_allclose(sol.t_events[0], np.sort(every[(every > 0) & (every < 100)]), atol=2e-6)


@pytest.mark.parametrize("ensemble", [False, True])
def test_a_bound_of_the_rate_that_is_refuted_ends_the_run(ensemble):
    """Zeros between steps would be missed: of 63, 5 were found."""
    blink = with_attributes(lambda t, x: np.cos(40 * t) - 0.999 + 0 * x[0], rate_bound=1.0)
    options = {"step": 0.05, "method": "velocity-verlet", "events": blink}
    if ensemble:
        starts = np.ones((3, 1)), np.zeros((3, 1))
        sol = kd.solve_ensemble(lambda x: -x, (0.0, 5.0), *starts, **options)[2]
    else:
        sol = kd.solve(lambda x: -x, (0.0, 5.0), [1.0], [0.0], **options)
    assert (sol.status, sol.n_steps) == (Outcome.FAILED, 0)
    assert (
        "changes by 1.42 in the step of 0.05 to t=0.05, faster than its rate_bound=1.0; give a larger one"
        in sol.message
    )
    blink.rate_bound = 40.0
    assert kd.solve(lambda x: -x, (0.0, 5.0), [1.0], [0.0], **options).success


def test_rows_do_not_depend_on_events_beyond_rounding_and_on_nothing_saved():
    def crossing(x):
        return x[0]

    options = {"step": 0.05, "method": "stormer-verlet", "progress": False}
    kepler = kd.systems.kepler(eccentricity=0.3)
    plain, watched = (kd.solve(kepler, (0.0, 20.0), events=events, **options) for events in (None, crossing))
    np.testing.assert_allclose(watched.x, plain.x, atol=1e-12)
    few = kd.solve(kepler, (0.0, 20.0), events=crossing, save_every=50, **options)
    assert (few.x == watched.x[::50]).all()
    assert (few.t_events[0] == watched.t_events[0]).all()
    assert watched.t_events[0].size == 7


def test_processed_and_split_methods_are_asked_where_people_see_them():
    planets = kd.systems.get("outer-solar-system")

    def right(x):
        return x[1, 0] - x[0, 0]

    options = {"step": 50.0, "events": right, "progress": False}
    found = [
        kd.solve(planets, (0.0, 20_000.0), method=method, **options).t_events[0] for method in ("saba-2", "dop853")
    ]
    assert found[0].size == found[1].size > 5
    np.testing.assert_allclose(*found, atol=0.5)


def test_a_function_that_gives_no_number_ends_the_run_with_what_was_done():
    def odd(t, x):
        return np.nan if t > 0.55 else 1.0

    sol = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.1, events=odd, **QUIET)
    assert sol.status is Outcome.FAILED
    assert "odd, returned NaN at t=0.6" in sol.message
    assert sol.t[-1] == pytest.approx(0.5)


@pytest.mark.parametrize("compile_", [True, False])
def test_a_function_that_raises_ends_the_run_at_the_last_step_before(compile_):
    def late(t, x):
        if t > 1.0:
            raise ValueError("too late")
        return 1.0

    sol = kd.solve(lambda x: -x, (0.0, 3.0), 1.0, 0.0, step=0.01, events=late, compile=compile_, progress=False)
    assert sol.status is Outcome.FAILED
    assert "late, raised ValueError at t=1.01: too late." in sol.message
    assert sol.t[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("fault", ["raise", "return"])
def test_the_cause_of_a_nan_is_known_without_another_call(fault):
    calls = []

    def late(t, x):
        calls.append(t)
        if t > 1.0 and fault == "raise":
            raise ValueError(f"call {calls.count(t)}")
        return np.nan if t > 1.0 else 1.0

    sol = kd.solve(lambda x: -x, (0.0, 1.5), 1.0, 0.0, step=0.25, events=late, compile=False, progress=False)
    assert f"late, {fault}" in sol.message
    assert calls.count(1.25) == 1


def test_what_goes_wrong_before_an_event_and_after_one():
    def bad_at_one(t, x):
        return -x if t < 1.0 else np.inf

    early = with_attributes(lambda t: t - 0.77, terminal=True)
    late = with_attributes(lambda t: t - 1.77, terminal=True)
    options = {"step": 0.01, **QUIET}
    assert kd.solve(bad_at_one, (0.0, 3.0), 1.0, 0.0, events=early, **options).t[-1] == pytest.approx(0.77)
    lost = kd.solve(bad_at_one, (0.0, 3.0), 1.0, 0.0, events=[late, lambda t: t - 0.5], **options)
    assert lost.status is Outcome.NOT_FINITE
    assert [own.size for own in lost.t_events] == [0, 1]


def test_a_zero_at_the_start_is_none_and_one_on_the_grid_is_one():
    sol = thrown(ground)
    assert sol.t_events[0].size == 1
    on_grid = kd.solve(lambda x: 0 * x, (0.0, 1.0), -0.5, 1.0, step=0.125, events=lambda x: x, **QUIET)
    assert on_grid.t_events[0] == pytest.approx([0.5], abs=1e-15)


def test_events_are_kept_in_files(tmp_path):
    sol = thrown(ground, lambda v: v[1])
    again = kd.load(sol.save(tmp_path / "ball.npz"))
    for name in ("t_events", "x_events", "v_events"):
        for mine, read in zip(getattr(sol, name), getattr(again, name), strict=True):
            np.testing.assert_array_equal(mine, read)
    assert "events" in sol.report()
    assert "1, 1 zeros" in sol.report()


@pytest.mark.parametrize(
    ("event", "text"),
    [
        (lambda x, y: x[0], "arguments that kickdrift does not know"),
        (lambda x: x, "must return one number"),
        (lambda x: x[0] > 0.0, "which is not a real number"),
        ("ground", "not a function"),
        ([3.0], "not a function"),
        (lambda x: x[7], "out of bounds"),
        (with_attributes(lambda x: x[0], terminal=-1), "terminal=-1"),
        (with_attributes(lambda x: x[0], terminal="yes"), "terminal='yes'"),
        (with_attributes(lambda x: x[0], direction="up"), "direction='up'"),
        (with_attributes(lambda x: x[0], direction=np.nan), "direction=nan"),
        (with_attributes(lambda x: x[0], direction=1j), "direction=1j; give a number, whose sign"),
        (with_attributes(lambda x: x[0], direction=None), "direction=None"),
        (with_attributes(lambda x: x[0], direction=True), "direction=True"),
        (with_attributes(lambda x: x[0], rate_bound=True), "rate_bound=True"),
        (with_attributes(lambda x: x[0], rate_bound=0.0), "rate_bound=0.0"),
        (with_attributes(lambda x: x[0], rate_bound=np.inf), "rate_bound=inf"),
    ],
)
def test_events_that_cannot_be(event, text):
    with pytest.raises(ArgumentError, match=text):
        kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1, events=event, **QUIET)


def test_noise_has_no_events():
    with pytest.raises(ArgumentError, match="the path is stochastic"):
        kd.solve(
            kd.Langevin(lambda x: -x, 1.0, 0.3),
            (0.0, 1.0),
            1.0,
            0.0,
            step=0.1,
            method="baoab",
            events=lambda x: x,
            **QUIET,
        )


def test_a_force_that_fails_between_steps_costs_the_zeros_and_not_the_run():
    def on_the_grid_only(t, x):
        if not np.isclose(t * 10, round(t * 10), atol=1e-9):
            raise ValueError("off")
        return -x

    options = {"step": 0.1, "method": "velocity-verlet", **QUIET}
    sol = kd.solve(on_the_grid_only, (0.0, 2.0), 1.0, 0.0, events=lambda x: x, **options)
    assert sol.success
    assert "ValueError was raised: off" in sol.message
    assert sol.t_events[0].size == 0
    ending = with_attributes(lambda x: x, terminal=True)
    stopped = kd.solve(on_the_grid_only, (0.0, 2.0), 1.0, 0.0, events=ending, **options)
    assert stopped.status is Outcome.FAILED
    assert 1.0 < stopped.t[-1] < 1.6


def test_force_evaluations_in_search_of_zeros_are_counted():
    calls = []

    def pull(x):
        calls.append(1)
        return -x

    options = {"step": 0.1, "method": "velocity-verlet", **QUIET}
    sol = kd.solve(pull, (0.0, 4.0), 1.0, 0.0, events=lambda x: x, **options)
    assert 1 + 40 < sol.n_force_evaluations <= len(calls) <= sol.n_force_evaluations + 2


@pytest.mark.parametrize("start", [1.0, [1.0, 2.0]])
def test_first_order_problems_have_events(start):
    decay = kd.FirstOrder(lambda y: -y)
    sol = kd.solve(
        decay, (0.0, 3.0), start, step=0.01, method="gauss-4", events=lambda y: np.ravel(y)[0] - 0.5, **QUIET
    )
    assert sol.t_events[0] == pytest.approx([np.log(2.0)], abs=1e-9)
    assert sol.x_events[0].shape == (1, *np.shape(start))
    assert sol.v_events[0].shape == (1, 0)


def test_a_function_that_fails_between_steps_is_said_to():
    def off_the_grid(t, x):
        if not np.isclose(t * 10, round(t * 10), atol=1e-9):
            raise ValueError("off")
        return t - 1.234

    options = {"step": 0.1, **QUIET}
    sol = kd.solve(lambda x: -x, (0.0, 2.0), 1.0, 0.0, events=off_the_grid, **options)
    assert sol.success
    assert "off_the_grid, raised ValueError at t=1.2" in sol.message
    assert sol.t_events[0].size == 0
    off_the_grid.terminal = True
    sol = kd.solve(lambda x: -x, (0.0, 2.0), 1.0, 0.0, events=off_the_grid, **options)
    assert sol.status is Outcome.FAILED
    assert "off_the_grid, raised ValueError at t=1.2" in sol.message


def test_a_function_that_stays_near_zero_is_not_asked_for_ever():
    asked = []

    def near(x):
        asked.append(1)
        return x

    near.rate_bound = 1.0
    sol = kd.solve(lambda x: 0 * x, (0.0, 0.3), 1e-9, 0.0, step=0.1, events=near, **QUIET)
    assert sol.success
    assert len(asked) < 3 * 600


def test_ctrl_c_in_search_of_zeros_keeps_the_run():
    asked = []

    def impatient(t, x):
        asked.append(1)
        if len(asked) > 45 and not np.isclose(t * 10, round(t * 10), atol=1e-9):
            raise KeyboardInterrupt
        return x

    sol = kd.solve(lambda x: -x, (0.0, 4.0), 1.0, 0.0, step=0.1, events=impatient, **QUIET)
    assert sol.t[-1] == 4.0
    assert "KeyboardInterrupt was raised" in sol.message


def test_long_runs_have_their_events_compiled_into_the_loop_with_the_same_bits(monkeypatch):
    def level(x, v):
        return np.sin(x) * 1.5 - v

    def run():
        pendulum = kd.systems.pendulum()
        return kd.solve(
            pendulum, (0, 200.0), 1.0, 0.0, step=0.01, method="velocity-verlet", events=level, progress=False
        )

    monkeypatch.setattr(quantities, "_MANY", 1 << 62)
    called = run()
    inside, asked = quantities._evaluate_inside, []
    monkeypatch.setattr(quantities, "_MANY", 64)
    monkeypatch.setattr(quantities, "_evaluate_inside", lambda quantity: asked.append(quantity) or inside(quantity))
    compiled = run()
    assert asked
    assert np.array_equal(compiled.t_events[0], called.t_events[0])
    assert np.array_equal(compiled.x_events[0], called.x_events[0])


def test_an_event_that_chatters_is_said_to():
    options = {"step": 0.01, "method": "velocity-verlet", "compile": False}
    run = kd.solve(lambda x: -x, (0.0, 10.0), 1.0, 0.0, events=lambda x: np.sin(1e6 * x), **options)
    assert re.search(r"changed its sign in \d+ of 1000 steps: it may have chattered", run.message)
    assert "chattered" not in kd.solve(lambda x: -x, (0.0, 100.0), 1.0, 0.0, events=lambda x: x, **options).message


@pytest.mark.parametrize(("restitution", "speed"), [(0.5, 1.0), (0.5, 0.0), (0.0, 1.0)])
def test_a_ball_at_rest_has_no_more_zeros(restitution, speed):
    """There its height is zero but for rounding, whose changes of sign are none of its own."""

    def height(x):
        return x[1]

    def found(events):
        impacts = kd.Impacts(lambda x: x[1], restitution=restitution)
        options = {"step": 0.01, "method": "velocity-verlet", "impacts": impacts, "events": events}
        return kd.solve(lambda x: np.array([0.0, -9.81]), (0.0, 5.0), [0.0, 1.0], [speed, 0.0], **options).t_events[0]

    bounces = found(height)
    np.testing.assert_allclose(found(with_attributes(height, rate_bound=50.0)), bounces, atol=1e-9)
    assert len(bounces) == (17 if restitution else 1)


def test_flat_zeros_and_small_oscillations_are_found_with_a_bound_of_the_rate():
    cube, fifth = (with_attributes(lambda x, n=n: x[0] ** n, rate_bound=1.1 * n) for n in (3, 5))
    moving = kd.solve(lambda x: 0 * x, (0.0, 2.0), [-1.0], [1.0], step=0.1, events=[cube, fifth])
    for zeros in moving.t_events:
        np.testing.assert_allclose(zeros, [1.0], atol=1e-6)

    def place(x):
        return x[0]

    def fading(events):
        return kd.solve(lambda x, v: -x - 0.5 * v, (0.0, 200.0), [0.9], [0.0], step=0.1, events=events).t_events[0]

    assert len(fading(with_attributes(place, rate_bound=1.0))) == len(fading(place)) == 62

"""Events of runs with impacts: what jumps there, gaps that close, and what rests and passes through nothing."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.outcomes import Outcome

G = 9.81


def speed(v):
    return v


def height(x):
    return x


def bounced(event, direction=0, *, step=0.05, restitution=0.8, end=3.0, terminal=False, located=True, **options):
    event.direction, event.terminal = direction, terminal
    floor = kd.Impacts(lambda x: x, restitution=restitution, located=located)
    options = {"method": "velocity-verlet", "impacts": floor, "events": event, "step": step, **options}
    return kd.solve(lambda x: -G, (0, end), 1.0, 0.0, **options)


FALL = np.sqrt(2 / G)
STRIKES = FALL * (1 + 2 * np.cumsum(np.append(0.0, 0.8 ** np.arange(1, 6))))
TOPS = FALL * 0.8 ** np.arange(1, 7) + STRIKES


@pytest.mark.parametrize("step", [0.05, 0.3, FALL / 5])  # at the last one the first impact is on the grid
@pytest.mark.parametrize(
    ("event", "direction", "expected"),
    [
        (speed, 0, np.sort(np.append(STRIKES, TOPS))),
        (speed, 1, STRIKES),
        (speed, -1, TOPS),
        (height, 0, STRIKES),
        (height, -1, STRIKES),
        (height, 1, []),
    ],
)
def test_jumps_of_the_velocity_and_closed_gaps_are_events_once(step, event, direction, expected):
    sol = bounced(event, direction, step=step)
    assert sol.t_events[0] == pytest.approx(expected, abs=1e-12)
    upwards = np.isin(np.round(sol.t_events[0], 9), np.round(STRIKES, 9))
    assert (sol.v_events[0][upwards] > 1.0).all()  # the states are those after the impacts
    assert np.abs(sol.x_events[0][upwards]).max(initial=0.0) < 1e-15


def test_what_ends_a_run_in_an_impact_is_said():
    sol = bounced(speed, 1, terminal=True)
    assert sol.status is Outcome.STOPPED
    assert "speed, changes its sign in an impact" in sol.message
    assert sol.t[-1] == pytest.approx(STRIKES[0], abs=1e-12)
    assert sol.v[-1] == pytest.approx(0.8 * G * FALL, abs=1e-10)
    sol = bounced(height, -1, terminal=2)
    assert "height, is zero" in sol.message
    assert sol.t[-1] == pytest.approx(STRIKES[1], abs=1e-12)
    assert sol.continue_to(3.0).t_events[0] == pytest.approx(STRIKES[:4], abs=1e-12)  # it ends at two more


def test_flights_with_steps_that_vary_end_with_terminal_events_and_go_on_with_the_velocity_after_the_impact():
    """An orbit of eccentricity 0.9 that rebounds from a sphere: each flight takes as long as by Kepler's equation."""

    def gravity(x):
        return -x / np.hypot(x[0], x[1]) ** 3

    def surface(x):
        return np.hypot(x[0], x[1]) - 0.5

    surface.terminal, surface.direction = True, -1
    options = {"rtol": 1e-12, "atol": 1e-12, "method": "dop853", "events": surface}
    orbit = kd.solve(gravity, (0, 20.0), [1.9, 0], [0, np.sqrt(2 / 1.9 - 1)], **options)
    times = []
    while orbit.status is Outcome.STOPPED:
        t, x, v = orbit.t[-1], orbit.x[-1], orbit.v[-1]
        times.append(t)
        orbit = kd.solve(gravity, (t, 20.0), x, v - 2 * (v @ x) / (x @ x) * x, **options)
    anomaly = np.arccos(0.5 / 0.9)
    half = np.pi - anomaly + 0.9 * np.sin(anomaly)
    assert times == pytest.approx(half * np.array([1, 3, 5]), abs=2e-10)


def test_impacts_that_are_not_located_are_events_too():
    closed = bounced(height, -1, step=0.01, located=False)
    assert closed.t_events[0][:2] == pytest.approx(STRIKES[:2], abs=0.05)
    jumps = bounced(speed, 1, step=0.01, located=False)
    assert jumps.t_events[0].size == closed.t_events[0].size
    assert np.isin(jumps.t_events[0], jumps.t).all()


def test_a_ball_that_rests_passes_through_nothing():
    for event in (height, speed):
        sol = bounced(event, restitution=0.5, end=20.0)
        rests = FALL * (1 + 2 * 0.5 / (1 - 0.5))
        assert sol.t_events[0].max() < rests + 0.1
        assert sol.t_events[0].size > 10


def test_a_block_on_a_slope_passes_through_nothing_across_it():
    across = np.array([np.sin(0.5), np.cos(0.5)])

    def gap(x):
        return across[0] * x[0] + across[1] * x[1]

    def rise(v):
        return across[0] * v[0] + across[1] * v[1]

    slope = kd.Impacts(gap, restitution=0.0, friction=0.2)
    start = 3.0 * np.array([np.cos(0.5), -np.sin(0.5)])
    options = {"step": 0.01, "method": "velocity-verlet", "impacts": slope, "events": [gap, rise]}
    sol = kd.solve(lambda x: np.array([0.0, -G]), (0, 5.0), start, [0, 0], **options)
    assert [own.size for own in sol.t_events] == [0, 0]


def test_rows_do_not_depend_on_chunks_of_events(tmp_path):
    whole = bounced(speed)
    for every in (1, 7):
        kept = bounced(speed, checkpoint=tmp_path / f"{every}", checkpoint_every=every)
        assert kept.t_events[0].tobytes() == whole.t_events[0].tobytes()
        assert kept.v_events[0].tobytes() == whole.v_events[0].tobytes()


@pytest.mark.parametrize("compile_", [True, False])
def test_an_event_that_raises_at_an_impact_ends_the_run(compile_):
    def low(x, v):
        if x[1] < 1e-9 and v[1] < 0.0:
            raise ValueError("too low")
        return x[1] - 0.5

    sol = kd.solve(
        lambda x: np.array([0.0, -9.81]), (0.0, 1.0), [0.0, 1.0], [0.0, 0.0], step=0.01,
        impacts=lambda x: x[1], events=low, compile=compile_, progress=False,
    )  # fmt: skip
    assert sol.status is kd.Outcome.FAILED
    assert "low, raised ValueError at t=0.446" in sol.message

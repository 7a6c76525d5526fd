"""Solutions that go on: with the bits of one run over the whole span."""

import copy
import functools
import math
import pickle

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.engine import run as run_module


def pulled(t, x):
    return -x + 0.1 * math.cos(t)


def crossing(x):
    return x


def same(one, other):
    assert np.array_equal(one.t, other.t)
    assert np.array_equal(one.x, other.x)
    assert np.array_equal(one.v, other.v)
    assert (one.step, one.n_steps, one.n_force_evaluations) == (other.step, other.n_steps, other.n_force_evaluations)
    assert (one.status, one.message) == (other.status, other.message)


@pytest.mark.parametrize("save_every", [None, 7])
@pytest.mark.parametrize(
    ("system", "method", "step"),
    [
        (kd.systems.kepler(0.6), "semi-implicit-euler", 1 / 32),
        (kd.systems.kepler(0.6), "velocity-verlet", 1 / 32),
        (kd.systems.kepler(0.6), "implicit-midpoint", 1 / 32),
        (kd.systems.outer_solar_system(), "wisdom-holman-corrected-3", 4.0),
    ],
    ids=["euler", "verlet", "implicit", "corrected"],
)
def test_a_solution_goes_on_with_the_bits_of_one_run(system, method, step, save_every):
    options = {"step": step, "method": method, "save_every": save_every}
    whole = kd.solve(system, (0.0, 400 * step), **options)
    part = kd.solve(system, (0.0, 200 * step), **options)
    same(part.continue_to(400 * step), whole)
    same(part.continue_to(300 * step).continue_to(400 * step), whole)
    restarted = kd.solve(system, (200 * step, 400 * step), part.x[-1], part.v[-1], **options)
    assert not np.array_equal(restarted.x[-1], whole.x[-1])  # compensation and coordinates are part of the state


@pytest.mark.parametrize("start", [0.0, 1.25, -0.7])
@pytest.mark.parametrize("step", [0.1, 0.02, 1 / 3, 0.013])
@pytest.mark.parametrize("ends", [(3, 9), (7, 14), (2, 59)])
def test_steps_that_divide_both_spans_have_the_same_bits(start, step, ends, tmp_path):
    """A step of the span over its number of steps may differ by a rounding for each end."""
    orbit, (near, far) = kd.systems.kepler(eccentricity=0.3), (start + count * step for count in ends)
    options = {"step": step, "method": "leapfrog"}
    whole = kd.solve(orbit, (start, far), **options)
    assert whole.step == step
    same(kd.solve(orbit, (start, near), **options).continue_to(far), whole)
    kept = {"checkpoint": tmp_path / "run", "checkpoint_every": 1, **options}
    kd.solve(orbit, (start, near), **kept)
    assert np.array_equal(kd.solve(orbit, (start, far), **kept).x, whole.x)


def test_a_step_of_a_few_roundings_of_the_time_does_not_end_a_step_short():
    start, step = 1e9, 5e-7  # four roundings
    short = kd.solve(pulled, (start, start + 10 * step), 1.0, 0.0, step=step)
    assert start + short.n_steps * short.step == pytest.approx(short.t[-1], abs=1.2e-7, rel=0)


def test_noise_goes_on():
    well = kd.Langevin(lambda x: 4 * x * (1 - x * x), friction=1.0, temperature=0.4, seed=7)
    options = {"x0": np.ones(5), "v0": np.zeros(5), "step": 0.25}
    whole = kd.solve(well, (0.0, 50.0), **options)
    same(kd.solve(well, (0.0, 20.0), **options).continue_to(50.0), whole)


@pytest.mark.parametrize("compiled", [True, False])
def test_a_forced_run_goes_on_backwards(compiled):
    options = {"x0": 1.0, "v0": 0.0, "step": 0.25, "method": "velocity-verlet", "compile": compiled}
    whole = kd.solve(pulled, (10.0, -10.0), **options)
    same(kd.solve(pulled, (10.0, 2.0), **options).continue_to(-10.0), whole)


def test_what_depends_on_matrices_goes_on():
    options = {"x0": [2.0, 0.0], "step": 1 / 16, "method": "radau-5"}
    problem = kd.FirstOrder(lambda y: np.array([y[1], 50 * (1 - y[0] ** 2) * y[1] - y[0]]))
    whole = kd.solve(problem, (0.0, 20.0), **options)
    on = kd.solve(problem, (0.0, 10.0), **options).continue_to(20.0)
    same(on, whole)
    assert np.array_equal(on.error_estimate, whole.error_estimate)


def test_an_interrupted_run_goes_on(monkeypatch):
    monkeypatch.setattr("kickdrift.core.interruption._CHUNK_SECONDS", 1e-5)
    attempt, calls = run_module.Run._attempt, []

    def interrupted(self, target):
        calls.append(target)
        result = attempt(self, target)
        if len(calls) == 5:
            raise KeyboardInterrupt
        return result

    options = {"step": 1 / 128, "save_every": 10}
    with monkeypatch.context() as patch:
        patch.setattr(run_module.Run, "_attempt", interrupted)
        part = kd.solve(kd.systems.kepler(), (0.0, 100.0), **options)
    assert part.status is kd.Outcome.INTERRUPTED
    assert part.t[-1] < 100.0
    same(part.continue_to(100.0), kd.solve(kd.systems.kepler(), (0.0, 100.0), **options))


def test_events_go_on_and_terminal_ones_count_anew():
    def third(x):
        return x

    third.terminal = 3
    options = {"x0": 1.0, "v0": 0.0, "step": 1 / 16, "method": "stormer-verlet"}
    whole = kd.solve(pulled, (0.0, 40.0), events=crossing, **options)
    part = kd.solve(pulled, (0.0, 15.0), events=crossing, **options).continue_to(40.0)
    assert np.array_equal(part.x, whole.x)
    assert np.array_equal(part.t_events[0], whole.t_events[0])
    stopped = kd.solve(pulled, (0.0, 40.0), events=third, **options)
    assert stopped.status is kd.Outcome.STOPPED
    assert stopped.t_events[0].size == 3
    again = stopped.continue_to(40.0)
    assert again.status is kd.Outcome.STOPPED
    assert np.allclose(again.t_events[0], whole.t_events[0][:6], rtol=0, atol=1e-12)
    rest = again.continue_to(40.0).continue_to(40.0).continue_to(40.0)
    assert rest.status is kd.Outcome.COMPLETED
    assert np.array_equal(rest.x, whole.x)
    assert rest.t_events[0].size == whole.t_events[0].size


@pytest.mark.parametrize("t_eval", [[0.0, 5.0, 10.0], [1.03, 7.77, 2.5], [3.0]])
def test_times_that_were_wanted_stay_and_the_new_end_is_one(t_eval):
    options = {"x0": 1.0, "v0": 0.0, "step": 1 / 16}
    whole = kd.solve(pulled, (0.0, 20.0), t_eval=[*t_eval, 20.0], **options)
    on = kd.solve(pulled, (0.0, 10.0), t_eval=t_eval, **options).continue_to(20.0)
    same(on, whole)


def test_between_the_rows_of_what_went_on_there_are_states():
    options = {"x0": 1.0, "v0": 0.0, "step": 1 / 16, "save_every": 16}
    whole = kd.solve(pulled, (0.0, 20.0), **options)
    on = kd.solve(pulled, (0.0, 10.0), **options).continue_to(20.0)
    times = np.linspace(0.0, 20.0, 77)
    assert np.array_equal(on(times).x, whole(times).x)


def test_a_solution_that_went_on_stays_as_it_was():
    part = kd.solve(pulled, (0.0, 10.0), 1.0, 0.0, step=1 / 16)
    before = part.x.copy()
    first, second = part.continue_to(20.0), copy.deepcopy(part).continue_to(20.0)
    assert np.array_equal(part.x, before)
    same(first, second)


@pytest.mark.parametrize(
    ("t", "words"),
    [
        (10.0, "does not lie beyond"),
        (5.0, "does not lie beyond"),
        (-1.0, "does not lie beyond"),
        (10.04, r"nearest times are 10.0 and 10.0625"),
        (10.02, r"nearest times are 10.0 and 10.0625"),
        (math.nan, "must be finite"),
        (math.inf, "must be finite"),
        ("late", "must be a time"),
        (None, "must be a time"),
        (1e300, "must be finite"),
        (1e12, "GiB"),
    ],
)
def test_ends_that_cannot_be_are_refused(t, words):
    part = kd.solve(pulled, (0.0, 10.0), 1.0, 0.0, step=1 / 16)
    with pytest.raises(kd.ArgumentError, match=words):
        part.continue_to(t)


def test_what_was_loaded_does_not_go_on(tmp_path):
    part = kd.solve(pulled, (0.0, 10.0), 1.0, 0.0, step=1 / 16)
    for other in (kd.load(part.save(tmp_path / "part")), pickle.loads(pickle.dumps(part))):
        with pytest.raises(kd.KickdriftError, match="checkpoint="):
            other.continue_to(20.0)


def test_solutions_in_units_go_on():
    u = pytest.importorskip("pint").UnitRegistry()
    options = {"x0": [1.0, 0.0] * u.m, "v0": [0.0, 1.0] * u.m / u.s, "step": 0.03125 * u.s}
    whole = kd.solve(lambda x: -x, (0 * u.s, 20 * u.s), **options)
    on = kd.solve(lambda x: -x, (0 * u.s, 10 * u.s), **options).continue_to(20_000 * u.ms)
    assert np.array_equal(on.x.magnitude, whole.x.magnitude)
    assert on.x.units == u.m
    with pytest.raises(kd.ArgumentError, match="t=30 has no unit"):
        on.continue_to(30)


def test_varied_steps_that_an_event_ended_go_on_to_their_end():
    def there(x):
        return x[1]

    there.terminal = 4
    options = {"step": 0.02, "step_control": "distance", "method": "stormer-verlet"}
    whole = kd.solve(kd.systems.kepler(0.8), (0.0, 30.0), **options)
    stopped = kd.solve(kd.systems.kepler(0.8), (0.0, 30.0), events=there, **options)
    assert stopped.status is kd.Outcome.STOPPED
    on = stopped.continue_to(30.0)
    while on.status is kd.Outcome.STOPPED:
        on = on.continue_to(30.0)
    assert np.array_equal(on.x, whole.x)
    assert np.array_equal(on.t, whole.t)
    for t in (30.0, -1.0, math.nan, math.inf):
        with pytest.raises(kd.ArgumentError, match=r"beyond the end of the solution, 30\.0"):
            on.continue_to(t)
    with pytest.raises(kd.ArgumentError, match="must be a time"):
        on.continue_to("late")
    with pytest.raises(kd.ArgumentError, match="use return_to"):
        on.return_to(10.0).continue_to(5.0)


def test_an_event_in_the_last_step_does_not_end_the_longer_run_again():
    """With another end, the last step is another one, and the zero in it moves by the error of the step."""

    def crosses(x):
        return x

    crosses.terminal = True
    options = {"rtol": 1e-5, "method": "dop853", "events": crosses}
    for after in np.geomspace(1e-4, 0.3, 60):  # the zero is at 1.8252
        stopped = kd.solve(lambda x: -math.sin(x), (0.0, 1.82525 + after), 1.5, 0.0, **options)
        assert stopped.status is kd.Outcome.STOPPED
        assert stopped.continue_to(3.0).status is kd.Outcome.COMPLETED, after


def forced(t, x):
    return -x - x**3 + math.cos(2 * t)


def sprung(x, params):
    return -x if params[-1] > 0 else -4 * x


FLOOR = kd.Impacts(lambda x: x, restitution=0.8)
VARIED = {
    "density": (forced, {"step": 0.02, "step_control": lambda x: 1 + x * x}),
    "error": (forced, {"step": 0.02, "rtol": 1e-9, "atol": 1e-9, "method": "dop853"}),
    "impacts": (lambda x: -9.81, {"step": 1 / 64, "method": "velocity-verlet", "impacts": FLOOR}),
    "switch": (sprung, {"step": 1 / 16, "method": "blanes-moan-srkn6b", "switches": lambda x: x}),
}


@pytest.mark.parametrize("kept", [{}, {"save_every": 7}, {"t_eval": [1.5, 0.25, 1.5]}], ids=["all", "every", "times"])
@pytest.mark.parametrize("name", VARIED)
def test_steps_that_vary_go_on_beyond_their_end_with_the_bits_of_one_run(name, kept):
    force, options = VARIED[name]
    solve = functools.partial(kd.solve, force, x0=1.0, v0=0.0, events=crossing, **options)
    part, longer = solve(t_span=(0.0, 2.0), **kept), dict(kept)
    if "t_eval" in longer:
        longer["t_eval"] = [*longer["t_eval"], 5.0]
    whole = solve(t_span=(0.0, 5.0), **longer)
    for on in (part.continue_to(5.0), part.continue_to(3.0).continue_to(5.0)):
        if "t_eval" in kept:
            assert on.t.tolist() == whole.t.tolist()[:3] + [3.0] * (on.t.size - 4) + [5.0]
            assert np.array_equal(on.x[[0, 1, 2, -1]], whole.x)
        else:
            same(on, whole)
            assert kept or np.array_equal(on(np.linspace(0.0, 5.0, 33)).x, whole(np.linspace(0.0, 5.0, 33)).x)
        assert np.array_equal(on.t_events[0], whole.t_events[0])
    assert part.t[-1] in (2.0, 1.5)


@pytest.mark.parametrize("end", [20.0, 25.0])
def test_an_event_that_ended_varied_steps_does_not_end_them_again(end):
    def second(x):
        return x

    second.terminal = 2
    options = {"x0": 1.0, "v0": 0.0, "rtol": 1e-8, "atol": 1e-8, "method": "dop853"}
    all_zeros = kd.solve(forced, (0.0, end), step=0.02, events=crossing, **options).t_events[0]
    on = kd.solve(forced, (0.0, 20.0), step=0.02, events=second, **options)
    for stop in range(2, all_zeros.size + 1, 2):
        assert on.status is kd.Outcome.STOPPED
        assert on.t_events[0] == pytest.approx(all_zeros[:stop], abs=1e-6)
        on = on.continue_to(end)
    assert on.status is kd.Outcome.COMPLETED
    assert on.t[-1] == end
    assert on.t_events[0].size == all_zeros.size


def test_most_steps_count_anew_where_varied_steps_go_on_beyond_their_end():
    options = {"x0": 1.0, "v0": 0.0, "step": 0.02, "step_control": lambda x: 1 + x * x, "max_steps": 50}
    some = kd.solve(forced, (0.0, 2.0), **options).continue_to(3.0)
    assert (some.status, some.n_steps) == (kd.Outcome.STEP_LIMIT, 100)
    assert np.array_equal(some.continue_to(3.0).x[:100], some.x[:100])
    farther = some.continue_to(8.0)
    assert [farther.n_steps, farther.continue_to(8.0).n_steps, farther.continue_to(9.0).n_steps] == [150, 200, 200]

"""How runs end: interrupted, not finite, failed, not converged; what was done is kept."""

import math
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from numba import njit

import kickdrift as kd
from kickdrift.engine import run as run_module
from kickdrift.engine.progress import Bar

OPTIONS = {"x0": 1.0, "v0": 0.0, "step": 0.01}


def forced_until_one(t, x):
    return -x if t < 1.0 else math.inf


def failing_at_one(t, x):
    if t >= 1.0:
        raise ValueError("too late")
    return -x


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize(
    ("function", "outcome", "cause"),
    [
        (forced_until_one, kd.Outcome.NOT_FINITE, "Try a smaller step"),
        (failing_at_one, kd.Outcome.FAILED, "ValueError: too late"),
    ],
)
@pytest.mark.parametrize("method", ["kick-drift", "velocity-verlet"])
@pytest.mark.parametrize("compensated", [True, False])
def test_a_run_ends_at_the_last_good_state(function, outcome, cause, compiled, method, compensated):
    sums = {"compensated": compensated}
    s = kd.solve(function, t_span=(0.0, 3.0), compile=compiled, method=method, **sums, **OPTIONS)
    good = 100 if method == "kick-drift" else 99  # Verlet's second kick sees the end of the step
    assert s.status is outcome
    assert not s.success
    assert s.n_steps == good
    assert s.t[-1] == pytest.approx(good * 0.01)
    assert cause in s.message
    assert f"after {good} of 300 steps" in s.message
    whole = kd.solve(kd.systems.harmonic_oscillator(), (0.0, 3.0), step=0.01, method=method, **sums)
    assert np.array_equal(s.x, whole.x[: good + 1])
    assert np.isfinite(s.v).all()


def test_the_last_good_state_is_kept_between_two_saved_times():
    s = kd.solve(forced_until_one, t_span=(0.0, 3.0), save_every=30, compile=False, **OPTIONS)
    assert np.allclose(s.t, [0.0, 0.3, 0.6, 0.9, 1.0])
    late = kd.solve(forced_until_one, t_span=(0.0, 3.0), t_eval=[2.0], compile=False, **OPTIONS)
    assert np.allclose(late.t, [1.0])


def test_a_first_step_that_fails_leaves_the_start():
    s = kd.solve(lambda t, x: math.inf * x, t_span=(0.0, 1.0), compile=False, **OPTIONS)
    assert s.status is kd.Outcome.NOT_FINITE
    assert s.t.tolist() == [0.0]


def test_an_implicit_step_that_is_not_solved_says_its_residual():
    # x'' = -sqrt(|x|) is not differentiable at 0; a huge factor puts every stage there.
    s = kd.solve(
        lambda x: -1e9 * math.copysign(1.0, x), (0.0, 1.0), 1e-3, 0.0, step=0.5, method="implicit-euler", compile=False
    )
    assert s.status is kd.Outcome.NOT_CONVERGED
    assert "residual was" in s.message
    assert s.x.tolist() == [1e-3]


def test_an_implicit_step_is_solved_to_rounding():
    kepler = kd.systems.kepler(0.6)
    s = kd.solve(kepler, (0.0, 200.0), step=0.01, method="implicit-midpoint")
    # The midpoint rule conserves quadratic invariants, so that the angular momentum shows a solver that stops early.
    assert np.ptp(s.invariants["angular momentum"]) < 1e-13
    euler = kd.solve(kepler, (0.0, 200.0), step=0.01, method="implicit-euler")
    assert np.ptp(euler.invariants["angular momentum"]) > 0.1


def test_interruption_keeps_whole_chunks(monkeypatch):
    monkeypatch.setattr("kickdrift.core.interruption._CHUNK_SECONDS", 1e-5)
    attempt, calls = run_module.Run._attempt, []

    def interrupted(self, target):
        calls.append(target)
        result = attempt(self, target)
        if len(calls) == 5:
            raise KeyboardInterrupt  # after the work of the chunk, before anyone took note of it
        return result

    monkeypatch.setattr(run_module.Run, "_attempt", interrupted)
    s = kd.solve(kd.systems.kepler(), (0.0, 100.0), step=0.01)
    monkeypatch.undo()
    assert s.status is kd.Outcome.INTERRUPTED
    assert s.n_steps == calls[3]
    assert s.t[-1] == pytest.approx(calls[3] * 0.01)
    whole = kd.solve(kd.systems.kepler(), (0.0, 100.0), step=0.01)
    assert np.array_equal(s.x, whole.x[: s.t.size])


def test_chunks_change_no_bit(monkeypatch):
    options = {"t_span": (0.0, 20.0), "step": 0.01, "method": "velocity-verlet"}
    whole = kd.solve(kd.systems.kepler(), **options)
    monkeypatch.setattr("kickdrift.core.interruption._CHUNK_SECONDS", 1e-9)
    assert np.array_equal(whole.x, kd.solve(kd.systems.kepler(), **options).x)


def test_a_real_ctrl_c_returns_what_is_done():
    kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.01)  # compiled before the clock starts
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    s = kd.solve(kd.systems.kepler(), (0.0, 1e7), step=0.001, save_every=10**6)
    timer.join()
    assert s.status is kd.Outcome.INTERRUPTED
    assert 0 < s.n_steps < 10**10
    assert np.isfinite(s.x).all()


def test_progress_shows_on_request_and_not_otherwise(capsys):
    kepler = kd.systems.kepler()
    kd.solve(kepler, (0.0, 1.0), step=0.01, progress=False)  # compiled before, which may be announced
    kd.solve(kepler, (0.0, 30_000.0), step=0.01, save_every=10**9)
    assert capsys.readouterr().err == ""

    kd.solve(kepler, (0.0, 1.0), step=1 / 51, progress=True)
    bar = capsys.readouterr().err
    assert "step" in bar
    assert "/51 " in bar


@pytest.mark.parametrize(("progress", "said"), [(None, True), (True, True), (False, False)])
def test_a_wait_for_the_compiler_is_announced_wherever_one_waits(progress, said, capsys, monkeypatch):
    monkeypatch.setattr("kickdrift.engine.announcing._A_MOMENT", 0.0)
    force = njit("float64(float32)")(lambda x: -x)  # one cannot tell what is in it, so that it is not found on disk
    kd.solve(force, (0.0, 1.0), 1.0, 0.0, step=0.1, progress=progress)
    lines = capsys.readouterr().err.splitlines()
    assert [line for line in lines if line.startswith("kickdrift: compiling")] == (
        ["kickdrift: compiling; this takes a few seconds ..."] if said else []
    )
    assert any("compiled in" in line for line in lines) == said
    kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1, progress=progress)
    kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1, progress=progress)
    capsys.readouterr()
    kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1, progress=progress)
    assert "compil" not in capsys.readouterr().err


def test_on_a_terminal_only_long_runs_show_progress(capsys, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setattr("kickdrift.engine.progress._SHORT_RUN_SECONDS", 0.5)

    def slow(x):
        time.sleep(0.002)
        return -x

    kd.solve(slow, (0.0, 0.01), 1.0, 0.0, step=0.001, compile=False)
    assert capsys.readouterr().err == ""
    kd.solve(slow, (0.0, 0.4), 1.0, 0.0, step=0.001, compile=False)
    assert "step" in capsys.readouterr().err
    kd.solve(slow, (0.0, 0.4), 1.0, 0.0, step=0.001, compile=False, progress=False)
    assert capsys.readouterr().err == ""


def test_a_first_step_that_takes_long_opens_no_bar(monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    bar = Bar(10_000, None)
    bar.show(1, 0.01)  # 100 s, if all steps took as long
    assert bar._bar is None
    bar.show(500, 0.2)
    assert bar._bar is not None
    bar.close()


def test_the_time_that_the_bar_takes_is_no_part_of_the_run(monkeypatch):
    late, clock = [0.0], time.perf_counter
    monkeypatch.setattr("time.perf_counter", lambda: clock() + late[0])
    monkeypatch.setattr(Bar, "show", lambda self, step, seconds: late.append(late.pop() + 1e6))
    assert kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1).wall_time < 1e6


def test_the_first_compilation_is_announced(tmp_path):
    code = (
        "import kickdrift as kd; from kickdrift.engine import announcing; announcing._A_MOMENT = 0.0;"
        "kd.solve(kd.systems.kepler(), (0, 1), step=0.1, progress=True).energy"
    )
    said, kept = [], []
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
            capture_output=True,
            text=True,
            check=True,
        )
        said.append(done.stderr)
        kept.append(sorted(path.name for path in tmp_path.rglob("*.nb?")))
    assert "compiling" in said[0]
    assert "compiled in" in said[0]
    assert "compil" not in said[1]
    assert kept[0] == kept[1]


REST = {"step": 0.1, "compile": False}


@pytest.mark.parametrize("method", ["implicit-euler", "implicit-midpoint"])
@pytest.mark.parametrize(
    ("force", "x0", "end", "rest"),
    [
        (lambda x, v: -100 * (x - 1 / 3) - 20 * v, 1.0, 20.0, 1 / 3),
        (lambda x, v: -100 * x - 9.81 - 20 * v, 0.0, 20.0, -0.0981),
        (lambda x, v: math.sin(x) - 0.5 * v, 1.0, 100.0, math.pi),
    ],
)
def test_implicit_methods_come_to_rest_anywhere(force, x0, end, rest, method):
    s = kd.solve(force, (0.0, end), x0, 0.0, method=method, **REST)
    assert s.success, s.message
    assert s.x[-1] == pytest.approx(rest, abs=1e-6)


@pytest.mark.parametrize("method", ["implicit-euler", "implicit-midpoint"])
@pytest.mark.parametrize(("k", "at"), [(100.0, 1 / 3), (1e8, 1 / 3), (100.0, -0.0981)])
def test_implicit_methods_solve_stiff_linear_steps_away_from_zero(k, at, method):
    s = kd.solve(lambda x: -k * x + k * at, (0.0, 20.0), 0.0, 0.0, method=method, **REST)
    assert s.success, s.message
    assert np.abs(s.x - at).max() <= abs(at) * (1 + 1e-6)


@pytest.mark.parametrize("t_eval", [[0.1], [0.0, 0.1]])
def test_a_run_that_ends_after_its_last_wanted_time_keeps_the_state_reached(t_eval):
    s = kd.solve(forced_until_one, t_span=(0.0, 3.0), t_eval=t_eval, compile=False, **OPTIONS)
    assert np.allclose(s.t, [*t_eval, 1.0])


def test_a_failure_that_does_not_repeat_is_still_a_failure():
    calls = []

    def once(x):
        calls.append(1)
        if len(calls) == 50:
            raise ValueError("once")
        return -x

    s = kd.solve(once, t_span=(0.0, 3.0), compile=False, **OPTIONS)
    assert s.status is kd.Outcome.FAILED
    assert "ValueError: once" in s.message
    assert s.n_steps < 300


def test_threads_start_in_processes_that_find_everything_compiled():
    code = (
        "import numpy as np, kickdrift as kd; x = np.random.default_rng(0).normal(size=(300, 3));"
        "kd.solve(kd.systems.nbody(np.ones(300), x, 0 * x, threads=True), (0, 0.1), step=0.1)"
    )
    exec(code)  # compiles, unless that is done
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


def test_an_energy_that_is_off_by_more_than_itself_is_said():
    pythagorean = kd.systems.nbody(
        masses=[3, 4, 5], x0=[[1, 3, 0], [-2, -1, 0], [1, -1, 0]], v0=np.zeros((3, 3)), G=1.0
    )
    lost = kd.solve(pythagorean, (0.0, 70.0), step=1e-2, method="stormer-verlet", save_every=100)
    times = abs(lost.energy[-1] / lost.energy[0] - 1.0)
    assert times > 1.0
    assert f"The energy error is {times:.3g} times the energy" in lost.message
    assert "The energy error is" in lost.report()
    kept = kd.solve(pythagorean, (0.0, 1.0), step=1e-3, method="stormer-verlet")
    assert "energy" not in kept.message


def half_square(x, v):
    return 0.5 * (v * v + x * x)


@pytest.mark.parametrize(
    ("problem", "start"),
    [
        (kd.Damped(lambda x: -x, damping=1.0, energy=half_square), 1.0),
        (kd.SecondOrder(lambda t, x: -x + 2.0 * np.cos(t), energy=half_square), 1e-3),
        (kd.SecondOrder(lambda x, v: -x + 0.5 * v, energy=half_square), 1e-3),
        (kd.SecondOrder(lambda x: -x, energy=lambda x, v: half_square(x, v) - 0.5), 1.0),
    ],
    ids=["damped", "driven", "pushed", "zero at the start"],
)
def test_an_energy_that_may_change_or_begins_at_zero_is_not_said_to_be_off(problem, start):
    run = kd.solve(problem, (0.0, 20.0), start, 0.0, step=0.01, method="auto", compile=False)
    assert "energy" not in run.message


def test_functions_that_raise_after_the_run_do_not_lose_it():
    def force(t, x):
        if force.done and t == 0.0:
            raise ValueError("not again")
        force.done = t > 9.0
        return 4.0 * x

    force.done = False
    grows = kd.SecondOrder(force, energy=half_square)
    run = kd.solve(grows, (0.0, 10.0), 1.0, 0.0, step=0.1, method="stormer-verlet", compile=False)
    assert run.success
    assert run.energy[-1] > 2.0 * run.energy[0]

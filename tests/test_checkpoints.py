"""Checkpoints: the same call goes on with the bits of one run, and what is no checkpoint of it is refused."""

import math
import os
import resource
import signal
import threading

import numpy as np
import pytest
from forking import FORK, elsewhere, forked
from killing import killed_after

import kickdrift as kd
from kickdrift.core import archive, locking
from kickdrift.engine import checkpoints, identity, run, task

STEP = 1 / 64
OPTIONS = {"x0": 1.0, "v0": 0.5, "step": STEP, "save_every": 9, "method": "stormer-verlet"}


def pulled(t, x):
    return -x + 0.1 * math.cos(t)


def crossing(x):
    return x


def crossing_in_the_plane(x):
    return x[1]


def solve(folder=None, end=50.0, every=500, problem=pulled, **others):
    kept = {} if folder is None else {"checkpoint": folder, "checkpoint_every": every}
    return kd.solve(problem, (0.0, end), **{**OPTIONS, **kept, **others})


def same(one, other):
    assert np.array_equal(one.t, other.t)
    assert np.array_equal(one.x, other.x)
    assert np.array_equal(one.v, other.v)
    assert (one.step, one.n_steps, one.n_force_evaluations) == (other.step, other.n_steps, other.n_force_evaluations)
    assert one.status is other.status


def files(folder):
    return sorted(path.name for path in folder.iterdir())


def broken_off(monkeypatch, folder, after, **others):
    """Run until so many checkpoints are written, and die before the next one is."""
    with killed_after(after, checkpoints.Checkpoints, "write", monkeypatch):
        solve(folder, **others)


@pytest.mark.parametrize(
    ("problem", "others"),
    [
        (pulled, {}),
        (pulled, {"compile": False}),
        (pulled, {"events": crossing}),
        (pulled, {"save_every": None, "t_eval": [0.0, 1.03, 40.2, 17.0]}),
        (kd.Langevin(lambda x: -x, friction=1.0, temperature=0.4, seed=3), {"method": "baoab"}),
        (kd.systems.kepler(0.6), {"method": "implicit-midpoint", "x0": None, "v0": None}),
        (kd.systems.outer_solar_system(), {"method": "wisdom-holman-corrected-3", "x0": None, "v0": None}),
        (
            kd.FirstOrder(lambda y: np.array([y[1], 50 * (1 - y[0] ** 2) * y[1] - y[0]])),
            {"method": "radau-5", "x0": [2.0, 0.0], "v0": None},
        ),
    ],
    ids=["compiled", "interpreted", "events", "times", "noise", "implicit", "corrected", "stiff"],
)
def test_the_same_call_goes_on_with_the_same_bits(problem, others, tmp_path, monkeypatch):
    whole = solve(problem=problem, **others)
    broken_off(monkeypatch, tmp_path / "run", 2, problem=problem, **others)
    on = solve(tmp_path / "run", problem=problem, **others)
    same(on, whole)
    assert "It resumed from step 1000" in on.message
    assert "It resumed from step 1000" in on.report()
    for one, other in zip(on.t_events, whole.t_events, strict=True):
        assert one.size > 5
        assert np.array_equal(one, other)
    if on.error_estimate is not None:
        assert np.array_equal(on.error_estimate, whole.error_estimate)


def test_a_run_that_is_done_is_there_at_once(tmp_path, monkeypatch):
    whole = solve(tmp_path / "run")
    before = files(tmp_path / "run")
    monkeypatch.setattr("kickdrift.engine.stepper.Stepper.advance", None)
    same(solve(tmp_path / "run"), whole)
    assert files(tmp_path / "run") == before


def test_two_are_kept_and_as_many_as_one_likes(tmp_path):
    solve(tmp_path / "run")
    assert files(tmp_path / "run") == ["step-000000000003000.npz", "step-000000000003200.npz"]
    solve(tmp_path / "one", checkpoint_keep=1)
    assert files(tmp_path / "one") == ["step-000000000003200.npz"]
    solve(tmp_path / "all", checkpoint_keep=None)
    assert len(files(tmp_path / "all")) == 7


def test_from_a_chain_any_earlier_time_is_near(tmp_path, monkeypatch):
    whole = solve(tmp_path / "run", checkpoint_keep=None)
    for end in (20.0, 33.203125, 50.0):
        part = solve(tmp_path / "run", end=end, checkpoint_keep=None)
        same(part, solve(end=end))
        assert np.array_equal(part.x[:-1], whole.x[: part.t.size - 1])
    began, go_on = [], run.Run.go_on
    monkeypatch.setattr(run.Run, "go_on", lambda self, standing: began.append(standing.step) or go_on(self, standing))
    solve(tmp_path / "run", end=20.1875, checkpoint_keep=None)
    assert began == [1280]  # the end of the first part, which was kept, too


def test_a_later_end_goes_on(tmp_path):
    solve(tmp_path / "run", end=20.0)
    same(solve(tmp_path / "run", end=50.0), solve(end=50.0))


def test_an_end_before_all_checkpoints_starts_anew_and_keeps_its_own(tmp_path):
    solve(tmp_path)
    there = files(tmp_path)
    same(solve(tmp_path, end=30.0, every=300), solve(end=30.0))
    assert files(tmp_path) == sorted([*there, "step-000000000001800.npz", "step-000000000001920.npz"])
    for others in ({"problem": lambda x: -2 * x}, {"events": crossing}, {"step": 2 * STEP}):
        with pytest.raises(kd.ArgumentError, match="belongs to another run"):
            solve(tmp_path, end=10.0, **others)


def test_a_folder_for_rows_is_not_held_by_a_run_whose_checkpoints_are_refused(tmp_path):
    pytest.importorskip("zarr")
    to_disk = {"end": 1.0, "save_to": tmp_path / "run.zarr"}
    with pytest.raises(kd.ArgumentError, match="in an existing folder"):
        solve(tmp_path / "none" / "checkpoints", **to_disk)
    assert solve(tmp_path / "checkpoints", **to_disk).success


def test_steps_that_differ_by_rounding_are_those_of_the_first_part(tmp_path):
    first = solve(tmp_path / "run", end=0.29, step=0.0101)
    assert first.step != solve(end=0.7, step=0.0101).step
    on = solve(tmp_path / "run", end=0.7, step=0.0101)
    same(on, first.continue_to(0.7))


def test_events_that_end_a_run_end_it_again(tmp_path, monkeypatch):
    def fifth(x):
        return x

    fifth.terminal = 5
    whole = solve(events=fifth)
    broken_off(monkeypatch, tmp_path / "run", 1, events=fifth)
    for _ in range(2):
        on = solve(tmp_path / "run", events=fifth)
        assert np.array_equal(on.x, whole.x)
        assert on.status is kd.Outcome.STOPPED
        assert np.array_equal(on.t_events[0], whole.t_events[0])
        assert on.n_force_evaluations == whole.n_force_evaluations


def test_an_interruption_is_kept(tmp_path, monkeypatch):
    def ctrl_c(*arguments):
        signal.raise_signal(signal.SIGINT)

    with monkeypatch.context() as patch:
        patch.setattr(task, "keep", ctrl_c)
        part = solve(tmp_path / "run")
    assert part.status is kd.Outcome.INTERRUPTED
    assert part.n_steps == 500
    assert part.t[-1] == 500 * STEP
    same(part.continue_to(50.0), solve())
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    solve(end=10.0)
    timer.start()
    long = solve(tmp_path / "long", end=1e7, every=None, save_every=10**7)
    timer.join()
    assert long.status is kd.Outcome.INTERRUPTED
    assert files(tmp_path / "long")[-1] == f"step-{long.n_steps:015d}.npz"


def test_without_a_number_of_steps_a_checkpoint_comes_after_a_while(tmp_path, monkeypatch):
    monkeypatch.setattr(checkpoints, "_SECONDS", 0.02)
    solve(tmp_path / "run", end=1e5, every=None, save_every=10**6, checkpoint_keep=None)
    assert 5 < len(files(tmp_path / "run")) < 500
    assert "step-000000000001000.npz" in files(tmp_path / "run")


def damage(path, size=0.5):
    path.write_bytes(path.read_bytes()[: int(size * path.stat().st_size)])


def test_where_the_newest_is_cut_short_the_one_before_is_taken_and_that_is_said(tmp_path, monkeypatch):
    for share in (0.0, 0.5, 0.999):
        folder = tmp_path / f"{share}"
        broken_off(monkeypatch, folder, 3)
        damage(folder / "step-000000000001500.npz", share)
        on = solve(folder)
        same(on, solve())
        assert "It resumed from step 1000" in on.message
        assert "A newer checkpoint is damaged: path=" in on.message
        assert "step-000000000001500.npz" in on.message
        assert "is not a checkpoint" in on.message


def test_where_all_are_damaged_that_is_an_error(tmp_path, monkeypatch):
    broken_off(monkeypatch, tmp_path / "run", 3)
    for path in (tmp_path / "run").iterdir():
        damage(path)
    with pytest.raises(kd.KickdriftError, match="no intact checkpoint"):
        solve(tmp_path / "run")


def test_a_bit_that_flips_is_seen(tmp_path, monkeypatch):
    broken_off(monkeypatch, tmp_path / "run", 1)
    path = tmp_path / "run" / "step-000000000000500.npz"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 4
    path.write_bytes(content)
    with pytest.raises(kd.KickdriftError, match="no intact checkpoint"):
        solve(tmp_path / "run")


def test_what_a_killed_process_left_is_removed(tmp_path, monkeypatch):
    broken_off(monkeypatch, tmp_path / "run", 1)
    partial = tmp_path / "run" / ".step-000000000001000.0123.partial.npz"
    partial.write_bytes(b"PK")
    (tmp_path / "run" / "notes.txt").write_text("mine")
    same(solve(tmp_path / "run"), solve())
    assert not partial.exists()
    assert (tmp_path / "run" / "notes.txt").exists()


def other_force(t, x):
    return -x + 0.2 * math.cos(t)


@pytest.mark.parametrize(
    ("others", "words"),
    [
        ({"problem": other_force}, "another problem"),
        ({"problem": kd.SecondOrder(pulled)}, "another problem"),
        ({"x0": 1.1}, "another x0"),
        ({"v0": 0.6}, "another v0"),
        ({"x0": [1.0], "v0": [0.5]}, "another x0 and v0"),
        ({"method": "semi-implicit-euler"}, "another method"),
        ({"step": 1 / 32}, r"another step \(0.015625 there, 0.03125 here\)"),
        ({"save_every": 10}, "another save_every or t_eval"),
        ({"save_every": None, "t_eval": [1.0, 2.0]}, "another save_every or t_eval"),
        ({"compensated": False}, "another compensated"),
        ({"compile": False}, "another compile"),
        ({"events": crossing}, "another events"),
        ({"problem": kd.systems.kepler(), "x0": None, "v0": None}, "another problem"),
    ],
)
def test_a_checkpoint_of_another_run_is_refused(others, words, tmp_path, monkeypatch):
    broken_off(monkeypatch, tmp_path / "run", 1)
    before = files(tmp_path / "run")
    with pytest.raises(kd.ArgumentError, match=words):
        solve(tmp_path / "run", **others)
    assert files(tmp_path / "run") == before
    same(solve(tmp_path / "run"), solve())


def test_numbers_that_a_function_finds_around_it_are_part_of_the_problem(tmp_path, monkeypatch):
    def spring(stiffness):
        return lambda x: -stiffness * x

    broken_off(monkeypatch, tmp_path / "run", 1, problem=spring(2.0))
    with pytest.raises(kd.ArgumentError, match="another problem"):
        solve(tmp_path / "run", problem=spring(2.5))
    same(solve(tmp_path / "run", problem=spring(2.0)), solve(problem=spring(2.0)))


def test_attributes_of_events_are_part_of_the_run(tmp_path, monkeypatch):
    def zero(x):
        return x

    broken_off(monkeypatch, tmp_path / "run", 1, events=zero)
    zero.direction = 1
    with pytest.raises(kd.ArgumentError, match="another events"):
        solve(tmp_path / "run", events=zero)


def test_a_checkpoint_of_another_version_is_refused(tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(identity, "VERSION", "0.0.9")
        broken_off(patch, tmp_path / "run", 1)
    with pytest.raises(kd.ArgumentError, match=r"was written by kickdrift 0\.0\.9, .* and this is kickdrift"):
        solve(tmp_path / "run")


@pytest.mark.parametrize("missing", ["x", "work", "rows: steps", "rows: xs"])
def test_a_file_that_lacks_something_is_refused(missing, tmp_path, monkeypatch):
    broken_off(monkeypatch, tmp_path / "run", 1)
    path = tmp_path / "run" / "step-000000000000500.npz"
    header, arrays = archive.read(path, "", "", lambda *found: found)
    del arrays[missing]
    archive.write(path, header, arrays)
    with pytest.raises(kd.KickdriftError, match="has invalid contents"):
        solve(tmp_path / "run")


@pytest.mark.parametrize(
    ("others", "words"),
    [
        ({"checkpoint": 3}, "is not a path"),
        ({"checkpoint": ""}, "is not a path"),
        ({"checkpoint": "a\0b"}, "is not a path"),
        ({"checkpoint": "no/such/folder"}, "cannot be used as the folder"),
        ({"checkpoint": __file__}, "cannot be used as the folder"),
        ({"checkpoint": "x", "checkpoint_every": 0}, "checkpoint_every=0 must"),
        ({"checkpoint": "x", "checkpoint_every": 1.5}, "checkpoint_every=1.5 must"),
        ({"checkpoint": "x", "checkpoint_every": True}, "checkpoint_every=True must"),
        ({"checkpoint": "x", "checkpoint_keep": 0}, "checkpoint_keep=0 must"),
        ({"checkpoint": "x", "checkpoint_keep": "all"}, "checkpoint_keep='all' must"),
        ({"checkpoint_every": 10}, "without checkpoint"),
    ],
)
def test_arguments_that_cannot_be_are_refused(others, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kd.ArgumentError, match=words):
        solve(**others)
    assert files(tmp_path) == []


def test_a_file_that_cannot_be_written_ends_the_run_with_what_is_done(tmp_path, monkeypatch):
    write = archive.write

    def full(path, *arguments, **others):
        if "1500" in str(path):
            raise kd.core.errors.FileFormatError(f"path={str(path)!r} cannot be written: No space left on device.")
        return write(path, *arguments, **others)

    with monkeypatch.context() as patch:
        patch.setattr(archive, "write", full)
        part = solve(tmp_path / "run")
    assert part.status is kd.Outcome.NOT_WRITTEN
    assert "No space left on device" in part.message
    assert (part.n_steps, part.t[-1]) == (1500, 1500 * STEP)
    assert files(tmp_path / "run") == ["step-000000000000500.npz", "step-000000000001000.npz"]
    same(solve(tmp_path / "run"), solve())


def with_short_files(folder):
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, resource.RLIM_INFINITY))
    part = solve(folder, save_every=1)
    return part.status.name, part.n_steps


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # of Python 3.12, where there are threads
def test_a_disk_that_is_full_ends_the_run_and_leaves_the_checkpoints_whole(tmp_path):
    """A limit on the size of files stands for the disk: rows beyond it are cut short on their way."""
    assert elsewhere(with_short_files, tmp_path / "run") == ("NOT_WRITTEN", 2500)
    assert files(tmp_path / "run") == ["step-000000000001500.npz", "step-000000000002000.npz"]
    same(solve(tmp_path / "run", save_every=1), solve(save_every=1))


@pytest.mark.parametrize(
    "control",
    [
        {"step_control": "distance", "method": "stormer-verlet"},
        {"step_control": kd.LogarithmicHamiltonian(), "method": "stormer-verlet"},
        {"rtol": 1e-8, "method": "dop853"},
        {"step_control": "distance", "method": "stormer-verlet", "events": crossing_in_the_plane},
        {"step_control": "distance", "method": "stormer-verlet", "t_eval": [0.0, 3.3, 30.0]},
    ],
    ids=["density", "logarithmic", "error", "events", "times"],
)
def test_steps_that_vary_go_on_too(control, tmp_path, monkeypatch):
    kepler = kd.systems.kepler(0.8)
    options = {"problem": kepler, "x0": None, "v0": None, "save_every": None if "t_eval" in control else 5, **control}
    options |= {} if "rtol" in control else {"step": 0.02}
    whole = solve(**options)
    broken_off(monkeypatch, tmp_path / "run", 2, every=30, **options)
    on = solve(tmp_path / "run", every=30, **options)
    same(on, whole)
    assert "It resumed from step 60" in on.message
    assert (on.n_rejected, on.step_range) == (whole.n_rejected, whole.step_range)
    for one, other in zip(on.t_events, whole.t_events, strict=True):
        assert one.size > 5
        assert np.array_equal(one, other)
    again = solve(tmp_path / "run", **options)
    same(again, whole)
    assert [zeros.size for zeros in again.t_events] == [zeros.size for zeros in whole.t_events]
    with pytest.raises(kd.ArgumentError, match="with another t_span; name"):
        solve(tmp_path / "run", end=60.0, **options)
    further, whole = on.continue_to(60.0), solve(end=60.0, **options)
    assert (further.n_steps, further.step_range) == (whole.n_steps, whole.step_range)
    assert all(map(np.array_equal, further.x_events, whole.x_events))


def falling(x):
    return np.array([0.0, -9.81])


def rubbed(x, params):
    return -x - 0.2 * params[-1]


@pytest.mark.parametrize(
    ("problem", "others"),
    [
        (falling, {"x0": [0.0, 1.0], "v0": [1.0, 0.0], "impacts": kd.Impacts(lambda x: x[1], restitution=0.8)}),
        (rubbed, {"x0": 2.5, "v0": 0.0, "switches": lambda v: v}),
    ],
    ids=["impacts", "switches"],
)
def test_steps_that_are_cut_go_on_too(problem, others, tmp_path, monkeypatch):
    options = {"problem": problem, "end": 12.0, "step": 1 / 32, "save_every": 5, **others}
    whole = solve(**options)
    broken_off(monkeypatch, tmp_path / "run", 2, every=50, **options)
    on = solve(tmp_path / "run", every=50, **options)
    same(on, whole)
    assert "It resumed from step 100" in on.message
    key = "impacts" if "impacts" in others else "switches"
    with pytest.raises(kd.ArgumentError, match="another step_control, impacts or switches"):
        solve(tmp_path / "run", **{**options, key: kd.Impacts(lambda x: x[1]) if key == "impacts" else lambda x: x})


def test_two_runs_at_once_in_a_folder_are_refused(tmp_path, monkeypatch):
    write, said = checkpoints.Checkpoints.write, []

    def meanwhile(self, step, *arguments):
        write(self, step, *arguments)
        for end in (50.0, 20.0):
            with pytest.raises(kd.ArgumentError, match=r"run' is in use by a run of this process; wait") as error:
                solve(tmp_path / "run", end=end)
            said.append(error)

    with monkeypatch.context() as patch:
        patch.setattr(checkpoints.Checkpoints, "write", meanwhile)
        solve(tmp_path / "run")
    assert said
    assert not (tmp_path / "run" / ".lock").exists()
    same(solve(tmp_path / "run"), solve())


def hold(folder, written):
    """Run until there is a checkpoint, and wait."""
    write = checkpoints.Checkpoints.write

    def waiting(self, step, *arguments):
        write(self, step, *arguments)
        written.send(True)
        signal.pause()

    checkpoints.Checkpoints.write = waiting
    solve(folder)


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # of Python 3.12, where there are threads
def test_another_process_is_refused_until_it_is_killed(tmp_path):
    read, written = FORK.Pipe(duplex=False)
    holder = forked(hold, tmp_path / "run", written)
    assert read.recv()
    with pytest.raises(kd.ArgumentError, match=f"in use by a run of process {holder.pid} on "):
        solve(tmp_path / "run")
    holder.kill()
    holder.join()
    assert (tmp_path / "run" / ".lock").exists()
    on = solve(tmp_path / "run")
    assert "It resumed from step 500" in on.message
    same(on, solve())
    assert not (tmp_path / "run" / ".lock").exists()


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # of Python 3.12, where there are threads
def test_what_a_killed_process_has_forked_does_not_keep_the_folder(tmp_path):
    """A pool's workers may outlive it, with all files that were open when they were forked."""
    read, hold = os.pipe()
    if (child := os.fork()) == 0:
        lock = locking.FileLock(tmp_path / ".lock")
        if os.fork() == 0:
            os.close(hold)
            os.read(read, 1)  # until the test ends
            os._exit(0)
        assert lock
        os.kill(os.getpid(), signal.SIGKILL)
    assert os.waitpid(child, 0)[1] == signal.SIGKILL
    with locking.FileLock(tmp_path / ".lock"):
        pass
    os.close(hold)


def test_a_lock_whose_holder_removes_it_meanwhile_is_taken_anew(tmp_path, monkeypatch):
    path, lock, count = tmp_path / ".lock", locking._lock, []

    def late(descriptor):
        lock(descriptor)
        count.append(1)
        if len(count) == 1:
            path.unlink()

    monkeypatch.setattr(locking, "_lock", late)
    with locking.FileLock(path):
        assert path.exists()
    assert len(count) == 2
    assert not path.exists()

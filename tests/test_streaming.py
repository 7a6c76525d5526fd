"""Rows that go to disk while a run goes on: xarray reads them at any moment, and memory stays as it is."""

import math
import resource
import signal
import sys
import tracemalloc

import numpy as np
import pytest
import xarray as xr
from forking import elsewhere
from killing import killed_after

import kickdrift as kd
from kickdrift.engine import checkpoints, zarr_store

STEP = 1 / 64
OPTIONS = {"step": STEP, "save_every": 3, "method": "stormer-verlet"}


@pytest.fixture(autouse=True)
def _small_chunks(monkeypatch):
    monkeypatch.setattr(zarr_store, "_CHUNK", 100 * 16)  # rows of two numbers


def solve(path=None, end=50.0, problem=None, **others):
    problem = kd.systems.kepler(0.6) if problem is None else problem
    return kd.solve(problem, (0.0, end), **{**OPTIONS, "save_to": path, **others})


def opened(path):
    return xr.open_zarr(path).load()


def same(path, whole):
    data, wanted = opened(path), whole.to_xarray()
    assert data.sizes == wanted.sizes
    for name in (*wanted.data_vars, "time", *wanted.coords):
        assert np.array_equal(data[name], wanted[name]), name
        assert data[name].dims == wanted[name].dims
        assert data[name].attrs == wanted[name].attrs
    for name, words in wanted.attrs.items():
        assert data.attrs[name] == words


def broken_off(monkeypatch, function, after, **others):
    """Run until a function of the store or of checkpoints was called so often, and die before the next call."""
    with killed_after(after, *function, monkeypatch):
        solve(**others)


APPEND, WRITE = (zarr_store.ZarrStore, "append"), (checkpoints.Checkpoints, "write")


VARIED = {"step_control": "distance", "step": 0.02}


def falling(x):
    return np.array([0.0, -9.81])


@pytest.mark.parametrize(
    ("problem", "others"),
    [
        (kd.systems.kepler(0.6), {}),
        (kd.systems.kepler(0.6), {"save_every": None, "end": 20.0}),
        (kd.systems.kepler(0.6), {"end": -30.0}),
        (kd.systems.outer_solar_system(), {"step": 4.0, "end": 4000.0, "method": "wisdom-holman-corrected-3"}),
        (kd.FirstOrder(lambda y: np.array([y[1], -y[0]])), {"x0": [1.0, 0.0], "method": "rk4"}),
        (lambda x: -x, {"x0": 1.0, "v0": 0.0}),
        (kd.systems.kepler(0.6), VARIED),
        (kd.systems.kepler(0.6), {**VARIED, "end": -30.0, "save_every": 1}),
        (kd.systems.kepler(0.6), {"step": None, "rtol": 1e-9, "method": "dop853", "save_every": None, "end": 400.0}),
        (kd.systems.kepler(0.6), {**VARIED, "step_control": kd.LogarithmicHamiltonian()}),
        (
            kd.systems.outer_solar_system(),
            {**VARIED, "step": 30.0, "end": 2.5e4, "step_control": kd.LogarithmicHamiltonian()},
        ),
        (falling, {"x0": [0.0, 1.0], "v0": [1.0, 0.0], "impacts": kd.Impacts(lambda x: x[1], restitution=0.9)}),
        (kd.Langevin(lambda x: -x, friction=1.0, temperature=0.4), {"x0": 1.0, "v0": 0.0, "method": "baoab"}),
    ],
    ids=[
        *("plain", "every", "backwards", "corrected", "first order", "scalar", "varied", "varied backwards", "error"),
        *("logarithmic", "planets", "impacts", "noise"),
    ],
)
def test_what_goes_to_disk_is_what_would_be_kept(problem, others, tmp_path, monkeypatch):
    whole, path = solve(problem=problem, **others), tmp_path / "run.zarr"
    monkeypatch.setattr(zarr_store, "_CHUNK", 100 * whole.x[0].nbytes)
    streamed = solve(path, problem=problem, **others)
    same(path, whole)
    assert streamed.saved_to == str(path)
    assert np.array_equal(streamed.t, whole.t[[0, -1]])
    assert np.array_equal(streamed.x, whole.x[[0, -1]])
    assert np.array_equal(streamed.v, whole.v[[0, -1]])
    assert (streamed.n_steps, streamed.n_force_evaluations) == (whole.n_steps, whole.n_force_evaluations)
    assert np.array_equal(streamed.to_xarray().x, whole.x)
    with pytest.raises(kd.KickdriftError, match="the states are on disk"):
        streamed.to_pandas()
    assert streamed.message == whole.message
    assert (streamed.step_range, streamed.n_rejected) == (whole.step_range, whole.n_rejected)
    assert whole.t.size > 200
    assert f"rows are in {str(path)!r}" in streamed.report()


def random_times(end, count=800):
    """Times in order, of which some are repeated, and one very often."""
    times = np.random.default_rng(7).uniform(0.0, abs(end), count)
    return np.sign(end) * np.sort(np.concatenate((times, times[::7], np.repeat(times[5], 250))))


@pytest.mark.parametrize(
    ("problem", "others"),
    [
        (kd.systems.kepler(0.6), {"t_eval": random_times(50.0)}),
        (kd.systems.kepler(0.6), {"t_eval": random_times(-30.0), "end": -30.0}),
        (kd.systems.kepler(0.6), {"t_eval": random_times(50.0), "step": 0.5}),
        (kd.systems.kepler(0.6), {"t_eval": np.arange(5.0, 50.01, 1 / 16)}),
        (kd.systems.kepler(0.6), {"t_eval": random_times(50.0), **VARIED}),
        (kd.systems.kepler(0.6), {"t_eval": random_times(-30.0), "end": -30.0, **VARIED}),
        (
            kd.systems.outer_solar_system(),
            {"t_eval": random_times(4e3), "end": 4e3, "step": 4.0, "method": "wisdom-holman-corrected-3"},
        ),
        (
            kd.FirstOrder(lambda y: np.array([y[1], -y[0]])),
            {"t_eval": random_times(50.0), "x0": [1.0, 0.0], "method": "rk4"},
        ),
        (
            falling,
            {
                "t_eval": np.arange(0.0, 50.0, 0.05),
                "x0": [0.0, 1.0],
                "v0": [1.0, 0.0],
                "impacts": kd.Impacts(lambda x: x[1], restitution=0.9),
            },
        ),
        (
            kd.Langevin(lambda x: -x, friction=1.0, temperature=0.4),
            {"t_eval": np.arange(0.0, 50.01, 1 / 16), "x0": 1.0, "v0": 0.0, "method": "baoab"},
        ),
    ],
    ids=[
        "plain",
        "backwards",
        "many in a step",
        "grid",
        "varied",
        "varied backwards",
        "corrected",
        "first order",
        "impacts",
        "noise",
    ],
)
def test_times_of_ones_own_go_to_disk(problem, others, tmp_path, monkeypatch):
    options = {"save_every": None, **others}
    whole, path = solve(problem=problem, **options), tmp_path / "run.zarr"
    monkeypatch.setattr(zarr_store, "_CHUNK", 100 * whole.x[0].nbytes)
    streamed = solve(path, problem=problem, **options)
    same(path, whole)
    assert np.array_equal(streamed.t, whole.t[[0, -1]])
    assert np.array_equal(streamed.v, whole.v[[0, -1]])
    assert (streamed.n_steps, streamed.n_force_evaluations) == (whole.n_steps, whole.n_force_evaluations)
    assert whole.t.size > 700


@pytest.mark.parametrize("others", [{}, VARIED], ids=["equal", "varied"])
@pytest.mark.parametrize(("function", "after"), [(APPEND, 0), (APPEND, 3), (WRITE, 1), (WRITE, 4)])
def test_a_run_with_times_of_ones_own_goes_on_in_its_folder(function, after, others, tmp_path, monkeypatch):
    kept = {"path": tmp_path / "run.zarr", "checkpoint": tmp_path / "kept", "checkpoint_every": 100 if others else 500}
    options = {"save_every": None, "t_eval": random_times(50.0), **others}
    broken_off(monkeypatch, function, after, **kept, **options)
    on, whole = solve(**kept, **options), solve(**options)
    same(tmp_path / "run.zarr", whole)
    assert on.n_force_evaluations == whole.n_force_evaluations
    assert ("It resumed from step" in on.message) == (after > 0)
    with pytest.raises(kd.ArgumentError, match="holds another run"):
        solve(**kept, **{**options, "t_eval": [1.0, 2.0]})


@pytest.mark.parametrize("others", [{}, VARIED], ids=["equal", "varied"])
def test_an_event_ends_a_run_between_times(others, tmp_path):
    def far(x):
        return x[0] + 1.59

    far.terminal = 3
    times = {"save_every": None, "t_eval": random_times(50.0)}
    whole = solve(events=far, **times, **others)
    streamed = solve(tmp_path / "stopped", events=far, **times, **others)
    same(tmp_path / "stopped", whole)
    assert np.array_equal(streamed.x[[0, -1]], whole.x[[0, -1]])


@pytest.mark.parametrize("times", [random_times(50.0), np.arange(0.0, 50.01, 5 / 64)], ids=["any", "grid"])
@pytest.mark.parametrize("others", [{}, {"rtol": 1e-4, "step": None}], ids=["equal", "varied"])
def test_an_early_end_between_times_is_written(times, others, tmp_path):
    options = {"problem": lambda t, x: -x if t < 20.0 else math.inf, "x0": 1.0, "v0": 0.0, "compile": False}
    options |= {"save_every": None, "t_eval": times, **others}
    lost = solve(tmp_path / "lost", **options)
    assert not lost.success
    same(tmp_path / "lost", solve(**options))


def test_memory_holds_a_few_states_of_those_between_times(tmp_path, monkeypatch):
    monkeypatch.setattr(zarr_store, "_CHUNK", 10 * 8000)
    start = {"x0": np.ones(1000), "v0": np.zeros(1000), "problem": lambda x: -x, "save_every": None}

    def most(path, end):
        tracemalloc.start()
        sol = solve(path, end=end, t_eval=np.linspace(0.0, end, int(20 * end)), **start)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        del sol
        return peak

    most(tmp_path / "warm", 1.0)
    short, long = most(tmp_path / "short", 2.0), most(tmp_path / "long", 20.0)
    assert long < 1.5 * short
    assert long < 0.5 * 400 * 16_000 < most(None, 20.0)


def test_xarray_reads_it_meanwhile(tmp_path, monkeypatch):
    path, seen = tmp_path / "run.zarr", []
    append = zarr_store.ZarrStore.append

    def watched(self, rows, attributes):
        append(self, rows, attributes)
        data = opened(path)
        assert data.sizes["time"] == self.rows
        assert np.isfinite(data.x).all()
        seen.append((self.rows, data.attrs["status"]))

    with monkeypatch.context() as patch:
        patch.setattr(zarr_store.ZarrStore, "append", watched)
        whole = solve(path)
    assert seen[:-1] == [(100 * (k + 1), "RUNNING") for k in range(len(seen) - 1)]
    assert seen[-1] == (1068, "COMPLETED")
    assert whole.n_steps == 3200


def test_readers_never_see_arrays_of_different_lengths(tmp_path, monkeypatch):
    broken_off(monkeypatch, (zarr_store.ZarrStore, "_commit"), 4, path=tmp_path / "run.zarr")
    assert opened(tmp_path / "run.zarr").sizes["time"] == 300  # the next hundred are there, but not told of


def test_memory_stays_as_it_is(tmp_path, monkeypatch):
    monkeypatch.setattr(zarr_store, "_CHUNK", 2_500 * 16)
    solve(tmp_path / "warm", end=10.0, save_every=None)

    def most(end):
        tracemalloc.start()
        solve(tmp_path / f"{end}", end=end, save_every=None)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return peak

    short, long = most(75.0), most(1500.0)
    assert long < 2.0 * short
    assert opened(tmp_path / "1500.0").sizes["time"] == 96_001
    assert long < 0.2 * 96_001 * 32


def test_what_would_not_fit_in_memory_says_so_and_names_the_way_out(tmp_path):
    with pytest.raises(kd.ArgumentError, match=r"GiB; give save_every=.* or save_to='run.zarr'"):
        solve(end=1e10, save_every=None)
    grid = solve.__globals__["kd"].engine.grid.lay_grid((0.0, 1e12), STEP, None, None, 4, True)
    assert grid.n_steps == 64 * 10**12


@pytest.mark.parametrize("others", [{}, {**VARIED, "save_every": 1}], ids=["equal", "varied"])
@pytest.mark.parametrize(("function", "after"), [(APPEND, 0), (APPEND, 5), (WRITE, 0), (WRITE, 1), (WRITE, 4)])
def test_a_run_that_was_killed_goes_on_in_its_folder(function, after, others, tmp_path, monkeypatch):
    every = 100 if others else 500
    options = {"path": tmp_path / "run.zarr", "checkpoint": tmp_path / "kept", "checkpoint_every": every, **others}
    broken_off(monkeypatch, function, after, **options)
    written, append = [], zarr_store.ZarrStore.append
    with monkeypatch.context() as patch:
        patch.setattr(zarr_store.ZarrStore, "append", lambda self, *a: written.append(self.rows) or append(self, *a))
        on = solve(**options)
    same(tmp_path / "run.zarr", solve(**others))
    assert ("It resumed from step" in on.message) == (after > 0)
    if function is WRITE and after == 4:
        # Whole chunks before the checkpoint are not written again: at step 2000 of row 667, or at 400
        assert written[0] == (400 if others else 600)
    solve(**options)  # which is done
    same(tmp_path / "run.zarr", solve(**others))


def test_it_goes_on_to_a_later_end_and_back_to_an_earlier_one(tmp_path):
    options = {"path": tmp_path / "run.zarr", "checkpoint": tmp_path / "kept", "checkpoint_every": 500}
    for end in (20.0, 50.0, 30.203125):
        solve(**options, end=end, checkpoint_keep=None)
        same(tmp_path / "run.zarr", solve(end=end))


@pytest.mark.parametrize("varied", [{}, VARIED], ids=["equal", "varied"])
def test_events_and_ends_before_the_end_are_written(varied, tmp_path):
    def far(x):
        return x[0] + 1.59

    far.terminal = 3
    whole = solve(events=far, **varied)
    assert whole.status is kd.Outcome.STOPPED
    streamed = solve(tmp_path / "stopped", events=far, **varied)
    same(tmp_path / "stopped", whole)
    assert np.array_equal(streamed.t_events[0], whole.t_events[0])
    assert np.array_equal(streamed.x[-1], whole.x[-1])

    def force(t, x):
        return -x if t < 20.0 else math.inf

    options = {"problem": force, "x0": 1.0, "v0": 0.0, "compile": False, **({"rtol": 1e-4} if varied else {})}
    lost = solve(tmp_path / "lost", **options)
    assert lost.status is (kd.Outcome.NO_STEP if varied else kd.Outcome.NOT_FINITE)
    same(tmp_path / "lost", solve(**options))


def test_an_interruption_keeps_what_is_done(tmp_path, monkeypatch):
    append, called = zarr_store.ZarrStore.append, []

    def ctrl_c(self, *arguments):
        append(self, *arguments)
        called.append(1)
        if len(called) == 3:
            signal.raise_signal(signal.SIGINT)

    with monkeypatch.context() as patch:
        patch.setattr(zarr_store.ZarrStore, "append", ctrl_c)
        part = solve(tmp_path / "run.zarr")
    assert part.status is kd.Outcome.INTERRUPTED
    data = opened(tmp_path / "run.zarr")
    assert data.attrs["status"] == "INTERRUPTED"
    assert np.array_equal(data.x, solve().x[:300])


def test_solutions_say_where_their_rows_are(tmp_path):
    streamed = solve(tmp_path / "run.zarr")
    for ask in (lambda: streamed(3.0), lambda: streamed.continue_to(60.0)):
        with pytest.raises(kd.KickdriftError, match=r"rows are in .*run\.zarr"):
            ask()
    assert kd.load(streamed.save(tmp_path / "ends")).t.size == 2


def other(path):
    path.mkdir()
    (path / "thesis.txt").write_text("mine")


def file(path):
    path.write_text("mine")


def this_run(path):
    solve(path)


def another_run(path):
    solve(path, problem=kd.systems.kepler(0.5))


@pytest.mark.parametrize(
    ("before", "others", "words"),
    [
        (other, {}, "exists already"),
        (other, {"checkpoint": "kept"}, "exists already"),
        (file, {}, "exists already"),
        (this_run, {}, "holds this run"),
        (another_run, {}, "holds another run"),
        (another_run, {"checkpoint": "kept"}, "holds another run"),
        (None, {"path": 3}, "is not a path"),
        (None, {"path": ""}, "is not a path"),
        (None, {"path": "no/such/folder.zarr"}, "folder that does not exist"),
        (None, {"t_eval": [1.0]}, "t_eval are both given"),
        (None, {"save_every": None, "t_eval": [2.0, 1.0]}, "in the order of the run"),
        (None, {"end": -5.0, "save_every": None, "t_eval": [-2.0, -1.0]}, "in the order of the run"),
    ],
)
def test_folders_that_cannot_be_are_refused(before, others, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if before is not None:
        before(tmp_path / "run.zarr")
    there = sorted(tmp_path.rglob("*"))
    with pytest.raises(kd.ArgumentError, match=words):
        solve(**{"path": tmp_path / "run.zarr", **others})
    assert sorted(tmp_path.rglob("*")) == there


def test_a_store_that_is_not_what_the_checkpoint_goes_on_from_is_refused(tmp_path, monkeypatch):
    import shutil

    options = {"path": tmp_path / "run.zarr", "checkpoint": tmp_path / "kept", "checkpoint_every": 500}
    broken_off(monkeypatch, WRITE, 3, **options)
    shutil.rmtree(tmp_path / "run.zarr")
    with pytest.raises(kd.KickdriftError, match="does not match the checkpoint"):
        solve(**options)


def test_without_zarr_one_is_told_how_to_install_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "zarr", None)
    with pytest.raises(kd.core.errors.MissingExtraError, match=r"pip install 'kickdrift\[zarr\]'"):
        solve(tmp_path / "run.zarr")


def on_a_full_disk(path):
    write = zarr_store.ZarrStore.append

    def limited(self, *arguments):
        if self.rows == 300:
            resource.setrlimit(resource.RLIMIT_FSIZE, (500, resource.RLIM_INFINITY))
        write(self, *arguments)

    zarr_store.ZarrStore.append = limited
    part = solve(path)
    return part.status.name, part.n_steps


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # of Python 3.12, where there are threads
def test_a_disk_that_is_full_ends_the_run_and_leaves_what_was_written(tmp_path):
    """A limit on the size of files stands for the disk."""
    assert elsewhere(on_a_full_disk, tmp_path / "run.zarr") == ("NOT_WRITTEN", 3 * 399)
    assert np.array_equal(opened(tmp_path / "run.zarr").x, solve().x[:300])


def test_units_go_to_disk(tmp_path):
    u = pytest.importorskip("pint").UnitRegistry()
    kd.solve(
        lambda x: -x, (0 * u.s, 1 * u.s), 1.0 * u.km, 0.0 * u.km / u.s, step=0.1 * u.s, save_to=tmp_path / "run.zarr"
    )
    data = opened(tmp_path / "run.zarr")
    assert [data[name].attrs["units"] for name in ("time", "x", "v")] == ["s", "km", "km/s"]


def test_a_folder_is_loaded_as_what_was_returned(tmp_path):
    def level(x):
        return x

    options = {"step": 0.01, "events": level, "save_to": tmp_path / "run.zarr", "checkpoint": tmp_path / "kept"}
    for end in (3.0, 6.0):
        stored = kd.solve(kd.systems.pendulum(), (0, end), **options)
        loaded = kd.load(tmp_path / "run.zarr")
        for name in ("t", "x", "v", "energy"):
            assert np.array_equal(getattr(loaded, name), getattr(stored, name)), name
        assert np.array_equal(loaded.t_events[0], stored.t_events[0])
        for name in ("status", "message", "saved_to", "n_steps", "about", "wall_time"):
            assert getattr(loaded, name) == getattr(stored, name), name
        assert loaded.to_xarray().identical(stored.to_xarray())


@pytest.mark.parametrize("name", ["x", "v", "time", "energy"])
def test_a_flipped_bit_on_disk_is_an_error(name, tmp_path):
    solve(tmp_path / "run.zarr")
    chunk = next(path for path in (tmp_path / "run.zarr" / name / "c").rglob("*") if path.is_file())
    damaged = bytearray(chunk.read_bytes())
    damaged[11] ^= 4
    chunk.write_bytes(damaged)
    with pytest.raises(ValueError, match="checksum"):
        opened(tmp_path / "run.zarr")

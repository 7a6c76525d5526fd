"""Ensembles on disk: whoever runs a chunk of members writes it, once, and the solution reads what it is asked for."""

import multiprocessing
import os
import signal
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial

import counting_writes
import numpy as np
import pytest
import xarray as xr

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.engine.progress import Bar
from kickdrift.scale import chunks, executors, member_store

SPAN = (0.0, 3.0)
OPTIONS = {"step": 0.01, "save_every": 60}
FIRST = np.array([1.0, 2.0, 3.0])


def starts(count=150):
    noise = np.random.default_rng(3).normal(size=(2, count, 2))
    return [1.0, 0.0] + 0.1 * noise[0], [0.0, 1.0] + 0.1 * noise[1]


def solve(path=None, problem=None, begin=None, **others):
    x, v = starts() if begin is None else begin
    problem = kd.systems.kepler() if problem is None else problem
    return kd.solve_ensemble(problem, SPAN, x, v, **{**OPTIONS, "save_to": path, **others})


@pytest.fixture
def small(monkeypatch):
    """Have chunks of a few members, and of a few times."""
    monkeypatch.setattr(chunks, "_BYTES", 20 * 6 * 4 * 8)
    monkeypatch.setattr(member_store, "_CHUNK", 20 * 4 * 2 * 8)


def same(stored, whole):
    for name in ("x", "v"):
        assert np.asarray(getattr(stored, name)).tobytes() == getattr(whole, name).tobytes(), name
    for name, values in whole.invariants.items():
        assert np.array_equal(stored.invariants[name], values, equal_nan=True), name
    for name in ("step", "step_range", "n_steps", "n_rejected", "n_force_evaluations"):
        assert np.array_equal(getattr(stored, name), getattr(whole, name)), name
    assert (stored.status, stored.messages) == (whole.status, whole.messages)


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("threads", [1, 2])
def test_what_is_on_disk_is_what_would_be_kept(threads, tmp_path):
    x, v = starts()
    x[7] = 1e-160, 0.0
    whole = solve(begin=(x, v))
    stored = solve(tmp_path / "run.zarr", begin=(x, v), threads=threads)
    assert not stored.success[7]
    same(stored, whole)
    assert not isinstance(stored.x, np.ndarray)
    assert stored.x.chunks == (20, 3, 2)
    data, wanted = xr.open_zarr(tmp_path / "run.zarr").load(), whole.to_xarray()
    for name in (*wanted.data_vars, *wanted.coords):
        assert np.array_equal(data[name], wanted[name], equal_nan=data[name].dtype.kind == "f"), name
        assert data[name].dims == wanted[name].dims
        assert data[name].attrs.get("units") == wanted[name].attrs.get("units")
    assert data.identical(stored.to_xarray().load())
    assert stored[3].x.tobytes() == whole[3].x.tobytes()
    assert np.array_equal(stored[7].energy, whole[7].energy)
    assert (
        stored.report().replace(f"rows                    in {stored.saved_to!r}\n", "").splitlines()[9:]
        == (whole.report().splitlines()[9:])
    )
    same(kd.load(stored.save(tmp_path / "run")), whole)
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


@pytest.mark.parametrize(
    "others",
    [
        {
            "problem": kd.systems.kepler,
            "begin": (None, None),
            "args": {"eccentricity": np.linspace(0, 0.9, 9), "mu": 1.0},
        },
        {"problem": kd.Langevin(lambda x: -x, friction=1.0, temperature=0.4), "method": "baoab", "seeds": range(150)},
        {"step_control": "distance", "method": "stormer-verlet", "t_eval": FIRST, "save_every": None},
        {"problem": kd.FirstOrder(lambda y: -y), "begin": (starts()[0], None), "method": "rk4"},
        {"step": np.where(np.arange(150) % 2, 0.01, 0.02), "t_eval": FIRST, "save_every": None},
    ],
    ids=["swept", "noise", "adaptive", "first order", "steps"],
)
@pytest.mark.usefixtures("small")
def test_all_kinds_of_members_go_to_disk(others, tmp_path):
    whole, stored = solve(**others), solve(tmp_path / "run.zarr", **others)
    same(stored, whole)
    data, wanted = xr.open_zarr(tmp_path / "run.zarr").load(), whole.to_xarray()
    for name in (*wanted.data_vars, *wanted.coords):
        assert np.array_equal(data[name], wanted[name], equal_nan=data[name].dtype.kind == "f"), name
    same(solve(tmp_path / "run.zarr", **others), whole)


@pytest.mark.usefixtures("small")
def test_a_call_goes_on_with_the_members_that_are_not_done(tmp_path, monkeypatch):
    show, ran, run_chunk = Bar.show, [], chunks.run_chunk

    def interrupted(self, step, seconds):
        show(self, step, seconds)
        if step > 80 * 300:
            signal.raise_signal(signal.SIGINT)

    with monkeypatch.context() as patch:
        patch.setattr(Bar, "show", interrupted)
        part = solve(tmp_path / "run.zarr")
    done = int(part.success.sum())
    assert 80 <= done < 150
    assert done % 20 == 0
    assert part.status[-1] is kd.Outcome.INTERRUPTED
    data = xr.open_zarr(tmp_path / "run.zarr")
    assert (data.status.values[:done] == "COMPLETED").all()
    assert (data.status.values[done:] == "").all()
    assert np.isnan(data.x.values[done:]).all()
    monkeypatch.setattr(
        chunks, "run_chunk", lambda chunk, *others: ran.append(chunk.first) or run_chunk(chunk, *others)
    )
    same(solve(tmp_path / "run.zarr", threads=1), solve())
    assert ran == list(range(done, 150, 20))


def pool(count, *given, method="spawn"):
    context = multiprocessing.get_context(method)
    return ProcessPoolExecutor(count, mp_context=context, initializer=counting_writes.count_writes, initargs=given)


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # of Python 3.12, where there are threads
@pytest.mark.parametrize("method", ["spawn", "fork"])
@pytest.mark.usefixtures("small")
def test_workers_write_each_chunk_once_and_the_parent_none(method, tmp_path, monkeypatch):
    log, put, here = tmp_path / "log", member_store.MemberStore.put, os.getpid()

    def elsewhere(*arguments):
        assert os.getpid() != here
        return put(*arguments)

    monkeypatch.setattr(member_store.MemberStore, "put", elsewhere)
    with pool(2, log, method=method) as workers:
        stored = solve(tmp_path / "run.zarr", executor=workers)
    counts = counting_writes.chunks_written(log)
    assert set(counts.values()) == {1}
    labels = {"time/c/0", "space/c/0"}
    assert counting_writes.chunks_there(tmp_path / "run.zarr") - labels == set(counts)
    assert len(counts) == 15 * 11  # x, v, two invariants, seven facts of members: no step was rejected
    same(stored, solve())


@pytest.mark.filterwarnings("ignore:a worker of the executor died:RuntimeWarning")
@pytest.mark.parametrize("deadly", ["energy/c/3/0", "x/c/0/1/0", "status/c/7"])
@pytest.mark.usefixtures("small")
def test_nothing_is_written_twice_where_a_worker_dies_in_the_middle_of_a_chunk(deadly, tmp_path, monkeypatch):
    from zarr.storage import LocalStore

    log, original = tmp_path / "log", LocalStore.set
    with pool(1, log, deadly) as workers, monkeypatch.context() as patch:
        patch.setattr(LocalStore, "set", original)
        counting_writes.count_writes(log)  # here too, where the rest runs
        stored = solve(tmp_path / "run.zarr", executor=workers)
    assert (tmp_path / "log.died").exists()
    counts = counting_writes.chunks_written(log)
    assert set(counts.values()) == {1}
    assert counting_writes.chunks_there(tmp_path / "run.zarr") <= set(counts)
    same(stored, solve())


@pytest.mark.usefixtures("small")
def test_a_disk_that_is_full_ends_it_with_what_is_whole(tmp_path, monkeypatch):
    write, count = member_store.MemberStore._write, []

    def full(self, array, first, values):
        count.append(1)
        if len(count) > 30:
            raise OSError(28, "No space left on device")
        write(self, array, first, values)

    with monkeypatch.context() as patch:
        patch.setattr(member_store.MemberStore, "_write", full)
        with pytest.warns(RuntimeWarning, match="finished members: save_to=.*No space left on device"):
            part = solve(tmp_path / "run.zarr")
    assert part.success.sum() == 40
    same(solve(tmp_path / "run.zarr"), solve())


def other(path):
    path.mkdir()
    (path / "thesis.txt").write_text("mine")


@pytest.mark.parametrize(
    ("before", "others", "words"),
    [
        (other, {}, "exists already"),
        (solve, {"step": 0.02, "save_every": 30}, "holds another run"),
        (solve, {"problem": kd.systems.kepler(0.5)}, "holds another run"),
        (lambda path: kd.solve(kd.systems.kepler(), SPAN, step=0.1, save_to=path), {}, "holds another run"),
        (None, {"path": 3}, "is not a path"),
        (None, {"path": "no/such/folder.zarr"}, "folder that does not exist"),
        (None, {"checkpoint": "kept"}, "both given"),
        (
            None,
            {"problem": lambda x, params: -params[0] * x, "args": {"energy": [1.0, 2.0]}, "begin": ([[1.0]], [[0.0]])},
            None,
        ),
        (
            None,
            {"problem": lambda x, params: -params[0] * x, "args": {"message": [1.0, 2.0]}, "begin": ([[1.0]], [[0.0]])},
            "uses for something else",
        ),
    ],
)
def test_folders_that_cannot_be_are_refused(before, others, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if before is not None:
        before(tmp_path / "run.zarr")
    there = sorted(tmp_path.rglob("*"))
    if words is None:
        solve(**{"path": tmp_path / "run.zarr", **others})
        return
    with pytest.raises(ArgumentError, match=words):
        solve(**{"path": tmp_path / "run.zarr", **others})
    assert sorted(tmp_path.rglob("*")) == there


def test_more_than_memory_holds_goes_to_disk(tmp_path, monkeypatch):
    monkeypatch.setattr("kickdrift.scale.prepared.free_bytes", lambda: 20_000.0)
    monkeypatch.setattr(chunks, "_BYTES", 10_000)
    with pytest.raises(ArgumentError, match=r"give save_to='run\.zarr'"):
        solve()
    assert solve(tmp_path / "run.zarr").success.all()


def test_a_group_that_was_half_made_is_made_anew(tmp_path, monkeypatch):
    def killed(self):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(member_store.MemberStore, "_commit", killed)
        with pytest.raises(KeyboardInterrupt):
            solve(tmp_path / "run.zarr")
    same(solve(tmp_path / "run.zarr"), solve())


def test_two_at_once_are_refused(tmp_path, monkeypatch):
    begin, said = member_store.MemberStore.begin, []

    def meanwhile(self, *arguments):
        begin(self, *arguments)
        monkeypatch.setattr(member_store.MemberStore, "begin", begin)
        with pytest.raises(ArgumentError, match="in use by a run of this process"):
            solve(tmp_path / "run.zarr")
        said.append(1)

    monkeypatch.setattr(member_store.MemberStore, "begin", meanwhile)
    assert solve(tmp_path / "run.zarr").success.all()
    assert said


@pytest.fixture
def cluster():
    distributed = pytest.importorskip("distributed")
    options = {"threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
    with distributed.LocalCluster(n_workers=2, **options) as made, distributed.Client(made) as client:
        yield client


@pytest.mark.filterwarnings("ignore")
@pytest.mark.usefixtures("small")
def test_a_cluster_that_loses_a_worker_writes_nothing_twice(cluster, tmp_path):
    from distributed import WorkerPlugin

    class Plugin(counting_writes.Counting, WorkerPlugin):
        pass

    log = tmp_path / "log"
    cluster.register_plugin(Plugin(log, "v/c/4/0/0"))
    stored = solve(tmp_path / "run.zarr", executor=cluster)
    assert (tmp_path / "log.died").exists()
    counts = counting_writes.chunks_written(log)
    assert set(counts.values()) == {1}
    assert counting_writes.chunks_there(tmp_path / "run.zarr") - {"time/c/0", "space/c/0"} <= set(counts)
    same(stored, solve())


@pytest.mark.filterwarnings("ignore")
def test_a_cluster_without_workers_is_said(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr(executors, "_patience", lambda: 0.5)
    monkeypatch.setattr(executors, "_LOOK_SECONDS", 0.1)
    submit, count = executors._submitted, []

    def leaving(executor, chunk):
        count.append(1)
        if len(count) == 3:
            cluster.cluster.scale(0)
            cluster.sync(cluster.cluster._correct_state)
        return submit(executor, chunk)

    monkeypatch.setattr(executors, "_submitted", leaving)
    with pytest.warns(RuntimeWarning, match=r"finished members: .*no workers left, and none has joined for 0\.5 s"):
        part = solve(tmp_path / "run.zarr", executor=cluster)
    assert not part.success.all()
    with pytest.raises(ArgumentError, match="no workers left"):
        solve(tmp_path / "run.zarr", executor=cluster)
    with ThreadPoolExecutor(2) as workers:
        same(solve(tmp_path / "run.zarr", executor=workers), solve())


def test_chunks_along_time_are_as_long_as_each_other(tmp_path, monkeypatch):
    monkeypatch.setattr(member_store, "_CHUNK", 150 * 5 * 2 * 8)
    stored = solve(tmp_path / "run.zarr")
    assert stored.x.shape[1] == 6
    assert stored.x.chunks[1] == 3  # and not 5, of which four of the second chunk would hold nothing
    same(stored, solve())


def test_arrays_on_disk_are_indexed_as_those_of_numpy(tmp_path):
    stored = solve(tmp_path / "run.zarr")
    whole = np.asarray(stored.x)
    mask = np.arange(len(whole)) % 3 == 0
    keys = [
        3,
        -1,
        np.int64(2),
        ...,
        slice(None, None, -1),
        slice(7, 2, -2),
        slice(5, 2),
        slice(2, 5, 2),
        mask,
        [4, -1, 1],
        [],
    ]
    for key in [
        *keys,
        (2, slice(None, None, -1), 0),
        (slice(3, None, -1), -1),
        (..., 1),
        ([1, 2], slice(None, None, -1)),
        (),
    ]:
        assert np.array_equal(stored.x[key], whole[key]), key
    assert np.array_equal(list(stored.x), whole)
    for key in (10**6, -(10**6), 1.5, "a", None, (0, 0, 0, 0), ([1], [1]), mask[:3], [10**6], [[1]], slice("a")):
        with pytest.raises(ArgumentError, match=r"of an array on disk .* read everything with \[:\]"):
            stored.x[key]


@pytest.mark.parametrize("problem", [None, kd.FirstOrder(lambda y: -y)], ids=["kepler", "first order"])
def test_folders_are_loaded_as_what_was_returned(problem, tmp_path):
    x, v = starts(20)
    begin = (x, None if problem else v)
    options = {"problem": problem, "begin": begin} | ({"method": "rk4"} if problem else {})
    whole, stored = solve(**options), solve(tmp_path / "run.zarr", **options)
    loaded = kd.load(tmp_path / "run.zarr")
    same(loaded, whole)
    assert loaded.saved_to == stored.saved_to
    assert (loaded.about, loaded.wall_time, repr(loaded)) == (stored.about, stored.wall_time, repr(stored))
    assert loaded[3].x.tobytes() == whole[3].x.tobytes()
    same(solve(tmp_path / "run.zarr", **options), whole)


def test_folders_of_runs_that_have_not_ended_are_no_solutions(tmp_path):
    solve(tmp_path / "run.zarr")
    (tmp_path / "run.zarr" / "solution.npz").unlink()
    with pytest.raises(FileFormatError, match="repeat the call"):
        kd.load(tmp_path / "run.zarr")
    with pytest.raises(FileFormatError, match="a folder without"):
        kd.load(tmp_path)


@pytest.mark.parametrize("name", ["step/c/0", "message/c/0", "last/c/0", "status/c/0", "x/c/0/0"])
@pytest.mark.parametrize("content", [b"", b"{}", b"\xff\x00\x01"])
def test_a_damaged_folder_is_said_to_be(name, content, tmp_path):
    run = partial(
        kd.solve_ensemble, kd.systems.pendulum(), (0.0, 1.0), [0.1, 0.2], step=0.1, save_to=tmp_path / "run.zarr"
    )
    run()
    (tmp_path / "run.zarr" / name).write_bytes(content)
    with pytest.raises(FileFormatError, match=r"run\.zarr.* (damaged|cannot be read)"):
        np.asarray(run().x)


def test_a_flipped_bit_on_disk_is_an_error(tmp_path):
    path = tmp_path / "run.zarr"
    kd.solve_ensemble(kd.systems.pendulum(), (0.0, 1.0), [0.1, 0.2], step=0.1, save_to=path)
    chunk = path / "x" / "c" / "0" / "0"
    damaged = bytearray(chunk.read_bytes())
    damaged[11] ^= 4
    chunk.write_bytes(damaged)
    with pytest.raises(FileFormatError, match=r"run\.zarr.* cannot be read"):
        np.asarray(kd.load(path).x)

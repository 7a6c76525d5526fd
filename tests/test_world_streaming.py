"""Recordings that go to disk while the world goes on: xarray reads them at any moment."""

import signal

import numpy as np
import pytest
import xarray as xr
from killing import killed_after
from test_world_checkpoints import STEP, pile, run
from typer.testing import CliRunner

import kickdrift as kd
from kickdrift.cli.app import app
from kickdrift.engine import checkpoints, zarr_store
from kickdrift.world.recordings import recorded_run

APPEND, WRITE = (zarr_store.ZarrStore, "append"), (checkpoints.Checkpoints, "write")


@pytest.fixture(autouse=True)
def _small_chunks(monkeypatch):
    monkeypatch.setattr(zarr_store, "_CHUNK", 8 * 8 * 6 * 4)  # 8 rows of the orientations of six bodies


def same(path, whole):
    data, wanted = xr.open_zarr(path).load(), whole.to_xarray()
    for name in (*wanted.data_vars, *wanted.coords):
        assert np.array_equal(data[name], wanted[name]), name
        assert data[name].dims == wanted[name].dims
        assert data[name].attrs.get("units") == wanted[name].attrs.get("units")
        assert data[name].attrs.get("unit_in_words") == wanted[name].attrs.get("unit_in_words")
    for name, values in whole.derived.items():
        assert np.array_equal(data[name.replace(" ", "_")], values), name
    assert data.attrs["status"] == whole.status.name


@pytest.mark.parametrize("others", [{}, {"save_every": None}, {"duration": 0.5, "save_every": 1000}])
def test_what_goes_to_disk_is_what_would_be_kept(others, tmp_path):
    whole, streamed = run(pile(), **others), run(pile(), **others, save_to=tmp_path / "run.zarr")
    same(tmp_path / "run.zarr", whole)
    assert streamed.saved_to == str(tmp_path / "run.zarr")
    for name in ("t", "x", "v", "orientation", "angular_velocity", "energy"):
        assert np.array_equal(getattr(streamed, name), getattr(whole, name)[[0, -1]]), name
    assert np.array_equal(streamed.to_xarray().orientation, whole.orientation)
    assert streamed.message == whole.message
    assert f"all states are in {streamed.saved_to!r}" in streamed.report()
    with pytest.raises(kd.KickdriftError, match=r"rows in .*run\.zarr"):
        streamed(0.1)


def test_xarray_reads_it_meanwhile_and_memory_holds_a_chunk(tmp_path, monkeypatch):
    append, seen = zarr_store.ZarrStore.append, []

    def watched(self, rows, attributes):
        append(self, rows, attributes)
        data = xr.open_zarr(tmp_path / "run.zarr")
        seen.append((data.sizes["time"], len(rows["time"]), data.attrs["status"]))

    monkeypatch.setattr(zarr_store.ZarrStore, "append", watched)
    run(pile(), save_to=tmp_path / "run.zarr")
    assert seen == [*((8 * k, 8, "RUNNING") for k in (1, 2, 3)), (27, 3, "COMPLETED")]


@pytest.mark.parametrize(("function", "after"), [(APPEND, 0), (APPEND, 2), (WRITE, 0), (WRITE, 2)])
def test_a_world_that_was_killed_goes_on_in_its_folder(function, after, tmp_path, monkeypatch):
    with killed_after(after, *function, monkeypatch):
        run(pile(), tmp_path / "kept", save_to=tmp_path / "run.zarr")
    written, append = [], zarr_store.ZarrStore.append
    with monkeypatch.context() as patch:
        patch.setattr(zarr_store.ZarrStore, "append", lambda self, *a: written.append(self.rows) or append(self, *a))
        on = run(pile(), tmp_path / "kept", save_to=tmp_path / "run.zarr")
    whole = run(pile())
    same(tmp_path / "run.zarr", whole)
    assert ("It resumed from step" in on.message) == (after > 0)
    assert np.array_equal(on.x, whole.x[[0, -1]])
    if function is WRITE and after == 2:
        assert written[0] == 8  # the checkpoint is at step 100, of row 15


def test_a_world_goes_on_to_a_later_end_and_back_to_an_earlier_one(tmp_path):
    for duration in (3.0, 4.0, 2.5):
        run(pile(), tmp_path / "kept", duration, save_to=tmp_path / "run.zarr", checkpoint_keep=None)
        same(tmp_path / "run.zarr", run(pile(), None, duration))


def test_an_end_before_the_end_is_written(tmp_path, monkeypatch):
    def ctrl_c(self, *arguments):
        drain(self, *arguments)
        if self.count == 16:
            signal.raise_signal(signal.SIGINT)

    drain = recorded_run.StreamedRecordingRows.drain
    monkeypatch.setattr(recorded_run.StreamedRecordingRows, "drain", ctrl_c)
    part = run(pile(), save_to=tmp_path / "run.zarr")
    assert part.status is kd.Outcome.INTERRUPTED
    data = xr.open_zarr(tmp_path / "run.zarr")
    assert data.attrs["status"] == "INTERRUPTED"
    assert np.array_equal(data.x, run(pile()).x[:16])


def test_a_disk_that_is_full_ends_it_with_what_is_whole(tmp_path, monkeypatch):
    append = zarr_store.ZarrStore.append

    def full(self, *arguments):
        if self.rows == 16:
            raise kd.core.errors.FileFormatError("No space left on device.")
        append(self, *arguments)

    monkeypatch.setattr(zarr_store.ZarrStore, "append", full)
    part = run(pile(), save_to=tmp_path / "run.zarr")
    assert part.status is kd.Outcome.NOT_WRITTEN
    assert part.n_steps == 23 * 7
    assert np.array_equal(xr.open_zarr(tmp_path / "run.zarr").x, run(pile()).x[:16])


@pytest.mark.parametrize(
    ("others", "words"),
    [
        ({"save_to": 3}, "is not a path"),
        ({"save_to": "run.zarr"}, "holds this run"),
        ({"save_to": "run.zarr", "step": STEP / 2}, "holds another run"),
        ({"save_to": "no/such.zarr"}, "folder that does not exist"),
        ({"checkpoint": "kept"}, "another save_to"),
        ({"save_to": "other.zarr", "checkpoint": "kept", "save_every": 8}, "another save_every"),
    ],
)
def test_folders_that_cannot_be_are_refused(others, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run(pile(), "kept", 0.5, save_to="run.zarr")
    with pytest.raises(kd.ArgumentError, match=words):
        run(pile(), duration=0.5, **others)


def test_two_runs_at_once_in_a_folder_are_refused(tmp_path, monkeypatch):
    append, said = zarr_store.ZarrStore.append, []

    def meanwhile(self, *arguments):
        append(self, *arguments)
        for folder, words in (("kept", "checkpoint=.* in use"), (None, "save_to=.* in use")):
            with pytest.raises(kd.ArgumentError, match=words):
                run(pile(), folder and tmp_path / folder, save_to=tmp_path / "run.zarr")
        said.append(1)

    monkeypatch.setattr(zarr_store.ZarrStore, "append", meanwhile)
    run(pile(), tmp_path / "kept", save_to=tmp_path / "run.zarr")
    assert len(said) == 4


@pytest.mark.parametrize("target", ["kepler", "bouncing-disk"])
def test_the_command_line_sends_states_to_disk_and_goes_on(target, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(checkpoints, "_FIRST", 40)
    monkeypatch.setattr(checkpoints, "_SECONDS", 0.0)
    command = ["run", target, "--duration", "2.0", "--step", "0.01", "--save-every", "3"]
    kept = ["--checkpoint", "kept", "--save-to", "run.zarr"]
    with killed_after(2, checkpoints.Checkpoints, "write", monkeypatch):
        CliRunner().invoke(app, [*command, *kept])
    result = CliRunner().invoke(app, [*command, *kept])
    assert result.exit_code == 0, result.output
    assert "written: run.zarr" in result.stdout
    assert "It resumed from step" in result.stdout
    assert CliRunner().invoke(app, [*command, "--save-to", "whole.zarr", "--quiet"]).output == ""
    assert xr.open_zarr("run.zarr").load().equals(xr.open_zarr("whole.zarr").load())
    assert xr.open_zarr("run.zarr").sizes["time"] == 68
    assert {path.name for path in tmp_path.iterdir()} == {"kept", "run.zarr", "whole.zarr"}
    again = CliRunner().invoke(app, [*command, "--save-to", "run.zarr"])
    assert again.exit_code == 2
    assert "holds this run" in again.stderr


def looped(world, count=50, **options):
    with world.record(**options) as recording:
        for _ in range(count):
            world.step(STEP)
    return recording


@pytest.mark.parametrize("every", [1, 4])
def test_a_loop_of_ones_own_goes_to_disk(every, tmp_path):
    whole = looped(pile(), save_every=every)
    streamed = looped(pile(), save_every=every, save_to=tmp_path / "run.zarr")
    same(tmp_path / "run.zarr", whole)
    for name in ("t", "x", "v", "orientation", "angular_velocity", "energy"):
        assert np.array_equal(getattr(streamed, name), getattr(whole, name)[[0, -1]]), name
    assert (streamed.status, streamed.n_steps) == (whole.status, whole.n_steps)
    with pytest.raises(kd.ArgumentError, match="name another folder"):
        looped(pile(), save_to=tmp_path / "run.zarr")


def sheets():
    world = kd.World()
    for name, x in (("gone", 0.0), ("kept", 2.0)):
        world.add_cloth_grid((1.0, 1.0), (3, 3), position=(x, 0, 1), name=name)
    return world


def test_what_is_on_disk_of_a_cloth_that_was_removed_ends_then(tmp_path):
    recordings = []
    for options in ({}, {"save_to": tmp_path / "run.zarr"}):
        world = sheets()
        with world.record(**options) as recording:
            world.advance(STEP, 2)
            world.remove_cloth(world.cloth("gone"))
            world.advance(STEP, 2)
        recordings.append(recording)
    same(tmp_path / "run.zarr", recordings[0])
    particles = xr.open_zarr(tmp_path / "run.zarr").particles.values
    assert np.isfinite(particles[:3]).all()
    assert np.isnan(particles[3:, :9]).all()
    assert np.isfinite(particles[3:, 9:]).all()
    assert np.array_equal(recordings[1].cloth("kept"), recordings[0].cloth("kept")[[0, -1]])


def test_a_cloth_that_has_no_columns_on_disk_is_refused_again(tmp_path):
    world, made = sheets(), []

    def growing():
        with world.record(save_every=2, save_to=tmp_path / "run.zarr") as recording:
            made.append(recording)
            world.advance(STEP, 3)
            world.add_cloth_grid((1.0, 1.0), (4, 4), name="late")
            world.step(STEP)

    with pytest.raises(kd.ArgumentError, match="a cloth was added"):
        growing()
    assert made[0].particles.shape == (2, 18, 3)
    assert [cloth.name for cloth in made[0].appearance.cloths] == ["gone", "kept"]


def test_errors_in_a_loop_leave_the_rows_before_them(tmp_path, monkeypatch):
    made = []

    def growing(world):
        with world.record(save_to=tmp_path / "run.zarr") as recording:
            made.append(recording)
            for _ in range(10):
                world.step(STEP)
            world.add_sphere(radius=0.1, mass=1.0, position=(0, 0, 9))
            world.step(STEP)

    with pytest.raises(kd.ArgumentError, match="add it before the recording"):
        growing(pile())
    assert made[0].status is kd.Outcome.FAILED
    assert xr.open_zarr(tmp_path / "run.zarr").time.size == 11

    def full(*_):
        raise kd.core.errors.FileFormatError("the disk is full")

    monkeypatch.setattr(zarr_store.ZarrStore, "append", full)
    recording = looped(pile(), 3, save_to=tmp_path / "other.zarr")
    assert recording.status is kd.Outcome.NOT_WRITTEN
    assert "the disk is full" in recording.message

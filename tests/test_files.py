"""Files: written whole or not at all, with the mode that they had; read if they are files, and of a size that can be."""

import os
import re
import stat
import zipfile

import numpy as np
import pytest
from typer.testing import CliRunner

import kickdrift as kd
from kickdrift.cli.app import app
from kickdrift.cli.bodies_table import read_text
from kickdrift.core import archive, room
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.core.files import written


@pytest.fixture(scope="module")
def falling():
    world = kd.World()
    world.add_sphere(0.1, position=(0, 0, 3))
    return world.run(0.1, 1 / 60)


def leftovers(folder):
    return sorted(path.name for path in folder.iterdir())


WRITERS = {
    "npz": lambda falling, path: falling.save(path),
    "png": lambda falling, path: falling.plot(path),
    "gif": lambda falling, path: falling.animate(path),
}


@pytest.mark.parametrize("ending", WRITERS)
def test_a_file_is_replaced_whole_and_keeps_its_mode(ending, falling, small_pictures, tmp_path):
    path = tmp_path / f"a.{ending}"
    path.write_text("before")
    path.chmod(0o640)
    WRITERS[ending](falling, path)
    assert path.read_bytes()[:6] != b"before"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert leftovers(tmp_path) == [path.name]


@pytest.mark.parametrize("ending", WRITERS)
def test_what_fails_half_way_leaves_what_was_there(ending, falling, small_pictures, tmp_path, monkeypatch):
    path = tmp_path / f"a.{ending}"
    path.write_text("before")

    def fail(*_, **__):
        for partial in set(tmp_path.iterdir()) - {path}:
            partial.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", fail)
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", fail)
    monkeypatch.setattr("PIL.Image.Image.save", fail)
    with pytest.raises(FileFormatError, match="No space left on device"):
        WRITERS[ending](falling, path)
    assert path.read_text() == "before"
    assert leftovers(tmp_path) == [path.name]


def test_new_files_have_the_mode_that_the_process_gives(falling, tmp_path):
    before = os.umask(0o027)
    try:
        path = falling.save(tmp_path / "a.npz")
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


@pytest.mark.parametrize("name", ["orbit", "orbit.kd", "orbit.npz"])
def test_a_file_is_read_by_the_name_by_which_it_was_written(tmp_path, name):
    sol = kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1)
    assert sol.save(tmp_path / name).suffix == ".npz"
    assert np.array_equal(kd.load(tmp_path / name).x, sol.x)
    with pytest.raises(kd.KickdriftError, match="cannot be read"):
        kd.load(tmp_path / "other")


def test_two_writers_at_once_have_files_of_their_own_and_an_error_leaves_none(tmp_path):
    target = tmp_path / "a.npz"
    with written(target) as one, written(target) as other:
        assert one != other
        one.write_bytes(b"one")
        other.write_bytes(b"other")
    assert target.read_bytes() == b"one"
    with pytest.raises(IsADirectoryError), written(target) as partial:
        tmp_path.write_text(str(partial.write_bytes(b"half")))
    assert target.read_bytes() == b"one"
    assert leftovers(tmp_path) == ["a.npz"]


READERS = {"npz": kd.load, "npz of a world": kd.load_world, "xml": kd.load_robot, "toml": read_text}


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
@pytest.mark.parametrize("reader", READERS)
def test_a_pipe_is_no_file(reader, tmp_path):
    if reader == "xml":
        pytest.importorskip("mujoco", reason="robots need MuJoCo's parser")
    path = tmp_path / f"a.{reader[:4].strip()}"
    os.mkfifo(path)
    with pytest.raises(FileFormatError, match="it is a pipe, a socket or a device"):
        READERS[reader](path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_what_is_no_file_is_not_replaced(falling, small_pictures, tmp_path):
    os.mkfifo(tmp_path / "a.png")
    with pytest.raises(FileFormatError, match="it is a pipe, a socket or a device"):
        falling.plot(tmp_path / "a.png")
    assert stat.S_ISFIFO((tmp_path / "a.png").stat().st_mode)


@pytest.mark.parametrize("read", [kd.load, kd.load_world])
def test_a_file_that_swells_is_not_read(read, tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "_LARGE", 1 << 22)
    path = tmp_path / "a.npz"
    np.savez_compressed(path, x=np.zeros(1 << 20))
    with zipfile.ZipFile(path) as members:
        assert sum(member.file_size for member in members.infolist()) > 100 * path.stat().st_size
    with pytest.raises(FileFormatError, match="more than 100 times its size on disk"):
        read(path)


def test_what_is_ours_and_would_swell_is_written_so_that_it_can_be_read(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "_LARGE", 1 << 16)
    monkeypatch.setattr(archive, "_MOST_TIMES", 10)
    world = kd.World(gravity=(0, 0, 0))
    for k in range(20):
        world.add_sphere(0.1, position=(k, 0, 0))
    still = world.run(2.0, 1 / 60)
    again = kd.load(still.save(tmp_path / "still.npz"))
    assert np.array_equal(again.x, still.x)
    assert (tmp_path / "still.npz").stat().st_size > 1 << 16


def test_what_cannot_be_kept_is_refused_before_it_is_reckoned(tmp_path, monkeypatch):
    monkeypatch.setattr(room, "free_bytes", lambda: 2.0**20)
    world = kd.World()
    world.add_sphere(0.1)
    for run in (
        lambda **kept: world.run(1000.0, 0.01, **kept),
        lambda **kept: kd.solve(lambda x: -x, (0.0, 1000.0), x0=np.ones(3), v0=np.zeros(3), step=0.01, **kept),
    ):
        with pytest.raises(
            ArgumentError, match=r"save_every=1 keeps all 100001 steps, .* room for .* give save_every="
        ) as said:
            run(save_every=1)
        least = int(re.search(r"give save_every=(\d+)", str(said.value))[1])
        with pytest.raises(ArgumentError, match=rf"save_every={least // 2} keeps \d+ of 100001 steps"):
            run(save_every=least // 2)
        assert run(save_every=least).success
    assert world.n_steps == 100_000
    result = CliRunner().invoke(app, ["run", "pendulum", "--duration", "10000", "--step", "0.01", "--save-every", "1"])
    assert result.exit_code != 0
    assert "save_every=1 keeps all" in result.stderr


def test_the_memory_that_is_free_is_known():
    assert room.free_bytes() > 2**24

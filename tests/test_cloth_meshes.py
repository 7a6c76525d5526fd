"""Meshes of cloths from files, and to files."""

import sys

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.world.deformables.mesh import cloth_mesh, flattened

trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")

SQUARE = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 5 5 5
vt 0 0
vt 1 1
vn 0 0 1
vn 0 1 0
f 1/1/1 2/2/1 3/1/1
f 1/2/2 3/2/2 4/1/2
"""


def test_a_mesh_of_a_file_becomes_a_cloth_whose_triangles_hang_together(tmp_path):
    path = tmp_path / "square.obj"
    path.write_text(SQUARE)
    vertices, triangles = kd.load_mesh(path)
    assert vertices.shape == (4, 3)  # the fifth is in no triangle; corners are repeated for other normals
    assert np.ptp(vertices, axis=0) == pytest.approx([1, 1, 0])
    sheet = kd.World().add_cloth(vertices, triangles, density=0.3)
    assert sheet.mass.sum() == pytest.approx(0.3)


@pytest.mark.parametrize("form", ["obj", "glb"])
def test_recordings_become_sequences_of_meshes_that_are_read_again(tmp_path, form):
    world = kd.World()
    world.add_cloth_grid((1.0, 1.0), (3, 3), position=(0, 0, 5))
    sheet = world.add_cloth_grid((0.7, 0.5), (4, 5), name="flag")
    recording = world.run(0.1, 1 / 60, progress=False)
    folder = recording.save_meshes(tmp_path / "frames", "flag", form=form)
    files = sorted(folder.iterdir())
    assert [file.name for file in files] == [f"flag-{row:06d}.{form}" for row in range(7)]
    for file, vertices in zip(files, recording.cloth("flag"), strict=True):
        mesh = kd.load_mesh(file)
        assert len(mesh.triangles) == len(sheet.triangles)
        assert mesh.vertices[mesh.triangles] == pytest.approx(vertices[sheet.triangles], abs=1e-6)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("none.obj", None, "is not a file"),
        ("empty.obj", "nothing", "no triangles"),
        ("odd.glb", "glTF?", "cannot be read"),
    ],
)
def test_files_that_no_mesh_is_in(tmp_path, name, content, words):
    path = tmp_path / name
    if content is not None:
        path.write_text(content)
    with pytest.raises(kd.KickdriftError, match=words):
        kd.load_mesh(path)


def test_what_cannot_be_written_is_refused(tmp_path, monkeypatch):
    world = kd.World()
    world.add_cloth_grid((1.0, 1.0), (3, 3))
    recording = world.run(0.02, 1 / 60, progress=False)
    with pytest.raises(kd.KickdriftError, match="form='fbx'"):
        recording.save_meshes(tmp_path, form="fbx")
    with pytest.raises(kd.KickdriftError, match="which"):
        recording.save_meshes(tmp_path, 3)
    (tmp_path / "file").write_text("")
    with pytest.raises(kd.KickdriftError, match="cannot be written"):
        recording.save_meshes(tmp_path / "file")
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(kd.KickdriftError, match=r"kickdrift\[meshes\]"):
        kd.load_mesh("any.obj")


def test_frames_of_an_earlier_recording_are_replaced(tmp_path):
    world = kd.World()
    world.add_cloth_grid(vertices=(3, 3), name="flag")
    world.run(duration=0.5, step=1 / 60).save_meshes(tmp_path, "flag")
    (tmp_path / "flag-notes.obj").write_text("kept")
    world.run(duration=0.1, step=1 / 60).save_meshes(tmp_path, "flag")
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == [f"flag-{row:06d}.obj" for row in range(7)] + ["flag-notes.obj"]


def test_a_recording_without_cloth_has_no_meshes(tmp_path):
    recording = kd.World().run(duration=0.1, step=0.1)
    with pytest.raises(kd.UnknownNameError, match="no cloth, rope or soft body"):
        recording.save_meshes(tmp_path)


@pytest.mark.parametrize("warp", [(1, 0, 0), (1, 2, 3)])
def test_warp_and_weft_do_not_depend_on_the_first_corners_of_triangles(warp):
    vertices = np.random.default_rng(0).normal(size=(3, 3))
    normal = np.asarray(warp, dtype=float)
    sides = vertices[:2] - vertices[2]
    vertices[:2] = vertices[2] + sides - np.outer(sides @ normal, normal) / (normal @ normal)
    first = flattened(cloth_mesh(vertices, [[0, 1, 2]]), normal)[1]
    second = flattened(cloth_mesh(vertices, [[1, 2, 0]]), normal)[1]
    assert first == pytest.approx(second, abs=1e-12)

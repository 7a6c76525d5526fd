"""Meshes in files of other programs, by trimesh: those that cloths are made of, and those that cloths become."""

import os
from glob import escape
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, FileFormatError, missing_extra
from kickdrift.world.recordings.recording import Recording

FORMS = "obj", "glb"


class Mesh(NamedTuple):
    """Triangles, as `World.add_cloth` takes them.

    Attributes
    ----------
    vertices : (N, 3) array
        In the unit of the file; `World.add_cloth` takes metres.
    triangles : (M, 3) array
        Indices of vertices.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]


def load_mesh(path: str | Path) -> Mesh:
    """Read the triangles of an OBJ, glTF, PLY or STL file, for a cloth: ``world.add_cloth(*kd.load_mesh("shirt.obj"))``.

    All meshes of a file become one. Coincident vertices are merged, since files repeat those whose normals or textures differ;
    unused vertices are left out.

    Parameters
    ----------
    path : path

    Returns
    -------
    Mesh

    Raises
    ------
    FileFormatError
        If there is no such file, or no triangles in it.
    MissingExtraError
        If trimesh is not installed.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> import kickdrift as kd
    >>> path = Path(mkdtemp()) / "triangle.obj"
    >>> lines = "v 0 0 0", "v 1 0 0", "v 0 1 0", "f 1 2 3"
    >>> _ = path.write_text(chr(10).join(lines))
    >>> kd.load_mesh(path).triangles
    array([[0, 1, 2]])
    """
    trimesh = _trimesh("kickdrift.load_mesh")
    if not isinstance(path, str | os.PathLike):
        raise ArgumentError(f"path={path!r} is not a path; give a string such as 'shirt.obj', or a pathlib.Path.")
    if not Path(path).is_file():
        raise FileFormatError(f"path={str(path)!r} is not a file; give the path of a mesh.")
    try:
        mesh = trimesh.load_mesh(str(path), process=False)
    except Exception as error:  # each reader has its own
        raise FileFormatError(
            f"path={str(path)!r} cannot be read as a mesh: {type(error).__name__}: {error}."
        ) from None
    if len(mesh.faces) == 0:
        raise FileFormatError(f"path={str(path)!r} has no triangles; give a file that has some.")
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    mesh.remove_unreferenced_vertices()
    return Mesh(np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64))


def save_meshes(recording: Recording, folder: str | Path, which: str | int, form: str) -> Path:
    """Write what is drawn of a cloth in each row of a recording to a file of its own; see `Recording.save_meshes`."""
    trimesh = _trimesh("Recording.save_meshes")
    if form not in FORMS:
        raise ArgumentError(f"form={form!r} must be one of {', '.join(map(repr, FORMS))}.")
    cloth = recording.drawn_cloth(which)
    target, name = Path(folder), cloth.name or cloth.kind.replace(" ", "-")
    try:
        target.mkdir(parents=True, exist_ok=True)
        for old in target.glob(f"{escape(name)}-{'[0-9]' * 6}.{form}"):
            old.unlink()
        for row, vertices in enumerate(recording.particles[:, cloth.first : cloth.last]):
            mesh = trimesh.Trimesh(*cloth.surface(vertices), process=False)
            mesh.export(str(target / f"{name}-{row:06d}.{form}"))
    except OSError as error:
        raise FileFormatError(
            f"folder={str(folder)!r} cannot be written: {error.strerror}; choose another one."
        ) from None
    return target


def _trimesh(feature: str) -> Any:
    try:
        import trimesh
    except ImportError:
        raise missing_extra(feature, "trimesh", "meshes") from None
    return trimesh

"""What files often have that MuJoCo refuses, made so that it does not: paths of packages, materials, inertias."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import FileFormatError

Floats = NDArray[np.float64]
Repair = Callable[[Any], None]

_PACKAGE = "package://"
_UNDEFINED = [np.nan, 0.0, 0.0, 0.0, 0.0, 0.0]
_NONE = 1e-12  # of the greatest moment of inertia


def find_packages(spec: Any, folder: Path, highest: Path) -> None:
    """Look for the files of packages in the folder of a robot and in those above it, up to the highest.

    Raises
    ------
    FileFormatError
        If one is only found above that.
    """
    for mesh in spec.meshes:
        if mesh.file.startswith(_PACKAGE):
            mesh.file = _in_package(mesh.file, folder, highest)


def drop_materials(spec: Any, notes: list[str]) -> None:
    """Take materials that there are not from geoms: nothing here looks at them."""
    known = {material.name for material in spec.materials}
    for geom in spec.geoms:
        if geom.material and geom.material not in known:
            notes.append(f"left out: material {geom.material!r}, which the file does not have")
            geom.material = ""


def _in_package(file: str, folder: Path, highest: Path) -> str:
    path = Path(file.removeprefix(_PACKAGE))
    inside = Path(*path.parts[1:])
    for above in (folder, *folder.parents):
        for candidate in (above / path, above / inside):
            if candidate.is_file():
                if not candidate.resolve().is_relative_to(highest):
                    raise FileFormatError(
                        f"{file!r} is in {str(above)!r}, which is not in {str(highest)!r}; if you trust the file, pass"
                        " folder=, a folder that contains all files that it may read."
                    )
                return str(candidate)
    return file


def mend_inertias(mujoco: Any, spec: Any, notes: list[str]) -> list[Repair]:
    """Make inertias that no body has such that MuJoCo compiles them.

    Returns
    -------
    list of callables
        What must be done to the compiled model, once there is one.
    """
    by_shapes = int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE)
    if spec.compiler.balanceinertia or int(spec.compiler.inertiafromgeom) == by_shapes:
        return []  # the file says what to do
    found = [_mend(mujoco, body, notes) for body in spec.bodies if body.explicitinertial]
    return [repair for repair in found if repair is not None]


def _mend(mujoco: Any, body: Any, notes: list[str]) -> Repair | None:
    inertia = _inertia(mujoco, body)
    moments = np.linalg.eigvalsh(inertia)
    if not np.isfinite(moments).all():
        return None
    if moments[0] <= _NONE * moments[2]:
        solid = [geom for geom in body.geoms if geom.contype or geom.conaffinity]
        if not solid or body.mass <= 0.0:
            return None
        notes.append(
            f"inertia of body {body.name!r} has a principal moment that is not positive; the inertia of its shapes is"
            " used, with the mass and centre from the file"
        )
        return _from_shapes(body)
    if moments[0] + moments[1] < moments[2]:
        notes.append(
            f"inertia of body {body.name!r} is impossible, with one principal moment above the sum of the others; it"
            " is kept"
        )
        return _kept(mujoco, body, inertia)
    return None


def _inertia(mujoco: Any, body: Any) -> Floats:
    """Return the inertia that a file gives to a body, (3, 3), in the body's axes."""
    xx, yy, zz, xy, xz, yz = body.fullinertia
    if np.isfinite(xx):
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    numbers = np.empty(9)
    mujoco.mju_quat2Mat(numbers, np.asarray(body.iquat))
    turn = numbers.reshape(3, 3)
    return np.asarray(turn @ np.diag(body.inertia) @ turn.T)


def _from_shapes(body: Any) -> Repair:
    name, mass, centre = body.name, float(body.mass), np.array(body.ipos)
    body.explicitinertial = False
    body.fullinertia = _UNDEFINED
    body.ipos = [np.nan, 0.0, 0.0]

    def repair(compiled: Any) -> None:
        row = compiled.body(name).id
        share = mass / compiled.body_mass[row]
        compiled.body_mass[row], compiled.body_ipos[row] = mass, centre
        compiled.body_inertia[row] *= share

    return repair


def _kept(mujoco: Any, body: Any, inertia: Floats) -> Repair:
    name, mean = body.name, float(np.trace(inertia)) / 3.0
    body.fullinertia = _UNDEFINED
    body.inertia, body.iquat = [mean] * 3, [1.0, 0.0, 0.0, 0.0]

    def repair(compiled: Any) -> None:
        row, moments, axes, turn = compiled.body(name).id, np.empty(3), np.empty(9), np.empty(4)
        mujoco.mju_eig3(moments, axes, turn, inertia.ravel())
        compiled.body_inertia[row], compiled.body_iquat[row] = moments, turn

    return repair

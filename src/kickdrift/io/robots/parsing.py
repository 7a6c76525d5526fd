"""MJCF and URDF texts through MuJoCo's parser and compiler."""

import re
import warnings
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, FileFormatError, missing_extra
from kickdrift.core.files import opened
from kickdrift.io.robots.confinement import check
from kickdrift.io.robots.mending import drop_materials, find_packages, mend_inertias
from kickdrift.world.shapes.hull import Hull

Floats = NDArray[np.float64]

# Of a URDF file, to have shapes that touch nothing; MuJoCo leaves them out by default.
_SHOWN = '<mujoco><compiler discardvisual="false"/></mujoco>'

_ROOT = re.compile(rb"<\s*(mujoco|robot)[\s>/]")


class Model(NamedTuple):
    """A robot as MuJoCo knows it, placed in the world at its reference pose.

    Attributes
    ----------
    mujoco, compiled, data : Any
        The package, its ``MjModel`` and the ``MjData`` that holds the reference pose.
    position, orientation : (3,) and (4,) array
        Of the file's axes in the world.
    is_urdf : bool
    hulls : dict
        Hulls of meshes that are made already, by their numbers; each with how many points it is of, 0 for all.
    """

    mujoco: Any
    compiled: Any
    data: Any
    position: Floats
    orientation: Floats
    is_urdf: bool
    hulls: dict[int, tuple[Hull, int]]

    def name(self, kind: str, index: int) -> str:
        """Return the name of a body, joint, geom, actuator or site; of one without, the kind and its number."""
        given: str = getattr(self.compiled, kind)(index).name
        return given or f"{kind} {index}"

    def named(self, kind: str, indices: Iterable[Any]) -> str:
        """List names."""
        return ", ".join(repr(self.name(kind, int(index))) for index in indices)

    def is_one_of(self, value: Any, *kinds: Any) -> bool:
        """Whether a number is one of MuJoCo's enumerations, which NumPy's numbers on the right do not equal."""
        return int(value) in map(int, kinds)

    def is_fixed(self, body: int) -> bool:
        """Whether a body is fixed to the world; numbers from ``nbody`` on are of bodies that move."""
        return body < self.compiled.nbody and bool(self.compiled.body_weldid[body] == 0)

    def point(self, point: Floats) -> Floats:
        """Take a point from the file's axes to the world's."""
        return self.position + self.direction(point)

    def direction(self, direction: Floats) -> Floats:
        """Take a direction from the file's axes to the world's."""
        result = np.empty(3)
        self.mujoco.mju_rotVecQuat(result, direction, self.orientation)
        return result

    def turn(self, quaternion: Floats) -> Floats:
        """Take an orientation from the file's axes to the world's."""
        return self.product(self.orientation, quaternion)

    def product(self, first: Floats, second: Floats) -> Floats:
        """Turn by the second quaternion, then by the first."""
        result = np.empty(4)
        self.mujoco.mju_mulQuat(result, first, second)
        return result

    def seen_from(self, body: int, point: Floats, turn: Floats) -> tuple[Floats, Floats]:
        """Take a place from the file's axes to those of a body at the reference pose."""
        back = self.data.xquat[body] * (1.0, -1.0, -1.0, -1.0)
        where = np.empty(3)
        self.mujoco.mju_rotVecQuat(where, point - self.data.xpos[body], back)
        return where, self.product(back, turn)

    def matrix(self, quaternion: Floats) -> Floats:
        """Return the (3, 3) matrix of a quaternion."""
        result = np.empty(9)
        self.mujoco.mju_quat2Mat(result, quaternion)
        return result.reshape(3, 3)


def parse(
    path: str | Path, floating: bool, position: Floats, orientation: Floats, folder: str | Path | None
) -> tuple[Model, list[str]]:
    """Read a file.

    Returns
    -------
    Model
    list of str
        Notes on what differs from the file.

    Raises
    ------
    MissingExtraError
        If MuJoCo is not installed.
    FileFormatError
        If there is no such file, or it is not MJCF or URDF that MuJoCo understands.
    ArgumentError
        For ``floating=True`` with a file that specifies floating bodies itself.
    """
    try:
        mujoco: Any = import_module("mujoco")
    except ImportError:
        raise missing_extra("kickdrift.load_robot", "mujoco", "robots") from None
    try:
        with opened(path) as file:
            content = file.read()
    except OSError as error:
        raise FileFormatError(f"path={str(path)!r} cannot be read: {error.strerror or error}.") from None
    except ValueError as error:
        raise FileFormatError(f"path={str(path)!r} names no file: {error}.") from None
    root = _ROOT.search(content)
    if root is None:
        raise FileFormatError(
            f"path={str(path)!r} is neither MJCF nor URDF: it has no element <mujoco> and none <robot>."
        )
    if floating and root[1] == b"mujoco":
        raise ArgumentError(
            f"floating=True is for URDF, which cannot specify whether its root is fixed; path={str(path)!r} is MJCF:"
            " add a <freejoint/> to its root."
        )
    notes: list[str] = []
    inside = Path(path).parent if folder is None else Path(folder)
    check(Path(path), content, inside)
    compiled = _compile(mujoco, Path(path), content, floating, inside, notes)
    data = mujoco.MjData(compiled)
    mujoco.mj_kinematics(compiled, data)
    return Model(mujoco, compiled, data, position, orientation, root[1] == b"robot", {}), notes


def _compile(mujoco: Any, path: Path, content: bytes, floating: bool, folder: Path, notes: list[str]) -> Any:
    """Compile a file, of a URDF file also what is for show, where MuJoCo can."""
    refused = (ValueError, RuntimeError, mujoco.FatalError)
    text = content.decode("utf-8", "replace")
    end = text.rfind("</robot>")
    if end >= 0 and "<mujoco" not in text:  # which says itself what it wants
        shown: list[str] = []
        try:
            spec = mujoco.MjSpec.from_string(text[:end] + _SHOWN + text[end:])
            compiled = _build(mujoco, spec, path, floating, folder, shown)
        except refused as error:
            notes.append(f"left out: visual geometry, which MuJoCo does not compile: {_reason(error)}")
        else:
            notes += shown
            return compiled
    try:
        return _build(mujoco, mujoco.MjSpec.from_file(str(path)), path, floating, folder, notes)
    except refused as error:
        raise FileFormatError(
            f"path={str(path)!r} is not a robot that MuJoCo {mujoco.__version__} can read: {_reason(error)}"
        ) from None


def _build(mujoco: Any, spec: Any, path: Path, floating: bool, folder: Path, notes: list[str]) -> Any:
    spec.modelfiledir = str(path.parent)
    spec.compiler.fusestatic = False  # keeps the names of bodies that are fixed to others
    if floating:
        _set_free(spec)
    find_packages(spec, path.resolve().parent, folder.resolve())
    drop_materials(spec, notes)
    repairs = mend_inertias(mujoco, spec, notes)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        compiled = spec.compile()
    notes += [f"MuJoCo says: {warning.message}" for warning in said if "texture" not in str(warning.message)]
    for repair in repairs:
        repair(compiled)
    return compiled


def _reason(error: Exception) -> str:
    return "; ".join(line.strip() for line in str(error).splitlines() if line.strip())


def _set_free(spec: Any) -> None:
    """Make roots without a joint float."""
    for body in spec.worldbody.bodies:
        if not body.joints:
            body.add_freejoint()

"""MJCF and URDF texts through MuJoCo's parser and compiler."""

import re
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, FileFormatError, missing_extra

Floats = NDArray[np.float64]

_ROOT = re.compile(rb"<\s*(mujoco|robot)[\s>/]")


class Model(NamedTuple):
    """A robot as MuJoCo knows it, placed in the world at its reference pose.

    Attributes
    ----------
    mujoco, compiled, data : Any
        The package, its ``MjModel`` and the ``MjData`` that holds the reference pose.
    position, orientation : (3,) and (4,) array
        Of the file's axes in the world.
    """

    mujoco: Any
    compiled: Any
    data: Any
    position: Floats
    orientation: Floats

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


def parse(path: str | Path, floating: bool, position: Floats, orientation: Floats) -> Model:
    """Read a file.

    Raises
    ------
    MissingExtraError
        If MuJoCo is not installed.
    FileFormatError
        If there is no such file, or it is no MJCF or URDF that MuJoCo understands.
    ArgumentError
        For ``floating=True`` with a file that says itself what floats.
    """
    try:
        mujoco: Any = import_module("mujoco")
    except ImportError:
        raise missing_extra("kickdrift.load_robot", "mujoco", "robots") from None
    try:
        root = _ROOT.search(Path(path).read_bytes())
    except OSError as error:
        raise FileFormatError(f"path={str(path)!r} cannot be read: {error.strerror or error}.") from None
    except ValueError as error:
        raise FileFormatError(f"path={str(path)!r} names no file: {error}.") from None
    if root is None:
        raise FileFormatError(
            f"path={str(path)!r} is neither MJCF nor URDF: it has no element <mujoco> and none <robot>."
        )
    if floating and root[1] == b"mujoco":
        raise ArgumentError(
            f"floating=True is for URDF, which cannot say whether its root is fixed; path={str(path)!r} is MJCF: give its"
            " root a <freejoint/>."
        )
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        spec.compiler.fusestatic = False  # keeps the names of bodies that are fixed to others
        if floating:
            _set_free(spec)
        compiled = spec.compile()
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        reason = "; ".join(line.strip() for line in str(error).splitlines() if line.strip())
        raise FileFormatError(
            f"path={str(path)!r} is no robot that MuJoCo {mujoco.__version__} understands: {reason}"
        ) from None
    data = mujoco.MjData(compiled)
    mujoco.mj_kinematics(compiled, data)
    return Model(mujoco, compiled, data, position, orientation)


def _set_free(spec: Any) -> None:
    """Let roots float that have no joint."""
    for body in spec.worldbody.bodies:
        if not body.joints:
            body.add_freejoint()

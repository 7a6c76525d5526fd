"""The interface of a kind of joint: a frozen record of its axes and their laws."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.core.rotations import cross
from kickdrift.world.argument_checks import direction
from kickdrift.world.joints.limits_motors_options import FREE, Axis, not_negative

Floats = NDArray[np.float64]
Axes = tuple[Axis, Axis, Axis]


class Geared(NamedTuple):
    """The data of a gear: rows of two joints, an axis of each, and the rates in the sum of rate x position that it holds."""

    joints: tuple[int, int]
    axes: tuple[int, int]
    rates: tuple[float, float]


class Placement(NamedTuple):
    """Anchors, axes and laws of a joint when it is created.

    Attributes
    ----------
    anchor_a, anchor_b : (3,) array
        Points of the bodies that it connects, in the world, m.
    frame : (3, 3) array
        Its axes 0, 1, 2 as columns, in the world.
    linear, angular : tuple of three Axis
        The laws along and about the axes.
    line : bool
        Whether axis 2 always points from one anchor to the other.
    length : float
        With `line`: distance of the anchors that counts as position zero, m. For a gear: the sum that it holds.
    cone : bool
        If all angular axes are open: whether angles are swing (axis 0) and twist (axis 2), or the rotation vector.
    principal : int
        The default axis: 0-2 linear, 3-5 angular; -1 for none.
    geared : Geared, optional
        For a gear, which has no anchors: the axes that it couples.
    """

    anchor_a: Floats
    anchor_b: Floats
    frame: Floats
    linear: Axes
    angular: Axes = (FREE, FREE, FREE)
    line: bool = False
    length: float = 0.0
    cone: bool = False
    principal: int = -1
    geared: Geared | None = None


@dataclass(frozen=True)
class Record(ABC):
    """A kind of joint with its parameters.

    Parameters
    ----------
    breaking_force, breaking_torque : float
        A joint breaks if its load, averaged over a step, exceeds this: N, N m.
    name : str, optional
        For `World.joint`; unique among joints.
    """

    breaking_force: float = field(default=inf, kw_only=True)
    breaking_torque: float = field(default=inf, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        not_negative("breaking_force", self.breaking_force, "N", infinite=True)
        not_negative("breaking_torque", self.breaking_torque, "N m", infinite=True)

    @abstractmethod
    def placement(self) -> Placement:
        """Return the frame of the joint and the laws of its axes.

        Raises
        ------
        ArgumentError
            For anchors and axes that are not vectors, axes of length zero and numbers of the wrong sign.
        """


def frame_of(name_x: str, x: ArrayLike, name_y: str, y: ArrayLike) -> Floats:
    """Return orthonormal axes as columns, (3, 3), given the directions of the first two.

    Raises
    ------
    ArgumentError
        For directions of length zero, or not at right angles to each other.
    """
    first, second = direction(name_x, x), direction(name_y, y)
    if abs(first @ second) > 1e-6:
        raise ArgumentError(f"{name_y}={y!r} and {name_x}={x!r} must be at right angles to each other.")
    second -= (first @ second) * first
    second /= np.linalg.norm(second)
    return np.column_stack((first, second, np.cross(first, second)))


def frame_along(z: Floats) -> Floats:
    """Return orthonormal axes as columns, (3, 3), whose third is the unit vector z."""
    x = cross(np.eye(3)[np.abs(z).argmin()], z)
    x /= np.sqrt(x @ x)
    return np.array((x, cross(z, x), z)).T

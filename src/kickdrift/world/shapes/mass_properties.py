"""Mass properties of shapes, and of bodies composed of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import real, reals
from kickdrift.core.errors import ArgumentError
from kickdrift.core.rotations import matrices
from kickdrift.world.argument_checks import vector

Array = NDArray[np.float64]

# Relative tolerance of inertias, for files with six digits.
_TOLERANCE = 1e-6

SMALLEST, LARGEST = 1e-15, 1e15  # m


class MassProperties(NamedTuple):
    """Mass properties of a shape of density 1.

    Attributes
    ----------
    volume : float
        m^3, and so its mass.
    centre : (3,) array
        Centre of mass in the shape's frame, m.
    inertia : (3, 3) array
        About the centre, in the shape's axes, for density 1: m^5.
    """

    volume: float
    centre: Array
    inertia: Array


class Mass(NamedTuple):
    """Mass of a body or of a part of one.

    Attributes
    ----------
    mass : float
        kg.
    centre : (3,) array
        Centre of mass, m.
    inertia : (3, 3) array
        About the centre of mass, in the axes that the centre is given in, kg m^2.
    """

    mass: float
    centre: Array
    inertia: Array


def placed(
    properties: MassProperties,
    position: ArrayLike = (0.0, 0.0, 0.0),
    orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
    *,
    density: float | None = None,
    mass: float | None = None,
) -> Mass:
    """Return the mass properties of a shape with a pose in a body.

    Parameters
    ----------
    properties : MassProperties
        Of the shape.
    position : (3,) array
        Origin of the shape's frame in the body, m.
    orientation : (4,) array
        Quaternion (w, x, y, z) that turns the shape's axes into the body's; any length but zero.
    density : float, optional
        kg/m^3.
    mass : float, optional
        kg; either this or the density is given.

    Raises
    ------
    ArgumentError
        If the density or mass is not positive and finite, if both or neither are given, or if a pose is not finite.
    """
    where = vector("position", position, 3)
    rotation = rotation_matrix(orientation)
    if (density is None) == (mass is None):
        raise ArgumentError(f"density={density!r} and mass={mass!r}: give exactly one of them.")
    if mass is not None:
        total = positive("mass", mass, "kg")
    elif density is not None:
        total = positive("density", density, "kg/m^3") * properties.volume
    inertia = total / properties.volume * (rotation @ properties.inertia @ rotation.T)
    return Mass(total, where + rotation @ properties.centre, inertia)


def combined(parts: Sequence[Mass]) -> Mass:
    """Return the mass properties of a body composed of parts, by the parallel axis theorem.

    Parameters
    ----------
    parts : sequence of Mass
        With centres and inertias in the same axes.

    Returns
    -------
    Mass
        Total mass, common centre of mass, and inertia about it.

    Raises
    ------
    ArgumentError
        If there are no parts, or if the inertia is physically impossible.
    """
    if not parts:
        raise ArgumentError("A body without shapes has no mass; give it a shape, or a mass and an inertia.")
    whole = summed(parts)
    return whole._replace(inertia=checked_inertia(whole.inertia))


def summed(parts: Sequence[Mass]) -> Mass:
    """Return the sum of parts as `combined` does, without checking the inertia."""
    masses = np.array([part.mass for part in parts])
    total = float(masses.sum())
    centre = masses @ np.array([part.centre for part in parts]) / total
    inertia = np.zeros((3, 3))
    for part in parts:
        arm = part.centre - centre
        inertia += part.inertia + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Mass(total, centre, inertia)


def checked_inertia(inertia: ArrayLike, argument: str = "inertia") -> Array:
    """Return an inertia as a symmetric (3, 3) array, if it is physically possible.

    Parameters
    ----------
    inertia : (3, 3) or (3,) array
        About the centre of mass, kg m^2; three numbers are the diagonal.
    argument : str
        Its name in messages.

    Raises
    ------
    ArgumentError
        If it is not finite, not symmetric, not positive definite, or if one principal moment is greater than the sum of
        the other two: each is the integral of the squares of two coordinates, so no body has such moments.
    """
    try:
        matrix = reals(inertia)
    except TypeError:
        raise ArgumentError(f"{argument}={inertia!r} must be three numbers, or (3, 3), in kg m^2.") from None
    if matrix.shape == (3,):
        matrix = np.diag(matrix)
    if matrix.shape != (3, 3):
        raise ArgumentError(
            f"{argument} has the shape {matrix.shape}; give (3, 3), or the three numbers of its diagonal."
        )
    if not np.isfinite(matrix).all():
        raise ArgumentError(f"{argument}={matrix.tolist()} is not finite; give every moment of inertia in kg m^2.")
    if np.abs(matrix - matrix.T).max() > _TOLERANCE * np.abs(matrix).max():
        raise ArgumentError(f"{argument}={matrix.tolist()} is not symmetric; give the same product of inertia twice.")
    matrix = 0.5 * (matrix + matrix.T)
    moments = np.linalg.eigvalsh(matrix)
    if not moments[0] > 0.0:
        raise ArgumentError(
            f"{argument} has the principal moments {_listed(moments)} kg m^2; all must be positive, "
            "or the body would turn without resistance; give it an extent in all directions."
        )
    if moments[2] > (moments[0] + moments[1]) * (1.0 + _TOLERANCE):
        raise ArgumentError(
            f"{argument} has the principal moments {_listed(moments)} kg m^2; none can exceed the sum of the other"
            " two; give the moments about the centre of mass."
        )
    return matrix


def rotation_matrix(orientation: ArrayLike) -> Array:
    """Return the (3, 3) matrix of a quaternion (w, x, y, z) of any length but zero; ArgumentError for others."""
    quaternion = vector("orientation", orientation, 4)
    size = np.sqrt(quaternion @ quaternion)
    if not 1e-100 < size < 1e100:
        raise ArgumentError(
            f"orientation={quaternion.tolist()} has norm {size:g} and is not a rotation; give a quaternion (w, x, y,"
            " z) of norm one."
        )
    return matrices(quaternion / size)


def extent(argument: str, value: float) -> float:
    """Return a length in m if it is in the supported range; ArgumentError if not. Its fifth power enters into inertias."""
    number = positive(argument, value, "m")
    if not SMALLEST <= number <= LARGEST:
        raise ArgumentError(f"{argument}={number:g} m is outside the supported range, {SMALLEST:g} to {LARGEST:g} m.")
    return number


def positive(argument: str, value: float, unit: str) -> float:
    """Return a number if it is positive and finite; ArgumentError if not."""
    try:
        number = real(value)
    except TypeError:
        raise ArgumentError(f"{argument}={value!r} is not a number; give a positive one, in {unit}.") from None
    if not 0.0 < number < np.inf:
        raise ArgumentError(f"{argument}={number:g} {unit} must be positive and finite.")
    return number


def _listed(moments: NDArray[np.floating[Any]]) -> str:
    return ", ".join(f"{moment:g}" for moment in moments)

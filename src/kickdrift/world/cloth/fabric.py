"""What a cloth is made of."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from kickdrift.core.errors import ArgumentError
from kickdrift.world.arguments import number

_POSITIVE = ("density", "thickness", "stretch_stiffness")
_UNITS = {
    "density": "kg/m^2", "thickness": "m", "stretch_stiffness": "N/m", "shear_stiffness": "N/m", "bending_stiffness": "N m",
    "damping": "s", "linear_damping": "1/s", "friction": "1", "drag": "1", "lift": "1", "air_density": "kg/m^3",
    "tear_strain": "1",
}  # fmt: skip


_SMALLEST, _LARGEST = 1e-15, 1e15  # of all of them: squares of what follows from them are finite


@dataclass(frozen=True)
class Fabric:
    """What a cloth is made of.

    Attributes
    ----------
    density : float
        kg/m^2.
    thickness : float
        m: vertices keep half of it away from shapes. Bodies that are narrower than its triangles pass between them.
    stretch_stiffness, shear_stiffness : float
        Tension over strain along warp and weft, and shear force over the shear angle, both of a metre's width, N/m.
    bending_stiffness : float
        Moment over curvature of a metre's width, N m.
    damping : float
        Of its strains, s: they count as they would be so much later. What is more than the step allows is left out, which
        the message of a recording says.
    linear_damping : float
        Of its velocities, 1/s.
    friction : float
        Coefficient; of a cloth and a shape the geometric mean counts.
    drag, lift : float
        Coefficients; see `kickdrift.world.cloth.wind.add_wind`. About 1.2 is that of a plate across the wind.
    air_density : float
        kg/m^3.
    tear_strain : float
        The largest strain around a vertex, in any direction, at which it comes apart there; zero if it does not tear. A strain
        of one is twice the length.

    Raises
    ------
    ArgumentError
        For numbers that cannot be, or lie so far out that the step could not count with them.
    """

    density: float = 0.2
    thickness: float = 0.005
    stretch_stiffness: float = 200.0
    shear_stiffness: float = 40.0
    bending_stiffness: float = 1e-5
    damping: float = 0.0
    linear_damping: float = 0.0
    friction: float = 0.6
    drag: float = 0.0
    lift: float = 0.0
    air_density: float = 1.2
    tear_strain: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in _UNITS.items():
            value = number(name, getattr(self, name), unit, zero=name not in _POSITIVE)
            if value > _LARGEST or 0.0 < value < _SMALLEST:
                zero = "" if name in _POSITIVE else "zero or "
                raise ArgumentError(f"{name}={value!r} has to be {zero}from {_SMALLEST:g} to {_LARGEST:g} {unit}.")
            object.__setattr__(self, name, value)


def fabric_of(options: Mapping[str, Any]) -> Fabric:
    """Return a fabric with these options.

    Raises
    ------
    ArgumentError
        For options that there are none of, and numbers that cannot be.
    """
    known = [field.name for field in fields(Fabric)]
    unknown = [name for name in options if name not in known]
    if unknown:
        raise ArgumentError(f"{unknown[0]}= is no option of a cloth; there are {', '.join(known)}.")
    return Fabric(**options)

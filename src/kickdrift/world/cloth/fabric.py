"""Material parameters of cloths."""

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


_SMALLEST, _LARGEST = 1e-15, 1e15  # range of all parameters, in which squares of derived quantities are finite


@dataclass(frozen=True)
class Fabric:
    """The material parameters of a cloth.

    Attributes
    ----------
    density : float
        Mass per area, kg/m^2.
    thickness : float
        m; vertices keep a distance of half of it from shapes. Bodies narrower than its triangles pass between vertices.
    stretch_stiffness, shear_stiffness : float
        Tension per strain along warp and weft, and shear force per shear angle, both per metre of width: N/m.
    bending_stiffness : float
        Moment per curvature, per metre of width: N m.
    damping : float
        Retardation time of a Kelvin-Voigt solid, s: forces belong to the strains plus this time times their rates. Where the
        step is too long for it, it is reduced, and the message of a recording reports that.
    linear_damping : float
        Rate at which velocities decay, 1/s.
    friction : float
        Coefficient of friction; a cloth and a shape in contact use the geometric mean.
    drag, lift : float
        Coefficients; see `kickdrift.world.cloth.wind.add_wind`. A plate perpendicular to the wind has a drag of about 1.2.
    air_density : float
        kg/m^3.
    tear_strain : float
        Largest principal strain, averaged over the triangles around a vertex, above which the cloth tears there; zero if it
        does not tear. A strain of one is twice the length.

    Raises
    ------
    ArgumentError
        For invalid numbers, and for numbers outside the supported range.
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
                raise ArgumentError(f"{name}={value!r} must be {zero}from {_SMALLEST:g} to {_LARGEST:g} {unit}.")
            object.__setattr__(self, name, value)


def fabric_of(options: Mapping[str, Any]) -> Fabric:
    """Return a fabric with these options.

    Raises
    ------
    ArgumentError
        For unknown options, and for invalid values.
    """
    known = [field.name for field in fields(Fabric)]
    unknown = [name for name in options if name not in known]
    if unknown:
        raise ArgumentError(f"{unknown[0]}= is not an option of a cloth; the options are {', '.join(known)}.")
    return Fabric(**options)

"""Material parameters of soft bodies."""

import math
from dataclasses import dataclass
from typing import Any

from kickdrift.core.arguments import real
from kickdrift.core.errors import ArgumentError
from kickdrift.world.deformables.material import check_numbers

_POSITIVE = ("density", "young_modulus", "thickness")
_UNITS = {
    "density": "kg/m^3", "young_modulus": "Pa", "thickness": "m", "damping": "s", "linear_damping": "1/s", "friction": "1",
}  # fmt: skip
_FARTHEST = 0.999  # largest Poisson ratio as a fraction of 1/2, and smallest one, at which the moduli are finite


def lame(young: Any, poisson: Any) -> tuple[Any, Any]:
    """Return the Lame parameters lambda and mu for Young's modulus, Pa, and Poisson's ratio: numbers or arrays."""
    mu = young / (2.0 * (1.0 + poisson))
    return 2.0 * mu * poisson / (1.0 - 2.0 * poisson), mu


@dataclass(frozen=True)
class SoftMaterial:
    """The material parameters of a soft body: the options of `World.add_soft_body`.

    Attributes
    ----------
    density : float
        kg/m^3.
    young_modulus : float
        Young's modulus: stress per strain in a bar under small tension, Pa.
    poisson_ratio : float
        Transverse contraction per axial strain in such a bar, above -1 and below 0.5, at which the volume would be constant.
    damping : float
        Retardation time of the strains, s. If the step is too long for it, it is reduced, and the message of a recording
        reports that.
    linear_damping : float
        Rate at which velocities decay, 1/s.
    friction : float
        Coefficient of friction; a soft body and what it touches use the geometric mean.
    thickness : float
        m; vertices keep a distance of half of it from shapes, and surfaces a whole thickness from each other.

    Raises
    ------
    ArgumentError
        For invalid numbers, and for numbers outside the supported range.
    """

    density: float = 1000.0
    young_modulus: float = 1e5
    poisson_ratio: float = 0.4
    damping: float = 0.0
    linear_damping: float = 0.0
    friction: float = 0.6
    thickness: float = 0.005

    def __post_init__(self) -> None:
        check_numbers(self, _UNITS, _POSITIVE)
        try:
            ratio = real(self.poisson_ratio)
        except TypeError:
            ratio = math.nan
        if not -_FARTHEST <= ratio <= 0.5 * _FARTHEST:
            raise ArgumentError(
                f"poisson_ratio={self.poisson_ratio!r} must be from {-_FARTHEST:g} to {0.5 * _FARTHEST:g}; at -1 and 0.5 a "
                "modulus would be infinite."
            )
        object.__setattr__(self, "poisson_ratio", ratio)

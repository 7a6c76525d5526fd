"""Units of the numbers in a system created from quantities."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core import units
from kickdrift.core.errors import ArgumentError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Units:
    """Units of astropy or pint; None for numbers without.

    Attributes
    ----------
    t, x, v : unit
    """

    t: Any = None
    x: Any = None
    v: Any = None

    @property
    def names(self) -> dict[str, str]:
        """Their names, as `System.units` has them."""
        given = {"t": self.t, "x": self.x, "v": self.v}
        return {name: units.spelt(unit) for name, unit in given.items() if unit is not None}


def of_bodies(
    masses: Any, x0: Any, v0: Any, G: Any, softening: Any
) -> tuple[tuple[Any, Any, Any, Any, Any], Units | None]:
    """Return what describes bodies under gravity as plain numbers in consistent units, and these.

    Lengths are in the unit of x0, masses in that of `masses`, velocities in that of v0, and times in what follows.

    Raises
    ------
    ArgumentError
        Where some have units and others, which need them, have none, or one measures something else.
    """
    if not units.has_unit((masses, x0, v0, G)):
        return (masses, x0, v0, G, softening), None
    for name, value in (("masses", masses), ("x0", x0), ("v0", v0), ("G", G)):
        if not units.has_unit(value):
            raise ArgumentError(
                f"{name} has no unit, but others of masses, x0, v0 and G have one; give units for all four, such as"
                " astropy.constants.G."
            )
    mass, x, v = (units.unit_of(value) for value in (masses, x0, v0))
    t = x / v
    if not units.is_time(t):
        raise ArgumentError(f"v0 in {units.spelt(v)} is not a velocity for x0 in {units.spelt(x)}.")
    plain_softening = units.numbers("softening", softening, x) if units.has_unit(softening) else softening
    if not units.has_unit(softening) and softening != 0:
        raise ArgumentError(f"softening={softening!r} has no unit; give it in {units.spelt(x)} or the like.")
    plain = (
        units.numbers("masses", masses, mass),
        units.numbers("x0", x0, x),
        units.numbers("v0", v0, v),
        float(units.numbers("G", G, x * v**2 / mass)),
    )
    return (*plain, plain_softening), Units(t, x, v)

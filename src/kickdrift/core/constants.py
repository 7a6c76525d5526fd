"""Physical constants, each with its unit and source."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Constant:
    """A number with its unit and the publication that it is from."""

    value: float
    unit: str
    source: str

    def __float__(self) -> float:
        return self.value


ASTRONOMICAL_UNIT = Constant(149_597_870.7, "km", "IAU 2012 Resolution B2 (exact)")
JULIAN_YEAR = Constant(365.25, "day", "IAU style manual (exact)")
GAUSSIAN_GRAVITATIONAL_CONSTANT = Constant(
    0.01720209895, "au^(3/2) solar mass^(-1/2) / day", "IAU 1976 System of Astronomical Constants (exact)"
)

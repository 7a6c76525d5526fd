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


JULIAN_YEAR = Constant(365.25, "day", "IAU style manual (exact)")

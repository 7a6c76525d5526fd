"""Description of a run for reports, files and pictures."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from kickdrift.core.kinds import Kind


@dataclass(frozen=True)
class Description:
    """Names and labels of a run for reports, files and pictures.

    Attributes
    ----------
    system, method : str
        Names.
    kind : str
        Name of the `Kind` of problem.
    order : int
        Order of the method.
    word : str
        The word of the method.
    compensated : bool
        Whether sums were compensated.
    dimensions : tuple of str
        Names of the axes of the state.
    coordinates : mapping of str to list
        Labels along those axes.
    units : mapping of str to str
        Units of t, x and v and of the invariants by name.
    scales : mapping of str to float
        Sizes relative to which errors of invariants are given if these may be zero: for a sum, the sum of its terms' norms.
    source : str
        Source of the system.
    choice : str
        Reason for the choice of ``"auto"``; empty if a method was named.
    step_control : str
        How the steps were chosen, and the quantities that this conserves; empty for equal steps.
    gm : tuple of float
        G times the masses of bodies that attract each other; for a body around a centre, that of the centre.
    """

    system: str
    method: str
    kind: str
    order: int
    word: str
    compensated: bool
    dimensions: tuple[str, ...] = ()
    coordinates: Mapping[str, Any] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)
    source: str = ""
    choice: str = ""
    step_control: str = ""
    gm: tuple[float, ...] = ()

    @property
    def v_is_velocity(self) -> bool:
        """Whether v is the rate of x; for Hamiltonians it is p, and first-order equations have none."""
        kind = Kind[self.kind]
        return Kind.VELOCITY_DEPENDENT.includes(kind) or kind in (Kind.CONSTRAINED, Kind.LANGEVIN)


def unit_attributes(unit: str) -> dict[str, str]:
    """Return a unit, if there is one, as an attribute of a labelled array.

    Other libraries parse the attribute "units" and fail on phrases, which get another name.
    """
    return {"units" if " " not in unit else "unit_in_words": unit} if unit else {}

"""What was run, in words."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from kickdrift.core.kinds import Kind


@dataclass(frozen=True)
class Description:
    """What was run: words for reports, files and pictures.

    Attributes
    ----------
    system, method : str
        Names.
    kind : str
        Name of the `Kind` of problem.
    order : int
        Stated order of the method.
    word : str
        The word of the method.
    compensated : bool
        Whether the sums carried what they rounded off.
    dimensions : tuple of str
        Names of the axes of the state.
    coordinates : mapping of str to list
        Labels along those axes.
    units : mapping of str to str
        Units of t, x and v and of the invariants by name.
    scales : mapping of str to float
        Of invariants that may be zero, the size against which their errors are judged: of a sum that of its parts.
    source : str
        Where the system is from.
    choice : str
        Why ``"auto"`` took the method; empty where it was named.
    step_control : str
        How the steps were chosen, and what that conserves; empty where they are equal.
    gm : tuple of float
        Of bodies that attract each other G times their masses; of one around a centre that of the centre.
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
    """Return a unit as an attribute of a labelled array, if there is one.

    What others read as units is one word; a phrase would be an error of theirs.
    """
    return {"units" if " " not in unit else "unit_in_words": unit} if unit else {}

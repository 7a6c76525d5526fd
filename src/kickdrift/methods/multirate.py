"""The impulse method: rare kicks by the slow part of the force, and small steps with the fast part between them."""

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import K, Method
from kickdrift.methods.words import word

_SUBSTEPS = 10


def respa(substeps: int = _SUBSTEPS) -> Method:
    """Create the impulse method, r-RESPA, with a number of steps of the fast force in each step of the slow one.

    A step is a half-kick by the slow force, `substeps` steps of Stoermer-Verlet with the fast one, and another half-kick. It
    is symplectic and symmetric, of order 2, with one evaluation of the slow force. Where the time between kicks is close to
    a multiple of half a period of the fast motion, resonance pumps energy into it: keep steps below a third of its shortest
    period. For linear fast forces the trigonometric methods are filtered against these resonances.

    Parameters
    ----------
    substeps : int
        At least 1.

    Returns
    -------
    Method

    Raises
    ------
    ArgumentError
        If `substeps` is not a positive whole number.

    References
    ----------
    Grubmueller, Heller, Windemuth, Schulten, Mol. Simul. 6, 121 (1991); Tuckerman, Berne, Martyna, J. Chem. Phys. 97,
    1990 (1992).

    Examples
    --------
    >>> import kickdrift as kd
    >>> kd.methods.respa(substeps=20).name
    'respa-2-substeps-20'
    """
    if not is_whole(substeps, 1):
        raise ArgumentError(f"substeps={substeps!r} must be a positive whole number, of steps with the fast force.")
    return Method(
        name="respa-2" if substeps == _SUBSTEPS else f"respa-2-substeps-{substeps}",
        order=2,
        word=word((K, "1/2"), (Letter.SUBSTEPS, 1), (K, "1/2")),
        symmetric=True,
        kind=Kind.MULTIRATE,
        source="Tuckerman, Berne, Martyna, J. Chem. Phys. 97, 1990 (1992)",
        aliases=("r-respa", "respa") if substeps == _SUBSTEPS else (),
        parameters=(int(substeps),),
    )


METHODS = (respa(),)

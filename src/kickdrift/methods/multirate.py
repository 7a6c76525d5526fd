"""The impulse method: seldom a kick by the slow part of the force, and between them small steps under the fast one."""

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import K, Method
from kickdrift.methods.words import word

_SUBSTEPS = 10


def respa(substeps: int = _SUBSTEPS) -> Method:
    """Make the impulse method, r-RESPA, with so many steps under the fast force in each step under the slow one.

    A step is half a kick by the slow force, `substeps` steps of Stoermer-Verlet under the fast one, and half a kick. It is
    symplectic and symmetric, of order 2, with one evaluation of the slow force. Where the time between kicks comes close
    to half a period of the fast motion, or a multiple of it, the kicks pump energy into it: steps of more than a third of
    its shortest period are on the user's own account. For fast forces that are linear the trigonometric methods are
    filtered against that.

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
        For a number that is not whole and positive.

    References
    ----------
    Grubmueller, Heller, Windemuth, Schulten, Mol. Simul. 6, 121 (1991); Tuckerman, Berne, Martyna, J. Chem. Phys. 97,
    1990 (1992).
    """
    if isinstance(substeps, bool) or not isinstance(substeps, int | np.integer) or substeps < 1:
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

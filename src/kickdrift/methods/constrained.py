"""Methods for holonomic constraints: words with projections between kicks and drifts.

P brings positions back to the constraints after a drift, Q brings velocities into their tangent space. The positions of
SHAKE and RATTLE are the same to rounding, since P takes away whatever a Q before it would have. The velocities of SHAKE
lack the last impulse of the constraint forces, so that they stand off the tangent space by a term of order 1; the
energy, to which that term is orthogonal, has order 2.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods.euler import HAIRER_LUBICH_WANNER
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, K, Method
from kickdrift.methods.words import word

P, Q = Letter.CONSTRAIN_POSITIONS, Letter.CONSTRAIN_VELOCITIES

METHODS = (
    Method(
        name="rattle",
        order=2,
        word=word((K, "1/2"), (D, 1), (P, 1), (K, "1/2"), (Q, 1)),
        symmetric=True,
        kind=Kind.CONSTRAINED,
        source=f"Andersen, J. Comput. Phys. 52, 24 (1983); {HAIRER_LUBICH_WANNER}, eq. (VII.1.26)",
    ),
    Method(
        name="shake",
        order=2,
        word=word((K, "1/2"), (D, 1), (P, 1), (K, "1/2")),
        symmetric=True,
        kind=Kind.CONSTRAINED,
        source="Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23, 327 (1977)",
    ),
    Method(
        name="projected-kick-drift",
        order=1,
        word=word((K, 1), (D, 1), (P, 1), (Q, 1)),
        symmetric=False,
        kind=Kind.CONSTRAINED,
        source=f"{HAIRER_LUBICH_WANNER}, eqs. (VII.1.19) and (VII.1.20)",
    ),
)

"""Words of exact oscillations and kicks by the remaining forces: trigonometric methods, for steps beyond h omega = 2.

They differ by how the kicks are filtered, see `kickdrift.engine.flows.oscillation`, and so by what happens where h omega is
close to a multiple of pi: without filters the error grows there, for every such frequency that the other forces drive.
Where the two filters are equal, as none and `mollified-impulse` have them, the method is symplectic.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods.euler import HAIRER_LUBICH_WANNER
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import K, Method
from kickdrift.methods.words import word

_KICK, _OSCILLATE = Letter.FILTERED_KICK, Letter.OSCILLATE
_TABLE = f"{HAIRER_LUBICH_WANNER}, section XIII.2"


def _filtered(name: str, source: str, *powers: int, alias: str = "") -> Method:
    return Method(
        name=name,
        order=2,
        word=word((_KICK, "1/2"), (_OSCILLATE, 1), (_KICK, "1/2")),
        symmetric=True,
        kind=Kind.OSCILLATORY,
        source=f"{source}; {_TABLE}",
        aliases=(alias,) if alias else (),
        parameters=powers,
    )


METHODS = (
    Method(
        name="deuflhard-2",
        order=2,
        word=word((K, "1/2"), (_OSCILLATE, 1), (K, "1/2")),
        symmetric=True,
        kind=Kind.OSCILLATORY,
        source=f"Deuflhard, Z. Angew. Math. Phys. 30, 177 (1979); {_TABLE}, method (B)",
        aliases=("impulse-oscillatory",),
    ),
    _filtered(
        "garcia-archilla-sanz-serna-skeel-2",
        "Garcia-Archilla, Sanz-Serna, Skeel, SIAM J. Sci. Comput. 20, 930 (1998)",
        *(1, 1, 0),
        alias="mollified-impulse",
    ),
    _filtered("hairer-lubich-2", "Hairer, Lubich, SIAM J. Numer. Anal. 38, 414 (2000)", 1, 0, 0),
    _filtered("grimm-hochbruck-2", "Grimm, Hochbruck, J. Phys. A 39, 5495 (2006)", 2, 1, 0),
    # Its filter of the kicks has poles at odd multiples of pi.
    _filtered("gautschi-2", "Gautschi, Numer. Math. 3, 381 (1961)", 0, 0, 1, alias="gautschi"),
)

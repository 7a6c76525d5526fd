"""The fourth-order triple jump of Forest and Ruth, found again by Yoshida."""

from decimal import Decimal, localcontext
from fractions import Fraction

from kickdrift.methods.record import D, Kind, Method, alternating

with localcontext() as _context:
    _context.prec = 60
    _cube_root_of_2 = Decimal(2) ** (Decimal(1) / Decimal(3))
    _outer = Fraction(1 / (2 - _cube_root_of_2))

# Three position-Verlet steps of _outer, _inner, _outer with the drifts between them merged.
_inner = 1 - 2 * _outer
_drifts = (_outer / 2, (_outer + _inner) / 2)

METHODS = (
    Method(
        name="forest-ruth-4",
        order=4,
        word=alternating(D, [_drifts[0], _outer, _drifts[1], _inner, _drifts[1], _outer, _drifts[0]]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source="Forest, Ruth, Physica D 43, 105 (1990); Yoshida, Phys. Lett. A 150, 262 (1990)",
        aliases=("yoshida-4",),
    ),
)

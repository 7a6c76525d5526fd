"""The Gauss methods: of all methods of s stages those of the highest order, symplectic and symmetric."""

from decimal import Decimal, localcontext
from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.collocation import collocation
from kickdrift.methods.euler import HAIRER_LUBICH_WANNER
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import word

with localcontext() as _context:
    _context.prec = 60
    # Distances of the nodes from the middle of the step: half the roots of Legendre's polynomials.
    _TWO = Fraction(Decimal(3).sqrt() / 6)
    _THREE = Fraction(Decimal(15).sqrt() / 10)
    _INNER, _OUTER = (Fraction(((15 + sign * 2 * Decimal(30).sqrt()) / 35).sqrt() / 2) for sign in (-1, 1))

_MIDDLE = Fraction(1, 2)


def _of_nodes(*distances: Fraction) -> Tableau:
    a, b = collocation([_MIDDLE + distance for distance in distances])
    return Tableau(a=a, b=b)


def _method(order: int, source: str, *distances: Fraction) -> Method:
    return Method(
        name=f"gauss-{order}",
        order=order,
        word=word((Letter.IMPLICIT_RUNGE_KUTTA, 1)),
        symmetric=True,
        kind=Kind.FIRST_ORDER,
        source=source,
        tableau=lambda: _of_nodes(*distances),
    )


METHODS = (
    _method(4, f"{HAIRER_LUBICH_WANNER}, table II.1.1", -_TWO, _TWO),
    _method(6, f"{HAIRER_LUBICH_WANNER}, table II.1.1", -_THREE, Fraction(0), _THREE),
    _method(8, "Butcher, Math. Comp. 18, 50 (1964)", -_OUTER, -_INNER, _INNER, _OUTER),
)

"""The pairs of Lobatto methods IIIA, for x, and IIIB, for v: the Stoermer-Verlet method of higher order.

The first and the last stage have the positions at the ends of the step. For Hamiltonians the pair is symplectic.
"""

from collections.abc import Sequence
from decimal import Decimal, localcontext
from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.collocation import collocation
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import word

with localcontext() as _context:
    _context.prec = 60
    _FOUR = Fraction(Decimal(5).sqrt() / 10)

_MIDDLE = Fraction(1, 2)


def _pair(nodes: Sequence[Fraction]) -> Tableau:
    a, b = collocation(nodes)
    # IIIB is what makes the pair symplectic: b_i A_ij + b_j a_ji = b_i b_j.
    stages = range(len(nodes))
    a_of_v = tuple(tuple(b[j] - b[j] * a[j][i] / b[i] for j in stages) for i in stages)
    return Tableau(a=a, b=b, a_of_v=a_of_v, b_of_v=b)


def _method(order: int, *nodes: Fraction) -> Method:
    return Method(
        name=f"lobatto-iiia-iiib-{order}",
        order=order,
        word=word((Letter.IMPLICIT_RUNGE_KUTTA, 1)),
        symmetric=True,
        kind=Kind.FIRST_ORDER,
        source="Sun, J. Comput. Math. 11, 365 (1993); Jay, SIAM J. Numer. Anal. 33, 368 (1996)",
        tableau=lambda: _pair(nodes),
    )


METHODS = (
    _method(4, Fraction(0), _MIDDLE, Fraction(1)),
    _method(6, Fraction(0), _MIDDLE - _FOUR, _MIDDLE + _FOUR, Fraction(1)),
)

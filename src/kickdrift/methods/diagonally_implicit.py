"""A diagonally implicit method that is symplectic."""

from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import word

METHODS = (
    # Two steps of the midpoint rule, each over half of the step.
    Method(
        name="qin-zhang-2",
        order=2,
        word=word((Letter.IMPLICIT_RUNGE_KUTTA, 1)),
        symmetric=True,
        kind=Kind.FIRST_ORDER,
        source="Qin, Zhang, J. Comput. Math., Suppl., 205 (1992)",
        tableau=lambda: Tableau(
            a=[[Fraction(1, 4), 0], [Fraction(1, 2), Fraction(1, 4)]], b=[Fraction(1, 2), Fraction(1, 2)]
        ),
    ),
)

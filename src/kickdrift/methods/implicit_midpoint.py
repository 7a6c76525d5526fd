"""The implicit midpoint rule."""

from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.euler import HAIRER_LUBICH_WANNER
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import word

METHODS = (
    Method(
        name="implicit-midpoint",
        order=2,
        word=word((Letter.IMPLICIT_RUNGE_KUTTA, 1)),
        symmetric=True,
        kind=Kind.FIRST_ORDER,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (I.1.7)",
        aliases=("gauss-2",),
        tableau=lambda: Tableau(a=[[Fraction(1, 2)]], b=[1]),
    ),
)

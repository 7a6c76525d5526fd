"""The fourth-order triple jump of Forest and Ruth, found again by Candy and Rozmus and by Yoshida."""

from decimal import Decimal, localcontext
from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.record import Method
from kickdrift.methods.yoshida import YOSHIDA, verlet_steps

with localcontext() as _context:
    _context.prec = 60
    _outer = Fraction(1 / (2 - Decimal(2) ** (Decimal(1) / Decimal(3))))

METHODS = (
    Method(
        name="forest-ruth-4",
        order=4,
        word=verlet_steps([_outer]),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"Forest, Ruth, Physica D 43, 105 (1990); Candy, Rozmus, J. Comput. Phys. 92, 230 (1991); {YOSHIDA}",
        aliases=("yoshida-4", "candy-rozmus-4"),
    ),
)

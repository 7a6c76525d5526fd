"""The Radau IIA methods: collocation with the end of the step as a node, for stiff problems.

They are L-stable: what decays faster than a step can follow is gone after it. They conserve no energy.
"""

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
    _SIX = Fraction(Decimal(6).sqrt() / 10)

_MIDDLE = Fraction(2, 5)


def _of_nodes(*nodes: Fraction) -> Tableau:
    a, b = collocation(nodes)
    return Tableau(a=a, b=b)


def _method(order: int, *nodes: Fraction) -> Method:
    return Method(
        name=f"radau-{order}",
        order=order,
        word=word((Letter.STIFF_RUNGE_KUTTA, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source="Hairer, Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996), tables IV.5.5 and IV.5.6",
        aliases=(f"radau-iia-{order}",),
        tableau=lambda: _of_nodes(*nodes),
    )


METHODS = (_method(3, Fraction(1, 3), Fraction(1)), _method(5, _MIDDLE - _SIX, _MIDDLE + _SIX, Fraction(1)))

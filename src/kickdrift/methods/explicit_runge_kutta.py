"""Explicit Runge-Kutta methods: accurate over short times, with energy drift over long ones."""

from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import word


def _dop853() -> Tableau:
    from scipy.integrate import DOP853

    # Its rows of errors have a slope after the step, too, of weight zero.
    errors = [DOP853.E5[:-1].tolist(), DOP853.E3[:-1].tolist()]
    return Tableau(a=DOP853.A.tolist(), b=DOP853.B.tolist(), error_weights=errors, error_order=7)


METHODS = (
    Method(
        name="runge-kutta-4",
        order=4,
        word=word((Letter.RUNGE_KUTTA, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source="Kutta, Z. Math. Phys. 46, 435 (1901)",
        aliases=("rk4",),
        tableau=lambda: Tableau(
            a=[[0, 0, 0, 0], [Fraction(1, 2), 0, 0, 0], [0, Fraction(1, 2), 0, 0], [0, 0, 1, 0]],
            b=[Fraction(1, 6), Fraction(1, 3), Fraction(1, 3), Fraction(1, 6)],
        ),
    ),
    Method(
        name="dop853",
        order=8,
        word=word((Letter.RUNGE_KUTTA, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source="Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), section II.5",
        tableau=_dop853,
    ),
)

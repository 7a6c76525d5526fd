"""The composition diagonal method, extrapolated: for first-order equations, friction, and chaos without structure.

The method itself, of order 2, is ``implicit-verlet``. Extrapolation gives its structure up for the order.
"""

from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Method
from kickdrift.methods.words import word


def _extrapolated(rows: int) -> Method:
    return Method(
        name=f"composition-diagonal-{2 * rows}",
        order=2 * rows,
        word=word((Letter.EXTRAPOLATION, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source="step: Butusov, Tutueva, Fedoseev, Terentev, Karimov, Mathematics 8, 943 (2020); extrapolation: Hairer,"
        " Norsett, Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), section II.9",
        parameters=(rows,),
    )


METHODS = tuple(_extrapolated(rows) for rows in (2, 3, 4))

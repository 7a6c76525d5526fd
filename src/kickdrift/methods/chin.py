"""The fourth-order method of Chin with the gradient of the force, whose weights are all positive."""

from fractions import Fraction

from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import D, K, Method
from kickdrift.methods.words import word

METHODS = (
    # In steps h the middle kick has the force F + (h^2/48) grad |F|^2 for unit masses. Over its own length s = 2h/3
    # that is F + c s^2 grad |F|^2 with c = (1/48) (3/2)^2 = 3/64, and grad |F|^2 = 2 (dF/dx)^T F. The sign matters:
    # with a minus the order is 2.
    Method(
        name="chin-4a",
        order=4,
        word=word((K, "1/6"), (D, "1/2"), (Letter.GRADIENT_KICK, "2/3"), (D, "1/2"), (K, "1/6")),
        symmetric=True,
        kind=Kind.NEWTONIAN,
        source="Chin, Phys. Lett. A 226, 344 (1997), algorithm A",
        aliases=("chin-4",),
        parameters=(Fraction(3, 64),),
    ),
)

"""The implicit midpoint rule."""

from kickdrift.methods.record import Kind, Letter, Method, word

METHODS = (
    Method(
        name="implicit-midpoint",
        order=2,
        word=word((Letter.IMPLICIT_MIDPOINT, 1)),
        symmetric=True,
        kind=Kind.GENERAL,
        source="Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), eq. (I.1.7)",
    ),
)

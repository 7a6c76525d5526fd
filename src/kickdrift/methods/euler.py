"""The four Euler methods: explicit, implicit, and semi-implicit in its two forms."""

from kickdrift.methods.record import D, K, Kind, Letter, Method, word

HAIRER_LUBICH_WANNER = "Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006)"

METHODS = (
    Method(
        name="kick-drift",
        order=1,
        word=word((K, 1), (D, 1)),
        symmetric=False,
        kind=Kind.GENERAL,
        source=f"de Vogelaere, Report No. 4, Univ. of Notre Dame (1956); {HAIRER_LUBICH_WANNER}, eq. (I.1.9)",
        aliases=("semi-implicit-euler", "symplectic-euler", "euler-cromer"),
    ),
    Method(
        name="drift-kick",
        order=1,
        word=word((D, 1), (K, 1)),
        symmetric=False,
        kind=Kind.GENERAL,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (I.1.9), the adjoint form",
    ),
    Method(
        name="explicit-euler",
        order=1,
        word=word((Letter.EXPLICIT_EULER, 1)),
        symmetric=False,
        kind=Kind.GENERAL,
        source=f"Euler, Institutionum calculi integralis I (1768); {HAIRER_LUBICH_WANNER}, eq. (I.1.5)",
        aliases=("forward-euler",),
    ),
    Method(
        name="implicit-euler",
        order=1,
        word=word((Letter.IMPLICIT_EULER, 1)),
        symmetric=False,
        kind=Kind.GENERAL,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (I.1.6)",
        aliases=("backward-euler",),
    ),
)

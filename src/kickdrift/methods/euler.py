"""The Euler methods: explicit, implicit, and semi-implicit in its forms."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import ADJOINT_D, ADJOINT_K, D, K, Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import word

HAIRER_LUBICH_WANNER = "Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006)"

METHODS = (
    Method(
        name="kick-drift",
        order=1,
        word=word((K, 1), (D, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source=f"de Vogelaere, Report No. 4, Univ. of Notre Dame (1956); {HAIRER_LUBICH_WANNER}, eq. (I.1.9)",
        aliases=("semi-implicit-euler", "symplectic-euler", "euler-cromer"),
        counterpart="implicit-kick-drift",
    ),
    Method(
        name="drift-kick",
        order=1,
        word=word((D, 1), (K, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (I.1.9), the adjoint form",
        counterpart="implicit-drift-kick",
    ),
    Method(
        name="implicit-kick-drift",
        order=1,
        word=word((ADJOINT_K, 1), (D, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (VI.3.1), left",
    ),
    Method(
        name="implicit-drift-kick",
        order=1,
        word=word((ADJOINT_D, 1), (K, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (VI.3.1), right",
    ),
    Method(
        name="explicit-euler",
        order=1,
        word=word((Letter.RUNGE_KUTTA, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source=f"Euler, Institutionum calculi integralis I (1768); {HAIRER_LUBICH_WANNER}, eq. (I.1.5)",
        aliases=("forward-euler",),
        tableau=lambda: Tableau(a=[[0]], b=[1]),
    ),
    Method(
        name="implicit-euler",
        order=1,
        word=word((Letter.IMPLICIT_RUNGE_KUTTA, 1)),
        symmetric=False,
        kind=Kind.FIRST_ORDER,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (I.1.6)",
        aliases=("backward-euler",),
        tableau=lambda: Tableau(a=[[1]], b=[1]),
    ),
)

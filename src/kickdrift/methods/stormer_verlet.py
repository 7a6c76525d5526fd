"""The Stoermer-Verlet method in its two forms."""

from kickdrift.methods.record import D, K, Kind, Method, word

_SOURCE = "Verlet, Phys. Rev. 159, 98 (1967); Hairer, Lubich, Wanner, Acta Numerica 12, 399 (2003)"

METHODS = (
    Method(
        name="velocity-verlet",
        order=2,
        word=word((K, "1/2"), (D, 1), (K, "1/2")),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=_SOURCE,
        aliases=("stormer-verlet", "leapfrog", "kick-drift-kick"),
    ),
    Method(
        name="position-verlet",
        order=2,
        word=word((D, "1/2"), (K, 1), (D, "1/2")),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{_SOURCE}, the dual form; Tuckerman, Berne, Martyna, J. Chem. Phys. 97, 1990 (1992)",
        aliases=("drift-kick-drift",),
    ),
)

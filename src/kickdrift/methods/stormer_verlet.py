"""The two forms of the Stoermer-Verlet method, and the one for partitioned equations."""

from kickdrift.core.kinds import Kind
from kickdrift.methods.euler import HAIRER_LUBICH_WANNER
from kickdrift.methods.record import ADJOINT_D, ADJOINT_K, D, K, Method
from kickdrift.methods.words import word

METHODS = (
    Method(
        name="velocity-verlet",
        order=2,
        word=word((K, "1/2"), (D, 1), (K, "1/2")),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"Verlet, Phys. Rev. 159, 98 (1967); {HAIRER_LUBICH_WANNER}, eq. (I.1.17)",
        aliases=("stormer-verlet", "leapfrog"),
        counterpart="implicit-verlet",
    ),
    Method(
        name="position-verlet",
        order=2,
        word=word((D, "1/2"), (K, 1), (D, "1/2")),
        symmetric=True,
        kind=Kind.SEPARABLE,
        source=f"{HAIRER_LUBICH_WANNER}, section I.1.4",
        counterpart="implicit-position-verlet",
    ),
    Method(
        name="implicit-verlet",
        order=2,
        word=word((ADJOINT_K, "1/2"), (D, "1/2"), (ADJOINT_D, "1/2"), (K, "1/2")),
        symmetric=True,
        kind=Kind.FIRST_ORDER,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (VI.3.4)",
        aliases=("lobatto-iiia-iiib-2", "composition-diagonal-2"),
    ),
    Method(
        name="implicit-position-verlet",
        order=2,
        word=word((ADJOINT_D, "1/2"), (K, "1/2"), (ADJOINT_K, "1/2"), (D, "1/2")),
        symmetric=True,
        kind=Kind.FIRST_ORDER,
        source=f"{HAIRER_LUBICH_WANNER}, eq. (VI.3.5)",
    ),
)

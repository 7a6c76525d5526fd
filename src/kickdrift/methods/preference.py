"""Which method to take for a kind of problem and an order: what ``method="auto"`` stands for."""

from kickdrift.core.errors import MethodMismatchError
from kickdrift.core.kinds import Kind
from kickdrift.methods.record import Method

_DEFAULT_ORDER = 4

_SYMPLECTIC_RUNGE_KUTTA = ("implicit-midpoint", "gauss-4", "gauss-6", "gauss-8")

# Of each order the least error at equal cost on most problems, as `python -m benchmarks --only precision` shows, but
# for order 2, which is the simplest. On order 8 for accelerations problems disagree: `teloy-8c` has a fiftieth of the
# error of `kahan-li-8` in the energy of Henon-Heiles, and three times its error in the end state of Kepler.
_PREFERRED: dict[Kind, tuple[str, ...]] = {
    Kind.NEWTONIAN: (
        "velocity-verlet",
        "blanes-moan-srkn6b",
        "blanes-moan-srkn11b",
        "kahan-li-8",
        "sofroniou-spaletta-10",
    ),
    Kind.SEPARABLE: ("velocity-verlet", "blanes-moan-s6", "blanes-moan-s10", "kahan-li-8", "sofroniou-spaletta-10"),
    Kind.VELOCITY_DEPENDENT: ("implicit-verlet", *_SYMPLECTIC_RUNGE_KUTTA[1:]),
    Kind.DAMPED: ("conformal-verlet", "blanes-moan-conformal-4", "blanes-moan-conformal-6"),
    Kind.CHARGED: ("boris", "blanes-moan-gyration-4", "blanes-moan-gyration-6"),
    Kind.LANGEVIN: ("baoab",),
    Kind.NEARLY_KEPLERIAN: ("wisdom-holman", "blanes-aba-1064", "blanes-moan-srkn11b", "kahan-li-8"),
    Kind.HAMILTONIAN: _SYMPLECTIC_RUNGE_KUTTA,
    Kind.PARTITIONED: _SYMPLECTIC_RUNGE_KUTTA,
    Kind.FIRST_ORDER: _SYMPLECTIC_RUNGE_KUTTA,
    Kind.CONSTRAINED: ("rattle",),
}


def preferred(kind: Kind, order: int | None, catalogue: dict[str, Method]) -> Method:
    """Choose by structure and wanted order: the least order that is at least as high.

    Parameters
    ----------
    kind : Kind
        What moves.
    order : int or None
        The order wanted; None for 4, or the highest where there is none so high.
    catalogue : dict of str to Method
        The methods to choose from.

    Raises
    ------
    MethodMismatchError
        If no method for the kind has an order so high.
    """
    choices = sorted((catalogue[name] for name in _PREFERRED[kind]), key=lambda method: method.order)
    enough = [method for method in choices if method.order >= (order or _DEFAULT_ORDER)]
    if enough:
        return enough[0]
    if order is None:
        return choices[-1]
    raise MethodMismatchError(
        f"order={order!r} is higher than methods for {kind.value} have; the highest is {choices[-1].order}"
        f" ({choices[-1].name!r})."
    )

"""The method that ``method="auto"`` selects for a kind of problem and an order."""

from kickdrift.core.errors import MethodMismatchError
from kickdrift.core.kinds import Kind
from kickdrift.methods.record import Method

_SYMPLECTIC_RUNGE_KUTTA = ("implicit-midpoint", "gauss-4", "gauss-6", "gauss-8")

_TRIGONOMETRIC = "garcia-archilla-sanz-serna-skeel-2"

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
    Kind.MULTIRATE: ("respa-2", "blanes-moan-srkn6b", "blanes-moan-srkn11b", "kahan-li-8", "sofroniou-spaletta-10"),
    Kind.OSCILLATORY: (
        _TRIGONOMETRIC,
        "blanes-moan-srkn6b",
        "blanes-moan-srkn11b",
        "kahan-li-8",
        "sofroniou-spaletta-10",
    ),
    Kind.HAMILTONIAN: _SYMPLECTIC_RUNGE_KUTTA,
    Kind.PARTITIONED: _SYMPLECTIC_RUNGE_KUTTA,
    Kind.FIRST_ORDER: _SYMPLECTIC_RUNGE_KUTTA,
    Kind.CONSTRAINED: ("rattle",),
}


# The fastest to errors of 1e-3, 1e-6 and 1e-9 at the end, or within 2 of it but for HIRES at 1e-9 (2.1), see
# `python -m benchmarks --only auto`:
# one method does for all three, of order 6 to 8. Among equals that which conserves more. Where no word of explicit flows
# does, DOP853 is three to five times as fast as Gauss methods to any error from 0.1 to 1e-9, also over 20,000 units of
# time (rigid body, Lotka-Volterra, spherical pendulum), though its energy drifts by that error.
_FASTEST: dict[Kind, str] = {
    Kind.NEWTONIAN: "blanes-moan-srkn11b",
    Kind.SEPARABLE: "blanes-moan-s10",
    Kind.VELOCITY_DEPENDENT: "dop853",
    Kind.DAMPED: "blanes-moan-conformal-6",
    Kind.CHARGED: "blanes-moan-gyration-6",
    Kind.LANGEVIN: "baoab",
    Kind.NEARLY_KEPLERIAN: "blanes-aba-1064",
    Kind.MULTIRATE: "respa-2",  # who splits a force has one part that is dear
    Kind.OSCILLATORY: "blanes-moan-srkn11b",
    Kind.HAMILTONIAN: "dop853",
    Kind.PARTITIONED: "dop853",
    Kind.FIRST_ORDER: "dop853",
    Kind.CONSTRAINED: "rattle",
}

# Of nearly Keplerian motion, for steps of more than 0.9 of the time in which the fastest body turns by a radian at its
# pericentre. On eight systems of 2 to 4 planets, with masses of 1e-6 to 1e-2 and eccentricities to 0.5, the two together were
# within 2 of the fastest at all errors but one; each alone was up to 6 times off, or did not get there.
_FOR_LONG_STEPS = "wisdom-holman-corrected-3"
LONG_STEP = 0.9

# Of the L-stable methods radau-7 is the fastest to 1e-6 and 1e-9, or within 1.3 of it, on rods, HIRES and Robertson's problem,
# where radau-5 is up to 1.8 times as slow. To 1e-3 in few steps its larger matrices cost more: on Robertson's problem 1.8 times
# the time of radau-5.
_L_STABLE = ("implicit-euler", "radau-3", "radau-5", "radau-7")
_FOR_FEW_STEPS = "radau-5"
FEW_STEPS = 50
_A_STABLE = "gauss-4"


def preferred(kind: Kind, order: int | None, catalogue: dict[str, Method]) -> Method:
    """Choose by structure and wanted order: the least order that is at least as high, or what is the fastest.

    Parameters
    ----------
    kind : Kind
        Kind of the problem.
    order : int or None
        The order wanted; None for the fastest.
    catalogue : dict of str to Method
        The methods to choose from.

    Raises
    ------
    MethodMismatchError
        If no method for the kind has so high an order.
    """
    if order is None:
        return catalogue[_FASTEST[kind]]
    choices = sorted((catalogue[name] for name in _PREFERRED[kind]), key=lambda method: method.order)
    enough = [method for method in choices if method.order >= order]
    if enough:
        return enough[0]
    raise MethodMismatchError(
        f"order={order!r} is higher than that of any method for {kind.value}; the highest is {choices[-1].order}"
        f" ({choices[-1].name!r})."
    )


def for_stiff(order: int | None, steps: float, catalogue: dict[str, Method]) -> Method | None:
    """Choose for decay much faster than a step, of so many; None if no L-stable method has so high an order."""
    if order is None:
        return catalogue[_FOR_FEW_STEPS if steps <= FEW_STEPS else _L_STABLE[-1]]
    return next((catalogue[name] for name in _L_STABLE if catalogue[name].order >= order), None)


def for_fast_oscillations(kind: Kind, catalogue: dict[str, Method]) -> Method:
    """Choose for oscillations much faster than a step, which neither grow nor decay then."""
    return catalogue[_TRIGONOMETRIC if kind is Kind.OSCILLATORY else _A_STABLE]


def for_long_steps(catalogue: dict[str, Method]) -> Method:
    """Choose for nearly Keplerian motion and steps that are long for its fastest pericentre."""
    return catalogue[_FOR_LONG_STEPS]

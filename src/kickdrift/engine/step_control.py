"""Control of variable steps: what users ask for, and how it changes the word of a method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.engine.program import Spelled
from kickdrift.methods.record import Word

Floats = NDArray[np.float64]
Spell = Callable[[Word], Spelled]
_HALF = Fraction(1, 2)


@dataclass(frozen=True)
class HairerSoderlind:
    """Reversible steps by a step density, for any symmetric method.

    Parameters
    ----------
    density : str or callable, optional
        The number of steps per unit of time, up to a factor, which is fixed by the given first step: a function of the
        state, with arguments named as those of forces, that is positive and even in v; or a name, ``"distance"`` (between
        the bodies of a state (N, d), or of a state (d,) from the origin, to the power -3/2), ``"acceleration"`` (the square
        root of its magnitude) or ``"own"``, the density of the system. By default ``"own"`` if there is one, otherwise
        ``"acceleration"``.

    Notes
    -----
    The step size follows the density explicitly, and the steps are reversible: with reversed velocities the same steps lead
    back. The energy error is bounded, as with a fixed step; momenta that the method conserves remain conserved. A step costs
    three evaluations of the density in addition to the forces.

    References
    ----------
    E. Hairer, G. Soederlind, Explicit, time reversible, adaptive step size control, SIAM J. Sci. Comput. 26, 1838 (2005).

    Examples
    --------
    >>> import kickdrift as kd
    >>> comet = kd.systems.kepler(eccentricity=0.9)
    >>> sol = kd.solve(
    ...     comet, (0.0, 20.0), step=1e-3, step_control=kd.HairerSoderlind("distance")
    ... )
    >>> bool(sol.step_range[1] > 20 * sol.step_range[0])
    True
    """

    density: str | Callable[..., Any] | None = None

    method: ClassVar[str] = "velocity-verlet"  # where none is named
    order: ClassVar[int | None] = 2  # of another, where that does not apply
    conserves: ClassVar[str] = "reversible; no drift of the energy"

    @staticmethod
    def spelled(spell: Spell, word: Word) -> Spelled:
        """Add the letters of the control to a word."""
        return [("begin-density", _HALF, Fraction(0)), *spell(word), ("end-density", _HALF, Fraction(1))]


@dataclass(frozen=True)
class HuangLeimkuhler:
    """Reversible steps by a step density reflected at each midpoint: adaptive Verlet, also for other splittings of order 2.

    Parameters
    ----------
    density : str or callable, optional
        As for `HairerSoderlind`, but a function of x and t only.

    References
    ----------
    W. Huang, B. Leimkuhler, The adaptive Verlet method, SIAM J. Sci. Comput. 18, 239 (1997).

    Examples
    --------
    >>> import kickdrift as kd
    >>> comet = kd.systems.kepler(eccentricity=0.9)
    >>> sol = kd.solve(
    ...     comet, (0.0, 20.0), step=1e-3, step_control=kd.HuangLeimkuhler("distance")
    ... )
    >>> bool(abs(sol.energy + 0.5).max() < 0.01)
    True
    """

    density: str | Callable[..., Any] | None = None

    method: ClassVar[str] = "velocity-verlet"  # where none is named
    order: ClassVar[int | None] = 2  # of another, where that does not apply
    conserves: ClassVar[str] = "reversible; no drift of the energy"

    @staticmethod
    def spelled(spell: Spell, word: Word) -> Spelled:
        """Divide a word at its midpoint."""
        middle, odd = divmod(len(word), 2)
        shared = tuple((letter, weight / 2) for letter, weight in word[middle : middle + odd])
        first, second = (*word[:middle], *shared), (*shared, *word[middle + odd :])
        return [*spell(first), ("reflect-density", Fraction(1), _HALF), *spell(second)]


@dataclass(frozen=True)
class LogarithmicHamiltonian:
    """Kicks and drifts of log(T - E) - log(-U), for gravity and other energies T(v) + U(x) with U < 0.

    Symplectic in a transformed time, in which close encounters are as smooth as the rest: with ``"position-verlet"``, the
    default here, the orbit of two bodies is exact except for the time, at any eccentricity. For any splitting into kicks and
    drifts; the system must have an energy.

    References
    ----------
    S. Mikkola, K. Tanikawa, Mon. Not. R. Astron. Soc. 310, 745 (1999); M. Preto, S. Tremaine, Astron. J. 118, 2532 (1999).

    Examples
    --------
    >>> import kickdrift as kd
    >>> comet = kd.systems.kepler(eccentricity=0.9)
    >>> sol = kd.solve(
    ...     comet, (0.0, 20.0), step=2e-3, step_control=kd.LogarithmicHamiltonian()
    ... )
    >>> bool(abs(sol.energy + 0.5).max() < 1e-13)
    True
    """

    method: ClassVar[str] = "position-verlet"  # where none is named
    order: ClassVar[int | None] = None
    conserves: ClassVar[str] = "reversible, and symplectic in the transformed time; no drift of the energy"

    @staticmethod
    def spelled(spell: Spell, word: Word) -> Spelled:
        """Give kicks and drifts their own time."""
        return _renamed("logarithmic", spell(word))


@dataclass(frozen=True)
class TimeTransformed:
    """The time-transformed leapfrog: kicks over 1 / density, and drifts over an auxiliary variable that follows it.

    For forces of very different magnitude, as in few-body gravity with large mass ratios, where the heavy bodies dominate
    the logarithmic Hamiltonian. For ``"position-verlet"``, the default here, and ``"velocity-verlet"``.

    Parameters
    ----------
    density : str or callable, optional
        As for `HairerSoderlind`, but a function of x only.

    References
    ----------
    S. Mikkola, S. Aarseth, A time-transformed leapfrog scheme, Celest. Mech. Dyn. Astron. 84, 343 (2002).

    Examples
    --------
    >>> import kickdrift as kd
    >>> comet = kd.systems.kepler(eccentricity=0.9)
    >>> sol = kd.solve(comet, (0.0, 20.0), step=2e-3, step_control=kd.TimeTransformed())
    >>> bool(abs(sol.energy + 0.5).max() < 1e-2)
    True
    """

    density: str | Callable[..., Any] | None = None

    method: ClassVar[str] = "position-verlet"  # where none is named
    order: ClassVar[int | None] = None
    conserves: ClassVar[str] = "reversible; no drift of the energy"

    @staticmethod
    def spelled(spell: Spell, word: Word) -> Spelled:
        """Give kicks and drifts their own time."""
        return _renamed("transformed", spell(word))


@dataclass(frozen=True, eq=False)
class LocalError:
    """Steps whose estimated error is at most ``atol + rtol * abs(state)`` on average, for any method without noise.

    The error is the method's own estimate (``"dop853"``), or else each step is done as a whole and as two halves, and
    the result of the halves is kept. For dissipative and other problems without conserved quantities: the energy drifts with
    the errors.

    Parameters
    ----------
    rtol : float
        Relative tolerance.
    atol : float or array_like
        Absolute tolerance, of a shape that broadcasts to the state; it applies to x and v.

    References
    ----------
    E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), section II.4.

    Examples
    --------
    >>> import kickdrift as kd
    >>> orbit, control = kd.systems.kepler(), kd.LocalError(1e-9, 1e-9)
    >>> sol = kd.solve(orbit, (0.0, 20.0), step_control=control, method="dop853")
    >>> bool(abs(sol.energy + 0.5).max() < 1e-6)
    True
    """

    rtol: float = 1e-3
    atol: ArrayLike = 1e-6

    method: ClassVar[str] = "auto"  # where none is named
    order: ClassVar[int | None] = None
    conserves: ClassVar[str] = "conserves nothing exactly; the energy drifts"

    @staticmethod
    def spelled(spell: Spell, word: Word) -> Spelled:
        """Do a word whole, and in halves."""
        halves = tuple((letter, weight / 2) for letter, weight in word) * 2
        none, whole = Fraction(0), Fraction(1)
        return [
            ("begin-trial", whole, none),
            *spell(word),
            ("end-coarse", whole, whole),
            *spell(halves),
            ("judge", whole, whole),
        ]

    @staticmethod
    def spelled_embedded(spell: Spell, word: Word) -> Spelled:
        """Do a word that estimates its error."""
        none, whole = Fraction(0), Fraction(1)
        return [("begin-trial", whole, none), *spell(word), ("judge-embedded", whole, whole)]


StepControl = HairerSoderlind | HuangLeimkuhler | LogarithmicHamiltonian | TimeTransformed | LocalError


def _renamed(sort: str, letters: Spelled) -> Spelled:
    return [(f"{sort}-{name}", weight, clock) for name, weight, clock in letters]

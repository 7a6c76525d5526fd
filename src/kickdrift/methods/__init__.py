"""The methods: tables, found by name."""

from kickdrift.core.errors import unknown_name
from kickdrift.core.kinds import Kind
from kickdrift.methods import (
    blanes_moan,
    calvo_sanz,
    charged,
    chin,
    composition_diagonal,
    constrained,
    damped,
    diagonally_implicit,
    doubled,
    euler,
    explicit_runge_kutta,
    forest_ruth,
    gauss,
    implicit_damping,
    implicit_midpoint,
    kahan_li,
    langevin,
    lobatto,
    mclachlan,
    mclachlan_atela,
    multirate,
    okunbor_skeel,
    omelyan,
    oscillatory,
    preference,
    radau,
    ruth,
    sofroniou_spaletta,
    stormer_verlet,
    suzuki,
    teloy,
    wisdom_holman,
    yoshida,
)
from kickdrift.methods.doubled import tao
from kickdrift.methods.letter import Letter
from kickdrift.methods.multirate import respa
from kickdrift.methods.record import Method
from kickdrift.methods.tableau import Tableau
from kickdrift.methods.words import alternating, composition, palindrome, rows, word

__all__ = [
    "Kind",
    "Letter",
    "Method",
    "Tableau",
    "alternating",
    "catalogue",
    "composition",
    "get",
    "palindrome",
    "preferred",
    "respa",
    "rows",
    "tao",
    "word",
]


def __dir__() -> list[str]:
    return __all__


_TABLES = (
    euler,
    stormer_verlet,
    ruth,
    mclachlan_atela,
    calvo_sanz,
    forest_ruth,
    omelyan,
    chin,
    mclachlan,
    blanes_moan,
    suzuki,
    yoshida,
    kahan_li,
    okunbor_skeel,
    teloy,
    sofroniou_spaletta,
    implicit_midpoint,
    gauss,
    radau,
    lobatto,
    diagonally_implicit,
    explicit_runge_kutta,
    composition_diagonal,
    doubled,
    implicit_damping,
    damped,
    charged,
    langevin,
    constrained,
    wisdom_holman,
    oscillatory,
    multirate,
)
_CATALOGUE: dict[str, Method] = {method.name: method for table in _TABLES for method in table.METHODS}
_ALIASES: dict[str, Method] = {alias: method for method in _CATALOGUE.values() for alias in method.aliases}


def catalogue() -> dict[str, Method]:
    """Return every method by its name, without aliases.

    Returns
    -------
    dict of str to Method

    Examples
    --------
    >>> import kickdrift as kd
    >>> len(kd.methods.catalogue()) > 90
    True
    >>> kd.methods.catalogue()["velocity-verlet"].spelling
    'K/2 D K/2'
    """
    return dict(_CATALOGUE)


def preferred(kind: Kind, order: int | None = None) -> Method:
    """Choose a method by the kind of problem and the requested order, as ``solve(..., method="auto", order=order)`` does.

    Parameters
    ----------
    kind : Kind
        Kind of the problem.
    order : int, optional
        The lowest order wanted; by default the fastest method, or nearly so, for errors between 1e-3 and 1e-9 at the end.

    Returns
    -------
    Method

    Raises
    ------
    MethodMismatchError
        If no method for the kind has so high an order.

    Examples
    --------
    >>> import kickdrift as kd
    >>> from kickdrift.methods import Kind
    >>> kd.methods.preferred(Kind.NEWTONIAN, order=6).name
    'blanes-moan-srkn11b'
    """
    return preference.preferred(kind, order, _CATALOGUE)


def preferred_for_stiff(order: int | None, steps: float) -> Method | None:
    """Choose a method for decay much faster than a step, of so many; None if no L-stable method has so high an order."""
    return preference.for_stiff(order, steps, _CATALOGUE)


def preferred_for_fast_oscillations(kind: Kind) -> Method:
    """Choose a method for oscillations much faster than a step."""
    return preference.for_fast_oscillations(kind, _CATALOGUE)


def preferred_for_nearly_keplerian(turn: float) -> Method:
    """Choose by the angle that the fastest body moves through in a step at its pericentre."""
    if turn > preference.LONG_STEP:
        return preference.for_long_steps(_CATALOGUE)
    return preferred(Kind.NEARLY_KEPLERIAN)


def get(name: str | Method) -> Method:
    """Return a method by its name or an alias; a `Method` is returned unchanged.

    Parameters
    ----------
    name : str or Method
        As in `catalogue`, or an alias such as ``"leapfrog"``.

    Returns
    -------
    Method

    Raises
    ------
    UnknownNameError
        For a name that is not in the catalogue; the message suggests similar ones.

    Examples
    --------
    >>> import kickdrift as kd
    >>> kd.methods.get("leapfrog").name
    'velocity-verlet'
    """
    if isinstance(name, Method):
        return name
    if not isinstance(name, str):
        raise unknown_name("method", name, [*_CATALOGUE, *_ALIASES])
    if name in _CATALOGUE:
        return _CATALOGUE[name]
    if name in _ALIASES:
        return _ALIASES[name]
    raise unknown_name("method", name, [*_CATALOGUE, *_ALIASES])

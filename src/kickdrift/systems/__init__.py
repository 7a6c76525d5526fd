"""The systems: descriptions of motion. A new one is a file of its own and a line in the catalogue."""

from collections.abc import Callable

from kickdrift.core.errors import unknown_name
from kickdrift.systems.benchmarks_game import benchmarks_game
from kickdrift.systems.charged import ChargedParticle
from kickdrift.systems.constrained import Constrained
from kickdrift.systems.damped import Damped
from kickdrift.systems.first_order import FirstOrder
from kickdrift.systems.hamiltonian import Hamiltonian, Partitioned, Separable
from kickdrift.systems.harmonic_oscillator import harmonic_oscillator
from kickdrift.systems.kepler import kepler
from kickdrift.systems.langevin import Langevin
from kickdrift.systems.multirate import Multirate
from kickdrift.systems.nbody import nbody
from kickdrift.systems.oscillatory import Oscillatory
from kickdrift.systems.outer_solar_system import outer_solar_system
from kickdrift.systems.pendulum import pendulum
from kickdrift.systems.planetary import planetary
from kickdrift.systems.problem import Problem
from kickdrift.systems.second_order import Newtonian, SecondOrder
from kickdrift.systems.solar_system import ephemeris, solar_system
from kickdrift.systems.system import Quantity, System

__all__ = [
    "ChargedParticle",
    "Constrained",
    "Damped",
    "FirstOrder",
    "Hamiltonian",
    "Langevin",
    "Multirate",
    "Newtonian",
    "Oscillatory",
    "Partitioned",
    "Problem",
    "Quantity",
    "SecondOrder",
    "Separable",
    "System",
    "benchmarks_game",
    "catalogue",
    "ephemeris",
    "get",
    "harmonic_oscillator",
    "kepler",
    "nbody",
    "outer_solar_system",
    "pendulum",
    "planetary",
    "solar_system",
]


def __dir__() -> list[str]:
    return __all__


_CATALOGUE: dict[str, Callable[[], System]] = {
    "harmonic-oscillator": harmonic_oscillator,
    "pendulum": pendulum,
    "kepler": kepler,
    "solar-system": solar_system,
    "outer-solar-system": outer_solar_system,
    "benchmarks-game": benchmarks_game,
}


def catalogue() -> dict[str, Callable[[], System]]:
    """Return the systems with a default initial state, by name: functions that create them.

    Returns
    -------
    dict of str to callable

    Examples
    --------
    >>> import kickdrift as kd
    >>> sorted(kd.systems.catalogue())[:3]
    ['benchmarks-game', 'harmonic-oscillator', 'kepler']
    """
    return dict(_CATALOGUE)


def get(name: str) -> System:
    """Create a system of the catalogue, with its default initial state.

    Parameters
    ----------
    name : str
        As in `catalogue`.

    Returns
    -------
    System

    Raises
    ------
    UnknownNameError
        For a name that is not in the catalogue; the message suggests similar ones.

    Examples
    --------
    >>> import kickdrift as kd
    >>> kd.systems.get("kepler").name
    'kepler'
    """
    if not isinstance(name, str) or name not in _CATALOGUE:
        raise unknown_name("system", name, _CATALOGUE)
    return _CATALOGUE[name]()

"""The methods: tables, found by name."""

from kickdrift.core.errors import unknown_name
from kickdrift.methods import blanes_moan, euler, forest_ruth, implicit_midpoint, stormer_verlet
from kickdrift.methods.record import Kind, Letter, Method, alternating, word

__all__ = ["Kind", "Letter", "Method", "alternating", "catalogue", "get", "word"]

_TABLES = (euler, stormer_verlet, forest_ruth, blanes_moan, implicit_midpoint)
_CATALOGUE: dict[str, Method] = {method.name: method for table in _TABLES for method in table.METHODS}
_ALIASES: dict[str, Method] = {alias: method for method in _CATALOGUE.values() for alias in method.aliases}


def catalogue() -> dict[str, Method]:
    """Return every method by its name, aliases left out.

    Returns
    -------
    dict of str to Method
    """
    return dict(_CATALOGUE)


def get(name: str | Method) -> Method:
    """Find a method by its name or an alias; a `Method` of your own is returned as it is.

    Raises
    ------
    UnknownNameError
        For a name that is not in the catalogue; the sentence names the nearest ones.
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

"""The names of what was swept in an ensemble, beside those of its arrays."""

from collections.abc import Iterable

from kickdrift.core.errors import KickdriftError


def check_swept(swept: Iterable[str], taken: Iterable[str]) -> None:
    """Refuse parameters with the names of arrays.

    Raises
    ------
    KickdriftError
    """
    if known := sorted({*swept} & {*taken}):
        raise KickdriftError(
            f"args has the name {known[0]!r}, and so have times, states or conserved quantities; with"
            " dataclasses.replace(solution, parameters={...}) it gets another."
        )

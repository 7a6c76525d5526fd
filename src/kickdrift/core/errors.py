"""Errors are sentences: the argument, its value, why it cannot be used, and what to do instead."""

import difflib
import inspect
import re
from collections.abc import Iterable
from itertools import takewhile

# Numbers, and lists of them, that are longer than a line
_LONG_NUMBERS = re.compile(r"[\d\s.,e+\-\[\]()]{120,}")


class KickdriftError(Exception):
    """The base class of all errors that kickdrift raises on purpose; long numbers are shortened in its message.

    Examples
    --------
    >>> import kickdrift as kd
    >>> issubclass(kd.ArgumentError, kd.KickdriftError)
    True
    """

    def __init__(self, message: object = "") -> None:
        super().__init__(_LONG_NUMBERS.sub(_shortened, str(message)))


def _shortened(numbers: re.Match[str]) -> str:
    return f"{numbers[0][:40]}...{numbers[0][-20:]}"


class ArgumentError(KickdriftError, ValueError):
    """An argument that cannot be used, found before any work was done.

    Examples
    --------
    >>> import kickdrift as kd
    >>> try:
    ...     kd.solve(kd.systems.kepler(), (0.0, 1.0), step=-0.1)
    ... except kd.ArgumentError as error:
    ...     print(error)
    step=-0.1 must be positive and finite; give its size; t_span sets the direction.
    """


class UnknownNameError(ArgumentError):
    """An unknown name of a method, a system, a body, a joint or a cloth; the message suggests others.

    Examples
    --------
    >>> import kickdrift as kd
    >>> try:
    ...     kd.methods.get("leap-frog")
    ... except kd.UnknownNameError as error:
    ...     print("did you mean 'leapfrog'" in str(error))
    True
    """


class MethodMismatchError(ArgumentError):
    """A method whose order would be lost on the structure of the system.

    Examples
    --------
    >>> import kickdrift as kd
    >>> try:
    ...     kd.solve(lambda x, v: -v, (0.0, 1.0), 1.0, 0.0, step=0.1, method="leapfrog")
    ... except kd.MethodMismatchError as error:
    ...     print("implicit-verlet" in str(error))
    True
    """


class MissingExtraError(KickdriftError, ImportError):
    """An optional package that is not installed; the message gives the command that installs it."""


class FileFormatError(KickdriftError):
    """A file that cannot be read or written, or has invalid contents.

    Examples
    --------
    >>> import kickdrift as kd
    >>> try:
    ...     kd.load("missing.npz")
    ... except kd.FileFormatError as error:
    ...     print("missing.npz" in str(error))
    True
    """


class LostBodyError(KickdriftError):
    """A body of a world that went to infinity."""


class InterpretedWarning(UserWarning):
    """A user's function runs interpreted, because Numba cannot compile it."""


class UnsolvedWarning(UserWarning):
    """Results of a world may be unreliable.

    Contacts or impacts were left unsolved or missed, joints lost energy or have no solution together with contacts, or a cloth
    is far softer than its material.
    """


def unknown_name(argument: str, value: object, known: Iterable[str]) -> UnknownNameError:
    """Build the error for a name that is not in a catalogue, with similar names."""
    known = sorted(known)
    near = difflib.get_close_matches(str(value), known, n=3, cutoff=0.4)
    hint = f"known: {', '.join(known)}." if known else "there are no names to choose from."
    if near:
        hint = f"did you mean {' or '.join(repr(name) for name in near)}?"
    return UnknownNameError(f"{argument}={value!r} is unknown; {hint}")


def missing_extra(feature: str, package: str, extra: str) -> MissingExtraError:
    """Build the error for an optional dependency, with the command that installs it."""
    return MissingExtraError(
        f"{feature} needs the package {package!r}, which is not installed; run: pip install 'kickdrift[{extra}]'"
    )


def depth_of_caller() -> int:
    """Stack level of the first frame outside kickdrift, for a warning that points there."""
    package = __name__.split(".")[0] + "."
    frames = inspect.stack(context=0)[1:]
    inside = takewhile(lambda frame: f"{frame.frame.f_globals.get('__name__')}.".startswith(package), frames)
    return len(list(inside)) + 1

"""Comparison of a user's function compiled and interpreted: integers beyond 64 bits overflow in compiled code."""

import random
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from weakref import WeakSet

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.compilation import Function
from kickdrift.core.errors import ArgumentError

Floats = NDArray[np.float64]

_COMPARED: WeakSet[Function] = WeakSet()  # functions that were compared in this process
LARGEST = 100  # numbers of a state, up to which the interpreter does a double loop quickly
_CLOSE = 1e-3  # tolerance relative to the largest number: rounding differs, by far in float32
_QUICK = 1e-4  # s of a compiled call, up to which the interpreted one does not take long
_TRIES = 5  # measurements of that time, since the machine may be busy


def aside(values: Floats) -> Floats:
    """Return slightly different values: at a symmetric start, sums may cancel to their rounding errors."""
    near: Floats = values * (1.0 + 1e-3 * np.cos(np.arange(1.0, values.size + 1.0))) + 1e-9
    return near


def compared(native: Function) -> bool:
    """Whether a compiled function was compared in this process."""
    return native in _COMPARED


def compare(
    name: str, native: Function, interpreted: Callable[[], Function], call: Callable[[Function], Floats]
) -> None:
    """Compare a compiled function with the same one interpreted.

    Parameters
    ----------
    name : str
        Name of the function, for the error.
    native : callable
        The compiled one.
    interpreted : callable
        Returns the one for the interpreter.
    call : callable
        Calls one of them near the start, and returns its result.

    Raises
    ------
    ArgumentError
        If the results differ by more than rounding, unless those of two interpreted calls differ, too.
    """
    found = wanted = again = np.zeros(0)
    with suppress(Exception), _chance_kept():  # Python raises where compiled code gives an infinity
        found = call(native)
        if any(_seconds(call, native) < _QUICK for _ in range(_TRIES)):
            python = interpreted()
            wanted, again = call(python), call(python)
        else:
            wanted = again = found
    if not np.array_equal(wanted, again, equal_nan=True):
        _COMPARED.add(native)
        return
    most = _CLOSE * np.abs(wanted[np.isfinite(wanted)]).max(initial=0.0)
    differ = ~np.isclose(found, wanted, 0.0, most, equal_nan=True)
    if differ.any():
        k = int(np.argmax(differ))
        raise ArgumentError(
            f"{name} returns {float(found[k])!r} compiled but {float(wanted[k])!r} in Python near the initial state;"
            " integers beyond 2**63, for example, overflow in compiled code. Write them as floats (1e12, not 10**12),"
            " or pass compile=False."
        )
    _COMPARED.add(native)


def _seconds(call: Callable[[Function], Floats], native: Function) -> float:
    started = time.perf_counter()
    call(native)
    return time.perf_counter() - started


@contextmanager
def _chance_kept() -> Iterator[None]:
    """Restore the states of the global random number generators afterwards."""
    of_numpy, of_python = np.random.get_state(), random.getstate()  # noqa: NPY002 - those that users draw from
    try:
        yield
    finally:
        np.random.set_state(of_numpy)  # noqa: NPY002
        random.setstate(of_python)

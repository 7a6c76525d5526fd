"""Tables that forces can call: ephemerides and measured series, by cubic splines."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import FunctionType
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numba.core.registry import CPUDispatcher
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError

Floats = NDArray[np.float64]

OUTSIDE = "a kd.spline is evaluated at a time outside its table"
_ENDS = ("not-a-knot", "natural", "clamped", "periodic")
_ROUNDING = 1e-9  # of the length: the times of a run are sums
_SMALLEST = 8  # knots

_ranges: WeakKeyDictionary[Any, tuple[float, float]] = WeakKeyDictionary()


def spline(t: ArrayLike, values: ArrayLike, end: str = "not-a-knot") -> Callable[[float], Any]:
    """Create a function from a table, which forces can call, compiled or not: a cubic spline through its values.

    Its values are data of the compiled force: another table of the same shape, with other times and values, does not
    recompile the force if it has at most as many rows, rounded up to a power of two.

    Parameters
    ----------
    t : (T,) array_like
        Times, or another abscissa, strictly increasing; at least two.
    values : (T,) or (T, ...) array_like
        Numbers, vectors, or arrays; the function returns an interpolated one.
    end : str
        Boundary condition: ``"not-a-knot"``, one cubic through the first four values; ``"natural"``, zero curvature;
        ``"clamped"``, zero slope; or ``"periodic"``.

    Returns
    -------
    callable
        ``table(t)``, for a number t. It raises outside the table: a run whose span extends beyond it is refused before it
        starts. A few methods with negative substeps, such as `yoshida-8`, and variable steps evaluate it slightly beyond the
        span.

    Raises
    ------
    ArgumentError
        For times that are not increasing, another number of values, or values that are not finite.

    Notes
    -----
    The coefficients are those of `scipy.interpolate.CubicSpline`.

    Examples
    --------
    >>> import numpy as np, kickdrift as kd
    >>> times = np.linspace(0.0, 10.0, 101)
    >>> push = kd.spline(times, np.sin(times))
    >>> options = {"step": 0.01, "method": "leapfrog", "compile": False}
    >>> sol = kd.solve(lambda t, x: push(t) - x, (0.0, 10.0), 1.0, 0.0, **options)
    >>> sol.success
    True
    """
    from scipy.interpolate import CubicSpline

    times, table = _checked(t, values)
    if end not in _ENDS:
        raise ArgumentError(f"end={end!r} must be one of {', '.join(map(repr, _ENDS))}.")
    try:
        found = CubicSpline(times, table, bc_type=end)
    except ValueError as error:
        raise ArgumentError(f"values do not fit end={end!r}: {error}.") from None
    size = max(_SMALLEST, 1 << (times.size - 1).bit_length())
    knots = np.full(size, np.inf)
    knots[: times.size] = times
    pieces = np.zeros((size, 4, *table.shape[1:]))
    pieces[: times.size - 1] = np.moveaxis(found.c, 0, 1)[:, ::-1]
    first, last = float(times[0]), float(times[-1])
    function = _Written(_function(knots, pieces, float(times.size), _ROUNDING * (last - first)), {}, _OPTIONS)
    _ranges[function] = first, last
    return function


class _Written(CPUDispatcher):  # type: ignore[misc]
    """A function that other compiled ones call, and the interpreter runs as it is written: 0.3 s less to wait for."""

    def __call__(self, t: float) -> Any:
        """Call Python's function."""
        if np.ndim(t):
            raise ArgumentError(f"a kd.spline takes one number, not an array of shape {np.shape(t)}; call it for each.")
        return self.py_func(t)


_OPTIONS = {"nopython": True}


def _checked(t: ArrayLike, values: ArrayLike) -> tuple[Floats, Floats]:
    try:
        times, table = reals(t), reals(values)
    except TypeError as error:
        raise ArgumentError(f"t and values must be arrays of numbers: {error}.") from None
    if times.ndim != 1 or times.size < 2 or table.shape[:1] != times.shape or not table.size:
        raise ArgumentError(
            f"t and values have shapes {times.shape} and {table.shape}; give at least two times, and one value per"
            " time."
        )
    if not (np.isfinite(times).all() and np.isfinite(table).all()):
        raise ArgumentError("t and values must be finite; leave out missing values.")
    if not (np.diff(times) > 0).all():
        row = int(np.argmin(np.diff(times) > 0))
        raise ArgumentError(
            f"t must be strictly increasing, but {float(times[row])!r} is followed by {float(times[row + 1])!r}; sort"
            " it."
        )
    return times, table


def _function(knots: Floats, pieces: Floats, rows: float, rounding: float) -> Callable[[float], Any]:
    """Write a function of a table; for one of numbers without views, whose references would be counted."""
    first, last = float(knots[0]), float(knots[int(rows) - 1])
    density = (rows - 1) / (last - first)

    def find_row(t: float) -> int:
        if not first - rounding <= t <= last + rounding:
            raise ValueError("a kd.spline is evaluated at a time outside its table")  # OUTSIDE, which is not a number
        low, high = 0, int(rows) - 1
        guess = min(max(int((t - first) * density), 0), high - 1)
        if knots[guess] <= t < knots[guess + 1]:  # where knots are evenly spaced
            return guess
        while high - low > 1:
            middle = (low + high) // 2
            if knots[middle] <= t:
                low = middle
            else:
                high = middle
        return low

    row_of = _Written(find_row, {}, _OPTIONS)

    def number(t: float) -> float:
        row = row_of(t)
        s = t - knots[row]
        value: float = ((pieces[row, 3] * s + pieces[row, 2]) * s + pieces[row, 1]) * s + pieces[row, 0]
        return value

    def array(t: float) -> Any:
        row = row_of(t)
        piece, s = pieces[row], t - knots[row]
        return ((piece[3] * s + piece[2]) * s + piece[1]) * s + piece[0]

    return number if pieces.ndim == 2 else array


def ranges_used(*given: Any) -> list[tuple[float, float]]:
    """Return from where to where the tables go that functions call: those given, or parts of what is given."""
    if not _ranges:
        return []
    functions = [function for one in given for function in _functions_in(one)]
    seen: set[int] = set()
    return sorted({found for function in functions for found in _ranges_of(function, seen)})


def _functions_in(given: Any) -> list[Any]:
    if isinstance(given, list | tuple):
        return [function for one in given for function in _functions_in(one)]
    return [given, *vars(given).values()] if hasattr(given, "__dict__") else [given]


def _ranges_of(function: Any, seen: set[int]) -> Iterator[tuple[float, float]]:
    if id(function) in seen:
        return
    seen.add(id(function))
    if isinstance(function, CPUDispatcher):
        if function in _ranges:
            yield _ranges[function]
            return
        function = function.py_func
    if isinstance(function, FunctionType):
        names = function.__code__.co_names
        cells = (cell.cell_contents for cell in function.__closure__ or () if _is_filled(cell))
        for value in (*(function.__globals__[name] for name in names if name in function.__globals__), *cells):
            if isinstance(value, FunctionType | CPUDispatcher):
                yield from _ranges_of(value, seen)


def _is_filled(cell: Any) -> bool:
    try:
        cell.cell_contents  # noqa: B018 - raises where it is empty
    except ValueError:
        return False
    return True

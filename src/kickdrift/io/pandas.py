"""Solutions as data frames."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from kickdrift.core.errors import KickdriftError, missing_extra
from kickdrift.engine.solution import Solution
from kickdrift.io.swept import check_swept
from kickdrift.scale.ensemble_solution import EnsembleSolution


def to_pandas(solution: Solution) -> Any:
    """Return a solution as a `pandas.DataFrame`: one row per time, one column per number.

    The index is the time, ``t``. Columns are named by the labels of the state, ``x``, ``x[0]`` or ``x[Jupiter, y]``, and
    ``energy``, ``angular momentum[2]`` and so on for conserved quantities. ``frame.attrs["units"]`` has their units.

    Raises
    ------
    KickdriftError
        If the states are on disk.
    MissingExtraError
        If pandas is not installed.
    """
    if solution.saved_to:
        raise KickdriftError(
            f"the states are on disk, in {solution.saved_to!r}, and the solution has only the first and the last; read them"
            " with to_xarray()."
        )
    pd = _pandas("Solution")
    return _frame(pd, solution.plain, pd.Index(solution.plain.t, name="t"), {})


def ensemble_to_pandas(solution: EnsembleSolution) -> Any:
    """Return the solution of an ensemble as a `pandas.DataFrame`: one row per member and time.

    The index has the levels ``member`` and ``t``. Columns are what was swept, and those of `to_pandas`.

    Raises
    ------
    KickdriftError
        If what was swept has the name of another column.
    MissingExtraError
        If pandas is not installed.
    """
    pd = _pandas("EnsembleSolution")
    index = pd.MultiIndex.from_product([range(len(solution)), solution.t], names=["member", "t"])
    return _frame(pd, solution, index, solution.parameters)


def _pandas(what: str) -> Any:
    try:
        import pandas
    except ImportError:
        raise missing_extra(f"{what}.to_pandas", "pandas", "pandas") from None
    return pandas


def _frame(pd: Any, solution: Solution | EnsembleSolution, index: Any, swept: Mapping[str, Any]) -> Any:
    """Return a frame with a row per entry of the index, of which each level is a dimension of the arrays."""
    labels = [solution.about.coordinates.get(name) for name in solution.about.dimensions]
    columns, units = {}, {"t": solution.about.units.get("t", "")}
    for name, values in {"x": solution.x, "v": solution.v, **solution.invariants}.items():
        flat = np.reshape(values, (len(index), *values.shape[index.nlevels :]))
        for column, numbers in _columns(name, flat, labels if values.shape == solution.x.shape else []):
            columns[column], units[column] = numbers, solution.about.units.get(name, "")
    of_members = {
        column: np.repeat(numbers, solution.t.size)
        for name, values in swept.items()
        for column, numbers in _columns(name, values, [])
    }
    check_swept(of_members, [*columns, *index.names])
    frame = pd.DataFrame({**of_members, **columns}, index=index)
    frame.attrs["units"] = {column: unit for column, unit in units.items() if unit}
    return frame


def _columns(name: str, values: Any, labels: list[Any]) -> Iterator[tuple[str, Any]]:
    for place in np.ndindex(values.shape[1:]):
        words = [
            str(labels[axis][k]) if axis < len(labels) and labels[axis] else str(k) for axis, k in enumerate(place)
        ]
        yield (f"{name}[{', '.join(words)}]" if words else name), values[(slice(None), *place)]

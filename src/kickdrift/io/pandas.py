"""Solutions as data frames."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from kickdrift.core.errors import missing_extra
from kickdrift.engine.solution import Solution


def to_pandas(solution: Solution) -> Any:
    """Return a solution as a `pandas.DataFrame`: one row per time, one column per number.

    The index is the time, ``t``. Columns are named by the labels of the state, ``x``, ``x[0]`` or ``x[Jupiter, y]``, and
    ``energy``, ``angular momentum[2]`` and so on for conserved quantities. ``frame.attrs["units"]`` has their units.

    Raises
    ------
    MissingExtraError
        If pandas is not installed.
    """
    try:
        import pandas as pd
    except ImportError:
        raise missing_extra("Solution.to_pandas", "pandas", "pandas") from None
    solution = solution.plain
    labels = [solution.about.coordinates.get(name) for name in solution.about.dimensions]
    kept = {"x": solution.x, "v": solution.v, **solution.invariants}
    columns, units = {}, {"t": solution.about.units.get("t", "")}
    for name, values in kept.items():
        for column, numbers in _columns(name, values, labels if values.shape == solution.x.shape else []):
            columns[column], units[column] = numbers, solution.about.units.get(name, "")
    frame = pd.DataFrame(columns, index=pd.Index(solution.t, name="t"))
    frame.attrs["units"] = {column: unit for column, unit in units.items() if unit}
    return frame


def _columns(name: str, values: Any, labels: list[Any]) -> Iterator[tuple[str, Any]]:
    for place in np.ndindex(values.shape[1:]):
        words = [
            str(labels[axis][k]) if axis < len(labels) and labels[axis] else str(k) for axis, k in enumerate(place)
        ]
        yield (f"{name}[{', '.join(words)}]" if words else name), values[(slice(None), *place)]

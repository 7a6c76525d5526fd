"""Small tables: columns by name, as Markdown and as a data frame."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import missing_extra

Column = Sequence[Any] | NDArray[Any]


def markdown(columns: Mapping[str, Column]) -> str:
    """Spell columns of one length as a table of Markdown."""
    cells = [[name, *map(_cell, column)] for name, column in columns.items()]
    widths = [max(map(len, column)) for column in cells]
    head, *rows = (
        "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) + " |"
        for row in zip(*cells, strict=True)
    )
    return "\n".join([head, "| " + " | ".join("-" * width for width in widths) + " |", *rows])


def frame(columns: Mapping[str, Column], caller: str) -> Any:
    """Make a `pandas.DataFrame` of columns.

    Raises
    ------
    MissingExtraError
        If pandas is not installed.
    """
    try:
        import pandas as pd
    except ImportError:
        raise missing_extra(caller, "pandas", "pandas") from None
    return pd.DataFrame(dict(columns))


def _cell(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float | np.floating) else str(value).replace("|", "\\|")

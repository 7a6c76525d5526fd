"""What solutions borrow from the floors above."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Presenters:
    """What a solution can do on the floors above: the package hands it down when it is imported."""

    plot: Callable[..., Any]
    save: Callable[..., Path]
    to_pandas: Callable[..., Any]
    to_xarray: Callable[..., Any]
    report: Callable[..., str]

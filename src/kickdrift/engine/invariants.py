"""Conserved quantities of a solution, evaluated on first access."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Invariants(Mapping[str, Floats]):
    """Conserved quantities by name, each evaluated on first access."""

    def __init__(self, names: tuple[str, ...], evaluate: Callable[[str], Floats]) -> None:
        self._names = names
        self._evaluate = evaluate
        self._known: dict[str, Floats] = {}

    def __getitem__(self, name: str) -> Floats:
        if name not in self._names:
            raise KeyError(name)
        if name not in self._known:
            self._known[name] = self._evaluate(name)
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __reduce__(self) -> tuple[Any, ...]:
        # Pickled by value, since the system may contain functions that cannot be pickled.
        return Invariants, (self._names, dict(self).__getitem__)

    def __repr__(self) -> str:
        return f"Invariants({', '.join(self._names)})"

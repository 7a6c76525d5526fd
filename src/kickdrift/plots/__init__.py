"""What people look at: pictures by matplotlib."""

from typing import Any


def plot_solution(solution: Any, path: Any = None) -> Any:
    raise NotImplementedError

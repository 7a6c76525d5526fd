"""The check of arguments that must be solutions."""

from typing import Any

from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution


def checked(solution: Any) -> Solution:
    """Return a solution; ArgumentError for anything else."""
    if not isinstance(solution, Solution):
        raise ArgumentError(f"solution={solution!r} is not a solution; give the result of kd.solve or kd.load.")
    return solution

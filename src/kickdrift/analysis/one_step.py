"""One step of a method, by the engine."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import KickdriftError
from kickdrift.engine.solve import solve
from kickdrift.methods import Method
from kickdrift.systems.system import System

Floats = NDArray[np.float64]


def take_step(problem: Any, method: str | Method, step: float, x: Floats, v: Floats, t: float = 0.0) -> tuple[Any, Any]:
    """Return x and v one step later.

    The engine runs interpreted, which gives the same bits: 0.15 ms, where loading a compiled flow takes 5 and compiling
    one 500.

    Raises
    ------
    KickdriftError
        If the step fails.
    """
    if isinstance(problem, System):
        problem = replace(problem, native=False)
    end = solve(
        problem, (t, t + step), x, v, step=abs(step), method=method, t_eval=[t + step], compile=False, progress=False
    )
    if not end.success:
        raise KickdriftError(f"step={step!r} of {end.about.method!r} failed: {end.message}")
    return end.x[-1], end.v[-1]

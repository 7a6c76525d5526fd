"""Laws of motion: each written once, number by number, and handed to every library in the form that it likes best."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rates = Callable[[Any, Any, Any], Any]  # (t, x, v) -> the rates as a tuple or list of scalars


def nothing(t: Any, x: Any, v: Any) -> Any:
    """Return the rates of no velocities: those of first-order equations."""
    return ()


@dataclass(frozen=True)
class Law:
    """Equations of motion: x' and v' of t, x and v. First-order equations have x' alone."""

    velocity: Rates
    force: Rates = nothing


AnyLaw = Callable[[ModuleType], Law]  # of a module with sqrt, sin and cos: math, jax.numpy or heyoka


def lawless(module: ModuleType) -> Law:
    """Stand for a law of another kind, such as one with noise.

    Raises
    ------
    LookupError
        Always.
    """
    raise LookupError("this case has no law of this form; its contestants bring their own.")


def compiled(rates: Rates) -> Callable[[float, Floats, Floats, Floats], None]:
    """Compile rates into a function that writes them: ``f(t, x, v, out)``."""
    inner = numba.njit(rates)

    @numba.njit
    def write(t: float, x: Floats, v: Floats, out: Floats) -> None:
        values = inner(t, x, v)
        for i in range(len(values)):
            out[i] = values[i]

    return write


def writing(law: AnyLaw, n: int) -> Callable[[float, Floats, Floats], None]:
    """Compile a law for n positions into ``f(t, y, out)``, with y the positions and then the velocities."""
    made = law(math)
    velocity = compiled(made.velocity)
    if made.force is nothing:

        @numba.njit
        def write(t: float, y: Floats, out: Floats) -> None:
            velocity(t, y, y, out)

        return write
    force = compiled(made.force)

    @numba.njit
    def write_both(t: float, y: Floats, out: Floats) -> None:
        velocity(t, y[:n], y[n:], out[:n])
        force(t, y[:n], y[n:], out[n:])

    return write_both


def returning(law: AnyLaw, n: int) -> Callable[[float, Floats], Floats]:
    """Compile a law into ``f(t, y)``."""
    write = writing(law, n)

    @numba.njit
    def rates(t: float, y: Floats) -> Floats:
        out = np.empty_like(y)
        write(t, y, out)
        return out

    return rates


def expressed(law: AnyLaw, module: ModuleType, n: int, t: Any, y: Any) -> list[Any]:
    """Evaluate a law with the functions of another module."""
    made = law(module)
    x, v = y[:n], y[n:]
    return [*made.velocity(t, x, v), *made.force(t, x, v)]

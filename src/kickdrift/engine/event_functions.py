"""Event functions, whose zeros are located along a run: adapted to the state, with the attributes set by the user."""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.core.kinds import Kind
from kickdrift.systems.problem import name_of
from kickdrift.systems.system import Quantity, System


class Event(NamedTuple):
    """An event function: its name, and the attributes set by the user."""

    name: str
    quantity: Quantity
    terminal: int  # number of the zero at which the run ends, 0 for none
    direction: float  # sign of the rates of the zeros, 0 for any
    rate_bound: float | None


def events_of(events: Any, quantity: Callable[[str, Any], Quantity]) -> tuple[Event, ...]:
    """Adapt functions to the state by `quantity`, and read their attributes.

    Raises
    ------
    ArgumentError
        For anything but functions of the state, and for invalid attributes.
    """
    return tuple(_event(f"events[{k}]", function, quantity) for k, function in enumerate(functions_of(events)))


def functions_of(events: Any) -> tuple[Any, ...]:
    """Return a tuple of functions, given one, several or none."""
    if events is None:
        return ()
    return tuple(events) if isinstance(events, Sequence) else (events,)


def _event(name: str, function: Any, quantity: Callable[[str, Any], Quantity]) -> Event:
    terminal, direction = getattr(function, "terminal", False), getattr(function, "direction", 0)
    bound = getattr(function, "rate_bound", None)
    argument, name = name, f"{name}, {name_of(function)}" if callable(function) else name
    if not (isinstance(terminal, bool | np.bool_ | int | np.integer) and terminal >= 0):
        raise ArgumentError(
            f"{name}, has terminal={terminal!r}; give True, False, or the number of the zero that ends the run."
        )
    for attribute, value, valid, wanted in (
        ("direction", direction, _is_real(direction), "a number, whose sign selects zeros"),
        ("rate_bound", bound, bound is None or (_is_real(bound) and 0.0 < bound < math.inf), "a positive number"),
    ):
        if not valid:
            raise ArgumentError(f"{name}, has {attribute}={value!r}; give {wanted}.")
    return Event(
        name,
        quantity(argument, function),
        int(terminal),
        float(np.sign(direction)),
        None if bound is None else float(bound),
    )


def _is_real(value: Any) -> bool:
    number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    return number and not math.isnan(value)


def check_path(events: tuple[Event, ...], system: System) -> None:
    """Refuse events where the path is not known between two steps.

    Raises
    ------
    ArgumentError
        For Langevin dynamics.
    """
    if events and system.kind is Kind.LANGEVIN:
        raise ArgumentError(
            "events are given, but the path is stochastic, and not known between steps; leave them out."
        )

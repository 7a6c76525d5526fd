"""Fields of records that are computed when they are first read."""

from collections.abc import Callable
from functools import partial
from typing import Any


def deferred(function: Callable[..., Any], *arguments: Any) -> Any:
    """Return what computes the value of a field, to be given in its place."""
    return partial(function, *arguments)


class Deferred:
    """The attribute of a class of records that makes a field `deferred`."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, record: object, owner: type | None = None) -> Any:
        if record is None:
            return self
        values = vars(record)
        if self._name not in values:
            raise AttributeError(self._name)
        value = values[self._name]
        if type(value) is partial:
            value = values[self._name] = value()
        return value

    def __set__(self, record: object, value: Any) -> None:
        vars(record)[self._name] = value

"""Signatures that show the arguments which functions pass on."""

import inspect
from collections.abc import Callable
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])


def shows_parameters_of(source: Callable[..., Any], leave_out: tuple[str, ...] = ()) -> Callable[[F], F]:
    """Return a decorator for functions that pass ``**options``, and ``*args``, on to `source`.

    In `inspect.signature`, `help` and completion they have the parameters of `source` instead, but for those of the same name
    and those to leave out. Without ``*args`` these are given by keyword.
    """

    def decorate(function: F) -> F:
        signature = inspect.signature(function, follow_wrapped=False)
        own = [
            each for each in signature.parameters.values() if each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD)
        ]
        own = [each.replace(annotation=each.empty) if each.name == "self" else each for each in own]
        by_keyword = not any(each.kind == each.VAR_POSITIONAL for each in signature.parameters.values())
        known = {*(each.name for each in own), *leave_out, "self"}
        passed_on = [each for each in inspect.signature(source).parameters.values() if each.name not in known]
        if by_keyword:
            passed_on = [each.replace(kind=each.KEYWORD_ONLY) for each in passed_on if each.default is not each.empty]
        vars(function)["__signature__"] = signature.replace(parameters=[*own, *passed_on])
        return function

    return decorate

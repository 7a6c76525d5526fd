"""What Numba knows of types and of how to write code for them, and remembers once it has found it.

Numba asks all templates of an operator for the type of a sum as often as there is one, and looks for new ones whenever it
begins with a function.
"""

import copy
import operator
from functools import cache
from typing import Any

from numba import types
from numba.core.cpu import CPUContext
from numba.core.typing.context import Context

_MOST_KNOWN = 20_000  # of 0.5 kB each; a world with joints makes a third of them


class Typing(Context):  # type: ignore[misc]
    """Finds types of calls and of operators once for types of arguments, not at each place."""

    known: dict[Any, Any]

    def refresh(self) -> None:
        """Take in what has been declared since."""
        for registry in tuple(self._registries):
            self.install_registry(registry)

    def resolve_function_type(self, func: Any, args: Any, kws: Any) -> Any:
        """Return the signature with which a function is called."""
        if kws or not _depends_on_types_alone(func):
            return super().resolve_function_type(func, args, kws)
        key = func, *args
        if (signature := self.known.get(key)) is None:
            signature = super().resolve_function_type(func, args, kws)
            if signature is not None and signature.is_precise():
                self._keep(key, signature)
        return signature

    def resolve_static_getitem(self, value: Any, index: Any) -> Any:
        """Return the signature with which an element is read whose index is known."""
        if type(index) is not int:
            return super().resolve_static_getitem(value, index)
        key = operator.getitem, value, index
        if (signature := self.known.get(key)) is None:
            signature = super().resolve_static_getitem(value, index)
            self._keep(key, signature)
        return signature

    def resolve_setitem(self, target: Any, index: Any, value: Any) -> Any:
        """Return the signature with which an element is written."""
        return self.resolve_function_type(operator.setitem, (target, index, value), {})

    def _keep(self, key: Any, signature: Any) -> None:
        if len(self.known) >= _MOST_KNOWN:
            self.known.clear()  # in a long session most are of functions that have gone
        self.known[key] = signature


def _depends_on_types_alone(function: Any) -> bool:
    """Whether the signature of a call does: not of a method, which may tell what the elements of a list are."""
    if isinstance(function, types.Dispatcher):
        return hasattr(function.dispatcher, "load")
    return isinstance(function, types.Function) or function in _ITERATION or not isinstance(function, types.Type | str)


_ITERATION = ("getiter", "iternext")


class Target(CPUContext):  # type: ignore[misc]
    """Knows a function of the compiler's as soon as it has been found for a signature."""

    found: dict[Any, Any]

    def refresh(self) -> None:
        """Take in what has been implemented since."""
        for registry in tuple(self._registries):
            self.install_registry(registry)
        self.typing_context.refresh()

    def get_returned_value(self, builder: Any, ty: Any, val: Any) -> Any:
        """Return what a call has returned, as a value."""
        model = self.data_model_manager[ty]
        return val if model.get_return_type() == model.get_value_type() else model.from_return(builder, val)

    def get_return_value(self, builder: Any, ty: Any, val: Any) -> Any:
        """Return a value as a call returns it."""
        model = self.data_model_manager[ty]
        return val if model.get_return_type() == model.get_value_type() else model.as_return(builder, val)


@cache
def own_typing(typing: Any) -> Typing:
    """Return what Numba's context knows, and goes on learning, with a memory."""
    typing.refresh()
    own: Typing = copy.copy(typing)
    own.__class__, own.known = Typing, {}
    return own


@cache
def own_target(typing: Any, target: Any) -> Target:
    """Return what Numba's context knows, and goes on learning."""
    target.refresh()
    own: Target = copy.copy(target)
    own.__class__, own.typing_context = Target, own_typing(typing)
    return own

"""Numba's typing and target contexts, with caches for resolved types and implementations.

Numba tries all templates of an operator at each use, and searches for new registrations at the beginning of each function.
"""

import copy
import math
import operator
import sys
from functools import cache
from typing import Any

import numpy as np
from numba import types
from numba.core.cpu import CPUContext
from numba.core.typing.context import Context
from numba.extending import overload
from numba.np.arrayobj import raise_with_shape_context
from numba.np.linalg import norm_impl

_MOST_KNOWN = 20_000  # of 0.5 kB each; a world with joints makes a third of them


def _raise_of_shapes(source: Any, target: Any) -> None:
    """Raise the error of an assignment to a slice from another shape."""
    raise NotImplementedError


@overload(_raise_of_shapes)  # type: ignore[untyped-decorator]
def _raise(source: Any, target: Any) -> Any:
    def raise_(source: Any, target: Any) -> None:
        raise ValueError("a slice is assigned an array of another shape")

    return raise_


def norm(x: Any, ord: Any = None) -> Any:  # noqa: A002 - NumPy's name
    """Return the norm of a vector or a matrix."""
    raise NotImplementedError


@overload(norm)  # type: ignore[untyped-decorator]
def _norm(x: Any, ord: Any = None) -> Any:  # noqa: A002 - NumPy's name
    if not (isinstance(x, types.Array) and x.ndim == 1 and x.dtype == types.float64 and ord in (None, types.none)):
        return None

    def euclidean(x: Any, ord: Any = None) -> float:  # noqa: A002 - NumPy's name
        total = 0.0
        for k in range(x.size):
            total += x[k] * x[k]
        if _LEAST < total < math.inf or math.isnan(total):
            return math.sqrt(total)
        largest = 0.0
        for k in range(x.size):
            largest = max(largest, abs(x[k]))
        if largest == 0.0 or math.isinf(largest):
            return largest
        total = 0.0
        for k in range(x.size):
            total += (x[k] / largest) ** 2
        return largest * math.sqrt(total)

    return euclidean


overload(norm)(norm_impl)  # of all other types


# Smallest sum of squares in which what underflows is less than the rounding error
_LEAST = sys.float_info.min / sys.float_info.epsilon

# Functions of Numba that are replaced. The error of an assignment to a slice, whose text tells the shapes, takes three times as
# long to compile as all else in a function with a slice. The norm of BLAS takes 40 ns more, and loads SciPy, in 0.15 s.
_REPLACED = ((raise_with_shape_context, _raise_of_shapes), (np.linalg.norm, norm))


class Typing(Context):  # type: ignore[misc]
    """Resolves calls and operators once for each combination of argument types, not at each use."""

    known: dict[Any, Any]

    def refresh(self) -> None:
        """Install declarations made since."""
        for registry in tuple(self._registries):
            self.install_registry(registry)

    def resolve_value_type(self, val: Any) -> Any:
        """Return the type of a value."""
        return super().resolve_value_type(next((new for old, new in _REPLACED if val is old), val))

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
        """Return the signature of reading an element with a constant index."""
        if type(index) is not int:
            return super().resolve_static_getitem(value, index)
        key = operator.getitem, value, index
        if (signature := self.known.get(key)) is None:
            signature = super().resolve_static_getitem(value, index)
            self._keep(key, signature)
        return signature

    def resolve_setitem(self, target: Any, index: Any, value: Any) -> Any:
        """Return the signature of writing an element."""
        return self.resolve_function_type(operator.setitem, (target, index, value), {})

    def _keep(self, key: Any, signature: Any) -> None:
        if len(self.known) >= _MOST_KNOWN:
            self.known.clear()  # in a long session most belong to functions that no longer exist
        self.known[key] = signature


def _depends_on_types_alone(function: Any) -> bool:
    """Whether the signature of a call depends on types alone: not that of a method, which may determine a list's elements."""
    if isinstance(function, types.Dispatcher):
        return hasattr(function.dispatcher, "load")
    return isinstance(function, types.Function) or function in _ITERATION or not isinstance(function, types.Type | str)


_ITERATION = ("getiter", "iternext")


class Target(CPUContext):  # type: ignore[misc]
    """A target context that passes on results of calls as they are where they need no conversion."""

    def refresh(self) -> None:
        """Install implementations made since."""
        for registry in tuple(self._registries):
            self.install_registry(registry)
        self.typing_context.refresh()

    def get_returned_value(self, builder: Any, ty: Any, val: Any) -> Any:
        """Convert the result of a call to a value."""
        model = self.data_model_manager[ty]
        return val if model.get_return_type() == model.get_value_type() else model.from_return(builder, val)

    def get_return_value(self, builder: Any, ty: Any, val: Any) -> Any:
        """Convert a value to the result of a call."""
        model = self.data_model_manager[ty]
        return val if model.get_return_type() == model.get_value_type() else model.as_return(builder, val)


@cache
def own_typing(typing: Any) -> Typing:
    """Return a copy of Numba's typing context that shares its registries and caches resolved types."""
    typing.refresh()
    own: Typing = copy.copy(typing)
    own.__class__, own.known = Typing, {}
    return own


@cache
def own_target(typing: Any, target: Any) -> Target:
    """Return a copy of Numba's target context that shares its registries, but not the functions that others have compiled."""
    target.refresh()
    own: Target = copy.copy(target)
    own.__class__, own.typing_context, own.cached_internal_func = Target, own_typing(typing), {}
    return own

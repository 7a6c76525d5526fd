"""Names that occur in the code of a function, read from its bytecode."""

import dis
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from types import CodeType
from typing import Any

from numba.core.typing import templates

from kickdrift.core.naming import digest


class CannotTellError(Exception):
    """The dependencies of a function's compiled code cannot be determined."""


@dataclass(frozen=True)
class Names:
    """Names in a code: globals, names used by inner functions, all names; and its digest.

    Further, the names that are exponents of powers, and those of functions that are only called.
    """

    globals: tuple[str, ...]
    inner: frozenset[str]
    all: frozenset[str]
    digest: str
    exponents: frozenset[str]
    callees: frozenset[str]


@lru_cache(maxsize=1024)
def names_of(code: CodeType) -> Names:
    """Read the names in a code and in those of its inner functions.

    Raises
    ------
    CannotTellError
        If the function assigns to globals or free variables, or imports.
    """
    codes = list(_codes(code))
    loaded, stored, exponents = set(), set(), set()
    for each in codes:
        last = ""
        for instruction in dis.get_instructions(each):
            operation, name = instruction.opname, instruction.argval
            if operation in ("LOAD_GLOBAL", "LOAD_NAME"):
                loaded.add(name)
            elif operation in ("STORE_GLOBAL", "DELETE_GLOBAL", "IMPORT_NAME"):
                raise CannotTellError
            elif operation in ("STORE_DEREF", "DELETE_DEREF"):
                stored.add(name)
            elif operation == "BINARY_OP" and instruction.argrepr.startswith("**"):
                exponents.add(last)
            if operation.startswith("LOAD_"):
                last = str(name[-1] if isinstance(name, tuple) else name)  # some instructions load two
    if stored & set(code.co_freevars):
        raise CannotTellError
    inner = {name for each in codes[1:] for name in (*each.co_names, *each.co_freevars)}
    every = {name for each in codes for name in each.co_names}
    return Names(
        globals=tuple(sorted(loaded)),
        inner=frozenset(inner),
        all=frozenset(every),
        digest=digest(_text_of(code)),
        exponents=frozenset(exponents),
        callees=_callees(code),
    )


def overloaded_elsewhere() -> frozenset[str]:
    """Return the names of functions and methods for which other packages have registered overloads with Numba."""
    registry = templates.builtin_registry
    return _overloaded(len(registry.functions), len(registry.attributes))


@lru_cache(maxsize=1)
def _overloaded(n_functions: int, n_attributes: int) -> frozenset[str]:
    registry, names = templates.builtin_registry, set[str]()
    for template in (*registry.functions[:n_functions], *registry.attributes[:n_attributes]):
        module = getattr(getattr(template, "_overload_func", None), "__module__", None)
        if module is not None and module.partition(".")[0] not in ("numba", "kickdrift"):
            names.add(str(getattr(template, "_attr", None) or getattr(template.key, "__name__", "")))
    return frozenset(names)


def _callees(code: CodeType) -> frozenset[str]:
    """Return the names that are only loaded to be called."""
    called: set[str] = set()
    loaded: set[str] = set()
    instructions = [None, *dis.get_instructions(code), None]
    for before, instruction, after in zip(instructions, instructions[1:], instructions[2:], strict=False):
        if instruction is None or instruction.opname not in ("LOAD_GLOBAL", "LOAD_DEREF"):
            continue
        mark = after if sys.version_info >= (3, 13) else before
        marked = "NULL" in instruction.argrepr.split() or (mark is not None and mark.opname == "PUSH_NULL")
        (called if marked else loaded).add(instruction.argval)
    return frozenset(called - loaded)


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _text_of(code: CodeType) -> str:
    consts = tuple(_text_of(c) if isinstance(c, CodeType) else _constant_of_code(c) for c in code.co_consts)
    counts = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags)
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    table = getattr(code, "co_exceptiontable", b"")
    return repr((code.co_name, code.co_code, table, counts, names, consts))


def _constant_of_code(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_constant_of_code, value))})"
    if isinstance(value, frozenset):
        return f"set({sorted(map(_constant_of_code, value))})"
    return f"{type(value).__name__} {value!r}"

"""Libraries of compiled code that are optimised once, after linking with everything that they call.

Numba links and optimises a function with everything that it calls, translates the result to machine code, and then does the
same for each of its callers, up to the one that is run. Here a *part* is the unoptimised code of one function, with which
callers are linked; a *whole* is a function with all its parts, optimised and translated once: a world with joints takes 38 s
of processor time instead of 72.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any

from llvmlite.binding import parse_assembly
from numba.core.codegen import JITCodeLibrary
from numba.core.environment import lookup_environment
from numba.core.fastmathpass import rewrite_module

# Numba's functions that count references, and those that accompany them.
_COUNTING = ("NRT_incref", "NRT_decref")
_HARMLESS = (*_COUNTING, "NRT_MemInfo_call_dtor", "NRT_MemInfo_data_fast")


class Part(JITCodeLibrary):  # type: ignore[misc]
    """The code of one function, which is not run but linked with its callers."""

    counts = True  # whether it counts references
    fails = True  # whether it may fail, so that callers have to check its status
    _own: Any = None

    def __init__(self, codegen: Any, name: str, reordered: Any) -> None:
        super().__init__(codegen, name)
        self._reordered = reordered

    def add_ir_module(self, module: Any) -> None:
        """Add the function's code, with the flags of its arithmetic.

        As flags of the compiler, Numba would pass them on to its own functions that this one uses, `int_power` for one. These
        are compiled once for all functions: their bits would depend on which function is compiled first.
        """
        if self._reordered:
            rewrite_module(module, self._reordered)
        super().add_ir_module(module)

    def finalize(self) -> None:
        """Close the library: nothing can be added any more."""
        self._finalized = True

    def own_module(self) -> Any:
        """Return a module of this function alone, which several callers may be linked with."""
        if self._own is None:
            self._own = self._final_module.clone()
            for function in self._own.functions:
                if not function.is_declaration and function.linkage.name == "external":
                    function.linkage = "linkonce_odr"
        return self._own

    def _get_module_for_linking(self) -> Any:
        """Return a module with everything that the function calls, for Numba's own libraries."""
        self._ensure_finalized()
        module = self.own_module().clone()
        for library in list(called(self))[1:]:
            module.link_in(_module_of(library), preserve=True)
        return module


class Whole(JITCodeLibrary):  # type: ignore[misc]
    """A function and everything that it calls, ready to be run.

    Where nothing in it allocates, and it `returns_no_array`, all arrays are views of memory that the caller keeps, and
    references are not counted: that takes a call for each view, and another at its end, which prevent optimisation. A step of
    Gauss 4 on the pendulum takes half as long without.
    """

    def __init__(self, part: Part, returns_no_array: bool) -> None:
        super().__init__(part.codegen, part.name)
        self.enable_object_caching()
        self._final_module = part._final_module.clone()
        self._final_module.name = part._final_module.name
        uncounted = returns_no_array and not any(map(_allocates, called(part)))
        if uncounted:
            self._final_module.link_in(_counting_nothing().clone())  # the first definition takes precedence
        for library in list(called(part))[1:]:
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(_module_of(library), preserve=True)
        self._keep_to_itself()
        self._optimize_final_module()
        self._final_module.verify()
        self._finalize_final_module()
        for variable in self._final_module.global_variables:
            environment = lookup_environment(variable.name)
            if environment is not None:
                self.codegen.set_env(variable.name, environment)

    def _keep_to_itself(self) -> None:
        """Hide all functions but the one that is run from the linker.

        Numba numbers functions of the same name in each process. Of two loaded from disk to which different processes gave the
        same number, both would run the first. ("internal" functions are found by their names, too, and crash, since their
        arguments may have been optimised away.)
        """
        for function in self._final_module.functions:
            shared = function.linkage.name == "linkonce_odr" or function.name in _COUNTING
            if shared and not function.is_declaration:
                function.linkage = "private"

    def serialize_using_object_code(self) -> tuple[str, str, tuple[bytes, bytes]]:
        """Return the form stored on disk: the machine code, and the names alone of the LLVM module.

        Numba only looks up in the module whether a function exists; reading all of it would double the time of loading.
        """
        name, kind, (machine_code, _) = super().serialize_using_object_code()
        defined = [f for f in self._final_module.functions if not f.is_declaration and f.linkage.name == "external"]
        names = "\n".join(f'define void @"{function.name}"() {{ ret void }}' for function in defined)
        return name, kind, (machine_code, parse_assembly(names).as_bitcode())


def called(part: Part) -> Iterator[JITCodeLibrary]:
    """Yield a part and all libraries that it calls, each once."""
    seen, waiting = set(), [part]
    while waiting:
        library = waiting.pop()
        if library not in seen:
            seen.add(library)
            yield library
            if isinstance(library, Part):
                waiting += reversed(library._linking_libraries)


def _allocates(library: Any) -> bool:
    """Whether a library itself may create or keep an array: whether it uses other functions of Numba's runtime."""
    names = {function.name for function in library._final_module.functions}
    return any(name.startswith("NRT_") and name not in _HARMLESS for name in names)


@cache
def _counting_nothing() -> Any:
    definitions = (f"define void @{name}(ptr %0) alwaysinline {{\n  ret void\n}}\n" for name in _COUNTING)
    return parse_assembly("".join(definitions))


def _module_of(library: Any) -> Any:
    return library.own_module() if isinstance(library, Part) else library._get_module_for_linking()

"""The compiler's pipeline: Numba's passes, some of them only where they have something to do.

Numba's passes each analyse the lifetimes of variables again, seven times a function, before they check whether there is
anything for them to do.
"""

from typing import Any

from numba.core import ir
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.ir_utils import build_definitions
from numba.core.ssa import reconstruct_ssa
from numba.core.typed_passes import IRLegalization, NativeLowering, NopythonRewrites, PreLowerStripPhis
from numba.core.untyped_passes import FixupArgs, InlineClosureLikes, ReconstructSSA

from kickdrift.core.contexts import own_target, own_typing
from kickdrift.core.free_numbers import GlobalsAsArguments
from kickdrift.core.lowering import Lower
from kickdrift.core.references import counts_references, lowered_without_counting
from kickdrift.core.returned_lists import TuplesForLists

# Modules that `kickdrift.core.lowering` lowers: worlds have many functions, 400 with joints. Steps of the engine, which are
# small, would take a fifth longer.
_WORLDS = ("kickdrift.world", "kickdrift.core.vectors", "kickdrift.core.rotations")


class Pipeline(CompilerBase):  # type: ignore[misc]
    """Numba's pipeline, with global numbers as arguments (`numbers_as_arguments`) and tuples for lists (`tuples_for_lists`)."""

    def __init__(self, typing: Any, target: Any, *others: Any) -> None:
        super().__init__(own_typing(typing), own_target(typing, target), *others)

    def define_pipelines(self) -> list[Any]:
        """Return Numba's passes with some replaced, and two more before Numba resolves the names that a function uses."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(TuplesForLists, FixupArgs)
        passes.add_pass_after(GlobalsAsArguments, FixupArgs)
        is_of_worlds = str(self.state.func_id.func.__module__).startswith(_WORLDS)
        ours = {**_OURS, NativeLowering: _WorldLowering if is_of_worlds else _Lowering}
        own = _Passes("nopython")
        own.passes = [(ours.get(pass_, pass_), description) for pass_, description in passes.passes]
        own.finalize()
        return [own]


class _Passes(PassManager):  # type: ignore[misc]
    """Runs passes one after the other, without Numba's timing and events."""

    def _runPass(self, index: int, pass_: Any, state: Any) -> None:  # noqa: N802 - Numba's name
        pass_.analysis = self._analysis
        pass_.run_initialization(state)
        pass_.run_pass(state)
        pass_.run_finalizer(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _InlineClosures(InlineClosureLikes):  # type: ignore[misc]
    """Inlines closures, comprehensions and stencils, if there are any."""

    _name = "kickdrift_inline_closures"

    def run_pass(self, state: Any) -> Any:
        return any(map(_is_inlined, _values(state.func_ir))) and super().run_pass(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _Assignments(ReconstructSSA):  # type: ignore[misc]
    """Gives each assignment its own variable; only generators need a new analysis of live variables."""

    _name = "kickdrift_reconstruct_ssa"

    def run_pass(self, state: Any) -> Any:
        if state.func_ir.is_generator:
            return super().run_pass(state)
        state.func_ir = reconstruct_ssa(state.func_ir)
        self._patch_locals(state)
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class _StripPhis(PreLowerStripPhis):  # type: ignore[misc]
    """Replaces phi nodes by variables, and determines whether references must be counted."""

    _name = "kickdrift_strip_phis"

    def run_pass(self, state: Any) -> Any:
        if state.func_ir.is_generator:
            super().run_pass(state)
        else:
            state.func_ir = self._strip_phi_nodes(state.func_ir)
            state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        state.counts = counts_references(state)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class _Rewrites(NopythonRewrites):  # type: ignore[misc]
    """Fuses array expressions into loops, where there may be arrays."""

    _name = "kickdrift_nopython_rewrites"

    def run_pass(self, state: Any) -> Any:
        return state.counts and super().run_pass(state)


@register_pass(mutates_CFG=False, analysis_only=True)
class _Legalisation(IRLegalization):  # type: ignore[misc]
    """Inserts the ends of variables, where references are counted."""

    _name = "kickdrift_ir_legalization"

    def run_pass(self, state: Any) -> Any:
        return state.counts and super().run_pass(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(NativeLowering):  # type: ignore[misc]
    """Lowers to LLVM as Numba does, without reference counts where none are needed."""

    _name = "kickdrift_native_lowering"

    def run_pass(self, state: Any) -> Any:
        if not state.counts:
            state.library.counts = False
            state.targetctx = lowered_without_counting(state.targetctx)
        return super().run_pass(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _WorldLowering(_Lowering):
    """Lowers to shorter LLVM code by `kickdrift.core.lowering`."""

    _name = "kickdrift_world_lowering"

    @property
    def lowering_class(self) -> Any:
        return Lower


_OURS = {
    InlineClosureLikes: _InlineClosures,
    ReconstructSSA: _Assignments,
    PreLowerStripPhis: _StripPhis,
    NopythonRewrites: _Rewrites,
    IRLegalization: _Legalisation,
}


def _values(function: Any) -> Any:
    """Yield the right-hand sides of all assignments of a function."""
    for block in function.blocks.values():
        for statement in block.find_insts(ir.Assign):
            yield statement.value


def _is_inlined(value: Any) -> bool:
    made = isinstance(value, ir.Expr) and value.op in ("make_function", "build_list")
    return made or (isinstance(value, ir.Global | ir.FreeVar) and hasattr(value.value, "neighborhood"))

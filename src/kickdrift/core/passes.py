"""How Numba compiles a function: by its own passes, some of them only where they have something to do.

Numba's passes each find out again which variables live where, seven times a function, before they look whether there is
anything for them.
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

# Whose code is written in words of our own: worlds have many functions, 400 with joints. Steps of the engine, which are small,
# would take a fifth longer, written so.
_WORLDS = ("kickdrift.world", "kickdrift.core.vectors", "kickdrift.core.rotations")


class Pipeline(CompilerBase):  # type: ignore[misc]
    """How Numba compiles a function, `numbers_as_arguments` are arguments, and lists become `tuples_for_lists`."""

    def __init__(self, typing: Any, target: Any, *others: Any) -> None:
        super().__init__(own_typing(typing), own_target(typing, target), *others)

    def define_pipelines(self) -> list[Any]:
        """Return Numba's passes, or ours in their places; and one of ours before Numba looks at what a function uses."""
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
    """Passes one after the other, untimed, and unannounced to those who watch Numba."""

    def _runPass(self, index: int, pass_: Any, state: Any) -> None:  # noqa: N802 - Numba's name
        pass_.analysis = self._analysis
        pass_.run_initialization(state)
        pass_.run_pass(state)
        pass_.run_finalizer(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _InlineClosures(InlineClosureLikes):  # type: ignore[misc]
    """Looks for closures and comprehensions where there are any, or what Numba makes stencils of."""

    _name = "kickdrift_inline_closures"

    def run_pass(self, state: Any) -> Any:
        return any(map(_is_inlined, _values(state.func_ir))) and super().run_pass(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _Assignments(ReconstructSSA):  # type: ignore[misc]
    """Gives each assignment its variable. Where what lives is kept for whoever resumes a function, all of it is found again."""

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
    """Makes variables of where control comes together, and finds out whether references must be counted."""

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
    """Makes one loop of an expression of arrays, where there may be any."""

    _name = "kickdrift_nopython_rewrites"

    def run_pass(self, state: Any) -> Any:
        return state.counts and super().run_pass(state)


@register_pass(mutates_CFG=False, analysis_only=True)
class _Legalisation(IRLegalization):  # type: ignore[misc]
    """Says where variables end, where that matters."""

    _name = "kickdrift_ir_legalization"

    def run_pass(self, state: Any) -> Any:
        return state.counts and super().run_pass(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(NativeLowering):  # type: ignore[misc]
    """Writes LLVM's code."""

    _name = "kickdrift_native_lowering"

    def run_pass(self, state: Any) -> Any:
        if not state.counts:
            state.library.counts = False
            state.targetctx = lowered_without_counting(state.targetctx)
        return super().run_pass(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _WorldLowering(_Lowering):
    """Writes LLVM's code in fewer words."""

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
    """Go through what is assigned in a function."""
    for block in function.blocks.values():
        for statement in block.find_insts(ir.Assign):
            yield statement.value


def _is_inlined(value: Any) -> bool:
    made = isinstance(value, ir.Expr) and value.op in ("make_function", "build_list")
    return made or (isinstance(value, ir.Global | ir.FreeVar) and hasattr(value.value, "neighborhood"))

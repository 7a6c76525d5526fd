"""Letters for many members of an ensemble at once: the flow of one member, in a loop over the lanes of a block.

A letter gathers the numbers of a lane from a block into local arrays of constant sizes, applies the flow to them, and scatters
the results. The arrays stay in registers, and the loop over lanes is vectorised as far as the system's functions allow. Each
lane does the operations of one member alone, in the same order, and so has the same bits.

A block of F fields is F x LANES numbers in memory, one field after the other. Since the distance between fields is constant,
the compiler can prove that vectors of up to LANES do not overlap. The fields are those of `Fields`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from numba import carray

from kickdrift.core.compilation import Function, compiled, is_kept, is_users, reorders, specialise, unbound
from kickdrift.core.memory import floats_at, floats_on_stack, word
from kickdrift.core.naming import comes_with_kickdrift, specialised_name
from kickdrift.engine.flows import layout
from kickdrift.engine.flows.sums import sums
from kickdrift.engine.flows.table import FLOWS
from kickdrift.engine.letters import functions_of, parts_called
from kickdrift.engine.program import Program
from kickdrift.systems.system import System

LANES = 64  # members of a block: a call of a letter is shared by them, and Kepler's fields fill 7 KB
_MOST_NUMBERS = 24  # of a state, and of params: the gathered numbers have to stay in registers

SIZE = SIZE_OF_V = PARAMS = ACCELERATIONS = RESIDUALS = TAIL = WORK = ROOM_OF_V = ROOM_OF_PARAMS = 0  # bound by `build`
flow: Callable[..., None] = unbound


@dataclass(frozen=True)
class Fields:
    """Numbers of fields of a block, in this order: x, v, params, and the parts of work that steps pass to the next.

    These are accelerations, residuals of compensated sums, and the scalars at its end, see `kickdrift.engine.flows.layout`.
    """

    x: int
    v: int
    params: int
    accelerations: int
    residuals: int
    tail: int

    @property
    def count(self) -> int:
        """Total number of fields."""
        return self.x + self.v + self.params + self.accelerations + self.residuals + self.tail


def fields_of(system: System, program: Program, compensated: bool) -> Fields | None:
    """Return the fields of a program on a system; None if its flows need more memory than lanes have."""
    names = program.flows + program.primers
    n, n_v, flows = system.x0.size, system.v0.size, [FLOWS[name] for name in names]
    functions = functions_of(system, program)
    sizes = n, program.coefficients, system.params
    if not system.native or max(n, n_v, system.params.size) > _MOST_NUMBERS or program.coefficients.size:
        return None
    if any(flow.constants or flow.estimates or flow.memory(*sizes) or flow.scratch(*sizes) for flow in flows):
        return None
    called = {part for flow in flows for part in parts_called(flow)}
    if not called <= functions.keys() or any(reorders(functions[part]) for part in called):
        return None
    again = any(flow.again in names for flow in FLOWS.values())
    plain = all(flow.plain for flow in flows)
    return Fields(
        n, n_v, system.params.size, n if again else 0, 2 * n if compensated else 0, 0 if plain else layout.TAIL
    )


def _letter(t: float, h: float, block: Any) -> None:
    numbers = floats_at(word(block, 1))
    for lane in range(word(block, 0)):
        x, v = carray(floats_on_stack(SIZE), (SIZE,)), carray(floats_on_stack(ROOM_OF_V), (SIZE_OF_V,))
        params = carray(floats_on_stack(ROOM_OF_PARAMS), (PARAMS,))
        work = carray(floats_on_stack(WORK), (WORK,))
        for i in range(SIZE):
            x[i] = numbers[i * LANES + lane]
        for i in range(SIZE_OF_V):
            v[i] = numbers[(SIZE + i) * LANES + lane]
        for i in range(PARAMS):
            params[i] = numbers[(SIZE + SIZE_OF_V + i) * LANES + lane]
        at = SIZE + SIZE_OF_V + PARAMS
        for i in range(ACCELERATIONS):
            work[i] = numbers[(at + i) * LANES + lane]
        for i in range(RESIDUALS):
            work[SIZE + i] = numbers[(at + ACCELERATIONS + i) * LANES + lane]
        for i in range(TAIL):
            work[4 * SIZE + i] = numbers[(at + ACCELERATIONS + RESIDUALS + i) * LANES + lane]
        flow(t, h, x, v, params, work)
        for i in range(SIZE):
            numbers[i * LANES + lane] = x[i]
        for i in range(SIZE_OF_V):
            numbers[(SIZE + i) * LANES + lane] = v[i]
        for i in range(ACCELERATIONS):
            numbers[(at + i) * LANES + lane] = work[i]
        for i in range(RESIDUALS):
            numbers[(at + ACCELERATIONS + i) * LANES + lane] = work[SIZE + i]
        for i in range(TAIL):
            numbers[(at + ACCELERATIONS + RESIDUALS + i) * LANES + lane] = work[4 * SIZE + i]


def build(name: str, system: System, program: Program, compensated: bool, fields: Fields) -> Function:
    """Bind the flow `name` to a system, for the lanes of blocks with these fields."""
    functions = functions_of(system, program)
    called = sorted(parts_called(FLOWS[name]))
    inlined = tuple((part, functions[part]) for part in called)
    return _native(name, inlined, fields, compensated, system.packaged)


@lru_cache(maxsize=256)
def _native(
    name: str, inlined: tuple[tuple[str, Function], ...], fields: Fields, compensated: bool, packaged: bool
) -> Function:
    known = FLOWS[name]
    bindings: dict[str, Any] = {
        "SIZE": fields.x,
        "SIZE_OF_V": fields.v,
        **sums(native=True, compensated=compensated),
        **{f"{part}_at": layout.part_inlined(part, function) for part, function in inlined},
    }
    for part, template in known.parts.items():
        bindings[part] = _inline(specialise(template, part, **bindings))
    template = known.small or known.template
    bound = _inline(specialise(template, template.__name__, **bindings))
    bound_to = inlined[0][1] if inlined else known.template
    details = [str(number) for number in vars(fields).values()]
    others = [specialised_name(function) for _, function in inlined[1:]]
    letter = specialise(
        _letter,
        specialised_name(bound_to, "lanes", name, *others, *details, "compensated" if compensated else "plain"),
        flow=bound,
        SIZE=fields.x,
        SIZE_OF_V=fields.v,
        PARAMS=fields.params,
        ACCELERATIONS=fields.accelerations,
        RESIDUALS=fields.residuals,
        TAIL=fields.tail,
        WORK=4 * fields.x + layout.TAIL,
        ROOM_OF_V=max(fields.v, 1),
        ROOM_OF_PARAMS=max(fields.params, 1),
    )
    kept = all(is_kept(function) or (packaged and comes_with_kickdrift(function)) for _, function in inlined)
    return compiled(cached=kept, users=any(is_users(function) for _, function in inlined))(letter)


def _inline(function: Function) -> Function:
    return compiled(cached=False, inline=True)(function)

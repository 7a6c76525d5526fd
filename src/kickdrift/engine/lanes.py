"""Many members of a problem at once, in blocks, each of which does all its steps while it stays in the L1 cache."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from kickdrift.core.calls import address_of
from kickdrift.core.compilation import compiled, load
from kickdrift.core.memory import floats_at, word
from kickdrift.engine.flows.layout import TROUBLE, aligned
from kickdrift.engine.grid import Grid
from kickdrift.engine.lane_letters import LANES, Fields, build, fields_of
from kickdrift.engine.loop import LETTER, call
from kickdrift.engine.program import Program
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
_WORDS = 2  # of a block's descriptor: the number of lanes in use, and the address
_VECTOR = 8  # lanes in a register

_INTEGERS, _FLOATS = (types.Array(kind, 1, "C") for kind in (types.int64, types.float64))
_ROWS = types.Array(types.float64, 3, "C")
_SIGNATURE = types.int64(
    *(_INTEGERS, _INTEGERS, _FLOATS, _FLOATS, _INTEGERS, types.float64, types.float64, types.int64, types.int64),
    *(types.intp, types.int64, _INTEGERS, types.int64, _ROWS, _ROWS),
)


@compiled
def _advance(
    flows: NDArray[np.int64],
    letters: NDArray[np.int64],
    weights: Floats,
    offsets: Floats,
    primers: NDArray[np.int64],
    t0: float,
    h: float,
    first: int,
    last: int,
    blocks: Any,
    n_blocks: int,
    save_steps: NDArray[np.int64],
    saved: int,
    xs: Any,
    vs: Any,
) -> int:
    """Run the steps from `first` to `last` on each block, copying the members into their rows after each of `save_steps`.

    Times and weights are computed as in `kickdrift.engine.loop.advance`.

    Returns
    -------
    saved : int
        Number of rows filled.
    """
    row = saved
    for b in range(n_blocks):
        block, row = blocks + 8 * _WORDS * b, saved
        if first == 0:
            for k in range(primers.size):
                call(flows[primers[k]], (t0, 0.0, block))
        for step in range(first, last):
            t = t0 + step * h
            for k in range(letters.size):
                call(flows[letters[k]], (t + offsets[k] * h, weights[k] * h, block))
            if row < save_steps.size and save_steps[row] == step + 1:
                _keep(block, LANES * b, row, xs, vs)
                row += 1
    return row


@compiled
def _keep(block: Any, first: int, row: int, xs: Any, vs: Any) -> None:
    """Copy the members of a block, the first of which is number `first`, into a row of each."""
    numbers, n, n_v = floats_at(word(block, 1)), xs.shape[2], vs.shape[2]
    for lane in range(min(LANES, xs.shape[0] - first)):
        for i in range(n):
            xs[first + lane, row, i] = numbers[i * LANES + lane]
        for i in range(n_v):
            vs[first + lane, row, i] = numbers[(n + i) * LANES + lane]


@dataclass(frozen=True, eq=False)
class Lanes:
    """A program compiled for blocks of members.

    Attributes
    ----------
    program : Program
    fields : Fields
    """

    program: Program
    fields: Fields
    _flows: NDArray[np.int64]  # addresses of the letters, those of the primers last
    _alive: Any  # the functions at these addresses, kept alive

    def blocks(self, x: Floats, v: Floats, params: Floats) -> "Blocks":
        """Lay members out in blocks: arrays of shape (M, n)."""
        return Blocks(self, x, v, params)


def compile_lanes(system: System, program: Program, compensated: bool) -> Lanes:
    """Compile a program on a system for blocks of members, or load it from disk."""
    fields = fields_of(system, program, compensated)
    assert fields is not None
    built = [build(name, system, program, compensated, fields) for name in program.flows + program.primers]
    load(_advance, _SIGNATURE)
    return Lanes(program, fields, np.array([address_of(letter, LETTER) for letter in built]), built)


class Blocks:
    """Members during a run.

    The unused lanes of the last block repeat its last member.

    Attributes
    ----------
    saved : int
        How many rows are filled.
    """

    def __init__(self, lanes: Lanes, x: Floats, v: Floats, params: Floats) -> None:
        self._lanes, self._members = lanes, x.shape[0]
        self.saved = 0
        fields, n_blocks = lanes.fields, -(-x.shape[0] // LANES)
        room, address = aligned(n_blocks * fields.count * LANES)
        self._numbers = room.view(np.float64).reshape(n_blocks, fields.count, LANES)
        places = np.minimum(np.arange(n_blocks * LANES), x.shape[0] - 1)
        at = 0
        for array in (x, v, params):
            size = array.shape[1]
            self._numbers[:, at : at + size] = array[places].reshape(n_blocks, LANES, size).transpose(0, 2, 1)
            at += size
        used = np.minimum(LANES, x.shape[0] - LANES * np.arange(n_blocks))
        self._words = np.zeros((n_blocks, _WORDS), dtype=np.intp)
        self._words[:, 0] = -(-used // _VECTOR) * _VECTOR
        self._words[:, 1] = address + 8 * fields.count * LANES * np.arange(n_blocks)

    def advance(self, grid: Grid, first: int, last: int, xs: Floats, vs: Floats) -> None:
        """Do the steps from `first` to `last`, and keep rows in arrays of shape (M, T, n)."""
        lanes, program = self._lanes, self._lanes.program
        if first == 0 and grid.save_steps[0] == 0:
            xs[:, 0], vs[:, 0] = self._member_numbers(0, xs.shape[2]), self._member_numbers(xs.shape[2], vs.shape[2])
            self.saved = 1
        primers = np.arange(len(program.flows), lanes._flows.size)
        word = program.letters, program.weights, program.offsets, primers
        blocks = self._words.ctypes.data, self._words.shape[0]
        self.saved = _advance(
            lanes._flows, *word, grid.t0, grid.step, first, last, *blocks, grid.save_steps, self.saved, xs, vs
        )

    @property
    def good(self) -> NDArray[np.bool_]:
        """Which members have finite states and did not fail."""
        fields = self._lanes.fields
        good: NDArray[np.bool_] = np.asarray(np.isfinite(self._member_numbers(0, fields.x + fields.v)).all(axis=1))
        if fields.tail:
            good &= self._member_numbers(fields.count + TROUBLE, 1)[:, 0] == 0.0
        return good

    def _member_numbers(self, start: int, size: int) -> Floats:
        """Return some fields of each member, (M, size)."""
        picked = self._numbers[:, start : start + size].transpose(0, 2, 1)
        numbers: Floats = picked.reshape(-1, size)[: self._members]
        return numbers

"""Cloth on a ball: a square metre that falls, drapes and swings, in the hands of the peers; and cloths of many sizes."""

from collections.abc import Callable, Mapping

import numpy as np
from numba import get_num_threads

from benchmarks.cloth.ours import Kickdrift, hanging
from benchmarks.cloth.peers import MuJoCo, MuJoCoIPC, Newton, NewtonXPBD, PyPBD, Rapier
from benchmarks.cloth.scene import FRAME, Draped
from benchmarks.table import Bound, Missing, Row, at_least, at_most, measured, skipped
from benchmarks.turns import Costs, in_turns, ratio

_SETTLING, _FRAMES = 60, 6  # before, and in a measurement
_SIDES = (40, 100)
_SCALE = {1000: 32, 10_000: 100, 100_000: 316}  # particles, to those on a side
_PEERS: Mapping[str, Callable[[int, bool], Draped]] = {
    "rapier3d": Rapier, "MuJoCo flex": MuJoCo, "MuJoCo flex, ipc": MuJoCoIPC, "pyPBD": PyPBD,
    "Newton VBD": Newton, "Newton XPBD": NewtonXPBD,
}  # fmt: skip
_FIVE_TIMES = 5.0
_LONG = 600  # frames of ten seconds


def compare(rounds: int) -> list[Row]:
    """Milliseconds of a frame of 1/60 s, one thread: over those of kickdrift; and nanoseconds of a particle and part."""
    rows = []
    for meets in (False, True):
        for side in _SIDES:
            rows += _on_a_ball(side, meets, rounds)
    return [*rows, *_ten_seconds(rounds), *_on_threads(rounds), *_many_sizes(rounds), _irregular(rounds)]


def _on_a_ball(side: int, meets: bool, rounds: int) -> list[Row]:
    title = f"{side} x {side}, {'with' if meets else 'without'} self-collision"
    ours, rows = Kickdrift(side, meets), []
    contestants: dict[str, Draped] = {"kickdrift": ours}
    for name, make in _PEERS.items():
        try:
            contestants[name] = make(side, meets)
        except Missing as missing:
            rows.append(skipped(f"{title}: {name} / kickdrift", str(missing)))
    for one in contestants.values():
        one.advance(_SETTLING)
    costs = in_turns({name: lambda one=one: one.cost(_FRAMES) for name, one in contestants.items()}, rounds)  # type: ignore[misc]
    wanted = at_most(1e3 * FRAME, "ms") if side == max(_SIDES) else None
    part = np.median(costs["kickdrift"]) * 1e6 / (side * side * ours.parts)
    rows.insert(
        0, measured(f"{title}: a frame", costs["kickdrift"], wanted, f"{part:.3g} ns a particle and part", "ms")
    )
    others = [name for name in contestants if name != "kickdrift"]
    return rows + [
        measured(f"{title}: {name} / kickdrift", ratio(costs, name, "kickdrift"), _bound(name), _said(costs))
        for name in others
    ]


def _bound(name: str) -> Bound | None:
    return at_least(_FIVE_TIMES) if name == "rapier3d" else None


def _said(costs: Costs) -> str:
    return ", ".join(f"{name} {np.median(own):.3g} ms" for name, own in costs.items())


def _ten_seconds(rounds: int) -> list[Row]:
    """Milliseconds of the frames of ten seconds, in which the cloth of 100 x 100 folds and comes to rest on itself."""
    frames = np.empty((rounds, _LONG))
    for own in frames:
        cloth = Kickdrift(100, True)
        cloth.advance(1)
        own[:] = [cloth.cost(1) for _ in range(_LONG)]
    title, least = "100 x 100, with self-collision, in ten seconds:", frames.min(axis=0)
    parts = {
        "a frame": frames.mean(axis=1),
        "the slowest frame": frames.max(axis=1),
        "at rest": frames[:, -60:].mean(axis=1),
    }
    over = f"{np.mean(least > 1e3 * FRAME):.0%} of the frames take longer than 1/60 s; median {np.median(least):.3g} ms"
    return [
        measured(f"{title} {name}", costs, at_most(1e3 * FRAME, "ms"), over if name == "a frame" else "")
        for name, costs in parts.items()
    ]


def _on_threads(rounds: int) -> list[Row]:
    """Frames in one thread over those in all of Numba's threads, with the same bits."""
    rows = []
    for side, meets in ((100, False), (200, False), (100, True)):
        own = {"one": Kickdrift(side, meets), "all": Kickdrift(side, meets, threads=True)}
        for one in own.values():
            one.advance(_SETTLING)
        costs = in_turns({name: lambda one=one: one.cost(_FRAMES) for name, one in own.items()}, rounds)  # type: ignore[misc]
        title = f"{side} x {side}, {'with' if meets else 'without'} self-collision: one thread / {get_num_threads()} threads"
        rows.append(measured(title, ratio(costs, "one", "all"), None, _said(costs)))
    return rows


def _irregular(rounds: int) -> Row:
    """Return the row of an irregular mesh over a grid, both of 50 x 50 particles."""
    worlds = {"irregular": hanging(50, True), "grid": hanging(50)}
    costs = in_turns({name: lambda own=own: own.part_cost(8) for name, own in worlds.items()}, rounds)  # type: ignore[misc]
    said = ", ".join(f"{name} {np.median(own):.3g} ns" for name, own in costs.items())
    return measured(
        "a particle and part of an irregular mesh / of a grid", ratio(costs, "irregular", "grid"), None, said
    )


def _many_sizes(rounds: int) -> list[Row]:
    """Nanoseconds of a particle and part of cloths that hang, with triangles of one size, each over those of the smallest."""
    worlds = {str(count): hanging(side) for count, side in _SCALE.items()}
    costs = in_turns(
        {name: lambda own=own: own.part_cost(max(20_000 // own.count, 1)) for name, own in worlds.items()}, rounds
    )  # type: ignore[misc]
    first, *others = worlds
    return [
        measured(
            f"a particle's part of a part of a substep among {name} / among {first}",
            ratio(costs, name, first),
            at_most(1.5),
            ", ".join(f"{size} {np.median(costs[size]):.3g} ns" for size in (name, first)),
        )
        for name in others
    ]

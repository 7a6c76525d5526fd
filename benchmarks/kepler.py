"""The Kepler problem with a user's function, against C and the peers."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kickdrift as kd
from benchmarks import c_programs, peers
from benchmarks.peers import STEP, V0, X0, Peer
from benchmarks.table import Bound, Missing, Row, at_least, at_most, measured, skipped
from benchmarks.turns import Costs, cheapest, in_turns, nanoseconds, ratio

SAVED = 1000
_CHECKED_STEPS = 10_000
_STEPS = 5_000_000  # of compiled code, about 0.1 s


def writing(x: Any, out: Any) -> None:
    """Acceleration of a user who cares for speed."""
    r2 = x[0] * x[0] + x[1] * x[1]
    w = -1.0 / (r2 * math.sqrt(r2))
    out[0] = w * x[0]
    out[1] = w * x[1]


def returning(x: Any) -> Any:
    """Acceleration of a user who does not."""
    return -x / np.linalg.norm(x) ** 3


@dataclass(frozen=True)
class Rival:
    """A peer, how many steps it does in about 0.1 s, and how much slower it should be."""

    make: Callable[[], Peer]
    steps: int
    wanted: Bound | None = None
    method: str = "semi-implicit-euler"
    against: str = "kickdrift"


RIVALS = {
    "NumPy loop": Rival(peers.numpy_loop, 30_000),
    "REBOUND leapfrog": Rival(peers.rebound, 1_000_000, at_least(3), method="position-verlet"),
    "diffrax, end alone": Rival(peers.diffrax, _STEPS, at_least(25)),
    f"diffrax, {SAVED} times": Rival(
        partial(peers.diffrax, SAVED), 200_000, at_least(25), against=f"kickdrift, {SAVED} times"
    ),
    "diffrax, every step": Rival(partial(peers.diffrax, None), 200_000, against="kickdrift, every step"),
    "symplecta": Rival(peers.symplecta, 10_000, at_least(100)),
}


def kickdrift(
    steps: int,
    function: Callable[..., Any] = writing,
    method: str = "semi-implicit-euler",
    compensated: bool = True,
    saved: int = 1,
) -> tuple[float, NDArray[np.float64]]:
    """Seconds in the loop, and where the body is, as the peers say it."""
    solution = kd.solve(
        function,
        (0.0, steps * STEP),
        X0,
        V0,
        step=STEP,
        method=method,
        save_every=steps // saved,
        compensated=compensated,
        progress=False,
    )
    return solution.wall_time, solution.x[-1]


def _every_step(steps: int) -> tuple[float, NDArray[np.float64]]:
    return kickdrift(steps, saved=steps)


OURS: dict[str, Peer] = {
    "kickdrift": kickdrift,
    "kickdrift plain": partial(kickdrift, compensated=False),
    f"kickdrift, {SAVED} times": partial(kickdrift, saved=SAVED),
    "kickdrift, every step": _every_step,
    "kickdrift, returning": partial(kickdrift, function=returning),
}
LIMITS = {"kickdrift plain": at_most(1.6), "kickdrift": at_most(2.2), "kickdrift, returning": None}


def compare(rounds: int) -> list[Row]:
    """Compare the time of a step with that of C and of the peers; ours has compensated sums unless it says plain."""
    rows = []
    contestants: dict[str, Callable[[], float]] = {
        name: _per_step(run, 200_000 if run is _every_step else _STEPS) for name, run in OURS.items()
    }
    builds: dict[str, Path] = {}
    try:
        builds = c_programs.build("kepler")
    except Missing as missing:
        rows.append(skipped("C", str(missing)))
    for name, path in builds.items():
        _check(name, np.array(c_programs.run(path, _CHECKED_STEPS).results))
        contestants[name] = partial(c_programs.ns_per_step, path, 4 * _STEPS)
    present = {}
    for name, rival in RIVALS.items():
        try:
            peer = rival.make()
        except Missing as missing:
            rows.append(skipped(name, str(missing)))
            continue
        _check(name, peer(_CHECKED_STEPS)[1], rival.method)
        present[name], contestants[name] = rival, _per_step(peer, rival.steps)
    costs = in_turns(contestants, rounds)
    return rows + (_rows_of_c(costs, cheapest(costs, builds)) if builds else []) + _rows_of_peers(costs, present)


def _per_step(peer: Peer, steps: int) -> Callable[[], float]:
    return lambda: peer(steps)[0] * 1e9 / steps


def _rows_of_c(costs: Costs, fastest: str) -> list[Row]:
    return [
        measured(f"{name} / {fastest}", ratio(costs, name, fastest), wanted, nanoseconds(costs, name, fastest))
        for name, wanted in LIMITS.items()
    ]


def _rows_of_peers(costs: Costs, present: dict[str, Rival]) -> list[Row]:
    return [
        measured(
            f"{name} / {rival.against}",
            ratio(costs, name, rival.against),
            rival.wanted,
            nanoseconds(costs, name, rival.against),
        )
        for name, rival in present.items()
    ]


def _check(name: str, x: NDArray[np.float64], method: str = "semi-implicit-euler") -> None:
    # Rounding differs; over 10,000 steps its growth along the orbit stays below 1e-9.
    ours = kickdrift(_CHECKED_STEPS, method=method)[1]
    if not np.allclose(x, ours, rtol=0, atol=1e-9):
        raise AssertionError(f"{name} ends at {x}, kickdrift at {ours}: they do not do the same work.")

"""How the time of a step grows with the number of bodies: boxes at rest in stacks of five."""

import time

import numpy as np

from benchmarks.table import Row, at_most, measured
from benchmarks.turns import in_turns, nanoseconds, ratio
from kickdrift.world.world import World

_STEP, _STACK = 1 / 60, 5
_COUNTS = (300, 1000, 10_000)  # a hundred and fewer would be solved directly, at ten times the cost
_BODY_STEPS = 50_000  # in a measurement


def compare(rounds: int) -> list[Row]:
    """Nanoseconds per body and step, each over those of three hundred bodies."""
    worlds = {str(count): _stacks(count) for count in _COUNTS}
    costs = in_turns({name: lambda world=world: _cost(world) for name, world in worlds.items()}, rounds)  # type: ignore[misc]
    first = str(_COUNTS[0])
    return [
        measured(
            f"a body's part of a step among {name} / among {first}",
            ratio(costs, name, first),
            at_most(1.5),
            nanoseconds(costs, name, first),
        )
        for name in worlds
        if name != first
    ]


def _stacks(count: int) -> World:
    world = World()
    world.add_plane(friction=0.6)
    side = int(np.ceil(np.sqrt(count / _STACK)))
    for k in range(count):
        row, column = divmod(k // _STACK, side)
        world.add_box((1, 1, 1), position=(2.0 * column, 2.0 * row, k % _STACK + 0.5), friction=0.6)
    world.advance(_STEP, 60)
    return world


def _cost(world: World) -> float:
    bodies = len(world.position) - 2
    steps = max(_BODY_STEPS // bodies, 1)
    started = time.perf_counter()
    world.advance(_STEP, steps)
    return (time.perf_counter() - started) / (steps * bodies) * 1e9

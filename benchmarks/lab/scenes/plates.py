"""Plates that carry loads, at rest and sliding."""

import itertools

import numpy as np

from benchmarks.lab.building import GRAVITY, Builder
from benchmarks.lab.measures import at_most, comes_to, overlaps, rests, sinks, stays
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched

_LOADS = (np.arange(5) - 2) * 3.0


def plate(mass: float, loads: int, load: float, friction: tuple[float, float] = (0.4, 0.8), pull: float = 0.0) -> Scene:
    """Put boxes on a plate, and pull the plate after 2 s.

    The floor's coefficient against the plate and the plate's against the loads are given; geometric means make those
    of the bodies.
    """
    own = friction[0]
    builder = Builder()
    builder.plane(friction=own)
    carrier = builder.box((20.0, 20.0, 1.0), position=(0.0, 0.0, 0.5), mass=mass, friction=own)
    side = round(loads**0.5)
    places = (np.arange(side) - (side - 1) / 2) * 3.0
    for x, y in itertools.product(places, places):
        builder.box((1.0, 1.0, 1.0), position=(x, y, 1.5), mass=load, friction=friction[1] ** 2 / own)
    if pull:
        builder.push(carrier, (pull, 0.0, 0.0), begin=2.0)
    return builder.scene()


def _resting() -> list[Trial]:
    criteria = (rests(), stays(0.05), sinks(np.inf), overlaps(0.1))
    return [
        Trial(f"plate of {mass:g} kg, {loads} boxes of {load:g} kg", (plate(mass, loads, load),), 10.0, criteria)
        for mass, loads, load in ((10.0, 25, 1.0), (1.0, 25, 1.0), (10.0, 9, 100.0), (100.0, 25, 10.0))
    ]


def _pulled() -> list[Trial]:
    """Pull a plate with 25 loads below and above what friction holds, 0.4 of the weight."""
    mass, loads, load = 10.0, 25, 1.0
    weight = (mass + loads * load) * GRAVITY
    held = Trial(
        "plate pulled at 98 % of its limit", (plate(mass, loads, load, pull=0.98 * 0.4 * weight),), 6.0, (stays(0.05),)
    )
    force = 1.1 * 0.4 * weight
    slid = comes_to("mu", "", lambda _, watched: _coefficient(watched, force, mass + loads * load), 0.4, 0.005)
    return [held, Trial("plate pulled at 110 %", (plate(mass, loads, load, pull=force),), 6.0, (slid,))]


def _coefficient(watched: Watched, force: float, mass: float, body: int = 1) -> float:
    """Coefficient that explains how fast a body speeds up in the last half."""
    half = len(watched.times) // 2
    rate = np.polyfit(watched.times[half:], watched.motions[half:, body, 0], 1)[0]
    return float((force / mass - rate) / GRAVITY)


def _heavy_load() -> Trial:
    """Pull a carrier under a load of ten times its weight, with the same coefficient everywhere: both move as one."""
    builder = Builder(friction=0.4)
    builder.plane()
    carrier = builder.box((2.0, 2.0, 0.5), position=(0.0, 0.0, 0.25), mass=1.0)
    load = builder.box((1.0, 1.0, 1.0), position=(0.0, 0.0, 1.0), mass=10.0)
    force = 1.5 * 0.4 * 11.0 * GRAVITY
    builder.push(carrier, (force, 0.0, 0.0), begin=1.0)

    def slip(scene: Scene, watched: Watched) -> float:
        apart = watched.poses[-1, [carrier, load], 0] - watched.poses[0, [carrier, load], 0]
        return float(abs(apart[0] - apart[1]))

    criteria = (
        comes_to("mu", "", lambda _, watched: _coefficient(watched, force, 11.0), 0.4, 0.005),
        at_most("slips", "m", slip, 0.01),
    )
    return Trial("load of ten times its carrier", (builder.scene(),), 3.0, criteria)


def _sliding_loads() -> Trial:
    """Let carriers slide to a stop under loads of 10 and 100 times their weight, with the same coefficient everywhere."""
    speed = 5.0
    scenes = []
    for mu in (0.1, 0.4, 0.9):
        for mass in (10.0, 100.0):
            builder = Builder(friction=mu)
            builder.plane()
            builder.box((0.24, 0.24, 0.06), position=(0.0, 0.0, 0.03), mass=1.0, velocity=(speed, 0.0, 0.0))
            builder.box((0.08, 0.08, 0.04), position=(0.0, 0.0, 0.08), mass=mass, velocity=(speed, 0.0, 0.0))
            scenes.append(builder.scene())

    def way(scene: Scene, watched: Watched) -> float:
        """Distance over that of Coulomb's law."""
        gone = watched.poses[-1, 1, 0] - watched.poses[0, 1, 0]
        return float(gone * 2.0 * scene.bodies[1].friction * GRAVITY / speed**2)

    def slip(scene: Scene, watched: Watched) -> float:
        apart = watched.poses[-1, 1:3, 0] - watched.poses[0, 1:3, 0]
        return float(abs(apart[0] - apart[1]))

    criteria = (comes_to("distance / exact", "", way, 1.0, 0.01), at_most("slips", "m", slip, 0.002))
    return Trial("6 carriers under 10 and 100 times their weight slide to a stop", tuple(scenes), 6.0, criteria)


TRIALS = (*_resting(), *_pulled(), _heavy_load(), _sliding_loads())

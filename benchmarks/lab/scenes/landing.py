"""Slender and flat bodies that land: their energy may not rise, nor fall where nothing takes it."""

import itertools

import numpy as np

from benchmarks.lab.building import Builder
from benchmarks.lab.measures import at_most, gains, loses, turned_back
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Floats, Scene
from benchmarks.world.judge import Watched

_MEMBERS = 25  # in a world, each on its own
_PITCH = 20.0  # m
_ACROSS = np.array([0.0, 1.0, 0.0])
_BODIES, _FLOOR = 2, 1  # layers: bodies meet the floor alone


def family(
    kind: str, restitution: float, friction: float, seed: int, planar: bool = False, fastest: float = 10.0
) -> Scene:
    """Let boxes or capsules fall from 2 m, of aspect ratios 0.02 to 38, turning with up to `fastest` rad/s about any axis."""
    random = np.random.default_rng(seed)
    builder = Builder(friction=friction, restitution=restitution, planar=planar)
    builder.plane(layer=_FLOOR)
    places = (np.arange(round(_MEMBERS**0.5)) - 2) * _PITCH
    for x, y in itertools.product(places, places):
        options = {
            "position": (x, y, 2.0),
            "orientation": random.normal(size=4) * ((1, 0, 1, 0) if planar else 1),
            "angular_velocity": random.uniform(0.0, fastest) * (_ACROSS if planar else _direction(random)),
            "layer": _BODIES,
            "mask": _FLOOR,
        }
        if kind == "box":
            aspect = 10.0 ** random.uniform(-1.7, 1.7)
            stick = (0.1, random.uniform(0.05, 0.1), min(0.1 * aspect, 3.8))
            builder.box(stick if aspect > 1 else (1.0, 1.0, aspect), **options)
        else:
            builder.capsule(0.05, 0.1 * 10.0 ** random.uniform(-0.5, 1.5), **options)
    return builder.scene()


def _direction(random: np.random.Generator) -> Floats:
    way = random.normal(size=3)
    return np.asarray(way / np.linalg.norm(way))


def _landing(kind: str, restitution: float, seed: int, planar: bool = False) -> Trial:
    scenes = tuple(family(kind, restitution, friction, seed + k, planar) for k, friction in enumerate((0.0, 0.5)))
    name = f"50 {'slender boxes' if kind == 'box' else 'capsules'} landing, e = {restitution:g}"
    return Trial(f"planar: {name}" if planar else name, scenes, 2.5, (gains(0.01),), looks=150)


def _fast() -> Trial:
    scenes = tuple(family(kind, 1.0, 0.0, 500 + k, fastest=1200.0) for k, kind in enumerate(("box", "capsule")))
    return Trial("50 slender bodies landing at up to 1200 rad/s, e = 1", scenes, 2.5, (gains(0.01),), looks=150)


def smooth(kind: str, seed: int) -> Scene:
    """Let boxes or capsules of 1:2 to 1:100 fall from 2 m, elastic and without friction, turning with up to 20 rad/s."""
    random = np.random.default_rng(seed)
    builder = Builder(friction=0.0, restitution=1.0)
    builder.plane(layer=_FLOOR)
    places = (np.arange(round(_MEMBERS**0.5)) - 2) * _PITCH
    for x, y in itertools.product(places, places):
        aspect = 10.0 ** random.uniform(0.3, 2.0)
        length = min(0.1 * aspect, 2.0)
        width = length / aspect
        options = {
            "position": (x, y, 2.0),
            "orientation": random.normal(size=4),
            "angular_velocity": random.uniform(0.0, 20.0) * _direction(random),
            "layer": _BODIES,
            "mask": _FLOOR,
        }
        if kind == "box":
            builder.box((width, width, length), **options)
        else:
            builder.capsule(width / 2, length, **options)
    return builder.scene()


def _smooth() -> Trial:
    scenes = (smooth("box", 400), smooth("capsule", 401))
    return Trial("50 smooth sticks landing, e = 1", scenes, 2.5, (gains(0.001), loses(0.01)), looks=150)


def _spinning(ground: str) -> Trial:
    """Frictionless capsules spin about their axes as they land: nothing can change that."""
    random = np.random.default_rng(5)
    builder = Builder(friction=0.0)
    if ground == "plane":
        builder.plane(layer=_FLOOR)
    else:
        builder.box((40.0, 40.0, 2.0), position=(0.0, 0.0, -1.0), static=True, layer=_FLOOR)
    for x in (np.arange(12) - 5.5) * 2:
        tilt = random.uniform(0.2, 1.4)
        turn = (np.cos(tilt / 2), 0.0, np.sin(tilt / 2), 0.0)
        axis = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
        spin = random.uniform(1.0, 10.0) * axis + 2.0 * np.array([0.0, random.uniform(-1, 1), 0.0])
        options = {"position": (x, 0.0, 1.5), "orientation": turn, "angular_velocity": spin}
        builder.capsule(0.05, 0.8, **options, layer=_BODIES, mask=_FLOOR)

    def change(scene: Scene, watched: Watched) -> float:
        spins = turned_back(watched.poses[:, 1:, 3:], watched.motions[:, 1:, 3:])[:, :, 2]
        return float(np.abs(spins / spins[0] - 1).max())

    scene = builder.scene()
    name = f"12 frictionless capsules spinning on a {ground}"
    return Trial(name, (scene,), 2.5, (at_most("spin changes", "", change, 1e-6),), 75)


TRIALS = (
    *(_landing("box", e, 10 * k + 100) for k, e in enumerate((0.0, 0.5, 0.8, 1.0))),
    *(_landing("capsule", e, 10 * k + 200) for k, e in enumerate((0.0, 0.5, 0.8, 1.0))),
    *(_landing("box", e, 10 * k + 300, planar=True) for k, e in enumerate((0.0, 0.5, 1.0))),
    _fast(),
    _smooth(),
    _spinning("plane"),
    _spinning("box"),
)

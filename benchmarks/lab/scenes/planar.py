"""Worlds in a plane."""

import numpy as np

from benchmarks.lab.building import GROUND, Builder
from benchmarks.lab.measures import apart, at_most, overlaps, rests, rises, sinks, speed, stays
from benchmarks.lab.scenes.towers import pyramid
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Floats, Scene
from benchmarks.world.judge import Watched


def _zigzag() -> Trial:
    """Stack five boxes, every other 0.2 m aside."""
    builder = Builder(planar=True)
    builder.plane()
    for k in range(5):
        builder.box((1.0, 1.0, 1.0), position=(0.2 * (k % 2), 0.0, k + 0.5), mass=1.0)
    return Trial("planar: 5 boxes, every other 0.2 m aside", (builder.scene(),), 10.0, (rests(), stays(0.05)))


def _pyramid() -> Trial:
    scene = pyramid(10, planar=True)
    return Trial("planar: pyramid of 55", (scene,), 10.0, (rests(), stays(0.05), overlaps(0.1)))


def hang_planks(builder: Builder, angles: Floats, width: float, mass: float) -> Floats:
    """Hang planks on hinges between two points of the ground; return where their ends are, (N + 1, 3)."""
    steps = width * np.column_stack((np.cos(angles), np.zeros_like(angles), -np.sin(angles)))
    ends = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    ends[:, 0] -= ends[-1, 0] / 2
    before = GROUND
    for begin, end, angle in zip(ends[:-1], ends[1:], angles, strict=True):
        turn = (np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0)
        plank = builder.box((width, 1.0, 0.1), position=(begin + end) / 2, orientation=turn, mass=mass)
        builder.join("hinge", before, plank, begin, (0.0, 1.0, 0.0))
        before = plank
    builder.join("hinge", before, GROUND, ends[-1], (0.0, 1.0, 0.0))
    return ends


def _bridge(planar: bool, sag: float = 0.3, planks: int = 12, ball: float = 15.0) -> Trial:
    """Put a ball on the middle of a bridge of planks of 3 kg, the ends of which hang at an angle, gently.

    Neither hinges nor rolling take energy, so that both may swing for as long as they like; the speed is information. Without
    sag no plank can move, and joints carry any weight, but only to the second order.
    """
    builder, radius = Builder(planar=planar), 0.35
    ends = hang_planks(builder, np.linspace(sag, -sag, planks), 0.5, 3.0)
    builder.sphere(radius, position=(0.0, 0.0, ends[planks // 2, 2] + 0.05 + radius + 0.005), mass=ball)

    def fallen(scene: Scene, watched: Watched) -> float:
        return float((watched.poses[:, :-1, 2].min(axis=1) - watched.poses[:, -1, 2]).max())

    criteria = (speed(), rises(1e-6), sinks(0.5), at_most("below the planks", "m", fallen, 0.0), apart(0.02))
    name = "ball on a bridge of hinges" if sag > 0.0 else "ball on a straight bridge of hinges"
    return Trial("planar: " + name if planar else name, (builder.scene(),), 20.0, criteria, looks=80)


def _towers(members: int = 6) -> Trial:
    """Stack three to seven boxes of random sizes and masses, each a little aside; statics holds them all."""
    random, scenes = np.random.default_rng(23), []
    for _ in range(members):
        builder, height, x = Builder(planar=True), 0.0, 0.0
        builder.plane()
        for _ in range(random.integers(3, 8)):
            edges, mass = random.uniform(0.6, 1.2, 2), 10.0 ** random.uniform(-0.5, 0.5)
            builder.box((edges[0], 1.0, edges[1]), position=(x, 0.0, height + edges[1] / 2), mass=mass)
            height, x = height + edges[1], x + random.uniform(-0.04, 0.04)
        scenes.append(builder.scene())
    return Trial("planar: 6 towers of random boxes", tuple(scenes), 10.0, (rests(), stays(0.1)))


def _nets(side: int = 14, mesh: float = 0.2) -> Trial:
    """Let weightless nets of balls fly on: their bodies turn in the plane only, however the axes of joints are rounded."""
    random, scenes = np.random.default_rng(1), []
    places = mesh * np.stack(np.meshgrid(np.arange(side), [0.0], np.arange(side), indexing="ij"), axis=-1)[:, 0]
    for kind in ("hinge", "ball", "fixed"):
        builder = Builder(0.0, planar=True)
        for place in places.reshape(-1, 3):
            angle, velocity = random.uniform(-np.pi, np.pi), random.normal(size=3) * (1.0, 0.0, 1.0)
            turn = (np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0)
            mass = 10.0 ** random.uniform(-0.5, 0.5)
            builder.sphere(0.05, position=place, orientation=turn, velocity=velocity, mass=mass)
        for i, k in np.ndindex(side, side):
            for near in (i + 1, k), (i, k + 1):
                if max(near) < side:
                    anchor = (places[i, k] + places[near]) / 2
                    builder.join(kind, side * i + k, side * near[0] + near[1], anchor, (0.0, 1.0, 0.0))
        scenes.append(builder.scene())
    return Trial("planar: nets of 14 x 14 balls", tuple(scenes), 5.0, (rises(1e-6), apart(0.1)))


TRIALS = (
    _zigzag(),
    _pyramid(),
    _towers(),
    _nets(),
    _bridge(True),
    _bridge(False),
    _bridge(True, 0.0),
    _bridge(False, 0.0),
)

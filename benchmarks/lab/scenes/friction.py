"""Friction against its law: belts, meshes, slopes, grooves, wedges, piles of balls."""

import numpy as np

from benchmarks.lab.building import GRAVITY, Builder
from benchmarks.lab.measures import at_most, comes_to, rests, sinks, stays
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched


def _belt() -> Trial:
    """Put a box of 1 kg under 5 kg on a belt of 3 m/s: both speed up by mu g, and not beyond the belt's speed."""
    builder, speed = Builder(friction=0.4), 3.0
    builder.box((40.0, 2.0, 0.5), position=(0.0, 0.0, -0.25), static=True, belt=np.array([speed, 0.0, 0.0]))
    box = builder.box((1.0, 1.0, 0.2), position=(0.0, 0.0, 0.1), mass=1.0)
    builder.box((0.8, 0.8, 0.2), position=(0.0, 0.0, 0.3), mass=5.0, friction=1.6)

    def coefficient(scene: Scene, watched: Watched) -> float:
        sliding = (watched.times > 0.2) & (watched.times < 0.6)
        return float(np.polyfit(watched.times[sliding], watched.motions[sliding, box, 0], 1)[0] / GRAVITY)

    def fastest(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[:, box, 0].max())

    criteria = (comes_to("mu", "", coefficient, 0.4, 0.005), at_most("fastest", "m/s", fastest, 1.01 * speed))
    return Trial("belt: a box under five times its weight", (builder.scene(),), 2.0, criteria, looks=120)


def _mesh() -> Trial:
    """Let a box slide over a flat mesh with mu = 0.3."""
    builder, cells = Builder(friction=0.3), 12
    x, y = np.meshgrid(np.linspace(-2, 10, cells + 1), np.linspace(-2, 2, 5), indexing="ij")
    points = np.column_stack((x.ravel(), y.ravel(), np.zeros(x.size)))
    corner = np.array([5 * i + j for i in range(cells) for j in range(4)])
    faces = np.vstack(
        (np.column_stack((corner, corner + 5, corner + 6)), np.column_stack((corner, corner + 6, corner + 1)))
    )
    builder.mesh(points, faces)
    builder.box((0.5, 0.5, 0.5), position=(0.0, 0.0, 0.25), mass=1.0, velocity=(4.0, 0.3, 0.0))

    def coefficient(scene: Scene, watched: Watched) -> float:
        speeds = np.linalg.norm(watched.motions[:, 1, :2], axis=1)
        return float((speeds[5] - speeds[-1]) / ((watched.times[-1] - watched.times[5]) * GRAVITY))

    return Trial("flat mesh, mu 0.3", (builder.scene(),), 1.0, (comes_to("mu", "", coefficient, 0.3, 0.005),))


def _rolling() -> Trial:
    """Let a ball slide until it rolls: with 5/7 of its speed, whatever the coefficient."""
    builder, speed = Builder(friction=0.3), 4.0
    builder.plane()
    ball = builder.sphere(0.1, position=(0.0, 0.0, 0.1), velocity=(speed, 0.0, 0.0))

    def after(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[-1, ball, 0])

    criteria = (comes_to("v", "m/s", after, speed * 5 / 7),)
    return Trial("ball slides until it rolls", (builder.scene(),), 2.0, criteria)


def _slopes(members: int = 12, angle: float = 0.4) -> Trial:
    """Boxes on a slope of 0.4 rad, coefficients drawn on both sides of its tangent: each slides by the law, or stands."""
    random = np.random.default_rng(17)
    builder = Builder(GRAVITY * np.array([np.sin(angle), 0.0, -np.cos(angle)]))
    floor = 0.6
    builder.plane(friction=floor)
    share = random.choice([-1.0, 1.0], members) * random.uniform(0.05, 0.5, members)
    friction = np.tan(angle) * (1 + share)
    for k, mu in enumerate(friction):
        size = (random.uniform(0.5, 1.0), random.uniform(0.5, 1.0), random.uniform(0.1, 0.3))
        builder.box(size, position=(0.0, 3.0 * k, size[2] / 2), friction=mu**2 / floor)
    rates = GRAVITY * np.maximum(np.sin(angle) - friction * np.cos(angle), 0.0)

    def error(scene: Scene, watched: Watched) -> float:
        found = watched.motions[-1, 1:, 0]
        return float(np.abs(found - rates * watched.times[-1]).max() / (GRAVITY * watched.times[-1]))

    return Trial("12 boxes on a slope, mu drawn", (builder.scene(),), 2.0, (at_most("rate off by", "g", error, 0.005),))


def _groove() -> Trial:
    """Let a box slide in a groove of two planes at right angles: their forces add up to 1.41 of its weight."""
    builder = Builder(GRAVITY * np.array([np.sin(0.6), 0.0, -np.cos(0.6)]), friction=0.3)
    for side in (-1.0, 1.0):
        builder.plane((0.0, side, 1.0))
    turn = (np.cos(np.pi / 8), np.sin(np.pi / 8), 0.0, 0.0)
    builder.box((1.0, 0.5, 0.5), position=(0.0, 0.0, 0.25 * 2**0.5), orientation=turn, mass=1.0)
    rate = GRAVITY * (np.sin(0.6) - 0.3 * 2**0.5 * np.cos(0.6))

    def found(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[-1, 2, 0] / watched.times[-1])

    return Trial("box in a groove", (builder.scene(),), 2.0, (comes_to("rate", "m/s^2", found, rate, 0.01),))


def _wedge() -> Trial:
    """Put a wedge of 30 degrees to a side between two blocks, with a coefficient at which statics holds it."""
    builder, slant = Builder(friction=0.5), np.tan(np.radians(30.0))
    builder.plane()
    top, low, high = 0.5, 0.2, 0.8
    for side in (-1.0, 1.0):
        inner = [side * (0.05 + slant * z) for z in (0.0, 1.0)]
        outer = side * 1.5
        profile = np.array([(inner[0], 0.0), (outer, 0.0), (outer, 1.0), (inner[1], 1.0)])
        _prism(builder, profile, 10.0)
    half = [0.05 + slant * low, 0.05 + slant * high]
    profile = np.array([(-half[0], low), (half[0], low), (half[1], high), (-half[1], high)])
    _prism(builder, profile, 10.0 * top)
    return Trial("wedge between two blocks", (builder.scene(),), 6.0, (rests(), stays(0.05), sinks(0.05)))


def _prism(builder: Builder, profile: np.ndarray, mass: float) -> None:
    """Add a prism of 1 m along y. Its moments are those about its own axes, near enough where it does not turn."""
    points = np.array([(x, y, z) for x, z in profile for y in (-0.5, 0.5)])
    builder.hull(points, mass=mass)


def _ball_piles() -> list[Trial]:
    """Put a ball on three: statics holds it for mu above tan(17.6 degrees) = 0.318."""
    trials = []
    for mu, name in ((0.4, "3 balls under one, mu 0.4"),):
        builder, radius = Builder(friction=mu), 0.25
        builder.plane()
        for k in range(3):
            way = 2 * np.pi * k / 3
            around = 2 * radius / 3**0.5
            builder.sphere(radius, position=(around * np.cos(way), around * np.sin(way), radius), mass=1.0)
        builder.sphere(radius, position=(0.0, 0.0, radius + 2 * radius * (2 / 3) ** 0.5), mass=1.0)
        trials.append(Trial(name, (builder.scene(),), 10.0, (rests(), stays(0.05), sinks(0.05))))
    return trials


TRIALS = (_belt(), _mesh(), _rolling(), _slopes(), _groove(), _wedge(), *_ball_piles())

"""What is struck: fast boxes, billiard balls, dominoes, coins."""

import numpy as np

from benchmarks.lab.building import Builder
from benchmarks.lab.measures import at_most, comes_to, keeps
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched


def _bullet(shape: str) -> Trial:
    """A body of 1 kg strikes two plates of 10 kg, welded to each other, with 500 m/s and e = 0: all move on together."""
    builder, speed = Builder(0.0), 500.0
    plates = [builder.box((2.0, 2.0, 0.1), position=(0.0, 0.0, z), mass=10.0) for z in (0.0, -0.1)]
    builder.join("fixed", *plates, (0.0, 0.0, -0.05))
    options = {"position": (0.0, 0.0, 3.0), "mass": 1.0, "velocity": (0.0, 0.0, -speed)}
    striker = builder.box((0.2, 0.2, 0.2), **options) if shape == "box" else builder.sphere(0.1, **options)

    def after(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[-1, striker, 2])

    criteria = (comes_to("v", "m/s", after, -speed / 21, 0.05),)
    return Trial(f"{shape} at 500 m/s on two welded plates", (builder.scene(),), 0.5, criteria)


def _billiards() -> Trial:
    """A ball breaks a rack of 15 along its axis of symmetry, e = 1: left and right stay mirror images."""
    builder, radius, speed = Builder(0.0, friction=0.0, restitution=1.0), 0.03, 5.0
    mirror = [builder.sphere(radius, position=(-0.5, 0.0, 0.0), mass=0.17, velocity=(speed, 0.0, 0.0))]
    for row in range(5):
        first = mirror[-1] + 1 if row else 1
        for place in range(row + 1):
            y = (place - row / 2) * 2 * radius
            builder.sphere(radius, position=(row * radius * 3**0.5, y, 0.0), mass=0.17)
        mirror += [first + row - place for place in range(row + 1)]

    def asymmetry(scene: Scene, watched: Watched) -> float:
        end = watched.poses[-1, :, :3]
        return float(np.linalg.norm(end - end[mirror] * (1.0, -1.0, 1.0), axis=1).max())

    criteria = (at_most("asymmetry", "m", asymmetry, 0.01), keeps(0.01))
    return Trial("billiard break, e = 1", (builder.scene(),), 1.0, criteria)


def _dominoes(exact: float, count: int = 30) -> Trial:
    """A row of dominoes falls; the wave takes so long from one to the next."""
    builder, size, pitch, tilt = Builder(friction=0.5), np.array([0.05, 0.3, 1.0]), 0.4, 0.35
    builder.plane()
    for k in range(count):
        angle = tilt if k == 0 else 0.0
        edge = k * pitch + size[0] / 2
        turn = (np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0)
        half, height = size[0] / 2, size[2] / 2
        x = edge - half * np.cos(angle) + height * np.sin(angle)
        z = half * np.sin(angle) + height * np.cos(angle)
        builder.box(size, position=(x, 0.0, z), orientation=turn, density=600.0)

    def pace(scene: Scene, watched: Watched) -> float:
        """Time between the falls of the fifth and of the one before the last few, over their number."""
        first, last = 5, count - 5
        drop = watched.poses[:, 1:, 2] - 0.9 * size[2] / 2
        falls = [np.interp(0.0, -drop[:, k], watched.times) if drop[-1, k] < 0 else np.inf for k in (first, last)]
        return float((falls[1] - falls[0]) / (last - first))

    criteria = (comes_to("time a domino", "s", pace, exact, 0.03),)
    return Trial("30 dominoes", (builder.scene(),), 8.0, criteria, looks=480)


def _coin(exact: float) -> Trial:
    """A coin of 24 corners, put down at 40 degrees and turning, until it lies flat."""
    builder, radius, thickness, tilt = Builder(friction=0.4), 0.1, 0.01, np.radians(40.0)
    builder.plane()
    corners = np.arange(24) * 2 * np.pi / 24
    rim = np.column_stack((radius * np.cos(corners), radius * np.sin(corners)))
    points = np.vstack([np.column_stack((rim, np.full(24, z))) for z in (-thickness / 2, thickness / 2)])
    height = radius * np.sin(tilt) + thickness / 2 * np.cos(tilt) + 0.001
    turn = (np.cos(tilt / 2), 0.0, np.sin(tilt / 2), 0.0)
    spin = (0.0, 0.0, 14.0)
    coin = builder.hull(points, position=(0.0, 0.0, height), orientation=turn, angular_velocity=spin, density=8000.0)

    def flat(scene: Scene, watched: Watched) -> float:
        high = np.flatnonzero(watched.poses[:, coin, 2] > thickness / 2 + 1e-3)
        return float(watched.times[min(high[-1] + 1, len(watched.times) - 1)])

    return Trial("coin of 24 corners", (builder.scene(),), 5.0, (comes_to("flat after", "s", flat, exact, 0.2),), looks=300)


TRIALS = (_bullet("box"), _bullet("ball"), _billiards(), _dominoes(0.25), _coin(1.8))

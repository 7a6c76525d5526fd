"""What swings and spins for a while: chains, grids, springs, tops."""

import numpy as np

from benchmarks.lab.building import GRAVITY, GROUND, Builder
from benchmarks.lab.measures import apart, at_most, comes_to, keeps, rests, rises, stays
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched

_LYING, _LYING_ACROSS = (2**-0.5, 0.0, 2**-0.5, 0.0), (2**-0.5, 2**-0.5, 0.0, 0.0)
_ACROSS = (0.0, 1.0, 0.0)
_PASSING = {"mask": 0, "layer": 2}  # what meets nothing


def _chain(kind: str, links: int, end: float) -> Trial:
    """Let a chain of rods of 1 kg and 0.5 m swing from the horizontal, a ball of some mass at its end."""
    builder, length, radius = Builder(), 0.5, 0.05
    before = GROUND
    for k in range(links):
        place = ((k + 0.5) * length, 0.0, 0.0)
        rod = builder.capsule(radius, length - 2 * radius, position=place, orientation=_LYING, mass=1.0, **_PASSING)
        builder.join(kind, before, rod, (k * length, 0.0, 0.0), _ACROSS)
        before = rod
    if end:
        size = radius * end ** (1 / 3)
        ball = builder.sphere(size, position=(links * length + size, 0.0, 0.0), mass=end, **_PASSING)
        builder.join(kind, before, ball, (links * length, 0.0, 0.0), _ACROSS)
    name = f"chain of {links} on {'hinges' if kind == 'hinge' else 'ball joints'}" + (
        f", {end:g} kg below" if end else ""
    )
    return Trial(name, (builder.scene(),), 5.0, (keeps(0.01), apart(0.01)), looks=100)


def _held(members: int = 12, links: int = 8, length: float = 0.3) -> Trial:
    """Let the friction of ball joints hold bent chains, which it can with twice the torque that they need."""
    random, scenes = np.random.default_rng(22), []
    for _ in range(members):
        builder, before, at = Builder(), GROUND, np.zeros(3)
        for _ in range(links):
            way = random.normal((1.0, 0.0, 0.0))
            way *= length / np.linalg.norm(way)
            ball = builder.sphere(0.1, position=at + way / 2, mass=1.0, **_PASSING)
            builder.join("ball", before, ball, at, friction=4.0 * links * GRAVITY * length)
            before, at = ball, at + way
        scenes.append(builder.scene())
    criteria = (rests(), stays(1e-3), apart(0.01))
    return Trial(f"{members} chains held by friction of ball joints", tuple(scenes), 2.0, criteria)


def _grid(size: int = 10) -> Trial:
    """Let a grid of balls, each joined to its neighbours, swing from its first row."""
    builder = Builder()
    balls = {}
    for row in range(size):
        for column in range(size):
            ball = builder.sphere(0.4, position=(row, column, 0.0), static=row == 0, **_PASSING)
            balls[row, column] = ball
            if row > 0:
                builder.join("ball", balls[row - 1, column], ball, (row - 0.5, column, 0.0))
            if row > 0 and column > 0:
                builder.join("ball", balls[row, column - 1], ball, (row, column - 0.5, 0.0))
    return Trial("joint grid of 10 x 10", (builder.scene(),), 5.0, (keeps(0.01), apart(0.01)), looks=100)


def _drum(links: int = 60) -> Trial:
    """Lay a rope of 60 links over a drum, on which friction holds it."""
    builder, drum, radius, length = Builder(friction=1.0), 0.5, 0.02, 0.1
    builder.capsule(drum, 4.0, orientation=_LYING_ACROSS, static=True)
    before = None
    for k in range(links):
        x = (k - (links - 1) / 2) * length
        place = (x, 0.0, drum + radius)
        rod = builder.capsule(radius, length - 2 * radius, position=place, orientation=_LYING, mass=0.1)
        if before is not None:
            builder.join("ball", before, rod, (x - length / 2, 0.0, drum + radius))
        before = rod

    def below(scene: Scene, watched: Watched) -> float:
        return float(drum - watched.poses[-1, 1:, 2].max())

    criteria = (at_most("below the top", "m", below, 0.0), apart(0.01))
    return Trial("rope of 60 links over a drum", (builder.scene(),), 5.0, criteria, quick=False)


def _spring(hertz: float, periods: int = 6) -> Trial:
    """Let a mass on an undamped spring swing for six periods."""
    builder, amplitude = Builder(0.0), 0.1
    mass, rate = 1.0, 2 * np.pi * hertz
    body = builder.box((0.2, 0.2, 0.2), mass=mass)
    options = {"stiffness": mass * rate**2, "target": amplitude}
    builder.join("slider", GROUND, body, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), **options)

    def left(scene: Scene, watched: Watched) -> float:
        stretch = watched.poses[-1, body, 0] - amplitude
        return float(np.hypot(stretch, watched.motions[-1, body, 0] / rate) / amplitude)

    criteria = (comes_to("amplitude left", "", left, 1.0),)
    return Trial(f"undamped spring of {hertz:g} Hz", (builder.scene(),), periods / hertz, criteria)


def _top(rate: float, tilt: float = 0.35) -> Trial:
    """Spin a heavy top on a ball joint so that it precesses evenly, by the slow root of its equation."""
    builder, arm, mass = Builder(), 0.15, 1.0
    about, across = 0.02, 0.01 + mass * arm**2  # moments about the axis, and across it through the tip
    a, b, c = across * np.cos(tilt), about * rate, mass * GRAVITY * arm
    slow = 2 * c / (b + np.sqrt(b * b - 4 * a * c))
    axis = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    spin = slow * np.array([0.0, 0.0, 1.0]) + (rate - slow * np.cos(tilt)) * axis
    motion = {"angular_velocity": spin, "velocity": np.cross(spin, arm * axis)}
    turn = (np.cos(tilt / 2), 0.0, np.sin(tilt / 2), 0.0)
    body = builder.sphere(
        0.1, position=arm * axis, orientation=turn, mass=mass, gyration=(0.01, 0.01, 0.02), **motion, **_PASSING
    )
    builder.join("ball", GROUND, body, (0.0, 0.0, 0.0))

    def precession(scene: Scene, watched: Watched) -> float:
        angles = np.unwrap(np.arctan2(watched.poses[:, body, 1], watched.poses[:, body, 0]))
        return float((angles[-1] - angles[0]) / watched.times[-1])

    criteria = (keeps(0.01), comes_to("precession", "rad/s", precession, float(slow), 0.02), apart(0.001))
    return Trial(f"top at {rate:g} rad/s", (builder.scene(),), 5.0, criteria, refusable=True)


def _wrecking(links: int = 18, mass: float = 900.0) -> Trial:
    """Swing a ball on a chain of rods of 1 kg into a wall of 28 blocks: no energy comes of it."""
    builder, lean, length, radius = Builder(friction=0.6), np.radians(70.0), 0.45, 0.5
    builder.plane(friction=0.5)
    top, along = np.array([0.0, 0.0, length * links + 1.6]), np.array([-np.sin(lean), 0.0, -np.cos(lean)])
    turn, before = (np.cos(lean / 2), 0.0, np.sin(lean / 2), 0.0), GROUND
    for k in range(links):
        place = top + (k + 0.5) * length * along
        rod = builder.capsule(0.05, length - 0.1, position=place, orientation=turn, mass=1.0, **_PASSING)
        builder.join("ball", before, rod, top + k * length * along)
        before = rod
    ball = builder.sphere(radius, position=top + (links * length + radius) * along, mass=mass)
    builder.join("ball", before, ball, top + links * length * along)
    for row, place in np.ndindex(7, 4):
        builder.box((0.4, 0.8, 0.4), position=(0.9, 0.82 * (place - 1.5), 0.2 + 0.4 * row), density=1200.0)
    fall = mass * GRAVITY * (links * length + radius) * (1 - np.cos(lean))
    return Trial("wrecking ball of 900 kg", (builder.scene(),), 2.6, (rises(0.01 * fall),), looks=52)


TRIALS = (
    _chain("hinge", 10, 0.0),
    _chain("ball", 10, 0.0),
    _chain("hinge", 20, 100.0),
    _chain("ball", 20, 1000.0),
    _held(),
    _grid(),
    _drum(),
    *(_spring(hertz) for hertz in (1.0, 6.0)),
    *(_top(rate) for rate in (100.0, 1000.0)),
    _wrecking(),
)

"""What is struck: fast boxes, billiard balls, dominoes, coins."""

import itertools

import numpy as np
from scipy.spatial.distance import pdist

from benchmarks.lab.building import GRAVITY, Builder
from benchmarks.lab.measures import at_most, comes_to, keeps
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched


def _bullet(shape: str) -> Trial:
    """Strike two plates of 10 kg, welded to each other, with 1 kg at 500 m/s and e = 0: all move on together."""
    builder, speed = Builder(0.0), 500.0
    plates = [builder.box((2.0, 2.0, 0.1), position=(0.0, 0.0, z), mass=10.0) for z in (0.0, -0.1)]
    builder.join("fixed", *plates, (0.0, 0.0, -0.05))
    options = {"position": (0.0, 0.0, 3.0), "mass": 1.0, "velocity": (0.0, 0.0, -speed)}
    striker = builder.box((0.2, 0.2, 0.2), **options) if shape == "box" else builder.sphere(0.1, **options)

    def after(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[-1, striker, 2])

    criteria = (comes_to("v", "m/s", after, -speed / 21, 0.05),)
    return Trial(f"{shape} at 500 m/s on two welded plates", (builder.scene(),), 0.5, criteria)


def _grounded_bullets(members: int = 6) -> Trial:
    """Boxes of random mass and size strike two welded plates that lie on the floor, with 500 m/s and e = 0."""
    random, scenes = np.random.default_rng(8), []
    for _ in range(members):
        builder, edge = Builder(), random.uniform(0.1, 0.6)
        builder.plane()
        plates = [builder.box((2.0, 2.0, 0.1), position=(0.0, 0.0, z), mass=10.0) for z in (0.05, 0.15)]
        builder.join("fixed", *plates, (0.0, 0.0, 0.1))
        place = (*random.uniform(-0.5, 0.5, 2), 3.0)
        builder.box((edge,) * 3, position=place, mass=10.0 ** random.uniform(-1, 2), velocity=(0.0, 0.0, -500.0))
        scenes.append(builder.scene())

    def rebound(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[:, 3, 2].max())

    def through(scene: Scene, watched: Watched) -> float:
        return float(0.2 - watched.poses[:, 3, 2].min())

    criteria = (at_most("rebounds", "m/s", rebound, 5.0), at_most("below the plates", "m", through, 0.0))
    return Trial("6 boxes at 500 m/s on grounded plates", tuple(scenes), 0.5, criteria, looks=30)


def _walls(members: int = 40) -> Trial:
    """Boxes and capsules of random size fly at a thin wall, of one box or of two triangles, at 50 to 500 m/s."""
    random, scenes = np.random.default_rng(9), []
    for member in range(members):
        builder = Builder(friction=0.0, restitution=random.choice([0.0, 0.5]))
        corners = [(0.0, y, z) for y, z in ((-5, -5), (5, -5), (5, 5), (-5, 5))]
        if member % 2:
            builder.mesh(corners, [(0, 2, 1), (0, 3, 2)])
        else:
            builder.box((0.01, 10.0, 10.0), static=True)
        start = np.array([-random.uniform(1, 3), *random.uniform(-2, 2, 2)])
        way = np.array([0.0, *random.uniform(-2, 2, 2)]) - start
        options = {
            "position": start,
            "velocity": 10.0 ** random.uniform(1.7, 2.7) * way / np.linalg.norm(way),
            "angular_velocity": 10.0 * random.normal(size=3),
            "orientation": random.normal(size=4),
            "mass": 1.0,
        }
        edge = 10.0 ** random.uniform(-1.5, -0.7)
        if member % 4 < 2:
            builder.box((2.0 * edge, edge, 0.5 * edge), **options)
        else:
            builder.capsule(0.4 * edge, 2.0 * edge, **options)
        scenes.append(builder.scene())

    def behind(scene: Scene, watched: Watched) -> float:
        return float(watched.poses[-1, 1, 0])

    criteria = (at_most("behind the wall", "m", behind, 0.0),)
    return Trial(f"{members} boxes and capsules at 50 to 500 m/s on thin walls", tuple(scenes), 0.2, criteria, looks=12)


def _billiards() -> Trial:
    """Break a rack of 15 balls along its axis of symmetry, e = 1: left and right stay mirror images."""
    builder, radius, speed = Builder(0.0, friction=0.0, restitution=1.0), 0.03, 5.0
    mirror = [builder.sphere(radius, position=(-0.5, 0.0, 0.0), mass=0.17, velocity=(speed, 0.0, 0.0))]
    for row in range(5):
        first = len(mirror)
        for place in range(row + 1):
            y = (place - row / 2) * 2 * radius
            builder.sphere(radius, position=(row * radius * 3**0.5, y, 0.0), mass=0.17)
        mirror += [first + row - place for place in range(row + 1)]

    def asymmetry(scene: Scene, watched: Watched) -> float:
        end = watched.poses[-1, :, :3]
        return float(np.linalg.norm(end - end[mirror] * (1.0, -1.0, 1.0), axis=1).max())

    criteria = (at_most("asymmetry", "m", asymmetry, 0.01), keeps(0.01))
    return Trial("billiard break, e = 1", (builder.scene(),), 1.0, criteria)


def _dominoes(exact: float = 0.1137, count: int = 30) -> Trial:
    """Let a row of dominoes fall; the wave takes so long from one to the next.

    MuJoCo takes 0.1137 s with 5, 2 and 1 ms; Box3D 0.1156 with 1 ms.
    """
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

    criteria = (comes_to("time a domino", "s", pace, exact, 0.05),)
    return Trial("30 dominoes", (builder.scene(),), 8.0, criteria, looks=480)


def _coin(exact: float = 1.480) -> Trial:
    """Begin a coin of 24 corners as Euler's disc would roll on at 45 degrees; it lies flat after a while.

    The disc's steady motion turns with 2 sqrt(g / (r sin(tilt))) about the vertical and rests in its middle. Corners take
    its energy: between impacts the coin turns about one of them, and at an impact keeps its angular momentum about the
    next. Integrated with a relative tolerance of 1e-9, 241 impacts later its centre is 1 mm above where it lies flat.
    """
    builder, radius, thickness, tilt = Builder(friction=1.0), 0.1, 0.01, np.pi / 4
    builder.plane()
    corners = np.arange(24) * 2 * np.pi / 24
    rim = np.column_stack((radius * np.cos(corners), radius * np.sin(corners)))
    points = np.vstack([np.column_stack((rim, np.full(24, z))) for z in (-thickness / 2, thickness / 2)])
    height = radius * np.sin(tilt) + thickness / 2 * np.cos(tilt)
    turn = (np.cos(tilt / 2), 0.0, np.sin(tilt / 2), 0.0)
    rate = 2 * np.sqrt(GRAVITY / (radius * np.sin(tilt)))
    spin = rate * np.sin(tilt) * np.array([-np.cos(tilt), 0.0, np.sin(tilt)])
    coin = builder.hull(points, position=(0.0, 0.0, height), orientation=turn, angular_velocity=spin, density=8000.0)

    def flat(scene: Scene, watched: Watched) -> float:
        high = np.flatnonzero(watched.poses[:, coin, 2] > thickness / 2 + 1e-3)
        return float(watched.times[min(high[-1] + 1, len(watched.times) - 1)])

    criteria = (comes_to("flat after", "s", flat, exact, 0.2),)
    return Trial("coin of 24 corners", (builder.scene(),), 5.0, criteria, looks=300)


def _gas(members: int = 3, count: int = 30) -> Trial:
    """Elastic balls of 1 to 100 kg fly about between six walls of 2 cm: a light one that is struck gets fast within a step."""
    scenes = []
    for seed in range(members):
        random, places = np.random.default_rng(seed), np.empty((0, 3))
        builder = Builder(0.0, friction=0.0, restitution=1.0)
        for axis in range(3):
            for side in (-1.01, 1.01):
                builder.box(2.1 - 2.08 * np.eye(3)[axis], position=side * np.eye(3)[axis], static=True)
        while len(places) < count:
            radius, at = random.uniform(0.03, 0.1), random.uniform(-0.88, 0.88, 3)
            if (np.linalg.norm(places - at, axis=1) > radius + 0.11).all():
                mass, speed = 100.0 ** random.uniform(), 5.0 * random.normal(size=3)
                builder.sphere(radius, position=at, mass=mass, velocity=speed)
                places = np.vstack((places, at))
        scenes.append(builder.scene())

    def outside(scene: Scene, watched: Watched) -> float:
        return float(np.abs(watched.poses[:, 6:, :3]).max() - 1.0)

    criteria = (at_most("outside", "m", outside, 0.0), keeps(0.01))
    return Trial("gas of 30 light and heavy balls between thin walls, e = 1", tuple(scenes), 5.0, criteria)


def _crowded(members: int = 3, count: int = 157, radius: float = 0.08) -> Trial:
    """Elastic balls at 30 m/s, so close that most are hit within a step: what is turned aside meets others, and stops there."""
    random, scenes = np.random.default_rng(157), []
    grid = 0.32 * np.stack(np.meshgrid(*3 * [np.arange(6) - 2.5]), axis=-1).reshape(-1, 3)
    for _ in range(members):
        builder = Builder(0.0, friction=0.0, restitution=1.0)
        for axis in range(3):
            for side in (-1.05, 1.05):
                builder.box(2.4 - 2.3 * np.eye(3)[axis], position=side * np.eye(3)[axis], static=True)
        for place in grid[:count]:
            way = random.normal(size=3)
            at, velocity = place + random.uniform(-0.05, 0.05, 3), 30.0 * way / np.linalg.norm(way)
            builder.sphere(radius, position=at, mass=1.0, velocity=velocity)
        scenes.append(builder.scene())

    def deepest(scene: Scene, watched: Watched) -> float:
        balls = watched.poses[:, 6:, :3]
        return 2 * radius - float(min(pdist(places).min() for places in balls))

    criteria = (at_most("overlap", "m", deepest, radius / 2), keeps(0.01))
    return Trial("157 balls at 30 m/s between walls, e = 1", tuple(scenes), 1.0, criteria, looks=60, quick=False)


def _wedged(radius: float = 0.05, gap: float = 0.1) -> Trial:
    """Drive a ball of 1 or 100 g into a wall of 2 cm with one of 1 kg at 10 or 30 m/s, e = 0: all stop there."""
    scenes = []
    for mass, speed in itertools.product((1e-3, 0.1), (10.0, 30.0)):
        builder = Builder(0.0, friction=0.0)
        builder.box((0.02, 4.0, 4.0), position=(0.01, 0.0, 0.0), static=True)
        builder.sphere(radius, position=(-radius - gap, 0.0, 0.0), mass=mass)
        builder.sphere(radius, position=(-4 * radius - gap, 0.0, 0.0), mass=1.0, velocity=(speed, 0.0, 0.0))
        scenes.append(builder.scene())

    def left(scene: Scene, watched: Watched) -> float:
        return float(np.linalg.norm(watched.motions[-1, 2, :3]) / watched.motions[0, 2, 0])

    criteria = (at_most("part of its speed left", "", left, 0.1),)
    return Trial("4 balls that press a light one to a wall, e = 0", tuple(scenes), 0.2, criteria, looks=12)


def _tube(members: int = 12) -> Trial:
    """Two free boxes of 10 kg to a ton fly about in a tube that is closed, with balls of 0.1 to 10 g between them and its ends.

    A ball in a closing gap is hit without end, the faster the narrower it is, and e takes the energy; it stays in the tube.
    """
    random, scenes, half = np.random.default_rng(2), [], np.array([1.0, 0.3, 0.3])
    for _ in range(members):
        builder = Builder(0.0, friction=0.0, restitution=random.choice([0.05, 0.2, 0.5]))
        for axis in range(3):
            for side in (-1.0, 1.0):
                size = 2 * half + 0.8
                size[axis] = 0.4
                builder.box(size, position=side * (half + 0.2) * np.eye(3)[axis], static=True)
        speed = 10.0 ** random.uniform(0, 1)
        for x in (-0.5, 0.3):
            motion = {"mass": 10.0 ** random.uniform(1, 3), "velocity": (speed * random.choice([-1, 1]), 0.0, 0.0)}
            builder.box((0.4, 0.5, 0.5), position=(x, 0.0, 0.0), **motion)
            radius = random.uniform(0.03, 0.1)
            place = (x + 0.25 + radius, *random.uniform(-0.1, 0.1, 2))
            builder.sphere(radius, position=place, mass=10.0 ** random.uniform(-4, -2))
        scenes.append(builder.scene())

    def outside(scene: Scene, watched: Watched) -> float:
        return float((np.abs(watched.poses[:, 6:, :3]) - half).max())

    criteria = (at_most("outside", "m", outside, 0.0),)
    name = f"balls of grams between heavy boxes in {members} closed tubes"
    return Trial(name, tuple(scenes), 0.3, criteria, looks=18, quick=False)


def _rooms(members: int = 20, count: int = 12) -> Trial:
    """Throw sticks, plates and capsules of aspect 5 to 40 about in rooms with walls of 2 cm, at 5 to 60 m/s and with spin."""
    scenes, corners = [], 0.6 * np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=3)))
    for seed in range(members):
        random = np.random.default_rng(seed)
        gravity, friction = random.choice([0.0, GRAVITY]), random.uniform(0, 1)
        builder = Builder(gravity, friction=friction, restitution=random.choice([0.0, 0.5]))
        for axis in range(3):
            for side in (-1.01, 1.01):
                builder.box(2.1 - 2.08 * np.eye(3)[axis], position=side * np.eye(3)[axis], static=True)
        speed = random.uniform(5, 60)
        for place in corners[random.permutation(27)[:count]]:
            length, way = random.uniform(0.1, 0.5), random.normal(size=3)
            thin = length / random.uniform(5, 40)
            options = {"position": place, "orientation": random.normal(size=4), "density": 10 ** random.uniform(2, 4)}
            options["velocity"] = speed * way / np.linalg.norm(way)
            options["angular_velocity"] = speed * random.choice([0.2, 1.0, 3.0]) * random.normal(size=3)
            match random.integers(3):
                case 0:
                    builder.box((length, thin, thin), **options)
                case 1:
                    builder.box((length, length * random.uniform(0.4, 1), thin), **options)
                case _:
                    builder.capsule(thin / 2, length - thin, **options)
        scenes.append(builder.scene())

    def outside(scene: Scene, watched: Watched) -> float:
        return float(np.abs(watched.poses[:, 6:, :3]).max() - 1.0)

    criteria = (at_most("outside", "m", outside, 0.0),)
    return Trial(f"slender bodies in {members} rooms with thin walls", tuple(scenes), 1.0, criteria, looks=60)


TRIALS = (
    _bullet("box"),
    _bullet("ball"),
    _grounded_bullets(),
    _walls(),
    _billiards(),
    _dominoes(),
    _coin(),
    _gas(),
    _crowded(),
    _wedged(),
    _tube(),
    _rooms(),
)

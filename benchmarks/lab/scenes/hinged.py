"""Impacts on bodies that hang on hinges, against the theory of rigid impact; and what turns on hinges for a while."""

import numpy as np

from benchmarks.lab.building import GRAVITY, GROUND, Builder
from benchmarks.lab.measures import apart, at_most, comes_to, keeps
from benchmarks.lab.trial import Criterion, Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched, energies

_UP, _ACROSS = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)
_WEIGHTLESS = 0.0


def rebound(mass: float, speed: float, inertia: float, arm: float, restitution: float) -> tuple[float, float]:
    """Velocity of a ball and rate of a hinged body after the ball met it at an arm, both at first along the ball's way.

    The impulse p takes p / mass from the ball and gives p arm / inertia to the body; the approach turns into e of itself.
    """
    impulse = (1 + restitution) * speed / (1 / mass + arm**2 / inertia)
    return speed - impulse / mass, impulse * arm / inertia


def _door(restitution: float) -> Trial:
    """Strike a door of 1 m x 2 m on its hinge with a ball, 0.8 m from the hinge."""
    builder = Builder(_WEIGHTLESS, restitution=restitution, friction=0.0)
    door = builder.box((1.0, 0.05, 2.0), position=(0.5, 0.0, 0.0), mass=5.0)
    builder.join("hinge", GROUND, door, (0.0, 0.0, 0.0), _UP)
    ball = builder.sphere(0.1, position=(0.8, -0.525, 0.0), mass=1.0, velocity=(0.0, 2.0, 0.0))
    inertia = 5.0 * (1.0**2 + 0.05**2) / 12 + 5.0 * 0.25
    after, rate = rebound(1.0, 2.0, inertia, 0.8, restitution)
    criteria = (_velocity(ball, 1, after), _rate(door, 2, rate), apart(1e-3))
    return Trial(f"door struck by a ball, e = {restitution:g}", (builder.scene(),), 0.4, criteria)


def _velocity(body: int, axis: int, exact: float) -> Criterion:
    return comes_to("v", "m/s", lambda _, watched: float(watched.motions[-1, body, axis]), exact)


def _rate(body: int, axis: int, exact: float) -> Criterion:
    return comes_to("rate", "rad/s", lambda _, watched: float(watched.motions[-1, body, 3 + axis]), exact)


def _rod(restitution: float) -> Trial:
    """Let a rod on a hinge strike a post with its tip: it rebounds with e of its rate."""
    builder = Builder(_WEIGHTLESS, restitution=restitution, friction=0.0)
    motion = {"velocity": (0.0, 0.0, -1.5), "angular_velocity": (0.0, 3.0, 0.0)}
    rod = builder.box((1.0, 0.05, 0.05), position=(0.5, 0.0, 0.0), mass=1.0, **motion)
    builder.join("hinge", GROUND, rod, (0.0, 0.0, 0.0), _ACROSS)
    builder.box((0.2, 0.2, 0.2), position=(0.95, 0.0, -0.525), static=True)
    criteria = (_rate(rod, 1, -3.0 * restitution), apart(1e-3))
    return Trial(f"hinged rod strikes a post, e = {restitution:g}", (builder.scene(),), 0.4, criteria)


def _cradle() -> Trial:
    """Five balls on rods and hinges, e = 1; the first swings in, the last leaves with its speed, and energy stays."""
    builder = Builder(friction=0.0, restitution=1.0)
    radius, length, tilt = 0.05, 1.0, 0.5
    balls = []
    for k in range(5):
        top = np.array([(2 * radius + 1e-4) * k, 0.0, 0.0])
        angle = tilt if k == 0 else 0.0
        way = np.array([-np.sin(angle), 0.0, -np.cos(angle)])
        turn = (np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0)
        balls.append(builder.sphere(radius, position=top + length * way, orientation=turn, mass=1.0))
        builder.join("hinge", GROUND, balls[-1], top, _ACROSS)
    drop, gyration = length * (1 - np.cos(tilt)), length**2 + 0.4 * radius**2
    speed = length * np.sqrt(2 * GRAVITY * drop / gyration)

    def last(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[:, balls[-1], 0].max())

    criteria = (comes_to("v of the last", "m/s", last, speed), keeps(0.01))
    return Trial("cradle on hinges, e = 1", (builder.scene(),), 5.0, criteria, looks=300)


def _rotor(rate: float, off: float) -> Trial:
    """Turn a plate on a hinge through its centre, or beside it, without weight, for 5 s."""
    builder = Builder(_WEIGHTLESS)
    motion = {"velocity": (0.0, rate * off, 0.0), "angular_velocity": (0.0, 0.0, rate)}
    rotor = builder.box((0.4, 0.2, 0.1), position=(off, 0.0, 0.0), mass=2.0, **motion)
    builder.join("hinge", GROUND, rotor, (0.0, 0.0, 0.0), _UP)
    where = f"{off:g} m off centre" if off else "on centre"
    return Trial(f"rotor, {rate:g} rad/s, {where}", (builder.scene(),), 5.0, (keeps(0.01), apart(0.01)), refusable=True)


def _rotors_drawn(members: int = 8) -> Trial:
    """Bodies of random shape and axis on hinges beside them, with 20 to 80 rad/s."""
    random = np.random.default_rng(3)
    scenes = []
    for _ in range(members):
        axis, anchor = random.normal(size=3), random.uniform(-0.3, 0.3, 3)
        axis /= np.linalg.norm(axis)
        spin = axis * random.uniform(20.0, 80.0)
        builder = Builder(_WEIGHTLESS)
        motion = {"velocity": np.cross(spin, -anchor), "angular_velocity": spin}
        rotor = builder.box(random.uniform(0.1, 0.5, 3), mass=1.0, **motion)
        builder.join("hinge", GROUND, rotor, anchor, axis)
        scenes.append(builder.scene())
    return Trial("8 rotors of random shape and axis", tuple(scenes), 5.0, (keeps(0.01), apart(0.01)))


def _hub(rate: float) -> Trial:
    """Turn a hub on a hinge through its centre that carries a weight, fixed to it, 0.5 m away."""
    builder = Builder(_WEIGHTLESS)
    spin = {"angular_velocity": (0.0, 0.0, rate)}
    hub = builder.box((0.4, 0.4, 0.1), mass=2.0, **spin)
    weight = builder.sphere(0.1, position=(0.5, 0.0, 0.0), mass=1.0, velocity=(0.0, 0.5 * rate, 0.0), **spin)
    builder.join("hinge", GROUND, hub, (0.0, 0.0, 0.0), _UP)
    builder.join("fixed", hub, weight, (0.3, 0.0, 0.0))
    return Trial(f"hub with a weight, {rate:g} rad/s", (builder.scene(),), 5.0, (keeps(0.01), apart(0.01)))


def _hanging_hub() -> Trial:
    """Turn a wheel on a hinge through its centre, with a weight that hangs from its rim on a hinge."""
    builder = Builder()
    spin, rate = {"angular_velocity": (0.0, 20.0, 0.0)}, 20.0
    hub = builder.box((0.6, 0.1, 0.6), mass=5.0, **spin)
    weight = builder.box((0.05, 0.05, 0.3), position=(0.3, 0.15, -0.15), mass=1.0, velocity=(0.0, 0.0, -0.3 * rate))
    builder.join("hinge", GROUND, hub, (0.0, 0.0, 0.0), _ACROSS)
    builder.join("hinge", hub, weight, (0.3, 0.15, 0.0), _ACROSS)
    return Trial("wheel with a swinging weight, 20 rad/s", (builder.scene(),), 5.0, (keeps(0.01), apart(0.01)), 100)


def _thrown(members: int = 300) -> Trial:
    """Throw trees of two to eight rods and balls, of masses that differ by up to 1000, at a wall at 3 to 100 m/s."""
    random = np.random.default_rng(3)
    scenes = tuple(_linkage(random, falls=k % 2 == 1) for k in range(members))

    criteria = (_rises_at_most(0.02),)
    return Trial(f"{members} linkages thrown at a wall", scenes, 2 / 3, criteria, looks=40, quick=False)


def _rises_at_most(part: float) -> Criterion:
    """Want the energy never to rise by more than a part of the kinetic energy at the start."""

    def risen(scene: Scene, watched: Watched) -> float:
        looks = [energies(scene, watched.poses[k], watched.motions[k]) for k in range(len(watched.times))]
        return (max(whole for _, whole in looks) - looks[0][1]) / looks[0][0]

    return at_most("energy risen", "", risen, part)


def _linkage(random: np.random.Generator, falls: bool) -> Scene:
    surface = {"friction": random.uniform(0.0, 0.8), "restitution": random.choice([0.0, 0.0, 0.5, 1.0])}
    builder = Builder(GRAVITY if falls else 0.0, **surface)
    builder.box((0.2, 6.0, 6.0), position=(3.0, 0.0, 0.0), static=True)
    if falls:
        builder.plane(position=(0.0, 0.0, -1.2))
    mass, bodies = 10.0 ** random.uniform(-1, 1.5), []
    velocity = np.array([10.0 ** random.uniform(0.5, 2), *random.normal(size=2)])
    spin = np.array([0.0, random.normal() * random.choice([0.0, 10.0]), 0.0])
    for k in range(random.integers(2, 9)):
        place, own = np.array([-0.5 * k, 0.0, 0.0]), mass * 10.0 ** random.uniform(-1.5, 1.5)
        motion = {"mass": own, "velocity": velocity + np.cross(spin, place), "angular_velocity": spin}
        long, kind = random.uniform(0.2, 0.6), random.integers(3)
        if kind == 0:
            bodies.append(builder.box((long, 0.1, 0.1), position=place, **motion))
        elif kind == 1:
            turn = (0.5**0.5, 0.0, 0.5**0.5, 0.0)
            bodies.append(builder.capsule(0.06, long, position=place, orientation=turn, **motion))
        else:
            bodies.append(builder.sphere(0.1 + 0.1 * random.random(), position=place, **motion))
        if k > 0:
            held = k - 1 if random.random() < 0.8 else random.integers(k)
            middle, joint = 0.5 * (place - np.array([0.5 * held, 0.0, 0.0])), random.choice(["hinge", "ball", "fixed"])
            axis = (0.0, 1.0, 0.0) if random.random() < 0.5 else random.normal(size=3)
            builder.join(str(joint), bodies[held], bodies[k], middle, axis)
    return builder.scene()


def _rows(*seeds: int, each: int, quick: bool) -> Trial:
    """Strike rows of free and jointed bodies of 0.1 g to a ton, with balls of 10 mg to 10 kg between them, e = 0.2 to 1."""
    scenes: list[Scene] = []
    for seed in seeds:
        random = np.random.default_rng(seed)
        scenes += [_row(random, falls=k % 2 == 1) for k in range(each)]
    name = f"{len(scenes)} rows of light and heavy bodies"
    return Trial(name, tuple(scenes), 2 / 3, (_rises_at_most(0.01),), looks=40, quick=quick)


def _row(random: np.random.Generator, falls: bool) -> Scene:
    builder = Builder(
        GRAVITY if falls else 0.0, friction=random.uniform(0.0, 0.6), restitution=random.choice([0.2, 0.5, 0.9, 1.0])
    )
    for wall in ((2.5, 0.0, 0.0), (-2.5, 0.0, 0.0)):
        builder.box((0.2, 4.0, 4.0), position=wall, static=True)
    builder.box((6.0, 4.0, 0.2), position=(0.0, 0.0, -1.6), static=True)
    for k in range(random.integers(2, 6)):
        place, speed = np.array([0.75 * k - 1.8, 0.0, 0.0]), 10.0 ** random.uniform(0, 2) * random.choice([-1.0, 1.0])
        motion = {"mass": 10.0 ** random.uniform(-4, 3), "velocity": (speed if k < 2 else 0.0, 0.0, 0.0)}
        kind, joint = random.integers(3), random.integers(4)
        if kind == 0:
            body = builder.sphere(0.3, position=place, **motion)
        elif kind == 1:
            body = builder.box((0.5, 0.5, 0.5), position=place, **motion)
        else:
            body = builder.capsule(0.15, 0.5, position=place, **motion)
        if joint < 3:
            named, axis = (("hinge", (0, 1, 0)), ("ball", (0, 0, 1)), ("slider", (1, 0, 0)))[joint]
            builder.join(named, GROUND, body, place + ((0.0, 0.0, 1.2) if joint < 2 else (0.0, 0.0, 0.0)), axis)
        if random.random() < 0.6:
            beside = place + np.array([0.38, 0.02, 0.05]) * (1.0, *random.normal(size=2))
            builder.sphere(0.03, position=beside, mass=10.0 ** random.uniform(-5, 1), velocity=random.normal(size=3))
    return builder.scene()


def _pressed(members: int = 8) -> Trial:
    """Drive a ball of 0.1 to 10 g that hangs on a joint into a wall with a ball of 1 kg, e = 0.2 to 0.6: both stop there.

    Between wall and ball it is hit without end in a finite time, and restitution takes all energy (McNamara, Young, 1992).
    """
    random, scenes, radius = np.random.default_rng(2), [], 0.05
    for _ in range(members):
        builder = Builder(_WEIGHTLESS, friction=0.0, restitution=random.uniform(0.2, 0.6))
        speed, gap = 10.0 ** random.uniform(0.0, 1.0), random.uniform(0.005, 0.02)
        builder.box((0.2, 4.0, 4.0), position=(0.1, 0.0, 0.0), static=True)
        light = builder.sphere(radius, position=(-radius - gap, 0.0, 0.0), mass=10.0 ** random.uniform(-4, -2))
        builder.sphere(radius, position=(-4 * radius - gap, 0.0, 0.0), mass=1.0, velocity=(speed, 0.0, 0.0))
        builder.join("ball", GROUND, light, (-radius - gap, 0.0, 5.0))
        scenes.append(builder.scene())

    def left(scene: Scene, watched: Watched) -> float:
        return float(np.linalg.norm(watched.motions[-1, 2, :3]) / watched.motions[0, 2, 0])

    criteria = (at_most("part of its speed left", "", left, 0.1),)
    return Trial(f"{members} balls that press a light one on a joint to a wall", tuple(scenes), 0.3, criteria, looks=18)


TRIALS = (
    *(_door(e) for e in (1.0, 0.5)),
    *(_rod(e) for e in (1.0, 0.5)),
    _cradle(),
    *(_rotor(rate, off) for rate, off in ((10, 0.0), (100, 0.0), (300, 0.0), (10, 0.5), (50, 0.5), (100, 0.5))),
    _rotors_drawn(),
    _hub(20.0),
    _hanging_hub(),
    _thrown(),
    _rows(12, each=150, quick=False),
    _rows(6, 13, each=26, quick=True),
    _pressed(),
)

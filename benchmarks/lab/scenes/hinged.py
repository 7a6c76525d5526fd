"""Impacts on bodies that hang on hinges, against the theory of rigid impact; and what turns on hinges for a while."""

import numpy as np

from benchmarks.lab.building import GRAVITY, GROUND, Builder
from benchmarks.lab.measures import apart, comes_to, keeps
from benchmarks.lab.trial import Criterion, Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched

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


TRIALS = (
    *(_door(e) for e in (1.0, 0.5)),
    *(_rod(e) for e in (1.0, 0.5)),
    _cradle(),
    *(_rotor(rate, off) for rate, off in ((10, 0.0), (100, 0.0), (300, 0.0), (10, 0.5), (50, 0.5), (100, 0.5))),
    _rotors_drawn(),
    _hub(20.0),
    _hanging_hub(),
)

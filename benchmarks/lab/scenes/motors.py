"""Motors, brakes and grippers: none does more than its maximum allows, also where contacts carry the load."""

import numpy as np

from benchmarks.lab.building import GRAVITY, GROUND, Builder
from benchmarks.lab.measures import at_most, comes_to, sinks, stays
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Scene
from benchmarks.world.judge import Watched

_ALONG, _ACROSS = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def _pusher() -> Trial:
    """Push a box of 50 kg with 3 kg, 1 m/s and at most 500 N: F / m until it has its speed."""
    builder, force = Builder(friction=0.0), 500.0
    builder.plane()
    pusher = builder.box((0.2, 0.5, 0.5), position=(-0.1, 0.0, 0.3), mass=3.0)
    box = builder.box((1.0, 1.0, 1.0), position=(0.5, 0.0, 0.5), mass=50.0)
    builder.join("slider", GROUND, pusher, (-0.1, 0.0, 0.3), _ALONG, motor=(1.0, force))
    early = 0.05

    def after(scene: Scene, watched: Watched) -> float:
        return float(np.interp(early, watched.times, watched.motions[:, box, 0]))

    def fastest(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[:, box, 0].max())

    criteria = (
        comes_to("v after 0.05 s", "m/s", after, force * early / 53.0),
        at_most("fastest", "m/s", fastest, 1.01),
    )
    return Trial("pusher of 500 N at 50 kg", (builder.scene(),), 1.0, criteria, looks=60)


def _striking_pusher() -> Trial:
    """Let the pusher strike the box: in 0.05 s it gives what the motor does, and what it brings itself."""
    builder, force, mass, speed = Builder(friction=0.0), 500.0, 3.0, 1.0
    builder.plane()
    pusher = builder.box((0.2, 0.5, 0.5), position=(-0.5, 0.0, 0.3), mass=mass)
    box = builder.box((1.0, 1.0, 1.0), position=(0.5, 0.0, 0.5), mass=50.0)
    builder.join("slider", GROUND, pusher, (-0.5, 0.0, 0.3), _ALONG, motor=(speed, force))

    def gained(scene: Scene, watched: Watched) -> float:
        return float(np.diff(watched.motions[:, box, 0]).max())

    most = 1.01 * (force * 0.05 + mass * speed) / 53.0
    criteria = (at_most("most gained in 0.05 s", "m/s", gained, most),)
    return Trial("pusher strikes 50 kg with 500 N", (builder.scene(),), 1.0, criteria, looks=20)


def _lift() -> Trial:
    """Lift 2 kg with 20 kg on it by 1.1 times their weight: they rise with 0.1 g."""
    builder = Builder()
    force = 1.1 * 22.0 * GRAVITY
    lift = builder.box((1.0, 1.0, 0.2), position=(0.0, 0.0, 1.0), mass=2.0)
    load = builder.box((0.5, 0.5, 0.5), position=(0.0, 0.0, 1.35), mass=20.0)
    builder.join("slider", GROUND, lift, (0.0, 0.0, 1.0), (0.0, 0.0, 1.0), motor=(2.0, force))

    def speed(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[-1, load, 2])

    return Trial("lift with 1.1 times its load", (builder.scene(),), 1.0, (comes_to("v", "m/s", speed, 0.1 * GRAVITY),))


def _cart(share: float, angle: float = 0.26) -> Trial:
    """Put a cart with balls as wheels on a slope, braked with a share of what holds it."""
    builder = Builder(GRAVITY * np.array([np.sin(angle), 0.0, -np.cos(angle)]), friction=1.0)
    builder.plane()
    radius, whole = 0.2, 14.0
    torque = share * whole * GRAVITY * np.sin(angle) * radius / 4
    body = builder.box((1.2, 0.4, 0.2), position=(0.0, 0.0, 0.3), mass=10.0)
    for x in (-0.5, 0.5):
        for y in (-0.45, 0.45):
            wheel = builder.sphere(radius, position=(x, y, radius), mass=1.0)
            builder.join("hinge", body, wheel, (x, y, radius), _ACROSS, friction=torque)
    if share > 1:
        return Trial(f"cart braked at {share:.0%}", (builder.scene(),), 3.0, (stays(0.05),))
    rate = (1 - share) * whole * GRAVITY * np.sin(angle) / (whole + 4 * 0.4)

    def speed(scene: Scene, watched: Watched) -> float:
        return float(watched.motions[-1, body, 0])

    criteria = (comes_to("v", "m/s", speed, 3.0 * rate),)
    return Trial(f"cart braked at {share:.0%}", (builder.scene(),), 3.0, criteria)


def _gripper(share: float, force: float = 40.0, mu: float = 0.5) -> Trial:
    """Grip a box with two fingers of at most 40 N; its weight is a share of what friction holds."""
    builder = Builder(friction=mu)
    mass = share * 2 * mu * force / GRAVITY
    box = builder.box((0.1, 0.1, 0.1), mass=mass)
    for side in (-1.0, 1.0):
        finger = builder.box((0.02, 0.08, 0.08), position=(0.06 * side, 0.0, 0.0), mass=0.5)
        builder.join("slider", GROUND, finger, (0.06 * side, 0.0, 0.0), (-side, 0.0, 0.0), motor=(0.1, force))
    name = f"gripper, weight {share:.0%} of what friction holds"
    if share < 1:
        return Trial(name, (builder.scene(),), 3.0, (sinks(0.02),))

    def rate(scene: Scene, watched: Watched) -> float:
        late = watched.times > 0.11  # when all have closed the fingers
        return float(-np.polyfit(watched.times[late], watched.motions[late, box, 2], 1)[0])

    exact = GRAVITY - 2 * mu * force / mass
    return Trial(name, (builder.scene(),), 0.3, (comes_to("rate", "m/s^2", rate, exact, 0.05),), looks=18)


TRIALS = (_pusher(), _striking_pusher(), _lift(), _cart(0.8), _cart(1.2), _gripper(0.8), _gripper(1.1))

"""Robots whose joints are held by springs and dampers: a quadruped, an arm, and a two-link arm without any."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from kickdrift.core.vectors import Vector
from kickdrift.scenes.worlds.placing import between
from kickdrift.world.bodies.handle import Body
from kickdrift.world.joints.handle import Joint
from kickdrift.world.joints.limits_motors_options import Drive
from kickdrift.world.world import World


class Robot(NamedTuple):
    """A robot: its bodies from the trunk or the base on, and its hinges."""

    world: World
    bodies: list[Body]
    hinges: list[Joint]


def quadruped(*, stiffness: float = 300.0, damping: float = 6.0, height: float = 0.0) -> Robot:
    """Let a robot of 33 kg stand on four legs, each of its twelve hinges held by a spring and a damper.

    Parameters
    ----------
    stiffness : float
        N m/rad, of a spring that is at rest in the pose at the start.
    damping : float
        N m s/rad.
    height : float
        Of the feet above the floor at the start, in m.

    Notes
    -----
    About as large and as heavy as the quadruped of SimBenchmark (leggedrobotics), which took steps of 5 ms.
    """
    world = World()
    world.add_plane(friction=0.8)
    link, foot, bent = 0.3, 0.03, 0.7
    hips = height + foot + 2 * link * math.cos(bent)
    trunk = world.add_box(size=(0.54, 0.2, 0.2), position=(0.0, 0.0, hips), mass=17.0, friction=0.8)
    bodies, hinges = [trunk], []
    for x in (0.27, -0.27):
        for side in (1.0, -1.0):
            hip = (x, 0.1 * side, hips)
            shoulder = (x, 0.2 * side, hips)
            knee = (x - link * math.sin(bent), 0.2 * side, hips - link * math.cos(bent))
            sole = (x, 0.2 * side, hips - 2 * link * math.cos(bent))
            parts = (
                (hip, shoulder, 0.06, 1.5, (1.0, 0.0, 0.0)),
                (shoulder, knee, 0.04, 2.0, (0.0, 1.0, 0.0)),
                (knee, sole, foot, 0.6, (0.0, 1.0, 0.0)),
            )
            before = trunk
            for start, end, radius, mass, axis in parts:
                body = _limb(world, start, end, radius, mass)
                hinges.append(world.add_hinge(before, body, anchor=start, axis=axis, drive=Drive(stiffness, damping)))
                bodies.append(body)
                before = body
    return Robot(world, bodies, hinges)


# Height of each hinge, its axis, the mass and the radius of what it turns, the stiffness of its spring.
_ARM = (
    (0.16, "z", 4.0, 0.06, 800.0),
    (0.34, "y", 4.0, 0.06, 800.0),
    (0.54, "z", 3.0, 0.05, 600.0),
    (0.74, "y", 2.7, 0.05, 600.0),
    (0.94, "z", 1.7, 0.05, 200.0),
    (1.14, "y", 1.8, 0.04, 100.0),
    (1.26, "z", 0.3, 0.03, 50.0),
)
_TIP = 1.36


def arm(*, targets: Sequence[float] = (0.0, 0.6, 0.0, 1.2, 0.0, 0.8, 0.0), damping: float = 0.1) -> Robot:
    """Bend a robot arm of seven hinges, which begins upright, by springs and dampers.

    Parameters
    ----------
    targets : sequence of float
        Angles at which the springs are at rest, in rad.
    damping : float
        Of a hinge, divided by the stiffness of its spring, in s.
    """
    world = World()
    axes: dict[str, Vector] = {"y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    bodies: list[Body] = []
    hinges = []
    ends = [*(height for height, *_ in _ARM[1:]), _TIP]
    for (height, axis, mass, radius, stiffness), end, target in zip(_ARM, ends, targets, strict=True):
        body = _limb(world, (0.0, 0.0, height), (0.0, 0.0, end), radius, mass)
        parent = bodies[-1] if bodies else world.ground
        drive = Drive(stiffness, damping * stiffness, target=target)
        hinge = world.add_hinge(parent, body, anchor=(0.0, 0.0, height), axis=axes[axis], drive=drive)
        bodies.append(body)
        hinges.append(hinge)
    return Robot(world, bodies, hinges)


def two_link_arm(*, length: float = 1.0, mass: float = 1.0, angles: tuple[float, float] = (math.pi / 2, 0.0)) -> Robot:
    """Let two rods swing in a plane without friction, the second from the end of the first.

    Parameters
    ----------
    length, mass : float
        Of each rod, in m and kg.
    angles : (float, float)
        Of the first rod from straight down, and of the second from the first, at the start, in rad.
    """
    world = World()
    bodies: list[Body] = []
    hinges = []
    start, angle = (0.0, 0.0, 0.0), 0.0
    for bend in angles:
        angle += bend
        end = (start[0] + length * math.sin(angle), 0.0, start[2] - length * math.cos(angle))
        body = _limb(world, start, end, 0.05 * length, mass)
        parent = bodies[-1] if bodies else world.ground
        hinges.append(world.add_hinge(parent, body, anchor=start, axis=(0.0, 1.0, 0.0)))
        bodies.append(body)
        start = end
    return Robot(world, bodies, hinges)


def _limb(world: World, start: Vector, end: Vector, radius: float, mass: float) -> Body:
    limb = between(start, end)
    length = limb.length
    return world.add_capsule(
        radius=radius, length=length, position=limb.position, orientation=limb.orientation, mass=mass, friction=0.8
    )

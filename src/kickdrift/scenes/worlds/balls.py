"""Balls that bounce: Newton's cradle and the bouncing disk."""

import math
from typing import NamedTuple

from kickdrift.world.bodies.handle import Body
from kickdrift.world.world import World


class Cradle(NamedTuple):
    """Newton's cradle and its balls, from the raised one on."""

    world: World
    balls: list[Body]


def newtons_cradle(
    *,
    count: int = 5,
    raised: int = 1,
    radius: float = 0.05,
    string: float = 1.0,
    angle: float = math.pi / 4,
    gap: float = 0.0,
    restitution: float = 1.0,
) -> Cradle:
    """Hang balls side by side on strings, some of them raised.

    Parameters
    ----------
    count, raised : int
        Balls, and how many of them are raised.
    radius : float
        m.
    string : float
        Length from the beam to a ball's centre, in m.
    angle : float
        By which they are raised, in rad; by default 45 degrees.
    gap : float
        Between balls, in m.
    restitution : float
        Of the balls, which have no friction.
    """
    world = World()
    pitch = 2 * radius + gap
    balls = []
    for number in range(count):
        top = ((number - (count - 1) / 2) * pitch, 0.0, 0.0)
        turned = angle if number < raised else 0.0
        position = (top[0] - string * math.sin(turned), 0.0, -string * math.cos(turned))
        ball = world.add_sphere(radius=radius, position=position, density=7800.0, friction=0.0, restitution=restitution)
        world.add_distance_joint(world.ground, ball, anchor_a=top, anchor_b=position)
        balls.append(ball)
    return Cradle(world, balls)


def bouncing_disk(*, radius: float = 0.1, speed: float = 5.0, restitution: float = 0.9) -> World:
    """Throw a ball up from the floor: it bounces, lower each time, as a disk does in two dimensions.

    Parameters
    ----------
    radius : float
        m.
    speed : float
        Upwards at the start, in m/s.
    restitution : float
        Of the ball and the floor: peaks fall by its square.
    """
    world = World()
    world.add_plane(restitution=restitution)
    world.add_sphere(
        radius=radius, position=(0.0, 0.0, radius), velocity=(0.0, 0.0, speed), density=1000.0, restitution=restitution
    )
    return world

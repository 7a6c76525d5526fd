"""Joints by the dozen: a chain with a heavy end, and a grid of joints."""

import math
from typing import NamedTuple

from kickdrift.scenes.worlds.placing import between
from kickdrift.world.bodies.handle import Body
from kickdrift.world.world import World


class Chain(NamedTuple):
    """A chain: its links from the top, the last of which is the load."""

    world: World
    links: list[Body]


def chain(
    *, links: int = 20, length: float = 0.5, ratio: float = 1000.0, angle: float = math.pi / 2, radius: float = 0.05
) -> Chain:
    """Hang a chain of rods with a heavy ball at its end from the origin, and let it swing; nothing in it collides.

    Parameters
    ----------
    links : int
        Rods, each of 1 kg.
    length : float
        Of a rod, in m.
    ratio : float
        Mass of the ball divided by that of a rod.
    angle : float
        Between the straight chain and the vertical at the start, in rad; by default horizontal.
    radius : float
        Of the rods, in m; that of the ball follows from the same density.
    """
    world = World()
    along = (math.sin(angle), 0.0, -math.cos(angle))

    def place(distance: float) -> tuple[float, float, float]:
        return (along[0] * distance, 0.0, along[2] * distance)

    ball_radius = radius * ratio ** (1 / 3)
    bodies: list[Body] = []
    for number in range(links):
        start = place(number * length)
        rod = between(start, place((number + 1) * length))
        body = world.add_capsule(
            radius=radius, length=length - 2 * radius, position=rod.position, orientation=rod.orientation, mass=1.0,
            collides_with=(),
        )  # fmt: skip
        world.add_ball_joint(bodies[-1] if bodies else world.ground, body, anchor=start)
        bodies.append(body)
    end = links * length
    ball = world.add_sphere(radius=ball_radius, position=place(end + ball_radius), mass=ratio, collides_with=())
    world.add_ball_joint(bodies[-1], ball, anchor=place(end))
    return Chain(world, [*bodies, ball])


def joint_grid(*, size: int = 30, radius: float = 0.4, spacing: float = 1.0, density: float = 1000.0) -> World:
    """Hang a square grid of balls, each joined to its four neighbours, from its first row.

    Parameters
    ----------
    size : int
        Balls along each side.
    radius : float
        In m; balls do not collide.
    spacing : float
        From centre to centre, in m.
    density : float
        kg/m^3.

    Notes
    -----
    The joint grid of Box3D, `shared/benchmarks.c`, is 100 balls wide. It hangs straight down there; here it begins
    horizontal, so that it swings.
    """
    world = World()
    grid: dict[tuple[int, int], Body] = {}
    for row in range(size):
        for column in range(size):
            x, y = row * spacing, column * spacing
            ball = world.add_sphere(
                radius=radius, position=(x, y, 0.0), density=density, static=row == 0, layer=1, collides_with=()
            )
            grid[row, column] = ball
            if row > 0:
                world.add_ball_joint(grid[row - 1, column], ball, anchor=(x - spacing / 2, y, 0.0))
            if row > 0 and column > 0:
                world.add_ball_joint(grid[row, column - 1], ball, anchor=(x, y - spacing / 2, 0.0))
    return world

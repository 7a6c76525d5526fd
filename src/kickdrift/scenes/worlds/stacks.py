"""Boxes on boxes: pyramids, piles and dominoes."""

from math import cos, sin

from kickdrift.core.rotations import about
from kickdrift.scenes.worlds.placing import scatter
from kickdrift.world.world import World


def pyramid(*, base: int = 10, size: float = 1.0, density: float = 100.0, friction: float = 0.6) -> World:
    """Stack a vertical pyramid of cubes, which touch their neighbours on all sides.

    Parameters
    ----------
    base : int
        Cubes in the lowest row: 10, 20 and 100 make 55, 210 and 5050 of them.
    size : float
        Edge, in m.
    density : float
        kg/m^3.
    friction : float
        Coefficient, of the cubes and of the floor.

    Notes
    -----
    The large pyramid of Box3D, `shared/benchmarks.c`, has a base of 100.
    """
    world = World()
    world.add_plane(friction=friction)
    for row in range(base):
        for place in range(base - row):
            x = (place - (base - row - 1) / 2) * size
            edges = (size, size, size)
            world.add_box(size=edges, position=(x, 0.0, (row + 0.5) * size), density=density, friction=friction)
    return world


def pile(
    *,
    count: tuple[int, int, int] = (10, 10, 10),
    size: float = 1.0,
    spacing: float = 1.5,
    density: float = 100.0,
    friction: float = 0.6,
    turn: float = 0.4,
) -> World:
    """Let cubes fall that hang in a loose grid, each turned and a little beside its place.

    Parameters
    ----------
    count : (int, int, int)
        Cubes along x, y and z.
    size : float
        Edge, in m.
    spacing : float
        From centre to centre, in edges; above 1.5 they do not touch at the start.
    density : float
        kg/m^3.
    friction : float
        Coefficient, of the cubes and of the floor.
    turn : float
        By which they differ, in rad. Those that are turned little stand on each other; above 1, spacings of 1.8 keep them
        apart at the start.
    """
    world = World()
    world.add_plane(friction=friction)
    pitch = spacing * size
    number = 0
    for layer in range(count[2]):
        for row in range(count[1]):
            for place in range(count[0]):
                number += 1
                aside = [0.2 * size * scatter(3 * number + axis) for axis in range(2)]
                position = (
                    (place - (count[0] - 1) / 2) * pitch + aside[0],
                    (row - (count[1] - 1) / 2) * pitch + aside[1],
                    (layer + 0.5) * pitch,
                )
                turned = about((0.6, 0.0, 0.8), turn * scatter(3 * number + 2))
                edges = (size, size, size)
                world.add_box(size=edges, position=position, orientation=turned, density=density, friction=friction)
    return world


def dominoes(
    *,
    count: int = 30,
    size: tuple[float, float, float] = (0.032, 0.12, 0.36),
    spacing: float = 0.12,
    tilt: float = 0.22,
    density: float = 580.0,
    friction: float = 0.5,
) -> World:
    """Stand dominoes in a row, the first of which already falls.

    Parameters
    ----------
    count : int
        Dominoes.
    size : (float, float, float)
        Thickness, width and height, in m.
    spacing : float
        From centre to centre, in m.
    tilt : float
        Of the first, in rad; at 0.24 it leans on the second.
    density : float
        kg/m^3: of wood.
    friction : float
        Coefficient, of the dominoes and of the floor.

    Notes
    -----
    Sizes and density are those of the domino example of Newton (newton-physics/newton).
    """
    world = World()
    world.add_plane(friction=friction)
    for number in range(count):
        angle = tilt if number == 0 else 0.0
        turn = about((0.0, 1.0, 0.0), angle)
        position = _on_its_edge(size, angle, number * spacing)
        world.add_box(size=size, position=position, orientation=turn, density=density, friction=friction)
    return world


def _on_its_edge(size: tuple[float, float, float], tilt: float, x: float) -> tuple[float, float, float]:
    """Centre of a box that stands at x and leans about its lower front edge."""
    half, height = size[0] / 2, size[2] / 2
    edge = x + half
    return (edge - half * cos(tilt) + height * sin(tilt), 0.0, half * sin(tilt) + height * cos(tilt))

"""Soft bodies: cubes of jelly that fall into a heap."""

from kickdrift.world.world import World


def jelly(*, cells: int = 5, side: float = 0.4) -> World:
    """Let cubes of jelly and a box fall onto each other.

    Parameters
    ----------
    cells : int
        Along each side of a cube.
    side : float
        Of the largest cube, m.
    """
    world = World()
    world.add_plane()
    places = ((0.0, 0.0, 0.4, 1.0), (0.08, 0.05, 1.0, 0.8), (-0.06, -0.03, 1.5, 0.6))
    for k, (x, y, z, size) in enumerate(places):  # so soft that they would fold into themselves
        world.add_soft_box(
            (size * side, size * side, size * side), (cells, cells, cells), position=(x, y, z),
            orientation=(1.0, 0.25 * k, 0.15 * k, 0.2), density=1000.0, young_modulus=1.5e4, poisson_ratio=0.4, damping=5e-4,
            linear_damping=0.2, friction=0.7, self_collision=True,
        )  # fmt: skip
    world.add_box(
        (0.2, 0.2, 0.2), position=(0.02, 0.0, 2.2), orientation=(1.0, 0.2, 0.3, 0.1), density=400.0, friction=0.7
    )
    return world

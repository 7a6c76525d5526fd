"""The appearance of a world: shapes, joints and cloths, for drawing."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables.layout import CLOTH_RADIUS, CORNERS, DIMENSION, FIRST_PARTICLE, ROPE
from kickdrift.world.deformables.registry import Cloths
from kickdrift.world.deformables.rope_surface import tube
from kickdrift.world.deformables.substep_choice import WORDS
from kickdrift.world.joints import layout
from kickdrift.world.layout import BODY_KIND, BODY_ROW, DYNAMIC
from kickdrift.world.shapes.record import Shape
from kickdrift.world.tables import BODY, CLOTH, CLOTH_NUMBERS, FACE, JOINT, JOINT_NUMBERS, SHAPE

if TYPE_CHECKING:
    from kickdrift.world.world import World

Floats = NDArray[np.float64]


class DrawnShape(NamedTuple):
    """A shape of a body: the row of the body, the shape, and its pose in the body."""

    body: int
    shape: Shape
    position: Floats
    orientation: Floats


class Rod(NamedTuple):
    """A joint as drawn: a line from a point of one body to a point of another, each in its body's axes."""

    body_a: int
    point_a: Floats
    body_b: int
    point_b: Floats


class DrawnCloth(NamedTuple):
    """A cloth, a rope or the surface of a soft body.

    Attributes
    ----------
    name : str or None
    first, last : int
        Its range of vertices among those of all; `last` is one after the last one.
    triangles : (M, 3) array
        Indices of its own vertices.
    radius : float
        Of a rope, m; otherwise zero.
    kind : str
        "cloth", "rope" or "soft body".
    """

    name: str | None
    first: int
    last: int
    triangles: NDArray[np.int64]
    radius: float = 0.0
    kind: str = "cloth"

    def surface(self, vertices: Floats) -> tuple[Floats, NDArray[np.int64]]:
        """Return the vertices and triangles that are seen where its vertices are at these places, (N, 3), m."""
        return tube(vertices, self.radius) if self.radius > 0.0 else (vertices, self.triangles)


class Appearance(NamedTuple):
    """The appearance of a world, independent of the poses of its bodies.

    Attributes
    ----------
    kinds : (N,) array of int
        Kinds of the bodies, as in `kickdrift.world.layout`: removed, static, kinematic or dynamic.
    parts : tuple of DrawnShape
    rods : tuple of Rod
    names : mapping of int to str
        Names of bodies, by row.
    cloths : tuple of DrawnCloth
    """

    kinds: NDArray[np.int64]
    parts: tuple[DrawnShape, ...]
    rods: tuple[Rod, ...]
    names: Mapping[int, str]
    cloths: tuple[DrawnCloth, ...] = ()


def appearance(world: "World") -> Appearance:
    """Return the shapes, joints and cloths of a world, for drawing."""
    rows = world.tables.array(SHAPE)
    parts = tuple(
        DrawnShape(int(rows[row, BODY_ROW]), placed.shape, placed.position, placed.orientation)
        for row, placed in sorted(world.shape_rows.shapes.items())
    )
    kinds = world.tables.array(BODY)[:, BODY_KIND].copy()
    return Appearance(
        kinds, parts, tuple(_rods(world, kinds)), world.bodies.names.all(), tuple(drawn_cloths(world.cloths))
    )


def drawn_cloths(cloths: Cloths) -> list[DrawnCloth]:
    """Return the appearance of the cloths, ropes and soft bodies of a world."""
    tables, names = cloths.tables, cloths.names
    own, faces = tables.array(CLOTH), tables.array(FACE)
    drawn, radii = [], tables.array(CLOTH_NUMBERS)[:, CLOTH_RADIUS].tolist()
    for row, (first, last, begin, end) in enumerate(own[:, FIRST_PARTICLE : FIRST_PARTICLE + 4].tolist()):
        dimension = int(own[row, DIMENSION])
        triangles, radius = faces[begin:end, CORNERS : CORNERS + 3] - first, radii[row] if dimension == ROPE else 0.0
        drawn.append(DrawnCloth(names.of(row), first, last, triangles, radius, WORDS[dimension]))
    return drawn


def _rods(world: "World", kinds: NDArray[np.int64]) -> list[Rod]:
    """Return lines from the centres of dynamic bodies to their joints, and between the ends of joints with a length."""
    rods: list[Rod] = []
    for joint, numbers in zip(world.tables.array(JOINT), world.tables.array(JOINT_NUMBERS), strict=True):
        if joint[layout.JOINT_KIND] == layout.REMOVED_JOINT:
            continue
        a, b = int(joint[layout.BODY_A]), int(joint[layout.BODY_B])
        on_a = numbers[layout.ANCHOR_A : layout.ANCHOR_A + 3].copy()
        on_b = numbers[layout.ANCHOR_B : layout.ANCHOR_B + 3].copy()
        ends = [(body, end) for body, end in ((a, on_a), (b, on_b)) if kinds[body] == DYNAMIC and end.any()]
        rods += [Rod(body, np.zeros(3), body, end) for body, end in ends]
        if joint[layout.LINEAR] == layout.LINE:
            rods.append(Rod(a, on_a, b, on_b))
    return rods

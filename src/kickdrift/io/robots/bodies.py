"""Bodies: what moves as one, with its mass and shapes."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.io.robots.geoms import Layers, is_shown, placed, touches
from kickdrift.io.robots.parsing import Model
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.shape_rows import Placed
from kickdrift.world.layout import BOUNDING_RADIUS, DYNAMIC, KINEMATIC, STATIC
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mass_properties import Mass, summed
from kickdrift.world.tables import RESTED
from kickdrift.world.world import World

Floats = NDArray[np.float64]

_SAME = 1e-9  # m, or of a quaternion


@dataclass
class Piece:
    """A body that is to be: MuJoCo's bodies that are fixed to each other.

    Attributes
    ----------
    members : list of int
        MuJoCo's bodies; the axes are those of the first.
    kind : int
        Whether forces move it.
    mass : Mass or None
        In the axes of the first member and from its origin.
    shapes : list of Placed
        In the same axes.
    shown : list of Placed
        What is only drawn, likewise.
    damping : float
        Rate at which its velocity decays, 1/s.
    """

    members: list[int]
    kind: int
    mass: Mass | None = None
    shapes: list[Placed] = field(default_factory=list)
    shown: list[Placed] = field(default_factory=list)
    damping: float = 0.0

    @property
    def centre(self) -> Floats:
        """Centre of mass in the axes and from the origin of the first member, m."""
        return np.zeros(3) if self.mass is None else self.mass.centre


def pieces(model: Model, layers: Layers, notes: list[str]) -> list[Piece]:
    """Collect what moves as one; what is fixed to the world stays apart."""
    m = model.compiled
    together: dict[int, list[int]] = {}
    for body in range(m.nbody):
        head = int(m.body_weldid[body]) or body
        together.setdefault(head, []).append(body)
    made = []
    for head, members in together.items():
        kind = STATIC if m.body_weldid[head] == 0 else KINEMATIC if m.body_mocapid[head] >= 0 else DYNAMIC
        piece = Piece(members, kind)
        try:
            if kind == DYNAMIC:
                piece.mass = summed([_mass(model, body, head) for body in members])
            for body in members:
                geoms = range(m.body_geomadr[body], m.body_geomadr[body] + m.body_geomnum[body])
                piece.shapes += [placed(model, g, head, layers, notes) for g in geoms if touches(model, g)]
        except ArgumentError as error:
            raise ArgumentError(f"body {model.name('body', head)!r}: {error}") from None
        piece.shown = _shown(model, piece, layers, notes)
        made.append(piece)
    return made


def _shown(model: Model, piece: Piece, layers: Layers, notes: list[str]) -> list[Placed]:
    """Make what is only drawn of a piece: what would be drawn twice, and what no shape is, is left out."""
    m, found = model.compiled, []
    for body in piece.members:
        geoms = range(m.body_geomadr[body], m.body_geomadr[body] + m.body_geomnum[body])
        for geom in (geom for geom in geoms if is_shown(model, geom)):
            try:
                made = placed(model, geom, piece.members[0], layers, [])
            except ArgumentError as error:
                notes.append(f"visual geom {model.name('geom', geom)!r} is not drawn: {error}")
                continue
            if not any(_same(made, other) for other in piece.shapes):
                found.append(made._replace(surface=piece.shapes[0].surface) if piece.shapes else made)
    return found


def _same(a: Placed, b: Placed) -> bool:
    same = a.shape is b.shape  # of hulls, which are one for each mesh
    if not same and a.shape.kind == b.shape.kind and not isinstance(a.shape, Hull):
        same = np.array_equal(a.shape.numbers, b.shape.numbers)
    return same and np.allclose([*a.position, *a.orientation], [*b.position, *b.orientation], 0.0, _SAME)


def _mass(model: Model, body: int, head: int) -> Mass:
    """Return the mass properties of one of MuJoCo's bodies in the frame of another one that it is fixed to."""
    m, d = model.compiled, model.data
    if body == head:
        centre, turn = np.array(m.body_ipos[body]), m.body_iquat[body]
    else:
        centre, turn = model.seen_from(head, d.xipos[body], model.product(d.xquat[body], m.body_iquat[body]))
    axes = model.matrix(turn)
    return Mass(float(m.body_mass[body]), centre, axes @ np.diag(m.body_inertia[body]) @ axes.T)


def add_piece(world: World, model: Model, piece: Piece) -> Body:
    """Add a body to a world, with the mass that the file gives it rather than that of its shapes."""
    d, head = model.data, piece.members[0]
    centre = d.xpos[head] + model.matrix(d.xquat[head]) @ piece.centre
    body = world.bodies.add(piece.kind, model.point(centre), model.turn(d.xquat[head]))
    if piece.mass is not None:
        world.bodies.set_mass(body.index, Mass(piece.mass.mass, np.zeros(3), piece.mass.inertia), (piece.damping, 0.0))
    for shape, position, orientation, surface in piece.shapes:
        arm = position - piece.centre
        rested = world.tables.array(RESTED)[body.index]
        rested[BOUNDING_RADIUS] = max(rested[BOUNDING_RADIUS], float(np.linalg.norm(arm)) + shape.reach)
        world.shape_rows.add(body.index, Placed(shape, arm, orientation, surface))
    for shape, position, orientation, surface in piece.shown:
        world.shape_rows.show(body.index, Placed(shape, position - piece.centre, orientation, surface))
    return body

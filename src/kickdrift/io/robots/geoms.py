"""Geoms as shapes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.io.robots.parsing import Model
from kickdrift.world.bodies.shape_rows import Placed, Surface
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.cylinder import Cylinder
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.plane import Plane
from kickdrift.world.shapes.polyhedron import MOST_VERTICES
from kickdrift.world.shapes.record import Shape
from kickdrift.world.shapes.sphere import Sphere

Floats = NDArray[np.float64]

_MERIDIANS, _CIRCLES = 12, 10  # of an ellipsoid's corners

_LAYERS = 62


def touches(model: Model, geom: int) -> bool:
    """Whether a geom touches anything; others are for show."""
    m = model.compiled
    return bool(m.geom_contype[geom] or m.geom_conaffinity[geom])


def is_shown(model: Model, geom: int) -> bool:
    """Whether a geom is only for show, in one of the groups that MuJoCo's viewer shows at first."""
    return not touches(model, geom) and int(model.compiled.geom_group[geom]) < 3


def shape_of(model: Model, geom: int, notes: list[str]) -> tuple[Shape, Floats]:
    """Make the shape of a geom.

    Returns
    -------
    Shape
    (3,) array
        Its origin in the geom's frame.

    Raises
    ------
    ArgumentError
        For geoms without a shape.
    """
    m, kinds = model.compiled, model.mujoco.mjtGeom
    kind, size = int(m.geom_type[geom]), m.geom_size[geom]
    middle, name = np.zeros(3), model.name("geom", geom)
    if kind == kinds.mjGEOM_PLANE:
        return Plane(), middle
    if kind == kinds.mjGEOM_SPHERE:
        return Sphere(float(size[0])), middle
    if kind == kinds.mjGEOM_CAPSULE:
        return Capsule(float(size[0]), 2.0 * float(size[1])), middle
    if kind == kinds.mjGEOM_BOX:
        return Box(2.0 * size), middle
    if kind == kinds.mjGEOM_CYLINDER:
        return Cylinder(float(size[0]), 2.0 * float(size[1])), middle
    if kind == kinds.mjGEOM_ELLIPSOID:
        notes.append(f"ellipsoid {name!r} collides as a polyhedron with its corners on the ellipsoid")
        return Hull(_ball() * size), middle
    if kind == kinds.mjGEOM_MESH:
        return _hull(model, geom, notes), middle
    if kind == kinds.mjGEOM_HFIELD:
        return _terrain(m, int(m.geom_dataid[geom]))
    raise ArgumentError(
        f"geom {name!r} is of a type without a shape; give a sphere, capsule, box, cylinder, ellipsoid, mesh, plane or"
        " height field, or contype=0 conaffinity=0."
    )


def _ball() -> Floats:
    """Points of a unit sphere."""
    latitude, longitude = np.meshgrid(
        (np.arange(1, _CIRCLES) / _CIRCLES - 0.5) * np.pi, np.arange(_MERIDIANS) * (2.0 * np.pi / _MERIDIANS)
    )
    circles = (np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude))
    return np.vstack((np.stack(circles, axis=-1).reshape(-1, 3), [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]))


def _hull(model: Model, geom: int, notes: list[str]) -> Hull:
    """Make the convex hull of a mesh, once of each."""
    m, name = model.compiled, model.name("geom", geom)
    mesh = int(m.geom_dataid[geom])
    first = int(m.mesh_vertadr[mesh])
    points = np.asarray(m.mesh_vert[first : first + int(m.mesh_vertnum[mesh])], dtype=np.float64)
    if mesh not in model.hulls:
        try:
            model.hulls[mesh] = _hull_of(points)
        except ArgumentError as error:
            raise ArgumentError(f"mesh {name!r}: {error}") from None
    hull, count = model.hulls[mesh]
    notes.append(
        f"mesh {name!r} collides as its convex hull" + (f" of {count} of its {len(points)} points" if count else "")
    )
    return hull


def _hull_of(points: Floats) -> tuple[Hull, int]:
    """Make a hull, and say of how many points it is where there are more than it can have; 0 if it is of all."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        corners = len(ConvexHull(points).vertices)
    except (QhullError, ValueError):
        corners = 0  # the hull says what is wrong with them
    if corners <= MOST_VERTICES:
        return Hull(points), 0
    chosen = _outermost(points)
    return Hull(chosen), len(chosen)


def _outermost(points: Floats) -> Floats:
    """Choose those points that lead in directions all around."""
    k = np.arange(MOST_VERTICES) + 0.5  # on a spiral around the sphere, equally dense everywhere
    z, angle = 1.0 - 2.0 * k / MOST_VERTICES, k * (np.pi * (3.0 - np.sqrt(5.0)))
    ways = np.column_stack((np.sqrt(1.0 - z * z) * np.cos(angle), np.sqrt(1.0 - z * z) * np.sin(angle), z))
    chosen: Floats = points[np.unique((points @ ways.T).argmax(axis=0))]
    return chosen


def _terrain(m: Any, field: int) -> tuple[Shape, Floats]:
    rows, columns, first = int(m.hfield_nrow[field]), int(m.hfield_ncol[field]), int(m.hfield_adr[field])
    rx, ry, top, _ = m.hfield_size[field]
    heights = np.asarray(m.hfield_data[first : first + rows * columns], dtype=np.float64).reshape(rows, columns)
    spacing = (2.0 * rx / (columns - 1), 2.0 * ry / (rows - 1))
    return HeightField(top * heights.T, spacing), np.array([-rx, -ry, 0.0])


class Layers:
    """Layers for the bit masks of geoms: one for each pair of contype and conaffinity.

    What else is in a world counts as contype 1 and conaffinity 1, MuJoCo's own default, and has any other layer.
    """

    def __init__(self, model: Model, used: int) -> None:
        m = model.compiled
        geoms = [geom for geom in range(m.ngeom) if touches(model, geom)]
        kinds = sorted({(int(m.geom_contype[geom]), int(m.geom_conaffinity[geom])) for geom in geoms} - {(1, 1)})
        free = [layer for layer in range(1, _LAYERS) if not used >> layer & 1]
        if len(kinds) > len(free):
            raise ArgumentError(
                f"path names a robot with {len(kinds)} pairs of contype and conaffinity, but the world has {len(free)}"
                " layers left; use fewer pairs."
            )
        self._layers = {(1, 1): 0, **dict(zip(kinds, free, strict=False))}

    def surface(self, model: Model, geom: int) -> Surface:
        """Return the properties of a geom's surface."""
        m = model.compiled
        slide, _, roll = m.geom_friction[geom].tolist()
        dimensions = int(m.geom_condim[geom])
        layer, meets = self._of(int(m.geom_contype[geom]), int(m.geom_conaffinity[geom]))
        return Surface(
            friction=slide if dimensions > 1 else 0.0,
            rolling_resistance=roll if dimensions == 6 else 0.0,
            layer=layer,
            collides_with=meets,
        )

    def _of(self, contype: int, conaffinity: int) -> tuple[int, tuple[int, ...] | None]:
        def meet(other: tuple[int, int]) -> bool:
            return bool(contype & other[1] or conaffinity & other[0])

        met = {layer for kind, layer in self._layers.items() if meet(kind)}
        if meet((1, 1)):
            met |= set(range(_LAYERS)) - set(self._layers.values())
        return self._layers[contype, conaffinity], None if len(met) == _LAYERS else tuple(sorted(met))


def placed(model: Model, geom: int, body: int, layers: Layers, notes: list[str]) -> Placed:
    """Make the shape of a geom, placed in the axes and at the origin of a body at the reference pose."""
    shape, origin = shape_of(model, geom, notes)
    frame = model.data.geom_xmat[geom].reshape(3, 3)
    turn = np.empty(4)
    model.mujoco.mju_mat2Quat(turn, model.data.geom_xmat[geom])
    where, turn = model.seen_from(body, model.data.geom_xpos[geom] + frame @ origin, turn)
    surface = layers.surface(model, geom) if touches(model, geom) else Surface(collides_with=())
    return Placed(shape, where, turn, surface)

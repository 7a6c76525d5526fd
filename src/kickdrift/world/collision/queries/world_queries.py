"""Spatial queries: ray casts and overlaps with boxes and balls, which do not change the state of the world.

They use the present poses of bodies. Sensors are not found. Meshes are surfaces: a shape inside a closed one overlaps nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.calls import address_of
from kickdrift.core.errors import KickdriftError
from kickdrift.world.collision.broad_phase.bvh_update import update_for_queries
from kickdrift.world.collision.broad_phase.fat_aabb import find_strays
from kickdrift.world.collision.narrow_phase.manifolds import COLLIDE
from kickdrift.world.collision.narrow_phase.pair_dispatch import PAIRS
from kickdrift.world.collision.queries.overlap_query import find_near, overlaps
from kickdrift.world.collision.queries.query_arguments import layer_bits, one_vector, rays_of
from kickdrift.world.collision.queries.ray_cast import DISTANCE, HIT, NORMAL, SHAPE_HIT, cast, cast_many
from kickdrift.world.collision.shape_properties import find_extents
from kickdrift.world.layout import BODY_ROW, IS_SENSOR, LAYER, SHAPE_KIND
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.kind_numbers import BOX, SPHERE
from kickdrift.world.shapes.mass_properties import rotation_matrix
from kickdrift.world.shapes.record import RAY
from kickdrift.world.shapes.shape_kinds import KINDS, RAYS, met_as
from kickdrift.world.shapes.sphere import Sphere
from kickdrift.world.step.status import FULL, take_request
from kickdrift.world.tables import MOVERS, PLANES, POSE, SHAPE, TRIANGLE_TREE, Tables

if TYPE_CHECKING:
    from kickdrift.world.bodies.handle import Body

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class RayHit(NamedTuple):
    """The first hit of a ray on a shape.

    Attributes
    ----------
    shape : int
        Row of the shape, which distinguishes the shapes of a compound body.
    body : Body
        The body of the shape.
    distance : float
        From the origin of the ray, m.
    point : (3,) array
        m.
    normal : (3,) array
        Outward unit normal of the shape, or of a triangle. A ray that starts inside a shape hits it where it leaves it.
    """

    shape: int
    body: Body
    distance: float
    point: Floats
    normal: Floats


class RayHits(NamedTuple):
    """The first hit of each of N rays.

    Attributes
    ----------
    shape, body : (N,) array of int
        Rows of the shapes and of their bodies; -1 for rays that hit nothing.
    distance : (N,) array
        m; infinity for rays that hit nothing.
    point, normal : (N, 3) array
        As in `RayHit`; NaN for rays that hit nothing.
    """

    shape: Integers
    body: Integers
    distance: Floats
    point: Floats
    normal: Floats


def ray_cast_all(
    tables: Tables,
    origin: ArrayLike,
    direction: ArrayLike,
    limit: float = np.inf,
    layers: Iterable[int] | None = None,
    ignored: Iterable[int] = (),
) -> RayHits:
    """Return the first hit of a ray on each shape along it, nearest first; arguments as in `ray_cast_many`."""
    rays = rays_of(one_vector("origin", origin), one_vector("direction", direction), limit)
    wanted = layer_bits(layers)
    strays = _strays(tables)
    hits = np.empty((2 * len(tables.array(SHAPE)) + 2, HIT))
    count = cast(tables.address, rays[0], _ray_functions(tables), strays, wanted, _rows(ignored), hits)
    _, first = np.unique(hits[:count, SHAPE_HIT], return_index=True)
    hits = hits[first]
    hits = hits[np.argsort(hits[:, DISTANCE], kind="stable")]
    return _described(tables, np.repeat(rays, len(hits), axis=0), hits)


def ray_cast_many(
    tables: Tables,
    origins: ArrayLike,
    directions: ArrayLike,
    limit: float = np.inf,
    layers: Iterable[int] | None = None,
    ignored: Iterable[int] = (),
) -> RayHits:
    """Return the nearest shape that each of many rays hits.

    Parameters
    ----------
    tables : Tables
        Of the world.
    origins : (N, 3) or (3,) array_like
        m; a single one is shared by all rays.
    directions : (N, 3) array_like
        Any lengths but zero.
    limit, layers
        As in `World.ray_cast`.
    ignored : iterable of int
        Rows of bodies that rays pass through.

    Raises
    ------
    ArgumentError
        As in `World.ray_cast`, or if the numbers of origins and directions differ.
    """
    rays = rays_of(origins, directions, limit)
    wanted = layer_bits(layers)
    strays = _strays(tables)
    hits = np.full((len(rays), HIT), np.nan)
    hits[:, SHAPE_HIT], hits[:, DISTANCE] = -1, np.inf
    cast_many(tables.address, rays, _ray_functions(tables), strays, wanted, _rows(ignored), hits)
    return _described(tables, rays, hits)


def overlap_box(
    tables: Tables,
    size: ArrayLike,
    position: ArrayLike = (0.0, 0.0, 0.0),
    orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
    layers: Iterable[int] | None = None,
    ignored: Iterable[int] = (),
) -> Integers:
    """Return the rows of the shapes that overlap a box, in ascending order.

    Parameters
    ----------
    tables : Tables
        Of the world.
    size : (3,) array_like
        Lengths of its edges, m.
    position : (3,) array_like
        Of its centre, m.
    orientation : (4,) array_like
        Quaternion (w, x, y, z) that turns its axes into the world's; any length but zero.
    layers : iterable of int, optional
        Layers whose shapes count, from 0 to 61; all by default.
    ignored : iterable of int
        Rows of bodies whose shapes do not count.

    Raises
    ------
    ArgumentError
        If the size is not positive, or the pose is not finite.
    """
    box = Box(size)
    half = np.abs(rotation_matrix(orientation)) @ box.numbers
    return _overlap(tables, BOX, box.numbers, position, orientation, half, layers, ignored)


def overlap_sphere(
    tables: Tables,
    radius: float,
    position: ArrayLike = (0.0, 0.0, 0.0),
    layers: Iterable[int] | None = None,
    ignored: Iterable[int] = (),
) -> Integers:
    """Return the rows of the shapes that overlap a ball with a radius in m; other arguments as in `overlap_box`."""
    ball = Sphere(radius)
    half = np.full(3, ball.radius)
    return _overlap(tables, SPHERE, ball.numbers, position, (1.0, 0.0, 0.0, 0.0), half, layers, ignored)


def _overlap(
    tables: Tables,
    kind: int,
    numbers: Floats,
    position: ArrayLike,
    orientation: ArrayLike,
    half: Floats,
    layers: Iterable[int] | None,
    ignored: Iterable[int],
) -> Integers:
    centre = one_vector("position", position)[0]
    turn = np.asarray(orientation, dtype=np.float64)
    turn = turn / np.sqrt(turn @ turn)
    wanted = layer_bits(layers)
    strays = _strays(tables)
    box = (*(centre - half).tolist(), *(centre + half).tolist())
    shapes = tables.array(SHAPE)
    found = np.empty(len(shapes) + len(tables.array(PLANES)) + 1)
    count = find_near(tables.address, box, found)
    candidates = np.union1d(found[:count].astype(np.int64), strays)
    candidates = candidates[(shapes[candidates, IS_SENSOR] == 0) & (shapes[candidates, LAYER] & wanted != 0)]
    candidates = candidates[~np.isin(shapes[candidates, BODY_ROW], _rows(ignored))]
    functions = _pair_functions(tables, kind)
    parts = np.empty(len(tables.array(TRIANGLE_TREE)) + 1)
    at, q = tuple(centre.tolist()), tuple(turn.tolist())
    touches = [
        overlaps(tables.address, int(shape), kind, numbers, at, q, box, functions, parts) for shape in candidates
    ]
    return np.asarray(candidates[np.array(touches, dtype=np.bool_)], dtype=np.int64)


def _strays(tables: Tables) -> Integers:
    """Update the trees to the present shapes, and return the rows of shapes that have left their fat bounds."""
    find_extents(tables, _kinds(tables))
    while not update_for_queries(tables.address):
        kind, table, wanted, body = take_request(tables)
        if kind != FULL:
            raise _nowhere(body)
        tables.make_room(table, wanted)
    strays = np.empty(len(tables.array(MOVERS)), dtype=np.int64)
    strays = strays[: find_strays(tables.address, strays)]
    bodies = tables.array(SHAPE)[strays, BODY_ROW]
    lost = bodies[~np.isfinite(tables.array(POSE)[bodies, :7]).all(axis=1)]
    if lost.size:
        raise _nowhere(int(lost[0]))
    return strays


def _nowhere(body: int) -> KickdriftError:
    return KickdriftError(f"Body {body} has a pose that is not finite, so queries cannot find it; move it.")


def _rows(bodies: Iterable[int]) -> Integers:
    return np.array(sorted(bodies), dtype=np.int64)


def _kinds(tables: Tables) -> list[int]:
    """Return the kinds of the present shapes."""
    kinds = np.unique(tables.array(SHAPE)[:, SHAPE_KIND])
    return [int(kind) for kind in kinds if kind >= 0]


def _ray_functions(tables: Tables) -> NDArray[np.intp]:
    functions = np.zeros(len(KINDS), dtype=np.intp)
    for kind in map(met_as, _kinds(tables)):
        functions[kind] = _ray_function(kind)
    return functions


@cache
def _ray_function(kind: int) -> int:
    return address_of(RAYS[kind], RAY)


def _pair_functions(tables: Tables, kind: int) -> NDArray[np.intp]:
    functions = np.zeros(len(KINDS), dtype=np.intp)
    for other in map(met_as, _kinds(tables)):
        functions[other] = _pair_function(min(kind, other), max(kind, other))
    return functions


@cache
def _pair_function(kind: int, other: int) -> int:
    return address_of(PAIRS[kind, other], COLLIDE)


def _described(tables: Tables, rays: Floats, hits: Floats) -> RayHits:
    shape = hits[:, SHAPE_HIT].astype(np.int64)
    met = shape >= 0
    body = np.full(len(hits), -1)
    body[met] = tables.array(SHAPE)[shape[met], BODY_ROW]
    point = np.full((len(hits), 3), np.nan)
    point[met] = rays[met, :3] + hits[met, DISTANCE, None] * rays[met, 3:6]
    return RayHits(shape, body, hits[:, DISTANCE].copy(), point, hits[:, NORMAL : NORMAL + 3].copy())

"""The contact of a ball with a shape: of particles of cloths, and of points of their triangles."""

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, conjugate, dot, minus, plus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.manifolds import collide
from kickdrift.world.columns import point_at
from kickdrift.world.contacts.layout import NORMAL, ON_A, ON_B, POINT
from kickdrift.world.deformables.body_contacts.contact_rows import Pose, Touch
from kickdrift.world.layout import BEGIN, SHAPE_KIND, SIZE
from kickdrift.world.shapes.kind_numbers import SPHERE, TRIANGLE
from kickdrift.world.shapes.triangle import TRIANGLE_SIZE, begin_of
from kickdrift.world.tables import COLLIDERS, GEOMETRY, MANIFOLD, SHAPE, flat, integers

_MANIFOLD = MANIFOLD.width
_NONE: Touch = ((0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0))


@compiled
def touch_of_ball(
    world: int, shape: int, triangle: int, start: Pose, p: Vector, radius: float, margin: float
) -> tuple[bool, Touch]:
    """Return whether a ball at p is within a margin of a shape in a pose, or of one of its triangles, and where.

    Returns
    -------
    bool
    Touch
        The normal from the shape, the gap and the point of the shape.
    """
    shapes, geometry = integers(world, SHAPE), flat(world, GEOMETRY)
    begin, size, kind = shapes[shape, BEGIN], shapes[shape, SIZE], shapes[shape, SHAPE_KIND]
    if triangle >= 0:
        begin, size, kind = begin_of(begin, triangle), TRIANGLE_SIZE, TRIANGLE
    ball, pose = carray(floats_on_stack(1), (1,)), carray(floats_on_stack(7), (7,))
    manifold = carray(floats_on_stack(_MANIFOLD), (_MANIFOLD,))
    ball[0] = radius
    at, q = start
    numbers, function = geometry[begin : begin + size], integers(world, COLLIDERS)
    is_first = kind <= SPHERE  # the shape is the first of the pair
    if is_first:
        pose[0], pose[1], pose[2] = turned_back(q, minus(p, at))
        pose[3], pose[4], pose[5], pose[6] = conjugate(q)
        count = collide(function[kind, SPHERE], (numbers, ball, pose, margin, manifold))
    else:
        pose[0], pose[1], pose[2] = minus(at, p)
        pose[3], pose[4], pose[5], pose[6] = q
        count = collide(function[SPHERE, kind], (ball, numbers, pose, margin, manifold))
    if count == 0:
        return False, _NONE
    normal, on_a, on_b = point_at(manifold, NORMAL), point_at(manifold, POINT + ON_A), point_at(manifold, POINT + ON_B)
    if is_first:
        normal = turned(q, normal)
        point, own_point = plus(at, turned(q, on_a)), minus(p, times(radius, normal))
    else:
        normal = times(-1.0, normal)
        point, own_point = plus(at, turned(q, on_b)), plus(p, on_a)
    return True, (normal, dot(normal, minus(own_point, point)), point)

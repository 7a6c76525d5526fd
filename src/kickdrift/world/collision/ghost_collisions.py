"""Ghost collisions: a body that slides over the seam between two shapes must not strike the side of the next one.

Where a body has sunk in by a micrometre, the side of the next shape separates them more than its top does, until the body is
above it. Such a contact is dropped if, moved on along their relative velocity, the shapes overlap by less than bodies at rest
do, and a body rests on something else along which it slides. Where a body with corners reaches the next shape within the step,
the points on top of it take the place of those at its side, and carry the body from there on.
"""

from numba import carray

from kickdrift.core.compilation import compiled
from kickdrift.core.memory import floats_on_stack
from kickdrift.core.vectors import Vector, dot, minus, plus, times, turned, turned_back
from kickdrift.world.collision.narrow_phase.manifold_points import put_no_load
from kickdrift.world.collision.narrow_phase.manifolds import deepest, find_manifold, write_points
from kickdrift.world.collision.shape_poses import placed_pose, relative_pose
from kickdrift.world.collision.shape_properties import half_width, is_round, sort_of
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    CONTACT_STATE,
    FOUND_POSE,
    JUST_FOUND,
    POINTS,
    REACHABLE,
    RECYCLED,
    SHAPE_A,
    SHAPE_B,
)
from kickdrift.world.layout import BODY_KIND, DYNAMIC, VELOCITY
from kickdrift.world.settings import MARGIN, SLOP, STEP
from kickdrift.world.shapes.record import SOLID
from kickdrift.world.tables import BODY, CONTACT, MANIFOLD, MOTION, SETTINGS, floats, integers, rows

_SIZE = MANIFOLD.width
_BEYOND = 2.0  # slops by which the shapes are moved on after they touch, but no farther than half of their thickness
_STEP_HEIGHT = 0.1  # of that: steps over which bodies slide
_SAME = 1.0 - 1e-4  # cosine between normals of the same surface


@compiled
def drop_ghosts(world: int, state: int) -> None:
    """Drop ghost collisions among the contacts that have this bit of `CONTACT_STATE`, whose points have just been found."""
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    for row in range(rows(world, CONTACT)):
        found = contact[row, CONTACT_STATE] & state and contact[row, POINTS] != 0
        if found and _may_have_seams(world, row) and _is_ghost(world, row):
            contact[row, POINTS], manifold[row, RECYCLED] = 0, 0.0
        contact[row, CONTACT_STATE] &= ~JUST_FOUND


@compiled(inline=True)
def _may_have_seams(world: int, row: int) -> bool:
    """Whether the shapes of a contact may lie beside each other as one floor: planes are whole, meshes know their edges."""
    a, b = integers(world, CONTACT)[row, SHAPE_A], integers(world, CONTACT)[row, SHAPE_B]
    return sort_of(world, a) == SOLID and not (is_round(world, a) and is_round(world, b))


@compiled
def _is_ghost(world: int, row: int) -> bool:
    """Whether to drop a contact as a ghost collision; its points may be replaced by those on top of the shape instead."""
    contact, settings = integers(world, CONTACT), floats(world, SETTINGS)
    manifold, motion = floats(world, MANIFOLD), floats(world, MOTION)
    thickness = min(half_width(world, contact[row, SHAPE_A]), half_width(world, contact[row, SHAPE_B]))
    beyond = min(_BEYOND * settings[0, SLOP], thickness)
    height = _STEP_HEIGHT * beyond
    at, turn = vector_at(manifold, row, FOUND_POSE), quaternion_at(manifold, row, FOUND_POSE + 3)
    _, turn_a = placed_pose(world, contact[row, SHAPE_A])
    gap, normal = deepest(manifold, row, contact[row, POINTS], at, turn)
    a, b = contact[row, BODY_A], contact[row, BODY_B]
    velocity = minus(vector_at(motion, b, VELOCITY), vector_at(motion, a, VELOCITY))
    way = turned_back(turn_a, velocity)
    closing = -dot(normal, way)
    if gap < -height or settings[0, STEP] * closing <= height:
        return False
    ahead = carray(floats_on_stack(_SIZE), (1, _SIZE))
    ahead[0, REACHABLE] = manifold[row, REACHABLE]
    put_no_load(ahead[0])
    then = plus(at, times((max(gap, 0.0) + beyond) / closing, way))
    count = write_points(world, row, then, turn, settings[0, MARGIN], ahead[0])
    if count > 0:
        depth, normal_then = deepest(ahead, 0, count, then, turn)
        if depth < -height or dot(normal, normal_then) > _SAME:
            return False
    if not (_slides(world, row, a, velocity, height) or _slides(world, row, b, velocity, height)):
        return False
    rolls = is_round(world, contact[row, SHAPE_A]) or is_round(world, contact[row, SHAPE_B])
    if count > 0 and not rolls and gap <= settings[0, STEP] * closing:
        find_manifold(world, row, then, turn, settings[0, MARGIN])
        for k in range(3):
            manifold[row, FOUND_POSE + k] = at[k]
        return False
    return True


@compiled
def _slides(world: int, row: int, body: int, velocity: Vector, height: float) -> bool:
    """Whether a body moves along what it rests on, other than by a contact: by less than `height` across it in a step."""
    contact, manifold, slides = integers(world, CONTACT), floats(world, MANIFOLD), False
    if integers(world, BODY)[body, BODY_KIND] != DYNAMIC:
        return False
    most = height / floats(world, SETTINGS)[0, STEP]
    for other in range(rows(world, CONTACT)):
        if other == row or contact[other, POINTS] == 0 or body not in (contact[other, BODY_A], contact[other, BODY_B]):
            continue
        a = placed_pose(world, contact[other, SHAPE_A])
        at, turn = relative_pose(a, placed_pose(world, contact[other, SHAPE_B]))
        gap, normal = deepest(manifold, other, contact[other, POINTS], at, turn)
        slides = slides or (abs(gap) < height and abs(dot(turned(a[1], normal), velocity)) < most)
    return slides

"""Bodies that turn too far in a substep to touch others: the step is done in parts.

Contacts know one rotation of a body in a substep, about one axis. Where a free body turns by a radian while its axis changes,
there may be none that conserves its energy: see `kickdrift.world.free_rotation`. The axis of tops hardly changes.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import applied, cross, dot
from kickdrift.world.collision.broad_phase.filters_and_sensors import is_solid
from kickdrift.world.collision.continuous.missed_contacts import drop_paths
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.contacts.layout import BODY_A, BODY_B
from kickdrift.world.free_rotation import turned_product
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    AWAKE,
    BODY_INERTIA,
    BODY_KIND,
    DYNAMIC,
    INERTIA_KIND,
    INVERSE_INERTIA_IN_WORLD,
    LINK_COUNT,
    ORIENTATION,
    TUMBLES,
)
from kickdrift.world.settings import STEP, SUBSTEPS
from kickdrift.world.step.status import DO_IN_PARTS, HALVINGS, MOST_HALVINGS, OK, STATUS
from kickdrift.world.tables import (
    BODY,
    CONTACT,
    INERTIA,
    INVERSE_MASS,
    MEMBER,
    MOTION,
    POSE,
    SETTINGS,
    STEP_STATUS,
    floats,
    integers,
    rows,
)

# In a substep: turn, rad, and change of the angular velocity relative to it. Of 1650 bodies thrown at the ground with 30 to
# 1600 rad/s, none gains 1e-5 of its energy; with 1 and 0.3 the worst gains 1.3e-5, with 1.5 and 0.3 one gains two thirds, and
# with 1 and 1 nine gain more than 1 %.
_TURN = 0.6
_CHANGE = 0.1


@compiled
def divide_fast_rotation(t: float, h: float, world: int) -> None:
    """Request that the step is done in parts if a body without joints that touches another turns too far in a substep.

    It runs before the substeps and after them, since impacts change rotations.
    """
    settings, status, contact = floats(world, SETTINGS), integers(world, STEP_STATUS), integers(world, CONTACT)
    substep = settings[0, STEP] / settings[0, SUBSTEPS]
    if status[0, HALVINGS] >= MOST_HALVINGS or not _any_fast(world, substep):
        return
    for row in range(rows(world, CONTACT)):
        if not is_solid(contact, row):
            continue
        if _is_fast(world, contact[row, BODY_A], substep) or _is_fast(world, contact[row, BODY_B], substep):
            drop_paths(t, h, world)
            if status[0, STATUS] == OK:
                status[0, STATUS] = DO_IN_PARTS
            return


@compiled
def _any_fast(world: int, h: float) -> bool:
    """Whether any body of a batch turns too far in a time h, s, about whatever axis."""
    motion, member = floats(world, MOTION), integers(world, MEMBER)
    for place in range(rows(world, MEMBER)):
        w = vector_at(motion, member[place, 0], ANGULAR_VELOCITY)
        if h * h * dot(w, w) > _TURN * _TURN:
            return True
    return False


@compiled
def _is_fast(world: int, row: int, h: float) -> bool:
    """Whether a body without joints turns too far in a time h, s, about an axis that changes."""
    body = integers(world, BODY)
    if body[row, BODY_KIND] != DYNAMIC or body[row, AWAKE] == 0 or body[row, LINK_COUNT] != 0:
        return False
    w, inertia = vector_at(floats(world, MOTION), row, ANGULAR_VELOCITY), floats(world, INERTIA)
    speed = math.sqrt(dot(w, w))
    if h * speed <= _TURN or inertia[row, INERTIA_KIND] != TUMBLES:
        return False
    spin = turned_product(
        quaternion_at(floats(world, POSE), row, ORIENTATION), symmetric_at(inertia, row, BODY_INERTIA), w
    )
    gained = applied(symmetric_at(floats(world, INVERSE_MASS), row, INVERSE_INERTIA_IN_WORLD), cross(spin, w))
    return h * math.sqrt(dot(gained, gained)) > _CHANGE * speed

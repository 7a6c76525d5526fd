"""Contact recycling: manifolds are found again if their shapes have moved relative to each other, and reused otherwise."""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Quaternion, Vector, conjugate, dot, minus, product
from kickdrift.world.collision.body_acceleration import closing_acceleration
from kickdrift.world.collision.broad_phase.search_state import TRIES
from kickdrift.world.collision.fast_pairs import needs_time_of_impact
from kickdrift.world.collision.ghost_collisions import drop_ghosts
from kickdrift.world.collision.narrow_phase.impulse_matching import reserve_lost_points
from kickdrift.world.collision.narrow_phase.manifolds import find_manifold, smallest
from kickdrift.world.collision.predicted_motion import has_change
from kickdrift.world.collision.shape_poses import placed_pose, relative_pose
from kickdrift.world.collision.shape_properties import is_round, sort_of
from kickdrift.world.collision.speculative_margin import approach
from kickdrift.world.columns import quaternion_at, vector_at
from kickdrift.world.contacts.layout import (
    BODY_A,
    BODY_B,
    CONTACT_STATE,
    FAST,
    FOUND_POSE,
    JUST_FOUND,
    LEFT_OUT,
    POINTS,
    REACHABLE,
    RECYCLED,
    SHAPE_A,
    SHAPE_B,
)
from kickdrift.world.layout import AWAKE, RADIUS
from kickdrift.world.settings import HAS_FAST, MARGIN, RECYCLE_DISTANCE, STEP
from kickdrift.world.shapes.record import SURFACE
from kickdrift.world.step.status import NEEDS_TIME_OF_IMPACT, STATUS
from kickdrift.world.tables import (
    BODY,
    CONTACT,
    MANIFOLD,
    PLACE,
    SEARCH,
    SETTINGS,
    STEP_STATUS,
    TRIANGLE_TREE,
    floats,
    integers,
    rows,
)

# Of the motion up to which a manifold is reused: up to this part of it, one is reused that lacks points that may touch
_INCOMPLETE = 0.1
_STANDING = 1e-4  # of its size: motion up to which a round shape standing on three or more points keeps its manifold


@compiled
def find_points(t: float, h: float, world: int) -> None:
    """Find the points of all contacts whose shapes have moved relative to each other."""
    if rows(world, TRIANGLE_TREE) > 0 and not reserve_lost_points(world):
        return
    contact, manifold = integers(world, CONTACT), floats(world, MANIFOLD)
    place, settings = floats(world, PLACE), floats(world, SETTINGS)
    awake, tried = integers(world, BODY), integers(world, SEARCH)[0, TRIES] > 0
    for row in range(rows(world, CONTACT)):
        a, b = contact[row, SHAPE_A], contact[row, SHAPE_B]
        if tried and contact[row, POINTS] != 0:  # a step that is repeated keeps the points that it has found
            continue
        if contact[row, CONTACT_STATE] & FAST:  # its points, if any, are not those at the start of a step
            contact[row, CONTACT_STATE] &= ~FAST
            manifold[row, RECYCLED] = 0.0
        if awake[contact[row, BODY_A], AWAKE] == 0 and awake[contact[row, BODY_B], AWAKE] == 0:
            continue
        at, turn = relative_pose(placed_pose(world, a), placed_pose(world, b))
        pushed = settings[0, STEP] ** 2 * closing_acceleration(world, row)
        way = approach(world, row, pushed)
        changes = has_change(world, contact[row, BODY_A]) or has_change(world, contact[row, BODY_B])
        moved = _moved(manifold, row, at, turn, place[b, RADIUS])
        # A triangle without points may be as near as those with points: at its edges it leaves them to its neighbours.
        apart = contact[row, POINTS] == 0 and sort_of(world, a) != SURFACE
        tolerance = _tolerance(world, a, b, contact[row, POINTS])
        most = tolerance * (_INCOMPLETE if moved + way >= manifold[row, LEFT_OUT] else 1.0)
        if moved + way < manifold[row, RECYCLED] and (apart or moved <= most):
            continue
        manifold[row, RECYCLED] = settings[0, MARGIN] + way
        if changes or needs_time_of_impact(world, row, way):
            contact[row, CONTACT_STATE] |= FAST
            if settings[0, HAS_FAST] == 0.0:
                integers(world, STEP_STATUS)[0, STATUS] = NEEDS_TIME_OF_IMPACT
        else:
            manifold[row, REACHABLE] = way + pushed + _INCOMPLETE * tolerance
            find_manifold(world, row, at, turn, settings[0, MARGIN] + way)
            contact[row, CONTACT_STATE] |= JUST_FOUND
    drop_ghosts(world, JUST_FOUND)


@compiled(inline=True)
def _moved(manifold: Any, row: int, at: Vector, turn: Quaternion, radius: float) -> float:
    """Bound the motion of any point of the second shape in the first's frame since the manifold was found, m."""
    q = quaternion_at(manifold, row, FOUND_POSE + 3)
    way = minus(at, vector_at(manifold, row, FOUND_POSE))
    d = product(conjugate(q), turn)
    angle = 2.0 * math.sqrt(d[1] * d[1] + d[2] * d[2] + d[3] * d[3])
    return math.sqrt(dot(way, way)) + angle * radius


@compiled(inline=True)
def _tolerance(world: int, a: int, b: int, points: int) -> float:
    """Return the motion of touching shapes up to which their manifold is reused, m."""
    place = floats(world, PLACE)
    most: float = floats(world, SETTINGS)[0, RECYCLE_DISTANCE]
    reach = smallest(place[a, RADIUS], place[b, RADIUS])
    if is_round(world, a) or is_round(world, b):
        # After a ball has rolled by d its contact point is off by d, and its weight pushes it on: with 1e-4 the speed of a ball
        # at rest grows from 1e-8 m/s to 1.5 mm/s within seconds.
        return 1e-9 * reach if points < 3 else _STANDING * reach
    return min(most, 0.05 * reach)

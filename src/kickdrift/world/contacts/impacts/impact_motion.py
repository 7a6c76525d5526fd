"""Motion of bodies to the time of their impact within the substep, and back.

They fly there as by the stages `kick` and `drift`: by the midpoint rule, and rotating with their angular momentum. After the
impact they are moved back to the pose from which their new velocities lead through it, for the drift that follows.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import (
    Quaternion,
    Vector,
    applied,
    conjugate,
    cross,
    exponential,
    minus,
    plus,
    product,
    times,
    turned,
    turned_back,
    turned_symmetric,
    unit,
)
from kickdrift.world.collision.predicted_motion import note_position
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.free_rotation import mean_turn
from kickdrift.world.layout import (
    ADDED,
    ANGULAR_VELOCITY,
    BODY_INERTIA,
    DISPLACEMENT,
    IMPACT_TIME,
    INERTIA_KIND,
    INVERSE_INERTIA,
    INVERSE_INERTIA_IN_WORLD,
    INVERSE_LINEAR_MASS,
    KICKED_ANGULAR_VELOCITY,
    KICKED_VELOCITY,
    NEXT_IMPACT,
    ORIENTATION,
    POSITION,
    ROTATION,
    SPIN,
    TUMBLES,
    VELOCITY,
)
from kickdrift.world.settings import MIDPOINT
from kickdrift.world.tables import (
    DELTA_POSE,
    INERTIA,
    INVERSE_MASS,
    KICKED,
    MOTION,
    POSE,
    SETTINGS,
    STARTED_POSE,
    floats,
)

# Position, orientation, velocity, angular velocity, angular acceleration, and the rotation vector since the substep began
Flight = tuple[Vector, Quaternion, Vector, Vector, Vector, Vector]
Place = tuple[Vector, Quaternion]  # position, and the rotation since the step began


@compiled(inline=True)
def is_moved(world: int, body: int) -> bool:
    """Whether impulses move a body."""
    moved: bool = floats(world, INVERSE_MASS)[body, INVERSE_LINEAR_MASS] > 0.0
    return moved


@compiled
def flown(world: int, h: float, body: int, when: float) -> Flight:
    """Return pose and motion of a body at a time `when` in the substep, s, by free flight; see `Flight`."""
    pose, motion, kicked, inertia = (
        floats(world, POSE),
        floats(world, MOTION),
        floats(world, KICKED),
        floats(world, INERTIA),
    )
    at, q = vector_at(pose, body, POSITION), quaternion_at(pose, body, ORIENTATION)
    v, w, none = vector_at(motion, body, VELOCITY), vector_at(motion, body, ANGULAR_VELOCITY), (0.0, 0.0, 0.0)
    if not is_moved(world, body):
        return plus(at, times(when, v)), product(exponential(times(when, w)), q), v, w, none, times(when, w)
    at = plus(at, way_to(world, h, body, when))
    v = minus(v, times(_left_to_gain(world, h, when), vector_at(kicked, body, ADDED)))
    if inertia[body, INERTIA_KIND] != TUMBLES:
        return at, product(exponential(times(when, w)), q), v, w, none, times(when, w)
    # From its last impact on; before that, it has not rotated as in free flight.
    last, spin = kicked[body, IMPACT_TIME], vector_at(kicked, body, SPIN)
    way = times(last, w)
    if last > 0.0:
        q = product(exponential(way), q)
    if when > last:
        rest = times(when - last, mean_turn(when - last, q, symmetric_at(inertia, body, BODY_INERTIA), spin, w))
        q, way = product(exponential(rest), q), plus(way, rest)
    inverse = turned_symmetric(q, symmetric_at(inertia, body, INVERSE_INERTIA))
    w = applied(inverse, spin)
    return at, q, v, w, applied(inverse, cross(spin, w)), way


@compiled(inline=True)
def place_of(world: int, body: int, at: Vector, q: Quaternion) -> Place:
    """Return position and rotation since the step began, from the position and orientation of a body."""
    return at, product(q, conjugate(quaternion_at(floats(world, STARTED_POSE), body, ORIENTATION)))


@compiled
def move_to_impact(world: int, h: float, body: int) -> None:
    """Move a body to the pose of its next impact, with the velocities that it has there."""
    kicked, pose, motion = floats(world, KICKED), floats(world, POSE), floats(world, MOTION)
    when = kicked[body, NEXT_IMPACT]
    if when < 0.0 or not is_moved(world, body):
        return
    at, q, v, w, _, way = flown(world, h, body, when)
    for k in range(3):
        pose[body, POSITION + k], motion[body, VELOCITY + k], motion[body, ANGULAR_VELOCITY + k] = at[k], v[k], w[k]
        floats(world, DELTA_POSE)[body, ROTATION + k] += way[k]
    kicked[body, IMPACT_TIME], kicked[body, NEXT_IMPACT] = when, -1.0
    note_position(world, body)
    _turn_to(world, body, q)


@compiled
def leave_impact(world: int, h: float, body: int) -> None:
    """Move a body back to the pose from which its present velocities lead to the present pose in the time since the start."""
    kicked, pose, motion, delta_pose = (
        floats(world, KICKED),
        floats(world, POSE),
        floats(world, MOTION),
        floats(world, DELTA_POSE),
    )
    if kicked[body, NEXT_IMPACT] != -1.0 or not is_moved(world, body):
        return
    kicked[body, NEXT_IMPACT] = -2.0
    when, inertia = kicked[body, IMPACT_TIME], floats(world, INERTIA)
    way = way_to(world, h, body, when)
    q, turn = quaternion_at(pose, body, ORIENTATION), vector_at(motion, body, ANGULAR_VELOCITY)
    if inertia[body, INERTIA_KIND] == TUMBLES:
        moments, spin = symmetric_at(inertia, body, BODY_INERTIA), vector_at(kicked, body, SPIN)
        before = applied(symmetric_at(floats(world, INVERSE_MASS), body, INVERSE_INERTIA_IN_WORLD), spin)
        spin = plus(spin, turned(q, applied(moments, turned_back(q, minus(turn, before)))))
        turn = mean_turn(h - when, q, moments, spin, turn)
        for k in range(3):
            kicked[body, SPIN + k] = spin[k]
    faster = _left_to_gain(world, h, when)
    for k in range(3):
        motion[body, VELOCITY + k] += faster * kicked[body, ADDED + k]
        back = when * (motion[body, VELOCITY + k] - kicked[body, KICKED_VELOCITY + k])
        pose[body, POSITION + k] -= way[k] + back
        delta_pose[body, DISPLACEMENT + k] -= back
        delta_pose[body, ROTATION + k] -= when * turn[k]
        kicked[body, KICKED_VELOCITY + k] = motion[body, VELOCITY + k]
        kicked[body, KICKED_ANGULAR_VELOCITY + k], motion[body, ANGULAR_VELOCITY + k] = turn[k], turn[k]
    _turn_to(world, body, product(exponential(times(-when, turn)), q))


@compiled(inline=True)
def way_to(world: int, h: float, body: int, when: float) -> Vector:
    """Return the displacement of a body from the start of the substep to a time, m, by the midpoint rule if it is set."""
    kicked, midpoint = floats(world, KICKED), floats(world, SETTINGS)[0, MIDPOINT]
    late = midpoint * when * (0.5 * when / h - 1.0)
    return plus(times(when, vector_at(kicked, body, KICKED_VELOCITY)), times(late, vector_at(kicked, body, ADDED)))


@compiled(inline=True)
def _left_to_gain(world: int, h: float, when: float) -> float:
    """Return the fraction of the kick that a body still has to gain at a time, if the midpoint rule is set; else 0."""
    left: float = floats(world, SETTINGS)[0, MIDPOINT] * (1.0 - when / h)
    return left


@compiled
def _turn_to(world: int, body: int, turn: Quaternion) -> None:
    """Set the orientation of a body, and its inverse inertia in the world's axes."""
    pose, inverse_mass, inertia = floats(world, POSE), floats(world, INVERSE_MASS), floats(world, INERTIA)
    q = unit(turn)
    for k in range(4):
        pose[body, ORIENTATION + k] = q[k]
    if inertia[body, INERTIA_KIND] == TUMBLES:
        inverse = turned_symmetric(q, symmetric_at(inertia, body, INVERSE_INERTIA))
        for k in range(6):
            inverse_mass[body, INVERSE_INERTIA_IN_WORLD + k] = inverse[k]

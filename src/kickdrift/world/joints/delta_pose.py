"""Changes of position that have no velocity."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, exponential, product, turned, turned_symmetric, unit
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.joints.layout import ANGULAR_PART
from kickdrift.world.layout import (
    ANGULAR_VELOCITY,
    DISPLACEMENT,
    INERTIA_KIND,
    INVERSE_INERTIA_IN_WORLD,
    ORIENTATION,
    POSITION,
    ROTATION,
    TUMBLES,
)
from kickdrift.world.tables import DELTA_POSE, INERTIA, INVERSE_MASS, MOTION, POSE, floats


@compiled(cached=False)
def shift_body(world: int, body: int, way: Vector, turn: Vector) -> None:
    """Change the pose of a body, and turn its angular velocity with it, which keeps its energy."""
    pose, delta_pose = floats(world, POSE), floats(world, DELTA_POSE)
    motion, inverse_mass = floats(world, MOTION), floats(world, INVERSE_MASS)
    by = exponential(turn)
    q = unit(product(by, quaternion_at(pose, body, ANGULAR_PART)))
    w = turned(by, vector_at(motion, body, ANGULAR_PART))
    for k in range(3):
        pose[body, POSITION + k] += way[k]
        delta_pose[body, DISPLACEMENT + k] += way[k]
        delta_pose[body, ROTATION + k] += turn[k]
        motion[body, ANGULAR_VELOCITY + k] = w[k]
    for k in range(4):
        pose[body, ORIENTATION + k] = q[k]
    if floats(world, INERTIA)[body, INERTIA_KIND] == TUMBLES:
        inverse = turned_symmetric(by, symmetric_at(inverse_mass, body, INVERSE_INERTIA_IN_WORLD))
        for k in range(6):
            inverse_mass[body, INVERSE_INERTIA_IN_WORLD + k] = inverse[k]

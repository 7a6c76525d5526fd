"""Energy of an articulation: joints without motors and springs never add to it, which tells solutions that no one wants."""

from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import applied, dot, length, minus, plus, times, turned_back
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.flight import BODY_INERTIA, MASS
from kickdrift.world.joints.layout import (
    ANGULAR_PART,
    ARM_A,
    ARM_B,
    AXES,
    BODY_A,
    DAMPING,
    DRIVEN,
    END,
    FIRST,
    LAWS,
    LINEAR_PART,
    LINK_A,
    LINK_B,
    LINK_JOINT,
    LINKS,
    MOBILITY,
    MOTOR_MAXIMUM,
    MOTOR_SPEED,
    NONE,
    POSITION,
    START_SPEED,
    STIFFNESS,
    TARGET,
    TARGET_SPEED,
    int64,
)
from kickdrift.world.joints.layout import BODY as LINK_BODY
from kickdrift.world.joints.measure import relative_velocity
from kickdrift.world.tables import (
    ARTICULATION,
    INERTIA,
    JOINT,
    JOINT_AXES,
    JOINT_NUMBERS,
    LINK,
    MOTION,
    POSE,
    RESPONSE,
    floats,
    integers,
)

_MOMENTS = int64(BODY_INERTIA)

# What joints may be off by in parts of their arms, so that putting it right within a substep takes no one's attention.
_UNNOTICED = 1e-5


@compiled(cached=False)
def kinetic_energy(row: int, world: int) -> float:
    """Kinetic energy of the links of an articulation; of one that floats, in the frame of its centre of mass.

    Joints cannot change how fast that moves, and a part of the energy of falling is no part of what they may do.
    """
    articulation: Any = integers(world, ARTICULATION)[row]
    links, motion, pose, inertia = (
        integers(world, LINK),
        floats(world, MOTION),
        floats(world, POSE),
        floats(world, INERTIA),
    )
    first, end = articulation[FIRST], articulation[FIRST] + articulation[LINKS]
    frame, mass, total = (0.0, 0.0, 0.0), 0.0, 0.0
    if _floats(row, world):
        for link in range(first, end):
            body = links[link, LINK_BODY]
            mass += inertia[body, MASS]
            frame = plus(frame, times(inertia[body, MASS], vector_at(motion, body, LINEAR_PART)))
        frame = times(1.0 / mass, frame)
    for link in range(first, end):
        body = links[link, LINK_BODY]
        v, w = minus(vector_at(motion, body, LINEAR_PART), frame), vector_at(motion, body, ANGULAR_PART)
        turn = turned_back(quaternion_at(pose, body, ANGULAR_PART), w)
        total += inertia[body, MASS] * dot(v, v) + dot(turn, applied(symmetric_at(inertia, body, _MOMENTS), turn))
    return 0.5 * total


@compiled(cached=False)
def _floats(row: int, world: int) -> bool:
    """Whether no joint holds an articulation to what it does not move."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, first = integers(world, LINK), articulation[FIRST]
    free: bool = links[first, LINK_JOINT] < 0
    for closing in range(first + articulation[LINKS], articulation[END]):
        free = free and links[closing, LINK_A] != NONE and links[closing, LINK_B] != NONE
    return free


@compiled(cached=False)
def allowance(row: int, h: float, world: int) -> float:
    """Bound what motors, springs, moving supports and putting right what is hardly off may add to the energy in a substep."""
    articulation: Any = integers(world, ARTICULATION)[row]
    links, joints, inertia = integers(world, LINK), integers(world, JOINT), floats(world, INERTIA)
    numbers, laws = floats(world, JOINT_NUMBERS), floats(world, JOINT_AXES)
    motion, response = floats(world, MOTION), floats(world, RESPONSE)
    total, mass, fastest = 0.0, 0.0, 0.0
    for link in range(articulation[FIRST], articulation[END]):
        joint = links[link, LINK_JOINT]
        if link < articulation[FIRST] + articulation[LINKS]:
            mass += inertia[links[link, LINK_BODY], MASS]
        if joint < 0:
            continue
        for side in range(2):
            end = joints[joint, BODY_A + side]
            if response[end, 0] == 0.0:
                arm = length(vector_at(numbers, joint, ARM_B if side == 1 else ARM_A))
                v, w = vector_at(motion, end, LINEAR_PART), vector_at(motion, end, ANGULAR_PART)
                fastest = max(fastest, length(v) + arm * length(w))
        if link < articulation[FIRST] + articulation[LINKS]:
            arm = length(vector_at(numbers, joint, ARM_A)) + length(vector_at(numbers, joint, ARM_B))
            total += 0.5 * inertia[links[link, LINK_BODY], MASS] * (_UNNOTICED * arm / h) ** 2
        if joints[joint, LAWS] == 0:
            continue
        v, w = relative_velocity(joint, world)
        for k in range(6):
            if joints[joint, LAWS] >> k & 1:
                law = 6 * joint + k
                off = numbers[joint, DRIVEN + k - 3] if k >= 3 else numbers[joint, POSITION + k] - laws[law, TARGET]
                # A spring gives no more than it has, and that only on its way.
                way = h * abs(dot(vector_at(numbers, joint, AXES + 3 * k), v if k < 3 else w))
                total += laws[law, STIFFNESS] * abs(off) * min(0.5 * abs(off), way)
                impulse = h * (laws[law, MOTOR_MAXIMUM] + laws[law, DAMPING] * abs(laws[law, TARGET_SPEED]))
                if impulse > 0.0:
                    # They accelerate an axis up to the speed that they want, and no further.
                    wanted = abs(laws[law, MOTOR_SPEED]) + abs(laws[law, TARGET_SPEED])
                    total += impulse * (abs(laws[law, START_SPEED]) + min(impulse * laws[law, MOBILITY], wanted))
    return total + 2.0 * mass * fastest * fastest

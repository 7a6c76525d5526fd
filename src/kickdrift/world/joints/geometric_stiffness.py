"""Damping of oscillations too fast for a substep, in chains of light bodies under great forces.

A link that is pulled at its joint by a force F at an arm r is turned back about an axis s with the geometric stiffness
K = r . F - (s . r) (s . F), against the inertia D of the bodies that turn at the joint. In a chain of rods, neighbours swing
against each other with h^2 w^2 up to 18 h^2 K / D. The substep follows such modes up to hw = 2, and feeds energy into them,
by resonance with the forces that they cause themselves, from sqrt(2) on: Skeel, Zhang, Schlick, SIAM J. Sci. Comput. 18
(1997) 203. Where h^2 K / D is above 0.11, the relative rotation about open axes of joints between two moving bodies is
braked, which conserves momentum and angular momentum. As no mode is faster than one body that swings for itself about its
centre of mass, with the stiffness K' of both of its joints and its own moment of inertia D', h^2 K / D counts as h^2 K' / 5
D' at most. A chain of 20 links of 1 kg with an end of 1000 kg then swings without limit; without damping, for a second.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, applied, dot, minus, plus, times, turned_back
from kickdrift.world.columns import quaternion_at, symmetric_at, vector_at
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import BODY_INERTIA
from kickdrift.world.tables import INERTIA, JOINT, JOINT_NUMBERS, LINK, LINK_NUMBERS, POSE, floats, integers

_RESOLVED, _BRAKING = 0.11, 0.5

# The square of hw of a body that swings alone is taken for this many times h^2 K / D, not for 18 times, as in chains of equal
# rods. With 18, tips of falling chains swing on, with energy kept no better, and cost half as many solutions again.
_ALONE = 5.0


@compiled(cached=False)
def set_brakes(world: int, link: int, joint: int, h: float) -> None:
    """Set the braking of the joint of a link for the next substep, after the relaxation."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    force, held = (0.0, 0.0, 0.0), integers(world, JOINT)[joint, j.LOCKED]
    for k in range(3):
        numbers[joint, j.PULL + k] = 0.5 * (numbers[joint, j.PULL + k] + numbers[joint, j.JOINT_IMPULSE + k])
        force = plus(
            force,
            times(h * links[link, j.SIGN] * numbers[joint, j.PULL + k], vector_at(numbers, joint, j.AXES + 3 * k)),
        )
    arm = _arm(world, joint, 1 if links[link, j.SIGN] > 0 else 0)
    for k in range(3, 6):
        axis = vector_at(numbers, joint, j.AXES + 3 * k)
        stiffness = dot(arm, force) - dot(axis, arm) * dot(axis, force)
        turned = work[link, j.YIELD + k] * stiffness
        unresolved = turned > _RESOLVED and links[link, j.PARENT] >= 0 and not held >> k & 1
        if unresolved:
            turned = min(turned, _most(world, joint, axis, times(links[link, j.SIGN], force)) / _ALONE)
        numbers[joint, j.BRAKE + k - 3] = (
            _BRAKING * stiffness * (1.0 - _RESOLVED / turned) if unresolved and turned > _RESOLVED else 0.0
        )


@compiled(cached=False)
def _arm(world: int, joint: int, side: int) -> Vector:
    """Return the vector from the centre of a body to its own end of a joint: the line of a rope is not part of its arm."""
    numbers = floats(world, JOINT_NUMBERS)
    if side == 1:
        return vector_at(numbers, joint, j.ARM_B)
    arm = vector_at(numbers, joint, j.ARM_A)
    if integers(world, JOINT)[joint, j.LINEAR] == j.LINE:
        line = numbers[joint, j.JOINT_POSITION + 2] + numbers[joint, j.LENGTH]
        arm = minus(arm, times(line, vector_at(numbers, joint, j.AXES + 6)))
    return arm


@compiled(cached=False)
def _most(world: int, joint: int, axis: Vector, force: Vector) -> float:
    """Bound the square of the turn hw of the bodies of a joint that swing about an axis: each about its centre of mass.

    No mode is faster than that of one body that swings alone, since the energy of its rotation is its own, and other bodies
    only add inertia. Its other joints are assumed to pull like this one.
    """
    joints, inertia, most = integers(world, JOINT), floats(world, INERTIA), 0.0
    for side in range(2):
        body = joints[joint, j.BODY_A + side]
        arm, pull = _arm(world, joint, side), times(1.0 if side == 1 else -1.0, force)
        seen = turned_back(quaternion_at(floats(world, POSE), body, j.ANGULAR_PART), axis)
        moment = dot(seen, applied(symmetric_at(inertia, body, BODY_INERTIA), seen))
        stiffness = 2.0 * (dot(arm, pull) - dot(axis, arm) * dot(axis, pull))
        most = max(most, stiffness / moment if moment > 0.0 else 0.0)
    return most

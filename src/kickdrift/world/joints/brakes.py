"""Damping of what swings too fast for a substep, in chains of light bodies under great forces.

A link that is pulled at its joint by a force F at an arm r is turned back about an axis s with the geometric stiffness
K = r . F - (s . r) (s . F), against the inertia D of what turns at the joint. In a chain of rods, neighbours swing against each
other with h^2 w^2 up to 18 h^2 K / D. The substep follows such modes up to hw = 2, and feeds energy into them, by resonance
with the forces that they make themselves, from sqrt(2) on: Skeel, Zhang, Schlick, SIAM J. Sci. Comput. 18 (1997) 203. Where
h^2 K / D is above 0.11, bodies are braked against each other, about open axes of joints between two that move; momentum and
angular momentum are kept. A chain of 20 links of 1 kg with an end of 1000 kg swings so for as long as one likes; without it,
for a second.
"""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import dot, plus, times
from kickdrift.world.columns import vector_at
from kickdrift.world.joints.layout import ARM_A, ARM_B, AXES, BRAKE, JOINT_IMPULSE, LOCKED, PARENT, PULL, SIGN, YIELD
from kickdrift.world.tables import JOINT, JOINT_NUMBERS, LINK, LINK_NUMBERS, floats, integers

_RESOLVED, _BRAKING = 0.11, 0.5


@compiled(cached=False)
def set_brakes(link: int, joint: int, h: float, world: int) -> None:
    """Find out how much the joint of a link is to be braked in the next substep, after the relaxation."""
    links, work, numbers = integers(world, LINK), floats(world, LINK_NUMBERS), floats(world, JOINT_NUMBERS)
    force, held = (0.0, 0.0, 0.0), integers(world, JOINT)[joint, LOCKED]
    for k in range(3):
        numbers[joint, PULL + k] = 0.5 * (numbers[joint, PULL + k] + numbers[joint, JOINT_IMPULSE + k])
        force = plus(
            force, times(h * links[link, SIGN] * numbers[joint, PULL + k], vector_at(numbers, joint, AXES + 3 * k))
        )
    arm = vector_at(numbers, joint, ARM_B if links[link, SIGN] > 0 else ARM_A)
    for k in range(3, 6):
        axis = vector_at(numbers, joint, AXES + 3 * k)
        stiffness = dot(arm, force) - dot(axis, arm) * dot(axis, force)
        turned = work[link, YIELD + k] * stiffness
        unresolved = turned > _RESOLVED and links[link, PARENT] >= 0 and not held >> k & 1
        work[link, BRAKE + k - 3] = _BRAKING * stiffness * (1.0 - _RESOLVED / turned) if unresolved else 0.0

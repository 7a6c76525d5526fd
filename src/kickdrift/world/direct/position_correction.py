"""Position correction of the bodies of an island whose joints are off."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import length, times
from kickdrift.world.columns import vector_at
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import REST
from kickdrift.world.direct.island_calls import aim_island, solve
from kickdrift.world.direct.island_velocities import fastest, kinetic_energy, note_velocities
from kickdrift.world.direct.loop_closures import has_loops, stay_closings
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.delta_pose import shift_body
from kickdrift.world.joints.kinematics import measure_joint
from kickdrift.world.joints.right_hand_side import REPAIR
from kickdrift.world.tables import ISLAND, ISLAND_JOINT, LINK, LINK_NUMBERS, MOTION, NODE, NOTED, floats, integers

REPAIRS = 8

# Turn in a substep, rad, from which on bodies leave the poses that joints allow by rotation alone. Without this bound, rings of
# three to eight links that spin freely lose a fifth of their energy in the mean instead of a tenth.
_SLOW = 0.1


@compiled
def correct_poses(world: int, island: int, h: float) -> None:
    """Correct the poses of bodies so that joints are satisfied, and note the velocities to go on with.

    They are the present ones. In slow islands with loops they are those that lead to the corrected poses, if these have less
    energy: so they lose what joints stop only to the second order, as the planks of a straight bridge.
    """
    note_velocities(world, island)
    for _ in range(REPAIRS):
        _correct(world, island, h)
    less = kinetic_energy(world, island, NOTED) < kinetic_energy(world, island, MOTION)
    slow = h * fastest(world, island, MOTION, j.ANGULAR_PART) < _SLOW
    if not (less and slow and has_loops(world, island)):
        note_velocities(world, island)


@compiled(cached=False)
def _correct(world: int, island: int, h: float) -> None:
    """Do one step of Newton's method with the poses, and add to the noted velocities what leads to them."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order, work, noted = integers(world, ISLAND_JOINT), floats(world, LINK_NUMBERS), floats(world, NOTED)
    aim_island(world, island, h, REPAIR)
    stay_closings(world, island)
    solve(world, island, h, d.CORRECTION, REST, True, False)
    for node in range(own[d.FIRST_NODE], own[d.AFTER_NODE]):
        link = nodes[node, d.LINK_ROW]
        way, turn = times(h, vector_at(work, link, j.GAIN)), times(h, vector_at(work, link, j.GAIN + 3))
        turn, body = times(1.0 / max(1.0, 2.0 * length(turn)), turn), links[link, j.LINK_BODY]
        shift_body(world, body, way, turn)
        for k in range(3):
            noted[body, j.LINEAR_PART + k] += way[k] / h
            noted[body, j.ANGULAR_PART + k] += turn[k] / h
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        measure_joint(world, links[order[place, 0], j.LINK_JOINT], 0.0)

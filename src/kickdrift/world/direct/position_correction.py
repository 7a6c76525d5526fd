"""Position correction of the bodies of an island whose joints are off."""

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import length, times
from kickdrift.world.columns import vector_at
from kickdrift.world.direct.active_set import aim_island, solve
from kickdrift.world.direct.contacts import REST
from kickdrift.world.direct.layout import AFTER_JOINT, AFTER_NODE, FIRST_JOINT, FIRST_NODE, LINK_ROW
from kickdrift.world.direct.loop_closures import stay_closings
from kickdrift.world.joints.body_shift import shift_body
from kickdrift.world.joints.kinematics import measure_joint
from kickdrift.world.joints.layout import GAIN, LINK_BODY, LINK_JOINT
from kickdrift.world.joints.right_hand_side import REPAIR
from kickdrift.world.tables import ISLAND, ISLAND_JOINT, LINK, LINK_NUMBERS, NODE, floats, integers

REPAIRS = 8


@compiled(cached=False)
def repair(world: int, island: int, h: float) -> None:
    """Correct the poses of bodies so that joints are satisfied, without changing velocities."""
    own, nodes, links = integers(world, ISLAND)[island], integers(world, NODE), integers(world, LINK)
    order, work = integers(world, ISLAND_JOINT), floats(world, LINK_NUMBERS)
    first, after = own[FIRST_NODE], own[AFTER_NODE]
    for _ in range(REPAIRS):
        aim_island(world, island, h, REPAIR)
        stay_closings(world, island)
        solve(world, island, h, -1.0, REST, True, False)
        for node in range(first, after):
            link = nodes[node, LINK_ROW]
            way, turn = times(h, vector_at(work, link, GAIN)), times(h, vector_at(work, link, GAIN + 3))
            turn = times(1.0 / max(1.0, 2.0 * length(turn)), turn)
            shift_body(world, links[link, LINK_BODY], way, turn)
        for place in range(own[FIRST_JOINT], own[AFTER_JOINT]):
            measure_joint(world, links[order[place, 0], LINK_JOINT], 0.0)

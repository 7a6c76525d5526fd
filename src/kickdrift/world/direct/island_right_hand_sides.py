"""The right-hand sides of the joints of an island."""

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.right_hand_side import write_right_hand_side
from kickdrift.world.tables import ISLAND, ISLAND_JOINT, LINK, integers


@compiled
def aim_joints(world: int, island: int, h: float, mode: int) -> float:
    """Set the right-hand sides of the joints of an island, and return the largest of their errors, NaN if one is NaN."""
    own, order, links = integers(world, ISLAND)[island], integers(world, ISLAND_JOINT), integers(world, LINK)
    worst = 0.0
    for place in range(own[d.FIRST_JOINT], own[d.AFTER_JOINT]):
        link = order[place, 0]
        off = write_right_hand_side(world, links[link, j.LINK_JOINT], link, h, mode)
        worst = worst if off <= worst else off  # keeps NaN
    return worst

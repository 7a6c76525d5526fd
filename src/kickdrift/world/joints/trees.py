"""Articulations without loops."""

from typing import Any

from kickdrift.core.compilation import compiled, specialise
from kickdrift.world.joints.articulated import factor, sweep
from kickdrift.world.joints.layout import FIRST, LINKS
from kickdrift.world.joints.newton import TREES, solve_articulations, solve_calmly, solve_once, touch_up
from kickdrift.world.joints.repair import repair_positions
from kickdrift.world.tables import ARTICULATION, integers


@compiled(cached=False)
def eliminate(row: int, ahead: float, world: int) -> None:
    """Solve an articulation without loops."""
    articulation: Any = integers(world, ARTICULATION)[row]
    factor(articulation[FIRST], articulation[LINKS], ahead, world)
    sweep(articulation[FIRST], articulation[LINKS], 1.0, world)


_once = compiled(cached=False)(specialise(solve_once, "solve_trees_once", answer=eliminate))
_repair = compiled(cached=False)(specialise(repair_positions, "repair_trees", answer=eliminate))
_calm = compiled(cached=False)(specialise(solve_calmly, "solve_trees_calmly", once=_once, answer=eliminate))
solve_trees = compiled(
    specialise(solve_articulations, "solve_trees", once=_once, calm=_calm, repair=_repair, FOR=TREES)
)
touch_up_trees = compiled(specialise(touch_up, "touch_up_trees", once=_once, FOR=TREES))

"""Relaxation of islands: the projection of velocities after the drift, and the judgement of the energy that it leaves."""

from kickdrift.core.compilation import compiled
from kickdrift.world.direct import layout as d
from kickdrift.world.direct.contact_active_set import REST, is_cut, note_impulses
from kickdrift.world.direct.energy_guard import gained
from kickdrift.world.direct.island_calls import aim_island, repair, solve
from kickdrift.world.direct.island_solver import project, solve_at_once
from kickdrift.world.direct.island_velocities import begin_from_kick
from kickdrift.world.direct.islands import direct_islands
from kickdrift.world.direct.joint_impulses import end_relaxation
from kickdrift.world.direct.loop_closures import stay_closings
from kickdrift.world.disjoint_sets import first_of
from kickdrift.world.joints.right_hand_side import RELAX
from kickdrift.world.tables import ISLAND, integers


@compiled
def relax_islands(t: float, h: float, world: int) -> None:
    """Project the velocities onto those that joints and contacts allow at the new poses, after the drift."""
    for island in range(direct_islands(world)):
        _relax(world, island, h)
    _relax_again(world, h)
    for island in range(direct_islands(world)):
        if is_cut(world, island):
            aim_island(world, island, h, RELAX)
            stay_closings(world, island)
            solve(world, island, h, 0.0, REST, True, False)
        end_relaxation(world, island, h)


@compiled(cached=False)
def _relax(world: int, island: int, h: float) -> None:
    """Project the velocities of an island after the drift, or, if that leaves too much energy, those after the kick.

    Where no solution was found, poses are corrected first; not judged, that turned the 2.4 kJ of a row of two bodies on sliders
    and one on a ball joint, 24 g to 250 kg, into 23 MJ. Islands that touch others are judged when all have been projected
    (`_relax_again`).
    """
    if integers(world, ISLAND)[island, d.LOST] != 0:
        repair(world, island, h)
        note_impulses(world, island, False)
        project(world, island, h, RELAX, REST)
    else:
        solve_at_once(world, island, h, RELAX, REST)
    if not is_cut(world, island) and not gained(world, island, h) <= 0.0:
        _relax_from_kick(world, island, h)


@compiled(cached=False)
def _relax_again(world: int, h: float) -> None:
    """Project the velocities after the kick of islands that have gained energy, if all that contacts connect them with have.

    Judged one by one, islands would be projected again though the energy came from their neighbours: sixteen ragdolls, dropped
    from eight heights, then take a tenth more eliminations of nodes.
    """
    islands = integers(world, ISLAND)
    for island in range(direct_islands(world)):
        if is_cut(world, island) and not gained(world, island, h) <= 0.0:
            total = 0.0
            for other in range(direct_islands(world)):
                if first_of(islands, d.GROUP, other) == first_of(islands, d.GROUP, island):
                    total += gained(world, other, h)
            if not total <= 0.0:
                _relax_from_kick(world, island, h)


@compiled(cached=False)
def _relax_from_kick(world: int, island: int, h: float) -> None:
    """Project the velocities after the kick, without the impulses of the substep."""
    begin_from_kick(world, island)
    solve_at_once(world, island, h, RELAX, REST)

"""HTML for notebooks of solutions, recordings and worlds: their facts, and a small picture."""

from io import BytesIO
from typing import TYPE_CHECKING, Any

from kickdrift.core.errors import KickdriftError
from kickdrift.core.html import facts
from kickdrift.engine.solution import Solution

if TYPE_CHECKING:
    from kickdrift.world.world import World

_DPI = 55
_MOST_NUMBERS = 2_000_000  # of a solution, which are drawn in a second


def solution_html(solution: Solution) -> str:
    """Return the report of a solution or a recording as a table, with its picture."""
    rows = [line.split("  ", 1) for line in solution.report().splitlines()]
    small = solution.plain.x.size <= _MOST_NUMBERS
    named = [(name, value.strip()) for name, value in rows]
    return facts(type(solution).__name__, named, _picture(solution) if small else b"")


def world_html(world: "World") -> str:
    """Return the facts of a world, and a picture of its current state."""
    energy = world.energy()
    rows: list[tuple[str, object]] = [
        ("time", f"{world.time:.6g} s, {world.n_steps} steps"),
        ("bodies", f"{len(world.bodies.moving())} that move, {len(world.shape_rows.shapes)} shapes"),
        ("touching", f"{len(world.touching)} pairs"),
        ("gravity", f"{world.gravity.tolist()} m/s²"),
        ("energy", f"{energy.total:.6g} J, of it {energy.kinetic:.6g} J kinetic"),
        ("residual", f"{world.residual:.3g} m/s"),
    ]
    picture = b""
    if world.recorder is None:
        with world.record() as recording:
            pass
        picture = _picture(recording, panels=1)
    return facts("World", rows, picture)


def _picture(drawn: Any, panels: int | None = None) -> bytes:
    """Return the picture as a PNG, or its first panels; none where there is nothing to draw, or nothing to draw with."""
    try:
        figure = drawn.plot()
    except KickdriftError:
        return b""
    if panels is not None:
        figure.suptitle("")
        for axes in figure.axes[panels:]:
            axes.remove()
    content = BytesIO()
    figure.savefig(content, format="png", dpi=_DPI, bbox_inches="tight")
    return content.getvalue()

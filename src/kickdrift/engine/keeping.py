"""Conversion between the progress of a run and a checkpoint on disk."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import FileFormatError
from kickdrift.engine.checkpoints import Checkpoints
from kickdrift.engine.grid import Course, Grid, with_step
from kickdrift.engine.rows import Mark
from kickdrift.engine.standing import Standing
from kickdrift.engine.stepper import State
from kickdrift.engine.zeros import Brackets, Seen, Zero

Arrays = Mapping[str, NDArray[Any]]
_ROWS = "rows: "


def keep(checkpoints: Checkpoints, grid: Grid | Course, standing: Standing) -> None:
    """Write a checkpoint of the progress of a run.

    Raises
    ------
    FileFormatError
        If it cannot be written.
    """
    state, seen = standing.state, standing.seen
    header: dict[str, Any] = {"h": grid.step, "wall_time": standing.wall_time, "mark": list(standing.mark)}
    arrays = {"x": state.x, "v": state.v, "scratch": state.scratch}
    arrays |= {"work": np.concatenate([state.work[part] for part in state.kept])}
    arrays |= {_ROWS + name: values for name, values in standing.rows.items()}
    if seen is not None:
        header |= {"evaluations": seen.evaluations, "beyond": seen.beyond}
        arrays |= {f"zeros {name}": np.array([getattr(zero, name) for zero in seen.zeros]) for name in Zero._fields}
        for event, brackets in seen.waiting:
            arrays |= {f"brackets {event} {name}": values for name, values in brackets._asdict().items()}
    checkpoints.write(standing.step, header, arrays)


def find(
    checkpoints: Checkpoints, grid: Grid | Course, blank: State, events: int
) -> tuple[Grid | Course, Standing, str] | None:
    """Return the grid with the run's own step, its progress, and a sentence for the message; None if there is no checkpoint.

    Parameters
    ----------
    checkpoints : Checkpoints
    grid : Grid or Course
        The grid of a run from the start.
    blank : State
        A state of the loop, of the same size.
    events : int
        Number of event functions.

    Raises
    ------
    ArgumentError
        If the checkpoint belongs to another run.
    FileFormatError
        If it is damaged.
    """
    found = checkpoints.find(grid if isinstance(grid, Grid) else None)
    if found is None:
        return None
    header, arrays, said = found
    try:
        h, seconds, mark = float(header["h"]), float(header["wall_time"]), Mark(*header["mark"])
        rows = {name.removeprefix(_ROWS): values for name, values in arrays.items() if name.startswith(_ROWS)}
        if sorted(rows) != _names_of_rows(grid):
            raise LookupError(f"its rows have {', '.join(rows)}")
        seen = _seen_of(header, arrays, events) if events else None
        standing = Standing(_state_of(arrays, blank), int(header["step"]), mark, rows, seconds, seen)
    except (LookupError, TypeError, ValueError) as error:
        raise FileFormatError(
            f"checkpoint={str(checkpoints.folder)!r} has invalid contents ({type(error).__name__}: {error}); remove it"
            " to start again."
        ) from None
    same = with_step(grid, h) if isinstance(grid, Grid) else grid
    if same is None or (same is grid and grid.step != h):
        raise checkpoints.refuse(f"step ({h!r} there, {grid.step!r} here)")
    if (
        isinstance(same, Grid)
        and not same.streamed
        and not np.array_equal(rows["steps"], same.rows_after(standing.step))
    ):
        raise checkpoints.refuse("save_every or t_eval")
    return same, standing, said


def _names_of_rows(grid: Grid | Course) -> list[str]:
    """Return the sorted names of the arrays of rows."""
    at_times = grid.stride == 0 if isinstance(grid, Course) else grid.every is None
    stored = ["spent"] * at_times + ["stored"] if grid.streamed else []
    if isinstance(grid, Course):
        return ["sizes", *stored, "ts", "vs", "xs"]
    return [*(stored or ["steps"]), "vs", "xs"]


def _state_of(arrays: Arrays, blank: State) -> State:
    """Return the state of the loop from the arrays of a checkpoint."""
    state = replace(blank, x=arrays["x"], v=arrays["v"], work=blank.work.copy(), scratch=arrays["scratch"])
    at = 0
    for part in state.kept:
        size = state.work[part].size
        state.work[part] = arrays["work"][at : at + size]
        at += size
    return state


def _seen_of(header: Mapping[str, Any], arrays: Arrays, events: int) -> Seen:
    """Return the zeros of events found so far."""
    columns = zip(*(arrays[f"zeros {name}"] for name in Zero._fields), strict=True)
    zeros = tuple(Zero(float(t), float(at), int(event), x, v, int(took)) for t, at, event, x, v, took in columns)
    waiting = tuple(
        (event, Brackets(*(arrays[f"brackets {event} {name}"] for name in Brackets._fields)))
        for event in range(events)
        if f"brackets {event} t" in arrays
    )
    return Seen(zeros, waiting, int(header["evaluations"]), header["beyond"])

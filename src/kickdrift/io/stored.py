"""Solutions whose rows are in a Zarr group: all else that they hold is in a file of its folder."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from kickdrift.core import archive
from kickdrift.core.errors import FileFormatError
from kickdrift.engine.solution import Solution
from kickdrift.engine.zarr_group import KEPT
from kickdrift.io import ensemble_file, solution_file
from kickdrift.scale.ensemble_solution import EnsembleSolution
from kickdrift.scale.member_store import arrays_of


def keep(solution: Solution | EnsembleSolution) -> None:
    """Write what `load_stored` reads into the folder of the rows.

    Raises
    ------
    FileFormatError
        If it cannot be written.
    """
    file = Path(solution.saved_to) / KEPT
    if isinstance(solution, Solution):
        solution_file.save(solution, file)
        return
    header, arrays = ensemble_file.contents(solution)
    archive.write(file, {**header, "rows": list(solution.invariants), "size of v": solution.v.size}, arrays)


def load_stored(path: Path) -> Solution | EnsembleSolution:
    """Read what `kickdrift.solve` or `kickdrift.solve_ensemble` returned when it wrote its rows to a folder.

    Raises
    ------
    FileFormatError
        If the folder holds no such rows, or their run has not ended.
    """
    file = path / KEPT
    if not file.is_file():
        raise FileFormatError(
            f"path={str(path)!r} is a folder without {KEPT}, which solve and solve_ensemble write to save_to at their"
            " end; repeat the call to finish it, or read its rows with xarray.open_zarr, as for worlds."
        )

    def assemble(head: dict[str, Any], arrays: dict[str, Any]) -> Solution | EnsembleSolution:
        if head["format"] != archive.ENSEMBLE:
            return replace(solution_file.assemble(head, arrays), saved_to=str(path))
        rows = arrays_of(path)
        arrays = {**arrays, "x": rows("x")}
        arrays["v"] = rows("v") if head["size of v"] else np.empty((*arrays["x"].shape[:2], 0))
        arrays |= {solution_file.INVARIANT + name: rows(name) for name in head["rows"]}
        return replace(ensemble_file.assemble(head, arrays), saved_to=str(path))

    return archive.read(file, "a kickdrift solution", "save_to", assemble)

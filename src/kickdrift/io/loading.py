"""Files that hold solutions and recordings, told apart by their formats."""

from pathlib import Path
from typing import Any

from kickdrift.core import archive
from kickdrift.core.errors import FileFormatError
from kickdrift.engine.solution import Solution
from kickdrift.io import ensemble_file, solution_file
from kickdrift.scale.ensemble_solution import EnsembleSolution


def load(path: str | Path) -> Solution | EnsembleSolution:
    """Read a solution, an ensemble solution, or the recording of a world, written by its method `save`.

    Parameters
    ----------
    path : path
        A file, or a folder written by ``save_to=``.

    Returns
    -------
    Solution, EnsembleSolution or Recording
        For a folder what `kickdrift.solve` or `kickdrift.solve_ensemble` returned.

    Raises
    ------
    FileFormatError
        If there is no such file, or it is not a solution.

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(kd.systems.kepler(), (0.0, 20.0), step=0.01, method="leapfrog")
    >>> path = sol.save("orbit.npz")
    >>> bool((kd.load(path).x == sol.x).all())
    True
    """
    if isinstance(path, str | Path) and "\0" not in str(path) and Path(path).is_dir():
        from kickdrift.io.stored import load_stored  # as ensembles are imported, which others need not wait for

        return load_stored(Path(path))

    def assemble(head: dict[str, Any], arrays: dict[str, Any]) -> Solution | EnsembleSolution:
        if head["format"] == archive.RECORDING:
            from kickdrift.io import recording_file  # the world takes a moment that solutions need not wait

            return recording_file.assemble(head, arrays)
        if head["format"] == archive.WORLD:
            raise FileFormatError(f"path={str(path)!r} is a world, not a recording; read it with kickdrift.load_world.")
        if head["format"] == archive.ENSEMBLE:
            return ensemble_file.assemble(head, arrays)
        return solution_file.assemble(head, arrays)

    return archive.read(path, "a kickdrift solution", "Solution.save", assemble)

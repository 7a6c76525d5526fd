"""Files that hold solutions and recordings, told apart by their formats."""

from pathlib import Path
from typing import Any

from kickdrift.core import archive
from kickdrift.core.errors import FileFormatError
from kickdrift.engine.solution import Solution
from kickdrift.io import solution_file


def load(path: str | Path) -> Solution:
    """Read a solution, or the recording of a world, that `Solution.save` or `Recording.save` wrote.

    Raises
    ------
    FileFormatError
        If there is no such file, or it is not a solution.
    """

    def assemble(head: dict[str, Any], arrays: dict[str, Any]) -> Solution:
        if head["format"] == archive.RECORDING:
            from kickdrift.io import recording_file  # the world takes a moment that solutions need not wait

            return recording_file.assemble(head, arrays)
        if head["format"] == archive.WORLD:
            raise FileFormatError(
                f"path={str(path)!r} is a world, not its recording; read it with kickdrift.load_world."
            )
        return solution_file.assemble(head, arrays)

    return archive.read(path, "a kickdrift solution", "Solution.save", assemble)

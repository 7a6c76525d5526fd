"""Pages for the browser inside of a notebook's cell."""

from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution


@dataclass(frozen=True)
class Embedded:
    """A page that plays in the cell of a notebook, without a server; it stays in the notebook when that is saved.

    Attributes
    ----------
    page : str
        The HTML of it.
    height : int
        Of its frame, in pixels.
    """

    page: str = field(repr=False)
    height: int

    def _repr_html_(self) -> str:
        """Return a frame that holds the page itself."""
        return f'<iframe srcdoc="{escape(self.page)}" width="100%" height="{self.height}" style="border:0"></iframe>'


def show(solution: Solution, height: int = 480) -> Embedded:
    """Return the page of a solution or a recording as a value that a notebook shows.

    Parameters
    ----------
    solution : Solution
    height : int
        Of the frame, in pixels.

    Raises
    ------
    ArgumentError
        For a height that is not a number of pixels.
    KickdriftError
        As for `Solution.to_html`.
    """
    if not is_whole(height, 1, 99_999):
        raise ArgumentError(f"height={height!r} must be a whole number of pixels, from 1 to 99999; 480 is usual.")
    with TemporaryDirectory() as folder:
        written = solution.to_html(Path(folder) / "page.html")
        return Embedded(written.read_text(encoding="utf-8"), int(height))

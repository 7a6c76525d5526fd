"""Output of the command line: files in a folder, tables on the terminal, and messages about the run."""

import shutil
import sys
import tempfile
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from textwrap import wrap

from kickdrift.cli import DONE, FAILED, INTERRUPTED
from kickdrift.core.errors import ArgumentError
from kickdrift.core.outcomes import Outcome


def prepare_folder(folder: Path) -> Path:
    """Make a folder and write into it for a test, before any work is done.

    Raises
    ------
    ArgumentError
        If it cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".kickdrift-"):
            pass
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ArgumentError(f"--output={str(folder)!r} cannot be written: {reason}; choose another folder.") from None
    return folder


def say(sentence: str) -> None:
    """Print a message about the run on standard error."""
    print(f"kickdrift: {sentence}", file=sys.stderr, flush=True)


def exit_code(status: Outcome, message: str) -> int:
    """Return the exit code of a run; print its message if it did not succeed."""
    if status.success:
        return DONE
    say(message)
    return INTERRUPTED if status is Outcome.INTERRUPTED else FAILED


_NARROWEST = 24  # characters to which a column of a table may shrink


def show_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table: whole lines where it is piped, wrapped cells on a terminal, blocks of lines on a narrow one."""
    widths = [max(len(line[i]) for line in (columns, *rows)) for i in range(len(columns))]
    if sys.stdout.isatty():
        room = shutil.get_terminal_size().columns - 2 * (len(widths) - 1)
        if sum(min(width, _NARROWEST) for width in widths) > room:
            _show_blocks(columns, rows)
            return
        while sum(widths) > room:
            widths[widths.index(max(widths))] -= 1
    for line in (columns, *rows):
        wrapped = [wrap(cell, width) for cell, width in zip(line, widths, strict=True)]
        for cells in zip_longest(*wrapped, fillvalue=""):
            print("  ".join(f"{cell:<{width}}" for cell, width in zip(cells, widths, strict=True)).rstrip())


def _show_blocks(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    label = max(len(column) for column in columns)
    for name, *cells in rows:
        print(name)
        for column, cell in zip(columns[1:], cells, strict=True):
            print(f"  {column:<{label}}  {cell}")

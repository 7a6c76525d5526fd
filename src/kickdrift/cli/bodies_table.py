"""The CSV file of bodies: a header of names in any order, then a body a line."""

import csv
import io
import math
from pathlib import Path
from typing import Any

from kickdrift.core.errors import FileFormatError, unknown_name
from kickdrift.core.files import opened

COLUMNS = ("name", "mass", "x", "y", "z", "vx", "vy", "vz")
_MOST_BYTES = 64 << 20  # half a million bodies, far beyond what a run could move


def read_bodies_table(path: Path) -> tuple[list[dict[str, Any]], list[int]]:
    """Read the bodies of a CSV file.

    Returns
    -------
    bodies : list of dict
        What the TOML file would hold.
    lines : list of int
        The line of each.

    Raises
    ------
    FileFormatError
        For a file that is not such a table; the sentence names the line.
    """
    reader = csv.reader(read_text(path).splitlines(keepends=True), strict=True)
    bodies: list[dict[str, Any]] = []
    lines: list[int] = []
    header: list[str] = []
    try:
        for row in reader:
            cells, place = [cell.strip() for cell in row], f"{path}:{reader.line_num}"
            if not header:
                header = _checked_header(cells, place)
            elif cells:
                bodies.append(_body(header, cells, place))
                lines.append(reader.line_num)
    except csv.Error as error:
        raise FileFormatError(f"{path}:{reader.line_num}: not a CSV file: {error}.") from None
    if not bodies:
        raise FileFormatError(f"{path}: no bodies; give the header {','.join(COLUMNS)} and a line for each body.")
    return bodies, lines


def read_text(path: Path) -> str:
    """Read a file that may hold anything: it must be a plain file, not too large, in UTF-8.

    Raises
    ------
    FileFormatError
        For one that is not.
    """
    try:
        with opened(path) as file:
            content = file.read(_MOST_BYTES + 1)
        if len(content) > _MOST_BYTES:
            raise FileFormatError(f"{path}: larger than {_MOST_BYTES >> 20} MiB; give a smaller file.")
        return io.TextIOWrapper(io.BytesIO(content), encoding="utf-8-sig").read()
    except UnicodeDecodeError as error:
        raise FileFormatError(f"{path}: byte {error.start} is not UTF-8; save the file as UTF-8.") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise FileFormatError(f"{path}: cannot be read: {reason}; give the path of a readable file.") from None


def _checked_header(cells: list[str], place: str) -> list[str]:
    for cell in cells:
        if cell not in COLUMNS:
            raise FileFormatError(f"{place}: {unknown_name('column', cell, COLUMNS)}")
        if cells.count(cell) > 1:
            raise FileFormatError(f"{place}: column={cell!r} appears twice; name each column once.")
    for column in COLUMNS:
        if column not in cells:
            raise FileFormatError(f"{place}: column={column!r} is missing; the header is {','.join(COLUMNS)}.")
    return cells


def _body(header: list[str], cells: list[str], place: str) -> dict[str, Any]:
    if len(cells) != len(header):
        raise FileFormatError(f"{place}: {len(cells)} values, but the header names {len(header)}; give one for each.")
    texts = dict(zip(header, cells, strict=True))
    numbers = {column: _number(column, texts[column], place) for column in COLUMNS[1:]}
    return {
        "name": texts["name"],
        "mass": numbers["mass"],
        "position": [numbers[column] for column in ("x", "y", "z")],
        "velocity": [numbers[column] for column in ("vx", "vy", "vz")],
    }


def _number(column: str, text: str, place: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FileFormatError(f"{place}: {column}={text!r} must be a finite number.")
    return value

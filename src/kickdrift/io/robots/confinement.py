"""What a robot's file asks MuJoCo to read, and how often to repeat, looked at before MuJoCo does."""

import html
import re
from collections.abc import Iterator
from pathlib import Path

from kickdrift.core.errors import FileFormatError
from kickdrift.core.files import opened

_MOST_COPIES = 10_000  # MuJoCo takes a millisecond for each, and more than in proportion
_MOST_BYTES = 1 << 30

_ATTRIBUTE = re.compile(r"""([\w:]+)\s*=\s*("[^"]*"|'[^']*')""")
_FOLDERS = ("meshdir", "texturedir", "assetdir")
_REPEATS = re.compile(r"<\s*(/?)\s*(replicate|composite|flexcomp)\b([^>]*)>")
_READ_NOW = re.compile(r"<\s*(?:include|model|attach)\b[^>]*>")  # by the parser: their own files are looked at as well


def check(path: Path, content: bytes, folder: Path | None) -> None:
    """Refuse a file that names one outside of a folder, or that repeats its parts more often than can be meant.

    Parameters
    ----------
    path : path
    content : bytes
        Of the file.
    folder : path, optional
        That everything lies in; by default the one that the file is in.

    Raises
    ------
    FileFormatError
    """
    inside = (path.parent if folder is None else folder).resolve()
    waiting, seen, copies = [(path, content.decode("utf-8", "replace"))], {path.resolve()}, 0
    while waiting:
        place, text = waiting.pop()
        copies += _copies(text)
        if copies > _MOST_COPIES:
            raise FileFormatError(
                f"path={str(path)!r} replicates parts {copies} times (replicate, composite or flexcomp); at most"
                f" {_MOST_COPIES} copies are read."
            )
        places = [path.parent, place.parent]
        places += [path.parent / value for name, value in _attributes(text) if name in _FOLDERS]
        for name, value in _attributes(text):
            if name.startswith("file") and "://" not in value:
                _check_inside(path, [at / value for at in places], value, inside)
        for element in _READ_NOW.findall(text):
            for name, value in _attributes(element):
                for found in {(at / value).resolve() for at in places if name == "file"} - seen:
                    if found.exists():
                        seen.add(found)
                        waiting.append((found, _text(path, found)))


def _attributes(text: str) -> Iterator[tuple[str, str]]:
    for name, value in _ATTRIBUTE.findall(text):
        yield name, html.unescape(value[1:-1])


def _check_inside(path: Path, candidates: list[Path], value: str, inside: Path) -> None:
    for candidate in candidates:
        try:
            found = candidate.resolve()
            outside = found.exists() and not found.is_relative_to(inside)
        except (OSError, ValueError):  # a name that no file can have
            continue
        if outside:
            raise FileFormatError(
                f"path={str(path)!r} refers to {value!r}, which is not in {str(inside)!r}; if you trust the file, pass"
                " folder=, a folder that contains all files that it may read."
            )


def _text(path: Path, included: Path) -> str:
    try:
        with opened(included) as file:
            return file.read(_MOST_BYTES).decode("utf-8", "replace")
    except OSError as error:
        raise FileFormatError(
            f"path={str(path)!r} includes {str(included)!r}, which cannot be read: {error.strerror or error}."
        ) from None


def _copies(text: str) -> int:
    """Return how many copies of their parts elements ask for, those inside of others as often as these."""
    total, within = 0, [1]
    for closing, name, attributes in _REPEATS.findall(text):
        if closing:
            within = within[:-1] or [1]
            continue
        copies = within[-1]
        for number in dict(_attributes(attributes)).get("count", "1").split():
            copies *= max(1, int(number) if number.isdecimal() and len(number) < 10 else _MOST_COPIES + 1)
        total += copies
        if name == "replicate" and not attributes.rstrip().endswith("/"):
            within.append(copies)
        if total > _MOST_COPIES:
            break
    return total

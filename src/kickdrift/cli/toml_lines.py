"""On which line of a TOML text a key stands: what `tomllib` knows while it reads, and does not tell."""

import re
import tomllib
from collections.abc import Iterator

Path = tuple[str | int, ...]  # keys and places in arrays, such as ("bodies", 1, "mass")

_TOKEN = re.compile(
    r'"""(?:\\.|[^\\])*?"""|' + r"'''.*?'''|" + r'"(?:\\.|[^"\\\n])*"|' + r"'[^'\n]*'|"  # strings
    r"#[^\n]*|\n|[\[\]{},=]|" + r"""[^\s\[\]{},=#"']+""",  # comments, punctuation, bare words
    re.DOTALL,
)
_VALUE_ENDS = ("\n", ",", "]", "}", "")


def key_lines(source: str) -> dict[Path, int]:
    """Find the line of every key, table and array element.

    Parameters
    ----------
    source : str
        A text that `tomllib` has read without complaint; nothing is checked again.

    Returns
    -------
    dict
        Lines, from 1, by path.
    """
    scanner = _Scanner(source)
    scanner.document()
    return scanner.lines


def line_of(path: Path, lines: dict[Path, int]) -> int:
    """Return the line of a path, or of the nearest thing around it that is in the text."""
    return next((lines[path[:n]] for n in range(len(path), 0, -1) if path[:n] in lines), 1)


class _Scanner:
    def __init__(self, source: str) -> None:
        self.lines: dict[Path, int] = {}
        self._elements: dict[Path, int] = {}  # of arrays of tables so far
        self._tokens = [*_tokens(source), ("", source.count("\n") + 1)]
        self._at = 0

    @property
    def _next(self) -> str:
        return self._tokens[self._at][0]

    @property
    def _line(self) -> int:
        return self._tokens[self._at][1]

    def _take(self) -> str:
        token = self._next
        self._at = min(self._at + 1, len(self._tokens) - 1)
        return token

    def document(self) -> None:
        table: Path = ()
        while self._next:
            if self._next == "\n":
                self._take()
            elif self._next == "[":
                table = self._header()
            else:
                self._pair(table)

    def _header(self) -> Path:
        line = self._line
        self._take()
        of_array = self._next == "["
        if of_array:
            self._take()
        path: Path = ()
        *tables, last = self._key("]")
        for part in tables:
            path += (part,)
            self.lines.setdefault(path, line)
            path += self._newest(path)
        path += (last,)
        if of_array:
            self.lines.setdefault(path, line)
            element = self._elements.get(path, 0)
            self._elements[path] = element + 1
            path += (element,)
            self._take()
        else:
            path += self._newest(path)
        self.lines[path] = line
        return path

    def _newest(self, path: Path) -> Path:
        return (self._elements[path] - 1,) if path in self._elements else ()

    def _key(self, end: str) -> list[str]:
        parts: list[str] = []
        while self._next not in (end, ""):
            token = self._take()
            if token[0] in "\"'":
                parts.append(tomllib.loads(f"key = {token}")["key"])
            else:
                parts += [part for part in token.split(".") if part]
        self._take()
        return parts

    def _pair(self, table: Path) -> None:
        line = self._line
        path = (*table, *self._key("="))
        for n in range(len(table) + 1, len(path) + 1):
            self.lines.setdefault(path[:n], line)
        self._value(path)

    def _value(self, path: Path) -> None:
        if self._next == "[":
            self._take()
            element = 0
            while self._next not in ("]", ""):
                if self._next in ("\n", ","):
                    self._take()
                    continue
                self.lines[(*path, element)] = self._line
                self._value((*path, element))
                element += 1
            self._take()
        elif self._next == "{":
            self._take()
            while self._next not in ("}", ""):
                if self._next in ("\n", ","):
                    self._take()
                    continue
                self._pair(path)
            self._take()
        else:
            while self._next not in _VALUE_ENDS:
                self._take()


def _tokens(source: str) -> Iterator[tuple[str, int]]:
    line = 1
    for match in _TOKEN.finditer(source):
        if not match[0].startswith("#"):
            yield match[0], line
        line += match[0].count("\n")

"""The rows of the table: what was wanted, what was measured, how much it scattered, and the verdict."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike


class Missing(Exception):  # noqa: N818 - not an error: the row says what to install
    """A peer or a compiler that is not here; the message says how to get it."""


class Verdict(Enum):
    """What became of a wanted figure."""

    MET = "met"
    MISSED = "missed"
    MET_NARROWLY = "met, within the noise"
    MISSED_NARROWLY = "missed, within the noise"
    UNJUDGED = ""
    SKIPPED = "skipped"


@dataclass(frozen=True)
class Bound:
    """A wanted figure: at most, or at least, so much."""

    limit: float
    at_most: bool
    unit: str = "x"

    def __str__(self) -> str:
        return f"{'at most' if self.at_most else 'at least'} {number(self.limit)} {self.unit}"

    def judge(self, low: float, middle: float, high: float) -> Verdict:
        """Judge a median by the bound, and say if the bound lies between the quartiles."""
        met = middle <= self.limit if self.at_most else middle >= self.limit
        if low < self.limit < high:
            return Verdict.MET_NARROWLY if met else Verdict.MISSED_NARROWLY
        return Verdict.MET if met else Verdict.MISSED


def at_most(limit: float, unit: str = "x") -> Bound:
    """Want no more than `limit`."""
    return Bound(limit, True, unit)


def at_least(limit: float, unit: str = "x") -> Bound:
    """Want no less than `limit`."""
    return Bound(limit, False, unit)


@dataclass(frozen=True)
class Row:
    """A row of the table, ready to print."""

    what: str
    wanted: str
    measured: str
    spread: str
    verdict: Verdict
    note: str = ""


def measured(what: str, samples: ArrayLike, bound: Bound | None = None, note: str = "", unit: str = "x") -> Row:
    """Make a row of one sample a round: the median, the quartiles as the spread, and the verdict."""
    low, middle, high = np.percentile(np.asarray(samples, dtype=float), [25, 50, 75])
    return Row(
        what=what,
        wanted=str(bound) if bound else "",
        measured=f"{number(middle)} {bound.unit if bound else unit}",
        spread=f"{number(low)} to {number(high)}",
        verdict=bound.judge(low, middle, high) if bound else Verdict.UNJUDGED,
        note=note,
    )


def equal(what: str, wanted: str, found: str, note: str = "") -> Row:
    """Make a row of something that has to come out exactly as printed."""
    return Row(what, wanted, found, "", Verdict.MET if wanted == found else Verdict.MISSED, note)


def skipped(what: str, reason: str) -> Row:
    """Make a row of what could not be measured here."""
    return Row(what, "", "", "", Verdict.SKIPPED, reason)


def number(value: float) -> str:
    """Print three digits, without an exponent where that is readable."""
    return f"{value:.2e}" if value >= 1e5 else f"{value:.3g}"


def markdown(sections: Iterable[tuple[str, Sequence[Row]]]) -> str:
    """Write the table; each section opens with a row of its title."""
    lines = ["| what | wanted | measured | quartiles | verdict | note |", "| --- | --- | --- | --- | --- | --- |"]
    for title, rows in sections:
        lines.append(f"| **{title}** | | | | | |")
        for row in rows:
            cells = (row.what, row.wanted, row.measured, row.spread, row.verdict.value, row.note)
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"

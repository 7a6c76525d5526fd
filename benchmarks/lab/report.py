"""The table of the lab."""

from collections.abc import Sequence

import numpy as np

from benchmarks.lab.running import Contestant, Result
from benchmarks.lab.trial import Trial

Rows = Sequence[tuple[Trial, Sequence[Result]]]
_CALM = (1e-4, 1e-6)  # m/s; single precision leaves its engines 1e-6 to 1e-5


def markdown(rows: Rows, contestants: Sequence[Contestant]) -> str:
    """Write a row a trial, a column an engine, and how many each holds."""
    labels = [contestant.label for contestant in contestants]
    steps = [f"{label}, {1e3 * one.step:.3g} ms" for label, one in zip(labels, contestants, strict=True)]
    lines = [f"| scene | wanted | {' | '.join(steps)} |", "| --- | --- |" + " --- |" * len(labels)]
    for trial, results in rows:
        wanted = "; ".join(filter(None, (criterion.wanted for criterion in trial.criteria)))
        lines.append(f"| {trial.name} | {wanted} | {' | '.join(map(_cell, results))} |")
    return "\n".join([*_counts(rows, labels), "", *lines]) + "\n"


def _cell(result: Result) -> str:
    if result.refused:
        return f"refused: {result.reason}"
    if not result.runs:
        return "-"
    cost = "" if np.isnan(result.cost) else f"; {1e3 * result.cost:.2g} to {1e3 * result.slow:.2g} ms"
    found = "; ".join(criterion.said(value) for criterion, value in result.findings)
    return f"{'holds' if result.holds else '**no**'}: {found}{cost}"


def _counts(rows: Rows, labels: Sequence[str]) -> list[str]:
    lines = [f"| of {len(rows)} scenes | {' | '.join(labels)} |", "| --- |" + " --- |" * len(labels)]
    columns = [[results[k] for _, results in rows] for k in range(len(labels))]
    held = [sum(result.holds for result in column) for column in columns]
    tried = [sum(result.runs for result in column) for column in columns]
    lines.append("| held | " + " | ".join(f"{h} of {t}" for h, t in zip(held, tried, strict=True)) + " |")
    for most in _CALM:
        cells = " | ".join(f"{sum(_rests(result, most) for result in column)}" for column in columns)
        lines.append(f"| at rest, below {most:g} m/s | {cells} |")
    return lines + _behind(rows, labels)


def _rests(result: Result, most: float) -> bool:
    """Whether all stands, where a trial is about rest, and nothing moves faster than this in the end."""
    speeds = [value for criterion, value in result.findings if criterion.label == "speed"]
    return result.holds and bool(speeds) and speeds[0] <= most


def _behind(rows: Rows, labels: Sequence[str]) -> list[str]:
    """Name what another engine does and the first one does not."""
    if len(labels) == 1:
        missed = [trial.name for trial, (result,) in rows if not result.holds]
        return ["", f"Not held: {'; '.join(missed) or 'none'}."]
    held, rest = [], []
    for trial, (first, *others) in rows:
        holding = [label for label, other in zip(labels[1:], others, strict=True) if other.holds]
        resting = [label for label, other in zip(labels[1:], others, strict=True) if _rests(other, _CALM[0])]
        if holding and not first.holds:
            held.append(f"{trial.name} ({', '.join(holding)})")
        if resting and not _rests(first, _CALM[1]):
            rest.append(f"{trial.name} ({', '.join(resting)})")
    return [
        "",
        f"Held by others and not by {labels[0]}: {'; '.join(held) or 'none'}.",
        "",
        f"At rest below {_CALM[0]:g} m/s in others and not below {_CALM[1]:g} in {labels[0]}: {'; '.join(rest) or 'none'}.",
    ]

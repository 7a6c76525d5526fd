"""Work and precision: kickdrift's methods for each kind of problem and the peers that can do it."""

from pathlib import Path

import numpy as np

from benchmarks.precision import curves, measure, ours, preference
from benchmarks.precision.case import Case
from benchmarks.precision.cases import every_case
from benchmarks.precision.curves import Comparison
from benchmarks.table import Row, Verdict, measured, number, skipped
from kickdrift.analysis.work_curve import Curve, nearest

_MOST_ROUNDS = 3


def sections(rounds: int, pictures: Path | None = None) -> list[tuple[str, list[Row]]]:
    """Compare all cases; three rounds do, the ratios are large. Pictures go into a folder, if there is one."""
    found = [_section(case, min(rounds, _MOST_ROUNDS), pictures) for case in every_case()]
    return [*found, (preference.TITLE, preference.compare())]


def _section(case: Case, rounds: int, pictures: Path | None) -> tuple[str, list[Row]]:
    own = [ours.contestant(case, method) for method in case.methods]
    found, missing = measure.curves(case, [*own, *case.peers], rounds)
    kickdrift, peers = found[: len(own)], found[len(own) :]
    rows = [_row(case, peer, kickdrift) for peer in peers]
    rows.extend(skipped(label, reason) for label, reason in missing.items())
    if pictures is not None:
        from benchmarks.precision import picture

        picture.draw(case, kickdrift, peers, pictures / f"{case.name}.png")
    return f"{case.kind.name}: {case.title}; {case.what}", rows


def _row(case: Case, peer: Curve, kickdrift: list[Curve]) -> Row:
    run = nearest(peer, case.near)
    found = curves.compare(peer, run, kickdrift)
    its = f"error {peer.errors[run]:.1e} in {peer.median[run] * 1e3:.3g} ms"
    note = f"{its}; time at equal error{_times(found)}"
    if np.median(found.errors) == 0:
        return Row(f"{peer.label} / kickdrift", "", "", "", Verdict.UNJUDGED, f"{note}; kickdrift has no run as short")
    return measured(f"{peer.label} / {found.most_exact}", found.errors, note=note)


def _times(found: Comparison) -> str:
    low, middle, high = np.percentile(found.times, [25, 50, 75])
    if middle == 0:
        return ": kickdrift has no run as exact"
    method = found.quickest.split()[1]
    return f" {number(middle)} x ({number(low)} to {number(high)}) that of {method}"

"""The report of a recording: one fact per line."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.io.report import lines
from kickdrift.world.recordings.recording import Recording


def report(recording: Recording) -> str:
    """Return a report: what was run, how fast, and what became of energy, momentum and angular momentum."""
    about, seconds = recording.about, recording.wall_time
    simulated = float(recording.t[-1] - recording.t[0])
    looks = recording.appearance
    kept = f"all states are in {recording.saved_to!r}" if recording.saved_to else f"{recording.t.size} states kept"
    rows = [
        ("world", about.system),
        ("bodies", f"{recording.moving.size} that move, {len(looks.parts)} shapes"),
        ("span", f"{recording.t[0]:.6g} to {recording.t[-1]:.6g} s"),
        ("step", f"{recording.step:.6g} s"),
        *_stages(about.word),
        ("steps", f"{recording.n_steps}, {kept}"),
    ]
    if recording.n_steps:
        per_step = seconds / recording.n_steps * 1e3
        rows.append(
            ("wall time", f"{seconds:.3g} s, {per_step:.3g} ms per step, {simulated / seconds:.3g} times real time")
        )
    rows.append(("energy", _change(recording.energy, "J")))
    rows += [(name, _change(recording.derived[name], "J")) for name in ("kinetic energy", "potential energy")]
    for name in ("momentum", "angular momentum"):
        sizes = np.linalg.norm(recording.invariants[name], axis=1)
        rows.append((name, _change(sizes, about.units[name])))
    for name, unit in (("overlap", "mm"), ("joint gap", "mm"), ("residual", "mm/s")):
        values = 1e3 * recording.derived[name]
        if values.any():
            most = "" if recording.saved_to else f"{values.max():.3g} {unit} at most, "
            rows.append((name, f"{most}{values[-1]:.3g} {unit} at the end"))
    away = [np.linalg.norm(x - recording.x[0], axis=1)[recording.moving] for x in recording.x]
    moved = np.nan_to_num(np.fmax.reduce(away))
    if moved.size:
        body = int(recording.moving[int(np.argmax(moved))])
        called = f", {looks.names[body]!r}" if body in looks.names else ""
        when = "from the start to the end" if recording.saved_to else "at most"
        rows.append(("displacement", f"{moved.max():.4g} m {when}, body {body}{called}"))
    rows.append(("outcome", recording.message))
    return lines(rows)


def _stages(word: str) -> list[tuple[str, str]]:
    """Return the names of the stages of a step, from its word: ``begin find-pairs (kick drift)* finish``."""
    before, _, rest = word.partition("(")
    substep, _, after = rest.partition(")*")
    parts = (("stages before", before), ("stages of substeps", substep), ("stages after", after))
    return [(when, ", ".join(stages.split()).replace("-", " ")) for when, stages in parts]


def _change(values: NDArray[np.float64], unit: str) -> str:
    first, last = float(values[0]), float(values[-1])
    return f"{first:.6g} to {last:.6g} {unit} ({last - first:+.3g})"
